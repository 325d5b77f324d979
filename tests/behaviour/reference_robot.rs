//! The reference robot with its shipped profiles.

use std::path::PathBuf;

use serde_json::Value;
use tests::{Application, Outcome, repository, take_turn};

/// The slowest of the seeds below needs 45 s of robot time.
const LIMIT: &str = "120s";

fn profile() -> PathBuf {
    repository().join("profiles/applications/target_following.xml")
}

fn drive(application: &Application, clock: &str, seed: u64) -> Outcome {
    let seed = seed.to_string();
    let arguments = ["--clock", clock, "--for", LIMIT, "--seed", &seed];
    application.run_file(&profile(), &arguments).ended_well()
}

fn robot(outcome: &Outcome) -> &Value {
    &outcome.summary()["robot"]
}

#[test]
fn it_reaches_its_target_without_touching_anything() {
    let application = Application::new();
    for seed in 0..20 {
        let outcome = drive(&application, "simulated", seed);
        let robot = robot(&outcome);
        assert_eq!(robot["reached"], true, "seed {seed}: {robot}");
        assert_eq!(robot["collisions"], 0, "seed {seed}: {robot}");
        let application = &outcome.summary()["applications"]["target_following"];
        assert_eq!(application["state"], "ACTIVE", "seed {seed}");
        assert_eq!(application["ended_by"], "target_reached", "seed {seed}");
    }
}

#[test]
fn the_same_seed_gives_the_same_events_and_another_seed_others() {
    let application = Application::new();
    let events = |seed: u64| {
        drive(&application, "simulated", seed)
            .raw_events()
            .to_owned()
    };
    let first = events(7);
    assert!(
        first == events(7),
        "the events of a seed differ from run to run"
    );
    assert!(first != events(8), "the seed changes nothing");
}

#[test]
fn in_real_time_it_drives_over_a_pseudo_terminal() {
    let _turn = take_turn();
    // A seed whose target is near, so that the test takes a quarter of a minute.
    let outcome = drive(&Application::new(), "real", 17);
    assert_eq!(robot(&outcome)["reached"], true, "{}", robot(&outcome));
    let events = outcome.raw_events();
    assert!(
        events.contains("'simulated:motion_board' is /dev/pts/"),
        "it drove over something else: {events}"
    );
}

#[test]
fn an_unplugged_serial_line_is_said_before_anything_starts() {
    let application = Application::new();
    let text = std::fs::read_to_string(repository().join("profiles/components/motor_driver.xml"))
        .expect("the profile is there");
    let changed = text.replace("simulated:motion_board", "/dev/ttyUSB_not_there");
    assert_ne!(text, changed, "the profile names its device");
    application.write("motor_driver.xml", changed);
    let shipped = std::fs::read_to_string(profile()).expect("the application is there");
    let file = application.write("target_following.xml", shipped);
    let search = |folder: &str| repository().join(folder).display().to_string();
    let (components, worlds) = (search("profiles/components"), search("profiles/worlds"));
    let outcome = application.run_file(
        &file,
        &["--search-path", &components, "--search-path", &worlds],
    );
    outcome.was_refused_after(5, &["motor_driver", "/dev/ttyUSB_not_there", "plugged in"]);
}
