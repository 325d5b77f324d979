//! The first experiment of the ReFrESH paper: smoke blows before the camera, the battery is low, and the
//! task goes on with the software dehazer.

use serde_json::{Value, json};
use tests::{Application, Outcome, repository};

use crate::visual_servoing::{Tracked, tracked};

/// When smoke blows in, in the world of the application.
const SMOKE_NS: u64 = 4_400_000_000;
/// The camera takes ten pictures a second.
const CAMERA_PERIOD_NS: u64 = 100_000_000;
/// The error at which the task as it runs is not good enough: P_F does not exceed 0.2 where
/// 1 - error / 50 does not exceed 0.2 / (0.95 * 0.9), what camera and PID leave.
const MOST_ERROR: f64 = 38.3;

fn drive(arguments: &[&str]) -> (Outcome, Vec<Tracked>) {
    let run = Application::new();
    let file = run.folder().join("run.mcap");
    let recording = file.to_str().expect("a path of this test");
    let root = repository();
    let profile = root.join("profiles/applications/visual_servoing_adaptive.xml");
    let rules = root.join("rules/visual_servoing_adaptive.xml");
    let rules = rules.to_str().expect("a path of this repository");
    let all = [arguments, &["--rules", rules, "--record", recording]].concat();
    let outcome = run.run_file(&profile, &all).ended_well();
    (outcome, tracked(&file))
}

fn only_decision(outcome: &Outcome) -> &Value {
    let events = outcome.all_events().iter();
    let decisions: Vec<&Value> = events
        .filter(|event| event["event"] == "adaptation")
        .collect();
    assert_eq!(decisions.len(), 1, "{decisions:#?}");
    decisions[0]
}

/// From the first picture whose error is too large to the first one of the new configuration it takes
/// less than two camera periods, whatever the seed.
#[test]
fn in_smoke_the_task_goes_on_with_the_software_dehazer() {
    for seed in 1..=20 {
        let seed = seed.to_string();
        let (outcome, tracked) = drive(&["--clock", "simulated", "--for", "8s", "--seed", &seed]);
        let decision = only_decision(&outcome);
        let candidates = decision["candidates"].as_array().expect("candidates");
        assert_eq!(candidates.len(), 2, "seed {seed}: {decision:#}");
        assert_eq!(decision["chosen"], 1, "seed {seed}: {decision:#}");
        let with_software = json!([
            "R1:Cam_reader",
            "R1:Dehazer(SW)",
            "R1:SSD",
            "R1:Traj_Gen_1",
            "R1:PID",
            "R1:Tbot_motor"
        ]);
        assert_eq!(candidates[0]["components"], with_software);
        let reason = &candidates[1]["rejected_because"];
        assert_eq!(reason, "R1 has 8 W of power, 13.4 needed");
        let changed_ns = decision["t_ns"].as_u64().expect("a time");
        let crossing = tracked.iter().find(|it| it.error > MOST_ERROR);
        let crossing_ns = crossing.expect("smoke is seen").time_ns;
        assert!(crossing_ns >= SMOKE_NS, "seed {seed}: {crossing_ns}");
        let waited_ns = changed_ns - crossing_ns;
        assert!(waited_ns < 2 * CAMERA_PERIOD_NS, "seed {seed}: {waited_ns}");
        let after = tracked.iter().filter(|it| it.time_ns > changed_ns);
        assert!(after.clone().count() > 30, "seed {seed}");
        let worst = after.map(|it| it.error).fold(0.0, f64::max);
        assert!(worst < MOST_ERROR, "seed {seed}: {worst}");
    }
}

#[test]
fn in_smoke_the_task_goes_on_in_real_time_too() {
    let (outcome, tracked) = drive(&["--clock", "real", "--for", "8s"]);
    let decision = only_decision(&outcome);
    assert_eq!(decision["outcome"], "changed", "{decision:#}");
    assert_eq!(decision["chosen"], 1, "{decision:#}");
    let last = tracked.last().expect("pictures are tracked");
    assert!(last.error < MOST_ERROR, "{}", last.error);
}
