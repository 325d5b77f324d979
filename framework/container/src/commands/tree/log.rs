//! `steadfast tree log`: what the trees of a run did, from its event file.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use serde_json::{Value, json};

use crate::commands::output;
use crate::commands::run::Failed;
use crate::commands::{exit_code, manual};

/// A chart of more bars takes a browser a minute; a mission of five minutes has some hundred.
const MOST_BARS: usize = 500;

/// What a bar may be short of and still be seen, in milliseconds.
const LEAST_BAR_MS: u64 = 1;

#[derive(Debug, Args)]
#[command(after_long_help = manual::TREE)]
pub(super) struct LogArguments {
    /// An event file, as `steadfast run --events` writes it
    file: PathBuf,
    /// Only this tree, by the name that the application gives it
    #[arg(long, value_name = "NAME")]
    tree: Option<String>,
    /// How the log is written
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people: one line for each change
    Text,
    /// A Gantt chart that GitHub and other pages draw
    Mermaid,
    /// For programs: one JSON object
    Json,
}

/// A node, or the tree itself where `node` is empty, begins to be in a state.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Change {
    t_ns: u64,
    tree: String,
    node: String,
    state: String,
}

/// Prints the log of a run.
pub(super) fn run(arguments: &LogArguments) -> ExitCode {
    let written = read(&arguments.file).and_then(|mut changes| {
        if let Some(tree) = &arguments.tree {
            changes.retain(|change| change.tree == *tree);
        }
        if changes.is_empty() {
            return Err(refused(&arguments.file, "has no tree in it"));
        }
        let text = match arguments.format {
            Format::Text => text(&changes),
            Format::Mermaid => mermaid(&changes),
            Format::Json => format!("{:#}\n", json(&changes)),
        };
        output::write(None, &text)
    });
    match written {
        Ok(()) => ExitCode::from(exit_code::DONE),
        Err(failed) => {
            // If nobody reads the text the exit code still tells.
            let _unread = writeln!(io::stderr(), "steadfast tree: {}", failed.text);
            ExitCode::from(failed.code)
        }
    }
}

fn refused(path: &Path, what: &str) -> Failed {
    Failed {
        code: exit_code::REFUSED,
        text: format!(
            "{} {what}\n  help: name a file that `steadfast run --events` wrote of an application with a <tree>",
            path.display()
        ),
    }
}

fn read(path: &Path) -> Result<Vec<Change>, Failed> {
    let content = std::fs::read_to_string(path).map_err(|error| Failed {
        code: exit_code::FILE,
        text: format!(
            "{} cannot be read: {error}\n  help: name what `steadfast run --events` wrote",
            path.display()
        ),
    })?;
    changes(&content).map_err(|what| refused(path, &what))
}

/// All changes in their order. The half line that a killed container leaves is passed over.
fn changes(content: &str) -> Result<Vec<Change>, String> {
    let mut changes = Vec::new();
    for (line, number) in content.split_inclusive('\n').zip(1_u32..) {
        match serde_json::from_str::<Value>(line) {
            Ok(event) => learn(&event, &mut changes),
            Err(_unfinished) if !line.ends_with('\n') && number > 1 => break,
            Err(error) => return Err(format!("has no event in line {number}: {error}")),
        }
    }
    Ok(changes)
}

fn learn(event: &Value, changes: &mut Vec<Change>) {
    let text = |name: &str| event[name].as_str().unwrap_or_default().to_owned();
    let t_ns = event["t_ns"].as_u64().unwrap_or_default();
    let tree = text("tree");
    let change = |node: &str, state: &str| Change {
        t_ns,
        tree: tree.clone(),
        node: node.to_owned(),
        state: state.to_owned(),
    };
    match event["event"].as_str() {
        Some("tree_state") => changes.push(change("", &text("to"))),
        Some("tree_nodes") => {
            let nodes = event["nodes"].as_array().into_iter().flatten();
            let pairs = nodes.filter_map(|it| Some((it[0].as_str()?, it[1].as_str()?)));
            changes.extend(pairs.map(|(node, state)| change(node, state)));
        }
        _ => {}
    }
}

fn text(changes: &[Change]) -> String {
    let mut text = String::new();
    for change in changes {
        let seconds = std::time::Duration::from_nanos(change.t_ns).as_secs_f64();
        let node = match change.node.as_str() {
            "" => String::new(),
            node => format!(" {node}"),
        };
        // Writing to memory does not fail.
        let _infallible = writeln!(
            text,
            "[{seconds:10.3}] {}{node}: {}",
            change.tree, change.state
        );
    }
    text
}

fn json(changes: &[Change]) -> Value {
    let changes = changes
        .iter()
        .map(|it| json!({"t_ns": it.t_ns, "tree": it.tree, "node": it.node, "state": it.state}));
    json!({"changes": changes.collect::<Vec<_>>()})
}

/// A node at work, from when it begins to be RUNNING until it is something else.
struct Bar<'a> {
    tree: &'a str,
    node: &'a str,
    from_ms: u64,
    to_ms: u64,
    /// What it came to; nothing if it was at work when the record ends.
    end: Option<&'a str>,
}

fn bars(changes: &[Change]) -> Vec<Bar<'_>> {
    let last_ms = changes.last().map_or(0, |it| it.t_ns / 1_000_000);
    let mut at_work: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    let mut bars: Vec<Bar<'_>> = Vec::new();
    for change in changes {
        let (tree, node) = (change.tree.as_str(), change.node.as_str());
        let now_ms = change.t_ns / 1_000_000;
        let is_running = change.state.eq_ignore_ascii_case("running");
        match at_work.remove(&(tree, node)) {
            Some(at) if is_running => _ = at_work.insert((tree, node), at),
            Some(at) => {
                bars[at].to_ms = now_ms;
                bars[at].end = Some(&change.state);
            }
            None if is_running => {
                at_work.insert((tree, node), bars.len());
                bars.push(Bar {
                    tree,
                    node,
                    from_ms: now_ms,
                    to_ms: last_ms,
                    end: None,
                });
            }
            None => {}
        }
    }
    bars
}

/// A section for each tree, a bar for each time at which a node was at work: grey if it succeeded, red
/// if it failed, blue else.
fn mermaid(changes: &[Change]) -> String {
    let bars = bars(changes);
    let left_out = bars.len().saturating_sub(MOST_BARS);
    let mut text = "gantt\n  dateFormat x\n  axisFormat %M:%S\n".to_owned();
    if left_out > 0 {
        text += &format!("  %% the last {left_out} times are left out\n");
    }
    let mut trees: Vec<&str> = bars.iter().map(|bar| bar.tree).collect();
    trees.sort_unstable();
    trees.dedup();
    for tree in trees {
        text += &format!("  section {}\n", plain(tree));
        let shown = bars.iter().take(MOST_BARS);
        for bar in shown.filter(|bar| bar.tree == tree) {
            let name = match bar.node.rsplit('/').next() {
                None | Some("") => plain(tree),
                Some(name) => plain(name),
            };
            let kind = match bar.end.map(str::to_ascii_lowercase).as_deref() {
                Some("success") => "done",
                Some("failure" | "failed") => "crit",
                _ => "active",
            };
            let to_ms = bar.to_ms.max(bar.from_ms + LEAST_BAR_MS);
            text += &format!("  {name} :{kind}, {}, {to_ms}\n", bar.from_ms);
        }
    }
    text
}

/// Without what ends a name in a Gantt chart.
fn plain(name: &str) -> String {
    name.replace([':', ';', '#', '\n'], " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    const EVENTS: &str = r#"{"t_ns":0,"event":"run_started"}
{"t_ns":1000000,"event":"tree_state","tree":"night","from":"waiting","to":"running"}
{"t_ns":1000000,"event":"tree_nodes","tree":"night","nodes":[["Night/rest","RUNNING"],["Night/ask::7","FAILURE"]],"left_out":0}
{"t_ns":501000000,"event":"tree_nodes","tree":"night","nodes":[["Night/rest","SUCCESS"],["Night/work","RUNNING"]],"left_out":0}
{"t_ns":501200000,"event":"tree_nodes","tree":"night","nodes":[["Night/work","FAILURE"],["Night/wait","RUNNING"]],"left_out":0}
{"t_ns":900000000,"event":"tree_nodes","tree":"night","nodes":[["Night/other","IDLE"]],"left_out":0}
{"t_ns":9000"#;

    #[test]
    fn bars_are_times_at_work_with_their_ends() {
        let changes = changes(EVENTS).expect("events, and half of one");
        assert_eq!(
            mermaid(&changes),
            "gantt\n  dateFormat x\n  axisFormat %M:%S\n  section night\n  night :active, 1, 900\n  \
             rest :done, 1, 501\n  work :crit, 501, 502\n  wait :active, 501, 900\n"
        );
        let text = text(&changes);
        assert!(
            text.contains("[     0.501] night Night/work: RUNNING\n"),
            "{text}"
        );
        assert_eq!(json(&changes)["changes"].as_array().map(Vec::len), Some(8));
    }

    #[test]
    fn a_chart_has_a_bound_and_names_end_nothing() {
        let change = |t_ns, state: &str| Change {
            t_ns,
            tree: "a: b;#".into(),
            node: "x:y".into(),
            state: state.into(),
        };
        let many: Vec<Change> = (0..600)
            .flat_map(|number| [change(number, "RUNNING"), change(number, "SUCCESS")])
            .collect();
        let chart = mermaid(&many);
        assert_eq!(chart.matches(":done").count(), MOST_BARS);
        assert!(chart.contains("the last 100 times are left out"), "{chart}");
        assert!(chart.contains("section a  b  \n  x y :done"), "{chart}");
    }

    #[test]
    fn what_is_no_event_file_is_refused_by_its_line() {
        for (content, expected) in [
            ("<svg/>\n", Err("line 1")),
            ("{\"t_ns\":1}\nnonsense\n{}\n", Err("line 2")),
            ("{\"t_ns\":1}\n{\"t_n", Ok(0)),
            ("", Ok(0)),
        ] {
            match (changes(content), expected) {
                (Ok(found), Ok(count)) => assert_eq!(found.len(), count),
                (Err(text), Err(words)) => assert!(text.contains(words), "{text}"),
                (found, expected) => panic!("{expected:?}, {found:?}"),
            }
        }
    }
}
