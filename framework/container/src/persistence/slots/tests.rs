//! The newest file that may be restored is found, whatever became of the other one.

use super::super::record::LibraryIdentity;
use super::*;

const NOW: Duration = Duration::from_secs(1_700_000_000);
const MAX_AGE: Duration = Duration::from_secs(60);

fn record(sequence: u64) -> Record {
    Record {
        origin: Origin {
            application: "patrol".to_owned(),
            component: "planner".to_owned(),
            library: LibraryIdentity::of("libplanner.so".to_owned(), b"ELF"),
        },
        written: 0,
        sequence,
        incarnation: 1,
        taken: NOW,
        memory: sequence.to_le_bytes().to_vec(),
    }
}

struct Disk {
    folder: tempfile::TempDir,
    slots: Slots,
}

impl Disk {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let slots = Slots::new(folder.path(), "planner");
        Self { folder, slots }
    }

    fn write(&mut self, sequence: u64) {
        self.slots.write(&mut record(sequence)).unwrap();
    }

    /// A container that is started again: the checkpoint that it finds, and what it refuses.
    fn restart(&mut self) -> (Option<u64>, Vec<String>) {
        self.slots = Slots::new(self.folder.path(), "planner");
        let found = self.slots.find(&record(0).origin, Some(8), NOW, MAX_AGE);
        let told = |file: &RefusedFile| {
            let name = file.path.file_name().unwrap().to_string_lossy();
            format!("{name}: {}", file.refusal)
        };
        let refused = found.refused.iter().map(told).collect();
        (found.fit.map(|(record, _)| record.sequence), refused)
    }

    fn path(&self, ending: &str) -> PathBuf {
        self.folder.path().join(format!("planner.{ending}"))
    }

    fn tear(&self, ending: &str) {
        let content = std::fs::read(self.path(ending)).unwrap();
        std::fs::write(self.path(ending), &content[..content.len() / 2]).unwrap();
    }
}

#[test]
fn the_newest_is_found_and_numbers_go_on() {
    let mut disk = Disk::new();
    assert_eq!(disk.restart(), (None, vec![]));
    for sequence in [5, 6, 7] {
        disk.write(sequence);
        assert_eq!(disk.restart(), (Some(sequence), vec![]));
    }
    // The one before is there as well, and nothing else.
    assert_eq!(std::fs::read_dir(disk.folder.path()).unwrap().count(), 2);
    assert_eq!(disk.slots.written, 3);
}

#[test]
fn of_a_broken_newest_the_previous_is_used_and_never_overwritten_first() {
    let mut disk = Disk::new();
    disk.write(1);
    disk.write(2);
    disk.tear("b");
    let (found, refused) = disk.restart();
    assert_eq!(found, Some(1));
    assert!(
        refused[0].starts_with("planner.b: it is torn: "),
        "{refused:?}"
    );
    assert_eq!(refused.len(), 1);
    // The next writing replaces the broken one.
    disk.write(3);
    disk.tear("b");
    assert_eq!(disk.restart().0, Some(1));
    disk.tear("a");
    let (found, refused) = disk.restart();
    assert_eq!((found, refused.len()), (None, 2));
}

#[test]
fn a_writing_that_was_interrupted_is_no_matter() {
    let mut disk = Disk::new();
    disk.write(1);
    std::fs::write(disk.path("new"), "half of a fi").unwrap();
    assert_eq!(disk.restart(), (Some(1), vec![]));
    disk.write(2);
    assert_eq!(disk.restart(), (Some(2), vec![]));
}

#[test]
fn a_foreign_newest_is_refused_and_the_previous_used() {
    let mut disk = Disk::new();
    disk.write(1);
    let mut foreign = record(2);
    foreign.origin.library.name = "libsecondary.so".to_owned();
    disk.slots.write(&mut foreign).unwrap();
    let (found, refused) = disk.restart();
    assert_eq!(found, Some(1));
    let expected = "planner.b: it is foreign: of library 'libsecondary.so', not 'libplanner.so'";
    assert_eq!(refused, [expected]);
    // Numbers go on behind the refused one, or it would be the newest for ever.
    disk.write(3);
    assert_eq!(disk.restart(), (Some(3), vec![]));
}

#[test]
fn what_cannot_be_read_is_refused() {
    let mut disk = Disk::new();
    disk.write(1);
    std::fs::create_dir(disk.path("b")).unwrap();
    let (found, refused) = disk.restart();
    assert_eq!(found, Some(1));
    assert!(
        refused[0].starts_with("planner.b: it cannot be read: "),
        "{refused:?}"
    );
}
