use std::time::Duration;

use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::style::Color;
use serde_json::json;

use super::*;
use crate::commands::top::model::Key;

fn model() -> Model {
    let mut model = Model::default();
    let one = |level: &str, state: &str, rate: f64| {
        json!({"level": level, "state": state, "tier": "guarded", "rate_hz": rate,
            "load_percent": 3.25, "overruns": 2, "incarnation": 1})
    };
    let mut camera = one("ERROR", "ERROR", 0.0);
    camera["last_fault"] = json!("segfault in onExecute: \u{1b}[2J");
    model.take_status(json!({
        "applications": {"patrol": "DEGRADED"}, "clock": "real", "time_s": 12.34,
        "emergency_stop": true,
        "container": {"process": 7, "uptime_s": 12.0, "threads": 9, "restarts": 0,
            "port_data_dropped": 3, "events_lost": 0},
        "components": {"camera": camera, "path_planner": one("OK", "ACTIVE", 50.0)},
    }));
    model.take_faults(vec![
        json!({"id": 1, "state": "HEALED", "component": "camera", "kind": "stale",
            "confirmed_ns": 1_500_000_000_u64, "cause": {"consequence_of": 4}, "actions": []}),
        json!({"id": 2, "state": "CONFIRMED", "component": "camera", "kind": "segfault",
            "confirmed_ns": 2_000_000_000_u64, "cause": "root",
            "actions": [{"action": "reset camera", "outcome": "under_way"}]}),
    ]);
    model
}

fn screen(model: &Model, width: u16, height: u16) -> (String, Terminal<TestBackend>) {
    let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
    terminal.draw(|frame| draw(frame, model)).unwrap();
    (terminal.backend().to_string(), terminal)
}

#[test]
fn a_person_sees_states_rates_and_faults() {
    let (text, terminal) = screen(&model(), 80, 24);
    for part in [
        "patrol DEGRADED  12.3 s real   EMERGENCY STOP ",
        "process 7  up 12 s  threads 9  restarts 0  dropped: 3 data, 0 events",
        "> camera",
        "path_planner OK    ACTIVE    guarded    50.0    3.2    2   1",
        "    2.000 s    2 CONFIRMED camera: segfault; reset camera: under way",
        "    1.500 s    1 HEALED    camera: stale (of 4)",
        "q quit",
    ] {
        assert!(text.contains(part), "{part:?} is not in\n{text}");
    }
    assert!(!text.contains('\u{1b}'), "nothing that a terminal obeys");
    let (newest, older) = (text.find("CONFIRMED"), text.find("HEALED"));
    assert!(newest < older, "the newest comes first");
    let buffer = terminal.backend().buffer();
    let coloured = |colour| buffer.content().iter().any(|cell| cell.fg == colour);
    assert!(coloured(Color::Red) && coloured(Color::Green));
}

#[test]
fn what_stands_in_front() {
    for (keys, part) in [
        (&[Key::Letter('?')][..], "asks first"),
        (
            &[Key::Down, Key::Letter('s')],
            "Stop path_planner, and what needs it?",
        ),
        (&[Key::Letter('i'), Key::Down], "> panic"),
    ] {
        let mut model = model();
        for key in keys {
            assert_eq!(model.press(*key), None);
        }
        let (text, _) = screen(&model, 80, 24);
        assert!(text.contains(part), "{part:?} is not in\n{text}");
    }
}

#[test]
fn whoever_is_gone_is_said_to_be() {
    let mut model = model();
    model.lose(
        "no application is running\n  help: start one".into(),
        Duration::from_secs(9),
    );
    let (text, _) = screen(&model, 80, 24);
    assert!(
        text.contains("no application answers (for 9 s); waiting, q quits"),
        "{text}"
    );
    assert!(text.contains("no application is running"), "{text}");
    assert!(
        text.contains("path_planner"),
        "the last that was known stays"
    );
}

#[test]
fn any_size_will_do() {
    let mut model = model();
    for (width, height) in [(1, 1), (3, 2), (20, 5), (80, 3), (40, 60), (300, 100)] {
        for dialog in [Dialog::None, Dialog::Help, Dialog::Stop, Dialog::Inject(5)] {
            model.dialog = dialog;
            let (text, _) = screen(&model, width, height);
            assert_eq!(text.lines().count(), usize::from(height));
        }
    }
    screen(&Model::default(), 80, 24);
}
