//! `steadfast tree`: files of behaviour trees are checked, shown and ticked.

use std::process::Command;
use std::time::Duration;

use serde_json::Value;
use tests::{Finished, Watched, artifacts};

/// Trees are ticked in simulated time.
const LIMIT: Duration = Duration::from_secs(30);

const MISSION: &str = r#"<root BTCPP_format="4">
  <BehaviorTree ID="Mission">
    <RecoveryNode number_of_retries="2" name="drive">
      <FollowPath path="{path}" _skipIf="done == 1"/>
      <Wait seconds="1"/>
    </RecoveryNode>
  </BehaviorTree>
</root>"#;

/// The command on a file of this content.
fn tree(what: &str, text: &str, options: &[&str]) -> Finished {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("mission.xml");
    std::fs::write(&file, text).expect("a file");
    let mut command = Command::new(artifacts().join("steadfast"));
    command.args(["tree", what]).arg(file).args(options);
    Watched::spawn(&mut command).wait(LIMIT)
}

fn json(finished: &Finished) -> Value {
    serde_json::from_str(&finished.stdout).expect("JSON")
}

#[test]
fn problems_are_told_as_check_tells_them() {
    let checked = tree("check", MISSION, &["--format", "json"]);
    assert_eq!(checked.code, Some(1), "{checked}");
    let told = json(&checked);
    let problem = &told["files"][0]["problems"][0];
    assert_eq!(problem["message"], "the node FollowPath is not known");
    assert_eq!(
        (&problem["line"], &problem["column"]),
        (&4.into(), &8.into())
    );
    let checked = tree("check", MISSION, &["--stubs", "--strict"]);
    assert_eq!(checked.code, Some(0), "{checked}");
    let broken = tree("run", &MISSION.replace("</root>", ""), &["--stubs"]);
    assert_eq!(broken.code, Some(1), "{broken}");
    assert!(broken.stderr.contains("is never closed"), "{broken}");
}

#[test]
fn trees_are_drawn() {
    let text = tree("show", MISSION, &["--stubs"]).stdout;
    assert_eq!(
        text,
        "Mission\n\
         └─ RecoveryNode \"drive\" number_of_retries=2\n   \
         ├─ FollowPath path={path} _skipIf=done == 1\n   \
         └─ Wait seconds=1\n"
    );
    let chart = tree("show", MISSION, &["--stubs", "--format", "mermaid"]).stdout;
    assert!(
        chart.starts_with("flowchart TD\n") && chart.contains("  n0 --> n2\n"),
        "{chart}"
    );
    let drawn = json(&tree("show", MISSION, &["--stubs", "--format", "json"]));
    assert_eq!(drawn["nodes"][1]["path"], "Mission/drive/FollowPath");
    assert_eq!(drawn["nodes"][0]["children"], serde_json::json!([1, 2]));
}

#[test]
fn trees_are_ticked_with_stubs() {
    let options = ["--stubs", "--format", "json", "--set", "done=0"];
    let failing = [
        &options[..],
        &[
            "--answer",
            "FollowPath=FAILURE",
            "--answer",
            "Wait=SUCCESS:250",
        ],
    ]
    .concat();
    let ended = json(&tree("run", MISSION, &failing));
    // Two waits of 250 ms at ticks of 100 ms; after the second the path fails once more.
    assert_eq!(
        (&ended["status"], &ended["ticks"]),
        (&"FAILURE".into(), &7.into())
    );
    let changes = ended["changes"].as_array().expect("a list");
    assert_eq!(changes[0]["node"], "Mission/drive/FollowPath");
    let skipped = [&options[..], &["--set", "done=1"]].concat();
    assert_eq!(json(&tree("run", MISSION, &skipped))["status"], "SKIPPED");
    let text = tree("run", MISSION, &["--stubs", "--set", "done=0"]);
    assert!(
        text.stdout.ends_with("Mission is SUCCESS after 1 tick\n"),
        "{text}"
    );
    // A script that cannot be run is the tree's problem.
    let failed = tree("run", MISSION, &["--stubs"]);
    assert_eq!(failed.code, Some(1), "{failed}");
    assert!(
        failed
            .stdout
            .contains("Mission/drive/FollowPath: the blackboard's entry `done` has no value"),
        "{failed}"
    );
}
