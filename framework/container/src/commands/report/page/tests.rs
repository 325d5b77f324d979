use serde_json::{Value, json};
use system_profile::Document;

use super::*;
use crate::commands::report::gathering::Gathering;

/// What comes from outside and would like to be markup.
const HOSTILE: &str = "</title><script>alert('\"&amp;\u{0}\u{7}')</script><img src=x onerror=y>";

fn run(events: &[Value]) -> Run {
    let mut gathering = Gathering::new(format!("{HOSTILE}.jsonl"));
    for event in events {
        gathering.learn(event).expect("an event");
    }
    gathering.finish()
}

/// A run in which every text is hostile.
fn hostile() -> Run {
    let mut run = run(&[
        json!({"t_ns": 0, "event": "run_started", "application": HOSTILE, "clock": HOSTILE}),
        json!({"t_ns": 1, "event": "state", "component": HOSTILE, "from": HOSTILE, "to": HOSTILE}),
        json!({"t_ns": 2, "event": "injection", "fault": HOSTILE, "component": HOSTILE,
               "change": HOSTILE}),
        json!({"t_ns": 3, "event": "notice", "message": HOSTILE}),
        json!({"t_ns": 3, "event": "log", "component": HOSTILE, "level": "error",
               "message": HOSTILE}),
        json!({"t_ns": 4, "event": "overrun", "executor": HOSTILE}),
        json!({"t_ns": 5, "event": "verdict", "id": 1, "kind": HOSTILE, "component": HOSTILE,
               "severity": HOSTILE, "state": HOSTILE, "rule": HOSTILE, "plan": [HOSTILE],
               "actions": [{"action": HOSTILE, "outcome": HOSTILE, "note": HOSTILE}],
               "evidence": {"exception": {"callback": HOSTILE, "message": HOSTILE,
                                          "backtrace": [HOSTILE], "place": HOSTILE}}}),
        json!({"t_ns": 5, "event": "verdict", "id": 2, "component": HOSTILE,
               "evidence": {"value": {"port": HOSTILE, "field": HOSTILE, "value": 7,
                                      "maximum": 3}}}),
        json!({"t_ns": 5, "event": "verdict", "id": 3, "evidence": {HOSTILE: {HOSTILE: HOSTILE}}}),
        json!({"t_ns": 9, "event": "run_stopped", "reason": HOSTILE}),
    ]);
    let component = json!({"state": HOSTILE, "tier": HOSTILE});
    run.summary = serde_json::from_value(json!({
        "applications": {HOSTILE: {"state": HOSTILE}}, "components": {HOSTILE: component},
    }))
    .expect("a summary");
    run.path = vec![(1, [0.0, 0.0]), (7, [1.0, 1.0])];
    run.path_topic = HOSTILE.to_owned();
    run.picture = Some(HOSTILE.to_owned());
    run
}

/// The page as a tree, if it is well-formed.
#[track_caller]
fn well_formed(page: &str) -> system_profile::tree::Element {
    let markup = page
        .strip_prefix("<!DOCTYPE html>\n")
        .expect("a document type");
    let document = Document::from_bytes("report.html", markup.as_bytes());
    match document.tree() {
        Some(root) => root.clone(),
        None => panic!("not well-formed: {:?}\n{page}", document.problems()),
    }
}

fn count_elements(element: &system_profile::tree::Element, name: &str) -> usize {
    let inside = element.children.iter().map(|it| count_elements(it, name));
    inside.sum::<usize>() + usize::from(element.name == name)
}

#[test]
fn no_text_becomes_markup() {
    let page = page(&[hostile(), hostile()]);
    let root = well_formed(&page);
    assert_eq!(count_elements(&root, "script"), 0);
    assert_eq!(count_elements(&root, "img"), 2, "the pictures");
    assert_eq!(count_elements(&root, "article"), 6);
    assert!(
        !page.contains("<script") && !page.contains("onerror=y>"),
        "{page}"
    );
    assert!(page.contains("&lt;script&gt;alert(&#39;&quot;&amp;amp;"));
}

#[test]
fn nothing_is_loaded_from_anywhere() {
    let page = page(&[hostile()]);
    assert!(
        page.contains(POLICY.replace('\'', "&#39;").as_str()),
        "{page}"
    );
    for word in ["http://", "https://", "<link", "@import", "url("] {
        assert!(!page.contains(word), "{word}");
    }
}

#[test]
fn every_fault_is_on_the_page() {
    let verdicts = (1..=300).map(|id| json!({"t_ns": id, "event": "verdict", "id": id}));
    let page = page(&[run(&verdicts.collect::<Vec<_>>())]);
    well_formed(&page);
    for id in 1..=300 {
        assert_eq!(
            page.matches(&format!("data-verdict=\"{id}\"")).count(),
            1,
            "{id}"
        );
    }
}

#[test]
fn a_run_of_which_nothing_is_known_has_a_page() {
    let page = page(&[Run::default()]);
    well_formed(&page);
    assert!(page.contains("No fault was confirmed."), "{page}");
}
