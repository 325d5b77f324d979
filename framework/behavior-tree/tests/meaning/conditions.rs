//! Pre- and post-conditions, blackboards, sub-trees.

use behavior_tree::definition::Format;
use behavior_tree::{Status, Value};

use crate::harness::{Trial, compile, file};

fn of_trees(trees: &[(&str, &str)]) -> Trial {
    let (plan, findings) = compile(&[file(trees, Format::V4)], "Main");
    Trial::of_plan(plan.unwrap_or_else(|| panic!("{findings:?}")))
}

#[test]
fn conditions_decide_before_the_node_begins() {
    for (leaf, answers) in [
        ("R<_failureIf=true>", "F"),
        ("R<_successIf=true>", "S"),
        ("R<_skipIf=true>", "K"),
        ("R<_while=false>", "K"),
        ("R<_while=true>", "RR"),
        // The first that decides counts, whatever the order in the file.
        ("R<_skipIf=true _successIf=true _failureIf=true>", "F"),
        ("R<_skipIf=true _successIf=true>", "S"),
        ("R<_successIf=false _while=false>", "K"),
    ] {
        let text = format!("(Sequence {leaf})");
        assert_eq!(Trial::new(&text).answers(answers.len()), answers, "{leaf}");
    }
}

#[test]
fn only_while_is_asked_of_a_running_node() {
    let mut trial =
        Trial::new("(Sequence (Script code=\"a := true; b := false\") R<_while=a _skipIf=b>)");
    assert_eq!(trial.tick(), Status::Running);
    trial.tree.set_entry("b", Value::Boolean(true));
    assert_eq!(trial.tick(), Status::Running);
    trial.tree.set_entry("a", Value::Boolean(false));
    // The script succeeded, and the leaf is skipped.
    assert_eq!(trial.tick(), Status::Success);
    assert_eq!((trial.ticks(), trial.halts()), (vec![2], vec![1]));
}

#[test]
fn scripts_follow_what_has_come() {
    for (leaf, answer, entry) in [
        (
            "S<_onSuccess=\"x := 1\" _onFailure=\"x := 2\">",
            "S",
            Some(1.0),
        ),
        (
            "F<_onSuccess=\"x := 1\" _onFailure=\"x := 2\">",
            "F",
            Some(2.0),
        ),
        ("S<_post=\"x := 3\">", "S", Some(3.0)),
        ("F<_post=\"x := 3\">", "F", Some(3.0)),
        ("R<_post=\"x := 3\">", "R", None),
        ("K<_post=\"x := 3\">", "K", None),
        // As in BehaviorTree.CPP they follow a decision of a pre-condition, too.
        ("R<_successIf=true _onSuccess=\"x := 4\">", "S", Some(4.0)),
    ] {
        let mut trial = Trial::new(&format!("(Sequence {leaf})"));
        assert_eq!(trial.answers(1), answer, "{leaf}");
        let found = trial.tree.entry("x").and_then(Value::as_number);
        assert_eq!(found, entry, "{leaf}");
    }
}

#[test]
fn a_script_follows_a_halt() {
    let mut trial = Trial::new("(Sequence R<_onHalted=\"x := 1\">)");
    trial.tick();
    trial.halt().expect("the script works");
    assert_eq!(trial.tree.entry("x"), Some(&Value::Number(1.0)));
    // One that cannot be run is told, and everything has been halted all the same.
    let mut trial = Trial::new("(Parallel R<_onHalted=\"x = nothing\"> R)");
    trial.tick();
    let error = trial.halt().expect_err("the entry is empty");
    assert!(error.message.contains("nothing"), "{error}");
    assert_eq!(trial.halts(), [1, 1]);
}

#[test]
fn a_script_that_cannot_be_run_is_an_error_of_the_tick() {
    let mut trial = Trial::new("(Fallback S<_skipIf=unset> S)");
    let error = trial.tick_after(1).expect_err("the entry is empty");
    assert_eq!(error.path, "Main/Fallback/S::1");
    assert!(error.message.contains("`unset` has no value"), "{error}");
}

#[test]
fn a_sub_tree_has_a_blackboard_of_its_own() {
    let inner = "(Sequence (Script code=\"own := 1; given := given + 1\") S)";
    let main = "(Sequence (Script code=\"value := 41; own := 7\") (Inner given={value}))";
    let mut trial = of_trees(&[("Main", main), ("Inner", inner)]);
    assert_eq!(trial.tick(), Status::Success);
    assert_eq!(trial.tree.entry("value"), Some(&Value::Number(42.0)));
    assert_eq!(trial.tree.entry("own"), Some(&Value::Number(7.0)));
}

#[test]
fn keys_reach_other_blackboards_as_they_say() {
    for (main, inner, expected) in [
        (
            "(Inner _autoremap=true)",
            "(Script code=\"x := 1\")",
            Some(1.0),
        ),
        ("(Inner _autoremap=false)", "(Script code=\"x := 1\")", None),
        ("(Inner )", "(Script code=\"@x := 1\")", Some(1.0)),
        ("(Inner x={=})", "(Script code=\"x := 1\")", Some(1.0)),
        (
            "(Inner y={x})",
            "(SetBlackboard value=1 output_key={y})",
            Some(1.0),
        ),
        ("(Inner y=1 z={x})", "(Script code=\"z := y\")", Some(1.0)),
        // What is said wins over what is remapped by itself.
        (
            "(Inner _autoremap=true x={other})",
            "(Script code=\"x := 1\")",
            None,
        ),
    ] {
        // The root mentions the key, so that it can be asked for it.
        let main = format!("(Sequence {main} S<key={{x}}>)");
        let mut trial = of_trees(&[("Main", &main), ("Inner", inner)]);
        assert_eq!(trial.tick(), Status::Success, "{main}");
        let found = trial.tree.entry("x").and_then(Value::as_number);
        assert_eq!(found, expected, "{main} {inner}");
    }
}

#[test]
fn private_keys_are_not_remapped_by_themselves() {
    let inner = "(Sequence (Script code=\"_x := 1\"))";
    let main = "(Sequence (Inner _autoremap=true) S<key={_x}>)";
    let mut trial = of_trees(&[("Main", main), ("Inner", inner)]);
    trial.tick();
    assert_eq!(trial.tree.entry("_x"), None);
}

#[test]
fn nodes_that_watch_an_entry_see_each_writing_once() {
    for (node, expected) in [
        ("(WasEntryUpdated entry=a)", "FSFS"),
        ("(SkipUnlessUpdated entry={a} S)", "KSKS"),
        ("(WaitValueUpdate entry=a S)", "RSRS"),
    ] {
        let mut trial = Trial::new(&format!("(Sequence {node})"));
        let mut answers = trial.answers(1);
        trial.tree.set_entry("a", Value::Number(1.0));
        answers += &trial.answers(2);
        // The same value again is a writing as well.
        trial.tree.set_entry("a", Value::Number(1.0));
        answers += &trial.answers(1);
        assert_eq!(answers, expected, "{node}");
    }
}

#[test]
fn a_loop_hands_its_items_out() {
    let text =
        "(LoopDouble queue=1;2.5;4 value={v} (Script code=\"sum := (v == 1 ? 0 : sum) + v\"))";
    let mut trial = Trial::new(text);
    assert_eq!(trial.answers(4), "RRRS");
    assert_eq!(trial.tree.entry("sum"), Some(&Value::Number(7.5)));
    assert_eq!(
        Trial::new("(LoopInt queue={q} if_empty=SKIPPED S)").answers(1),
        "K"
    );
}

#[test]
fn a_persistent_sequence_keeps_its_place_on_the_blackboard() {
    let mut trial = Trial::new("(PersistentSequence current_child_idx={i} S R S)");
    trial.tree.set_entry("i", Value::Number(1.0));
    trial.tick();
    assert_eq!(trial.ticks(), [0, 1, 0]);
    trial.halt().expect("halting works");
    assert_eq!(trial.tree.entry("i"), Some(&Value::Number(1.0)));
    trial.tree.set_entry("i", Value::Number(9.0));
    let error = trial.tick_after(1).expect_err("there is no such child");
    assert!(error.message.contains("current_child_idx"), "{error}");
}

#[test]
fn a_port_without_what_it_needs_is_an_error_of_the_tick() {
    for (text, told) in [
        (
            "(Repeat num_cycles={n} S)",
            "port num_cycles needs a number, and has the empty entry `n`",
        ),
        (
            "(Parallel success_count=3 S S)",
            "port success_count needs at most 2, its children,",
        ),
        (
            "(SetBlackboard value={v} output_key=k)",
            "port value needs a value",
        ),
        (
            "(Sequence (Script code=\"n := 'x'\") (Sleep msec={n}))",
            "needs a number, and has `x`",
        ),
    ] {
        let error = Trial::new(text).tick_after(1).expect_err(text);
        assert!(error.message.contains(told), "{text}: {error}");
    }
}
