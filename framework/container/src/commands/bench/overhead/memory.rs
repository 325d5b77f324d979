//! How much memory a process and all its descendants take, as the kernel counts it.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};

/// What is counted, by the names of the result for programs.
pub(super) const QUANTITIES: [&str; 7] = [
    "rss_kib",
    "pss_kib",
    "library_copies_kib",
    "threads",
    "open_files",
    "mappings",
    "processes",
];
const RSS: usize = 0;
const PSS: usize = 1;
const COPIES: usize = 2;
const THREADS: usize = 3;
const FILES: usize = 4;
const MAPPINGS: usize = 5;
const PROCESSES: usize = 6;

/// What a process and its descendants take, one number for each of [`QUANTITIES`]: resident pages
/// with shared ones counted in each process and divided among them, copies of libraries in memory
/// files (what is mapped of them is resident, too), threads, open files, mappings, processes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Footprint(pub(super) [f64; QUANTITIES.len()]);

/// Memory that comes and goes although nothing happens, such as buffers of the event log, in KiB.
const NOISE_KIB: f64 = 64.0;

impl Footprint {
    /// Whether nothing but noise is between them.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        let same = |quantity: usize| self.0[quantity] == other.0[quantity];
        (self.0[RSS] - other.0[RSS]).abs() <= NOISE_KIB && same(COPIES) && same(THREADS)
    }

    /// The share of each, where the other one has `count` fewer.
    pub(super) fn each(&self, without: &Self, count: usize) -> Self {
        let mut each = *self;
        for (this, other) in each.0.iter_mut().zip(without.0) {
            *this = (*this - other) / count as f64;
        }
        each
    }
}

/// Looks at a process and its descendants.
///
/// # Errors
/// If the process is not there any more.
pub(super) fn footprint(process: u32) -> io::Result<Footprint> {
    let mut sum = Footprint::default();
    let mut copies = BTreeMap::new();
    let mut waiting = vec![process];
    while let Some(process) = waiting.pop() {
        let folder = PathBuf::from(format!("/proc/{process}"));
        match add(&folder, &mut sum, &mut copies) {
            Ok(children) => waiting.extend(children),
            // A descendant may end while it is looked at.
            Err(error) if waiting.is_empty() && sum == Footprint::default() => return Err(error),
            Err(_ended) => {}
        }
    }
    sum.0[COPIES] = copies.into_values().sum();
    Ok(sum)
}

/// Adds a process; its children are returned. Memory files are told apart by their numbers: several
/// processes may have the same one open.
fn add(
    folder: &Path,
    sum: &mut Footprint,
    copies: &mut BTreeMap<u64, f64>,
) -> io::Result<Vec<u32>> {
    let rollup = fs::read_to_string(folder.join("smaps_rollup"))?;
    let maps = fs::read_to_string(folder.join("maps"))?;
    let mut children = Vec::new();
    for task in fs::read_dir(folder.join("task"))? {
        let of_task = fs::read_to_string(task?.path().join("children")).unwrap_or_default();
        children.extend(
            of_task
                .split_whitespace()
                .filter_map(|it| it.parse::<u32>().ok()),
        );
        sum.0[THREADS] += 1.0;
    }
    for file in fs::read_dir(folder.join("fd"))? {
        let path = file?.path();
        sum.0[FILES] += 1.0;
        let target = fs::read_link(&path).unwrap_or_default();
        if target.to_string_lossy().starts_with("/memfd:")
            && let Ok(file) = fs::metadata(&path)
        {
            copies.insert(file.ino(), file.blocks() as f64 / 2.0);
        }
    }
    sum.0[RSS] += field(&rollup, "Rss:");
    sum.0[PSS] += field(&rollup, "Pss:");
    sum.0[MAPPINGS] += maps.lines().count() as f64;
    sum.0[PROCESSES] += 1.0;
    Ok(children)
}

fn field(rollup: &str, name: &str) -> f64 {
    let line = rollup.lines().find_map(|line| line.strip_prefix(name));
    let number = line.and_then(|line| line.split_whitespace().next());
    number
        .and_then(|number| number.parse().ok())
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_found_by_their_whole_names() {
        let rollup = "Rss:   104 kB\nPss:  52 kB\nPss_Dirty:  20 kB\n";
        for (name, expected) in [("Rss:", 104.0), ("Pss:", 52.0), ("Swap:", 0.0)] {
            assert_eq!(field(rollup, name), expected, "{name}");
        }
    }

    #[test]
    fn this_process_takes_something() {
        let footprint = footprint(std::process::id()).expect("this process is there");
        for quantity in [RSS, PSS, THREADS, FILES, MAPPINGS, PROCESSES] {
            assert!(footprint.0[quantity] > 0.0, "{}", QUANTITIES[quantity]);
        }
    }

    #[test]
    fn the_share_of_each_is_the_difference_divided() {
        let of = |number: f64| Footprint([number; QUANTITIES.len()]);
        assert_eq!(of(110.0).each(&of(10.0), 50), of(2.0));
    }
}
