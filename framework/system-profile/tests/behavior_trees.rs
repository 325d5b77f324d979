//! Files of behaviour trees: small ones for each case, and every public one. Those lie beside the
//! project, not in it; without them the test says so and passes.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use behavior_tree::stub::StubAnswers;
use behavior_tree::{NodeId, Plan, Status, Tree, Value};
use system_profile::{Severity, TreeOptions, TreeOutcome, load_trees};

const CORPUS: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../../shared/corpus/behaviour-trees"
);

fn options(stubs: bool) -> TreeOptions {
    let mut options = TreeOptions::default();
    options.compile.stubs = stubs;
    options
}

/// Loads files of which the first is `main.xml`.
fn load(files: &[(&str, &str)], options: &TreeOptions) -> TreeOutcome {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        fs::write(folder.path().join(name), text).expect("a file");
    }
    let mut options = options.clone();
    for model in &mut options.models {
        *model = folder.path().join(&*model);
    }
    load_trees(&folder.path().join(files[0].0), &options)
}

/// `severity line:column message` of every problem.
fn problems(outcome: &TreeOutcome) -> Vec<String> {
    let all = outcome.files.iter().flat_map(|file| &file.problems);
    let told = all.map(|problem| {
        let (line, column) = (problem.place.line, problem.place.column);
        format!(
            "{} {line}:{column} {}",
            problem.severity.name(),
            problem.message
        )
    });
    told.collect()
}

/// Ticks a plan with leaves that all succeed; where nothing waits for ever it completes.
fn run(plan: Plan) -> (Tree, Result<Status, String>) {
    let answers = StubAnswers::default();
    let mut make = |plan: &Plan, node: NodeId| answers.make(plan, node);
    let mut tree = Tree::new(Arc::new(plan), &mut make).expect("stubs can be made");
    let mut ignored = |_node: NodeId, _before: Status, _now: Status| {};
    let mut status = Ok(Status::Idle);
    for tick in 0..50 {
        let ticked = tree.tick(Duration::from_millis(tick * 100), &mut ignored);
        status = ticked.map_err(|error| error.to_string());
        if status != Ok(Status::Running) {
            break;
        }
    }
    (tree, status)
}

#[test]
fn both_spellings_and_raw_signs_are_read() {
    let text = r#"<!-- a comment first -->
<root BTCPP_format="4" main_tree_to_execute="Main">
  <BehaviorTree ID="Main">
    <Control ID="Sequence" name="all">
      <Script code="a := 1; b := 2 &lt; 3"/>
      <Condition ID="ScriptCondition" code="a < 2 && b"/>
      <Action ID="Script" code="c := a &amp; 1 && true"/>
      <SubTree ID="Other" given="{a}"/>
    </Control>
  </BehaviorTree>
  <BehaviorTree ID="Other"><Script code="given := given + 41"/></BehaviorTree>
</root>"#;
    let outcome = load(&[("main.xml", text)], &options(false));
    assert_eq!(
        problems(&outcome),
        [
            "warning 6:47 not well-formed XML, read all the same: `<` in the value of an attribute",
            "warning 7:40 not well-formed XML, read all the same: `&` in the value of an attribute",
        ]
    );
    let (tree, status) = run(outcome.plan.expect("a tree"));
    assert_eq!(status, Ok(Status::Success));
    assert_eq!(tree.entry("a"), Some(&Value::Number(42.0)));
    assert_eq!(tree.entry("c"), Some(&Value::Boolean(true)));
}

#[test]
fn mistakes_are_told_all_at_once_with_their_places() {
    let text = r#"<root BTCPP_format="4">
  <BehaviorTree ID="A">
    <Sequence>
      <Squence><AlwaysSuccess/></Squence>
      <Timeout msec="1" delay="2"><AlwaysSuccess _skipIf="a ="/></Timeout>
      <Action/>
      <SubTree ID="b"/>;
    </Sequence>
  </BehaviorTree>
  <BehaviorTree ID="B"/>
  <BehaviorTree ID="C"><AlwaysSuccess/><AlwaysSuccess/></BehaviorTree>
  <BehaviourTree/>
  <TreeNodesModel><Aktion ID="x"/></TreeNodesModel>
</root>"#;
    let outcome = load(&[("main.xml", text)], &options(false));
    assert_eq!(
        problems(&outcome),
        [
            "error 4:8 the node Squence is not known",
            "error 5:25 Timeout has no port delay",
            "error 5:59 this is no script: the end where a value was expected, at character 4 of the script",
            "error 6:8 <Action> has no ID",
            "error 7:20 there is no tree b",
            "warning 7:24 text in <Sequence> is not read",
            "error 10:4 the tree B is empty",
            "error 11:41 a second node in the tree C",
            "error 12:4 unknown element <BehaviourTree> in <root>",
            "error 13:20 unknown element <Aktion> in <TreeNodesModel>",
        ]
    );
    let helps: Vec<&str> = outcome.files[0]
        .problems
        .iter()
        .filter_map(|it| it.help.as_deref())
        .collect();
    assert!(
        helps[0].starts_with("did you mean `Sequence`?"),
        "{helps:?}"
    );
    assert!(helps[4].starts_with("did you mean `B`?"), "{helps:?}");
    assert!(outcome.plan.is_none());
}

#[test]
fn includes_and_models_are_followed_each_once() {
    let main = r#"<root BTCPP_format="4">
  <include path="other.xml"/>
  <BehaviorTree ID="Main"><SubTree ID="Other"/></BehaviorTree>
</root>"#;
    let other = r#"<root BTCPP_format="4">
  <include path="main.xml"/><include path="missing.xml"/><include ros_pkg="p" path="x.xml"/>
  <BehaviorTree ID="Other"><Wait seconds="1"/></BehaviorTree>
</root>"#;
    let palette = r#"<root><TreeNodesModel><Action ID="Wait">
  <input_port name="seconds" type="double" default="1.0">How long.</input_port>
</Action></TreeNodesModel></root>"#;
    let mut options = options(false);
    options.models.push(PathBuf::from("palette.xml"));
    let files = [
        ("main.xml", main),
        ("other.xml", other),
        ("palette.xml", palette),
    ];
    let told = problems(&load(&files, &options));
    assert_eq!(told.len(), 2, "{told:?}");
    assert!(told[0].contains("missing.xml is not there"), "{told:?}");
    assert!(told[1].contains("ROS package"), "{told:?}");
    let other = other.replace(
        r#"<include path="missing.xml"/><include ros_pkg="p" path="x.xml"/>"#,
        "",
    );
    let files = [
        ("main.xml", main),
        ("other.xml", other.as_str()),
        ("palette.xml", palette),
    ];
    let outcome = load(&files, &options);
    assert_eq!(problems(&outcome), [""; 0]);
    assert_eq!(outcome.plan.expect("a tree").len(), 2);
}

#[test]
fn which_tree_is_executed_must_be_known() {
    let two = r#"<root BTCPP_format="4"><BehaviorTree ID="A"><AlwaysSuccess/></BehaviorTree>
<BehaviorTree ID="B"><AlwaysFailure/></BehaviorTree></root>"#;
    let load_with = |text: &str, main: Option<&str>| {
        let mut options = options(false);
        options.main = main.map(str::to_owned);
        let outcome = load(&[("main.xml", text)], &options);
        assert_eq!(problems(&outcome), [""; 0]);
        outcome
            .plan
            .map(|plan| plan.id)
            .ok_or_else(|| outcome.undecided.expect("a reason"))
    };
    assert_eq!(load_with(two, Some("B")), Ok("B".to_owned()));
    assert!(load_with(two, None).is_err_and(|reason| reason.ends_with("to be executed: A, B")));
    assert!(load_with(two, Some("C")).is_err_and(|reason| reason.contains("no tree C")));
    let said = two.replace("<root", "<root main_tree_to_execute=\"A\"");
    assert_eq!(load_with(&said, None), Ok("A".to_owned()));
    assert!(load_with("<root><TreeNodesModel/></root>", None).is_err());
}

#[test]
fn files_of_version_3_mean_what_they_meant() {
    let text = r#"<root main_tree_to_execute="Main">
  <BehaviorTree ID="Main">
    <Sequence>
      <SetBlackboard output_key="mine" value="1"/>
      <SubTree ID="Plain" theirs="mine"/>
      <SubTreePlus ID="Plus" theirs="{mine}" other="7"/>
      <SubTreePlus ID="Plus" __autoremap="1"/>
    </Sequence>
  </BehaviorTree>
  <BehaviorTree ID="Plain"><SetBlackboard output_key="theirs" value="2"/></BehaviorTree>
  <BehaviorTree ID="Plus"><SetBlackboard output_key="theirs" value="3"/></BehaviorTree>
</root>"#;
    let outcome = load(&[("main.xml", text)], &options(false));
    assert_eq!(problems(&outcome), [""; 0]);
    let (tree, status) = run(outcome.plan.expect("a tree"));
    assert_eq!(status, Ok(Status::Success));
    assert_eq!(tree.entry("mine").and_then(Value::as_number), Some(3.0));
    assert_eq!(tree.entry("theirs").and_then(Value::as_number), Some(3.0));
}

/// Public files that are refused, and why: cut out of other files, deliberately wrong, or without
/// what they include.
const REFUSED: [(&str, &str); 20] = [
    (
        "HEAD-embedded/examples/plugin_example/plugin_executor.cpp.0.xml",
        "3:1 not well-formed XML: text outside the outermost element",
    ),
    (
        "HEAD-embedded/examples/t14_subtree_model.cpp.1.xml",
        "7:20 there is no tree MySub",
    ),
    (
        "HEAD-embedded/fuzzing/bt_fuzzer.cpp.0.xml",
        "3:22 not well-formed XML: <BehaviorTree> is never closed",
    ),
    (
        "HEAD-embedded/tests/gtest_if_then_else.cpp.7.xml",
        "4:12 IfThenElse has 1 child, and must have 2 to 3",
    ),
    (
        "HEAD-embedded/tests/gtest_if_then_else.cpp.8.xml",
        "4:12 IfThenElse has 4 children, and must have 2 to 3",
    ),
    (
        "HEAD-embedded/tests/gtest_subtree.cpp.17.xml",
        "5:10 the tree PrintToConsole contains itself",
    ),
    (
        "HEAD-embedded/tests/gtest_subtree.cpp.18.xml",
        "6:27 the tree MainTree contains itself",
    ),
    (
        "HEAD-embedded/tests/gtest_subtree.cpp.19.xml",
        "6:27 the tree TreeA contains itself",
    ),
    (
        "HEAD-embedded/tests/gtest_switch.cpp.0.xml",
        "6:9 not well-formed XML: a tag with an attribute value that is never closed",
    ),
    (
        "HEAD-embedded/tests/gtest_updates.cpp.1.xml",
        "5:24 there is no tree Check",
    ),
    (
        "HEAD-embedded/tests/gtest_updates.cpp.2.xml",
        "6:24 there is no tree Check",
    ),
    (
        "HEAD-embedded/tests/gtest_updates.cpp.3.xml",
        "7:26 there is no tree Check",
    ),
    (
        "HEAD-embedded/tests/gtest_updates.cpp.4.xml",
        "7:26 there is no tree Check",
    ),
    (
        "HEAD-embedded/tests/gtest_xml_null_subtree_id.cpp.0.xml",
        "7:8 <SubTree> has no ID",
    ),
    (
        "HEAD/fuzzing/corpus/bt_corpus/corpus2.xml",
        "5:22 Timeout has no msec",
    ),
    (
        "HEAD/fuzzing/corpus/bt_corpus/corpus4.xml",
        "5:18 ForceSuccess has no child, and must have one",
    ),
    (
        "HEAD/tests/trees/child/child_include_parent.xml",
        "2:18 the included file",
    ),
    (
        "HEAD/tests/trees/parent_include_child_include_parent.xml",
        "2:18 the included file",
    ),
    (
        "heads_v3.8/tests/trees/child/child_include_parent.xml",
        "2:18 the included file",
    ),
    (
        "heads_v3.8/tests/trees/parent_include_child_include_parent.xml",
        "2:18 the included file",
    ),
];

fn files(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else {
        eprintln!("skipped: there is no corpus at {}", folder.display());
        return Vec::new();
    };
    let mut found: Vec<PathBuf> = Vec::new();
    for path in entries.flatten().map(|entry| entry.path()) {
        match path.is_dir() {
            true => found.extend(files(&path)),
            false => found.push(path),
        }
    }
    found.retain(|path| path.extension().is_some_and(|ending| ending == "xml"));
    found.sort();
    found
}

#[test]
fn every_public_file_loads_or_is_refused_for_what_it_is() {
    for path in files(Path::new(CORPUS)) {
        let outcome = load_trees(&path, &options(true));
        let all = outcome.files.iter().flat_map(|file| &file.problems);
        let first = all
            .clone()
            .find(|problem| problem.severity == Severity::Error);
        let first = first.map(|problem| {
            let (line, column) = (problem.place.line, problem.place.column);
            format!("{line}:{column} {}", problem.message)
        });
        let expected = REFUSED.iter().find(|(name, _)| path.ends_with(name));
        match (first, expected) {
            (None, None) => {}
            (Some(told), Some((_, reason))) if told.starts_with(reason) => {}
            (told, expected) => panic!("{}: {told:?}, expected {expected:?}", path.display()),
        }
    }
}

#[test]
fn every_tree_of_nav2_is_ticked() {
    let mut ticked = 0;
    for path in files(&Path::new(CORPUS).join("ros-navigation+navigation2")) {
        let mut options = options(true);
        let trees = load_trees(&path, &options).files[0].reading["trees"].clone();
        for id in trees.as_array().expect("a list") {
            options.main = id.as_str().map(str::to_owned);
            let plan = load_trees(&path, &options).plan;
            let plan = plan.unwrap_or_else(|| panic!("{}: {id}", path.display()));
            let (_, status) = run(plan);
            assert!(status.is_ok(), "{}: {status:?}", path.display());
            ticked += 1;
        }
    }
    let is_there = Path::new(CORPUS).is_dir();
    assert!(ticked > 80 || !is_there, "{ticked} trees");
}
