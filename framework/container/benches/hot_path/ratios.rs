//! The ratios that matter, from the measurements of this run.

use std::path::PathBuf;
use std::time::SystemTime;

/// Median and 99th percentile of one benchmark, in nanoseconds.
struct Figure {
    median_ns: f64,
    p99_ns: f64,
}

/// Where criterion left what it measured, and since when that is of this run.
struct Run {
    root: PathBuf,
    since: SystemTime,
}

/// Prints the table: of what was measured since then, not what earlier runs have left.
pub fn print(since: SystemTime) {
    let Some(root) = results() else {
        println!("no measurements to compare");
        return;
    };
    let run = &Run { root, since };
    println!("\nRatios of this run (medians; p99 over criterion's samples)");
    difference(
        run,
        "guard: guarded call over plain call",
        "guard/guarded_call",
        "guard/plain_call",
    );
    for (what, one, other) in [
        ("interposed / the library's own", "interposed", "library"),
        (
            "in a component, counted / not",
            "in_component_counted",
            "in_component",
        ),
    ] {
        let name = |which: &str| format!("allocation/{which}");
        ratio(
            run,
            &format!("allocation: {what}"),
            &name(one),
            &name(other),
        );
    }
    for policy in ["last", "fifo"] {
        for size in [64, 4096] {
            for threads in ["same_thread", "across_threads"] {
                let name = |queue: &str| format!("ports/{policy}_{queue}_{size}_{threads}");
                let what = format!("{policy} {size} B {}", threads.replace('_', " "));
                ratio(
                    run,
                    &format!("{what}: port / bare queue"),
                    &name("port"),
                    &name("bare"),
                );
                ratio(
                    run,
                    &format!("{what}: port / rtrb"),
                    &name("port"),
                    &name("rtrb"),
                );
                ratio(
                    run,
                    &format!("{what}: port / crossbeam"),
                    &name("port"),
                    &name("crossbeam"),
                );
            }
        }
    }
    for length in [2u32, 10] {
        if let Some(cycle) = figure(run, &format!("cycle/chain_of_{length}")) {
            println!(
                "  {:52} {:8.1} ns a component (p99 {:.1})",
                format!("chain of {length}: executor cycle"),
                cycle.median_ns / f64::from(length),
                cycle.p99_ns / f64::from(length)
            );
        }
        monitors(run, length);
    }
}

fn monitors(run: &Run, length: u32) {
    let chain = |name: &str| figure(run, &format!("cycle/{name}_of_{length}"));
    if let (Some(with), Some(without)) = (chain("monitored_chain"), chain("chain")) {
        let more_ns = (with.median_ns - without.median_ns) / f64::from(length);
        println!(
            "  {:52} {more_ns:+8.1} ns a component a cycle, ratio {:.2}",
            format!("chain of {length}: all monitors on"),
            with.median_ns / without.median_ns
        );
    }
}

fn ratio(run: &Run, what: &str, one: &str, other: &str) {
    if let (Some(one), Some(other)) = (figure(run, one), figure(run, other)) {
        println!(
            "  {what:52} {:8.2}     ({:.1} ns p99 {:.1} / {:.1} ns p99 {:.1})",
            one.median_ns / other.median_ns,
            one.median_ns,
            one.p99_ns,
            other.median_ns,
            other.p99_ns
        );
    }
}

fn difference(run: &Run, what: &str, one: &str, other: &str) {
    if let (Some(one), Some(other)) = (figure(run, one), figure(run, other)) {
        println!(
            "  {what:52} {:+8.1} ns  ({:.1} ns p99 {:.1} / {:.1} ns p99 {:.1})",
            one.median_ns - other.median_ns,
            one.median_ns,
            one.p99_ns,
            other.median_ns,
            other.p99_ns
        );
    }
}

/// The samples of a benchmark: total times over numbers of iterations.
fn figure(run: &Run, name: &str) -> Option<Figure> {
    let file = run.root.join(name).join("new/sample.json");
    if file.metadata().ok()?.modified().ok()? < run.since {
        return None;
    }
    let text = std::fs::read(file).ok()?;
    let sample: serde_json::Value = serde_json::from_slice(&text).ok()?;
    let numbers = |key: &str| -> Option<Vec<f64>> {
        sample
            .get(key)?
            .as_array()?
            .iter()
            .map(serde_json::Value::as_f64)
            .collect()
    };
    let (times, iterations) = (numbers("times")?, numbers("iters")?);
    let mut each: Vec<f64> = times
        .iter()
        .zip(&iterations)
        .map(|(time, count)| time / count)
        .collect();
    each.sort_by(f64::total_cmp);
    let at = |share: f64| {
        each.get(((each.len() - 1) as f64 * share) as usize)
            .copied()
    };
    Some(Figure {
        median_ns: at(0.5)?,
        p99_ns: at(0.99)?,
    })
}

/// Where criterion keeps its results: beside the profile folder of this executable.
fn results() -> Option<PathBuf> {
    let executable = std::env::current_exe().ok()?;
    let root = executable.ancestors().nth(3)?.join("criterion");
    root.is_dir().then_some(root)
}
