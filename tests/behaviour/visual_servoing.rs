//! Visual servoing on real pixels: in smoke the tracker loses the target unless the picture is
//! cleared.

use std::net::TcpListener;
use std::path::{Path, PathBuf};

use recording::read;
use tests::{Application, repository, take_turn};

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
    tracked_on(file, "/ssd_tracker/target")
}

/// What the tracker has written on this topic.
pub(crate) fn tracked_on(file: &Path, topic: &str) -> Vec<Tracked> {
    let messages = read(file).expect("the recording can be opened");
    let messages = messages.map(|message| message.expect("the recording is whole"));
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    messages
        .filter(|message| message.topic() == topic)
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

pub(crate) fn keeps_the_target_in_the_middle(tracked: &[Tracked]) -> bool {
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

/// A port that nobody listens at.
fn free_port() -> u16 {
    let listener = TcpListener::bind(("127.0.0.1", 0)).expect("a free port");
    listener.local_addr().expect("its address").port()
}

/// The shipped files of two robots, with ports that are free.
pub(crate) fn robots_at(run: &Application, names: [&str; 2]) -> [PathBuf; 2] {
    let ports = [free_port(), free_port()].map(|port| port.to_string());
    names.map(|name| {
        let file = format!("{name}.xml");
        let shipped = repository().join("profiles/applications").join(&file);
        let text = std::fs::read_to_string(shipped).expect("a shipped file");
        run.write(
            &file,
            text.replace("7447", &ports[0]).replace("7448", &ports[1]),
        )
    })
}

/// A camera on one robot, a dehazer on the other, and back: by the machine's clock, over loopback.
#[test]
fn another_robot_clears_the_pictures() {
    let _turn = take_turn();
    let (first, second) = (Application::new(), Application::new());
    let names = ["visual_servoing_offered_r1", "visual_servoing_offered_r2"];
    let files = robots_at(&first, names);
    let recording = first.folder().join("run.mcap");
    let search = |folder: &str| repository().join(folder).display().to_string();
    let (components, worlds) = (search("profiles/components"), search("profiles/worlds"));
    let paths = ["--search-path", &components, "--search-path", &worlds];
    let _clearing = second.start_files(&files[1..], &paths);
    second.wait_until(|events| events.contains("\"to\":\"ACTIVE\""));
    let record = [
        "--for",
        "9s",
        "--record",
        recording.to_str().expect("a path"),
    ];
    let _ended = first
        .run_together(&files[..1], &[&paths[..], &record].concat())
        .ended_well();
    let tracked = tracked(&recording);
    let smoky = tracked.iter().filter(|it| it.time_ns > SMOKE_NS);
    let low = smoky.clone().filter(|it| it.error < LOST_ERROR).count();
    // A busy machine may lose pictures; those that came were cleared.
    assert!(low > 20, "{low} pictures of {} in smoke", smoky.count());
    assert_eq!(low, smoky.count(), "some were not");
    assert!(keeps_the_target_in_the_middle(&tracked));
}
