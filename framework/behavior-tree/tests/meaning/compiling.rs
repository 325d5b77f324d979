//! What is wrong with trees is found before they are ticked.

use behavior_tree::definition::{Direction, Format, NodeClass, NodeModel, PortModel, TreeFile};
use behavior_tree::{CompileOptions, Library, MAX_NESTING};

use crate::harness::{Trial, compile, file, located};

/// What is said of a file whose unknown nodes are no stubs.
fn findings(file: &TreeFile) -> Vec<String> {
    let (library, mut findings) = Library::new([file]);
    findings.extend(library.check(&CompileOptions::default()));
    findings
        .into_iter()
        .map(|finding| finding.message)
        .collect()
}

#[test]
fn mistakes_are_found() {
    for (text, told) in [
        (
            "(Sequence )",
            "Sequence has no child, and must have at least 1",
        ),
        (
            "(Inverter (AlwaysSuccess ) (AlwaysSuccess ))",
            "Inverter has 2 children, and must have one",
        ),
        (
            "(IfThenElse (AlwaysSuccess ))",
            "IfThenElse has 1 child, and must have 2 to 3",
        ),
        (
            "(RecoveryNode (AlwaysSuccess ))",
            "RecoveryNode has 1 child, and must have 2",
        ),
        (
            "(AlwaysSuccess (AlwaysSuccess ))",
            "AlwaysSuccess has 1 child, and must have none",
        ),
        (
            "(Sequnce (AlwaysSuccess ))",
            "the node Sequnce is not known",
        ),
        ("(Timeout (AlwaysSuccess ))", "Timeout has no msec"),
        (
            "(Timeout msec=1 timeout_ms=10 (AlwaysSuccess ))",
            "Timeout has no port timeout_ms",
        ),
        (
            "(Timeout msec=soon (AlwaysSuccess ))",
            "`soon` at port msec is not understood",
        ),
        (
            "(RunOnce then_skip=2m (AlwaysSuccess ))",
            "`2m` at port then_skip is not understood",
        ),
        (
            "(Precondition if=1 else=success (AlwaysSuccess ))",
            "`success` at port else is not understood",
        ),
        (
            "(Script code=\"a :=\")",
            "this is no script: the end where a value was expected, at character 5 of the script",
        ),
        (
            "(AlwaysSuccess _skipIf=\"a &&\")",
            "this is no script: the end where a value was expected, at character 5 of the script",
        ),
        (
            "(AlwaysSuccess _skippIf=a)",
            "the attribute _skippIf has no meaning",
        ),
        ("(Main )", "the tree Main contains itself"),
    ] {
        assert_eq!(
            findings(&file(&[("Main", text)], Format::V4)),
            [told],
            "{text}"
        );
    }
}

#[test]
fn trees_that_contain_each_other_are_found() {
    let trees = [
        ("Main", "(A )"),
        ("A", "(Sequence (B ) (AlwaysSuccess ))"),
        ("B", "(A )"),
    ];
    let found = findings(&file(&trees, Format::V4));
    assert!(
        found.contains(&"the tree A contains itself".to_owned()),
        "{found:?}"
    );
    let twice = [("Main", "(AlwaysSuccess )"), ("Main", "(AlwaysFailure )")];
    assert_eq!(findings(&file(&twice, Format::V4)), ["a second tree Main"]);
}

#[test]
fn a_tree_is_not_deeper_or_larger_than_can_be_ticked() {
    let deep = format!(
        "{}S{}",
        "(Inverter ".repeat(MAX_NESTING),
        ")".repeat(MAX_NESTING)
    );
    let (plan, found) = compile(&[file(&[("Main", &deep)], Format::V4)], "Main");
    assert!(
        plan.is_none() && found[0].message.contains("nodes in each other"),
        "{found:?}"
    );
    let just = format!(
        "{}S{}",
        "(Inverter ".repeat(MAX_NESTING - 1),
        ")".repeat(MAX_NESTING - 1)
    );
    assert_eq!(Trial::new(&just).answers(1), "F");
    // Ten sub-trees in each of ten sub-trees, and so on.
    let ids = ["Main", "A", "B", "C", "D", "E"];
    let text = |inner: &str| format!("(Sequence {})", format!("({inner} )").repeat(10));
    let texts: Vec<String> = ids.iter().skip(1).map(|id| text(id)).collect();
    let mut trees: Vec<(&str, &str)> = ids
        .into_iter()
        .zip(texts.iter().map(String::as_str))
        .collect();
    trees.push(("E", "(AlwaysSuccess )"));
    let (plan, found) = compile(&[file(&trees, Format::V4)], "Main");
    assert!(
        plan.is_none() && found[0].message.contains("more than 20000 nodes"),
        "{found:?}"
    );
}

fn model(class: NodeClass, ports: &[(&str, Option<&str>)]) -> NodeModel {
    let port = |(name, default): &(&str, Option<&str>)| PortModel {
        name: located(name),
        direction: Direction::Input,
        default: default.map(str::to_owned),
    };
    NodeModel {
        id: located("Known"),
        class,
        ports: ports.iter().map(port).collect(),
    }
}

#[test]
fn models_say_which_ports_there_are() {
    for (class, text, told) in [
        (NodeClass::Action, "(Known a=1)", vec![]),
        (
            NodeClass::Action,
            "(Known c=1)",
            vec!["Known has no port c"],
        ),
        (
            NodeClass::Action,
            "(Known a=1 (AlwaysSuccess ))",
            vec!["Known has 1 child, and must have none"],
        ),
        (
            NodeClass::Decorator,
            "(Known (AlwaysSuccess ))",
            vec![
                "Known is not built in, and is taken for one that passes on what its child answers",
            ],
        ),
        (
            NodeClass::Control,
            "(Known (AlwaysSuccess ))",
            vec!["Known is not built in, and is taken for a Sequence"],
        ),
    ] {
        let mut file = file(&[("Main", text)], Format::V4);
        file.models
            .push(model(class, &[("a", None), ("b", Some("{key}"))]));
        assert_eq!(findings(&file), told, "{text}");
    }
}

#[test]
fn a_sub_trees_model_gives_defaults_and_says_what_is_needed() {
    let mut trees = file(
        &[
            (
                "Main",
                "(Sequence (Known a=1) (ScriptCondition code=\"out == 43\"))",
            ),
            ("Known", "(Script code=\"b := a + c\")"),
        ],
        Format::V4,
    );
    let ports = [("a", None), ("b", Some("{out}")), ("c", Some("42"))];
    trees.models.push(model(NodeClass::SubTree, &ports));
    let (plan, found) = compile(&[trees.clone()], "Main");
    let plan = plan.unwrap_or_else(|| panic!("{found:?}"));
    assert_eq!(Trial::of_plan(plan).answers(1), "S");
    let other = file(&[("Main", "(Known )")], Format::V4);
    trees.trees[0] = other.trees[0].clone();
    assert_eq!(findings(&trees), ["the tree Known needs a"]);
}

#[test]
fn old_files_mean_what_they_meant() {
    for (text, answers) in [
        ("(SequenceStar S FS)", "FS"),
        ("(FallbackStar F S)", "S"),
        ("(RetryUntilSuccesful num_attempts=2 FS)", "RS"),
        ("(ParallelNode threshold=1 R S)", "S"),
        ("(ParallelNode threshold=1 F R)", "R"),
        (
            "(Parallel success_threshold=1 failure_threshold=2 F S)",
            "S",
        ),
    ] {
        let (plan, found) = compile(&[file(&[("Main", text)], Format::V3)], "Main");
        let plan = plan.unwrap_or_else(|| panic!("{text}: {found:?}"));
        assert_eq!(
            Trial::of_plan(plan).answers(answers.len()),
            answers,
            "{text}"
        );
    }
}

#[test]
fn paths_tell_siblings_apart() {
    let trial = Trial::new(
        "(Sequence name=work S (Inner ) S)"
            .replace("(Inner )", "(Inverter F)")
            .as_str(),
    );
    let plan = trial.tree.plan();
    let paths: Vec<&str> = plan
        .node_ids()
        .map(|node| plan.describe(node).path.as_str())
        .collect();
    assert_eq!(
        paths,
        [
            "Main/work",
            "Main/work/S::1",
            "Main/work/Inverter",
            "Main/work/Inverter/F",
            "Main/work/S::2"
        ]
    );
}
