//! Visual servoing on real pixels: in smoke the tracker loses the target unless the picture is
//! cleared.

use std::path::Path;

use recording::read;
use tests::{Application, repository};

/// When smoke blows in, in the world of both applications.
const SMOKE_NS: u64 = 4_400_000_000;
/// `lost_error` of the tracker's profile.
const LOST_ERROR: f64 = 40.0;

/// One tracked picture: when, matching error, column of the target.
pub(crate) struct Tracked {
    pub(crate) time_ns: u64,
    pub(crate) error: f64,
    pub(crate) column: f64,
}

fn drive(application: &str, seed: u64) -> Vec<Tracked> {
    let run = Application::new();
    let file = run.folder().join("run.mcap");
    let recording = file.to_str().expect("a path of this test");
    let seed = seed.to_string();
    let profile = repository().join(format!("profiles/applications/{application}.xml"));
    let arguments = ["--clock", "simulated", "--for", "12s", "--seed", &seed];
    let _ended = run
        .run_file(
            &profile,
            &[&arguments[..], &["--record", recording]].concat(),
        )
        .ended_well();
    tracked(&file)
}

pub(crate) fn tracked(file: &Path) -> Vec<Tracked> {
    let messages = read(file).expect("the recording can be opened");
    let messages = messages.map(|message| message.expect("the recording is whole"));
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    messages
        .filter(|message| message.topic() == "/ssd_tracker/target")
        .map(|message| Tracked {
            time_ns: message.value["time"].as_u64().expect("a time"),
            error: number(&message.value["matching_error"]),
            column: number(&message.value["column"]),
        })
        .collect()
}

/// Pictures before the smoke and in it.
fn parted(tracked: &[Tracked]) -> (&[Tracked], &[Tracked]) {
    let before = tracked.partition_point(|it| it.time_ns < SMOKE_NS);
    assert!(before > 40 && tracked.len() > 110, "ten pictures a second");
    tracked.split_at(before)
}

fn keeps_the_target_in_the_middle(tracked: &[Tracked]) -> bool {
    tracked.iter().all(|it| (it.column - 80.0).abs() < 30.0)
}

#[test]
fn in_smoke_the_tracking_error_rises_and_stays() {
    for seed in 0..3 {
        let tracked = drive("visual_servoing", seed);
        let (clear, smoky) = parted(&tracked);
        assert!(
            clear.iter().all(|it| it.error < LOST_ERROR / 2.0),
            "seed {seed}"
        );
        assert!(smoky.iter().all(|it| it.error > LOST_ERROR), "seed {seed}");
        assert!(keeps_the_target_in_the_middle(clear), "seed {seed}");
    }
}

#[test]
fn with_the_dehazer_the_tracking_error_stays_low() {
    for seed in 0..3 {
        let tracked = drive("visual_servoing_dehazed", seed);
        assert!(
            tracked.iter().all(|it| it.error < LOST_ERROR),
            "seed {seed}"
        );
        assert!(keeps_the_target_in_the_middle(&tracked), "seed {seed}");
    }
}
