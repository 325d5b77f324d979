//! What a behaviour tree may say of the application that it belongs to.

use crate::project::{Loaded, Project};

fn with(tree: &str) -> Loaded {
    let project = Project::new();
    project.write(
        "trees/mission.xml",
        &format!(
            "<root BTCPP_format='4'>\n<BehaviorTree ID='Mission'><Sequence>{tree}</Sequence>\
             </BehaviorTree></root>"
        ),
    );
    let rest = "<tree name='mission' file='mission.xml'/>";
    project.application("sonar:sensor.xml planner:planner.xml", "", rest)
}

#[test]
fn a_sound_tree_comes_with_its_plan() {
    let loaded = with(
        "<StopComponent component='sonar'/>\
         <WaitForData component='sonar' port='range' timeout_ms='{patience}'/>\
         <WritePort component='planner' port='image' field='x' value='{x}'/>\
         <RaiseEvent component='planner' port='alarm'/>\
         <CallService component='sonar' port='setup' method='calibrate'/>",
    )
    .sound();
    let [tree] = loaded.trees.as_slice() else {
        panic!("{:?}", loaded.trees);
    };
    assert_eq!(tree.name, "mission");
}

#[test]
fn unknown_names_are_refused_with_place_and_what_was_meant() {
    for (tree, problem) in [
        (
            "<StopComponent component='snar'/>",
            "mission:2: there is no component `snar` (did you mean `sonar`)",
        ),
        (
            "<WaitForData component='sonar' port='rnge'/>",
            "mission:2: there is no output data port `rnge` (did you mean `range`)",
        ),
        (
            "<WritePort component='sonar' port='range' field='x' value='1'/>",
            "mission:2: there is no input data port `range`",
        ),
        (
            "<StopComponent/>",
            "mission:2: StopComponent has no component",
        ),
        (
            "<StopComponent component='{which}'/>",
            "mission:2: component must be known before the first tick",
        ),
        (
            "<ReadPort component='sonar' port='range' field='x' value='x'/>",
            "mission:2: value must be an entry of the blackboard",
        ),
        (
            "<StopComponent component='sonar' timeout_ms='soon'/>",
            "mission:2: `soon` at port timeout_ms is no such number",
        ),
        (
            "<ComponentInState component='sonar' state='ACTVE'/>",
            "mission:2: there is no word `ACTVE` (did you mean `ACTIVE`)",
        ),
    ] {
        with(tree).refused(&[problem]);
    }
}

#[test]
fn a_subtree_may_be_told_the_name_of_a_component() {
    let project = Project::new();
    project.write(
        "trees/mission.xml",
        "<root BTCPP_format='4' main_tree_to_execute='Mission'>
         <BehaviorTree ID='Mission'><SubTree ID='Rest' whom='sonar'/></BehaviorTree>
         <BehaviorTree ID='Rest'><StopComponent component='{whom}'/></BehaviorTree></root>",
    );
    let rest = "<tree name='mission' file='mission.xml'/>";
    let members = "sonar:sensor.xml";
    project.application(members, "", rest).sound();
}

#[test]
fn a_tree_of_a_file_that_does_not_say_which_is_refused() {
    let project = Project::new();
    project.write(
        "trees/mission.xml",
        "<root BTCPP_format='4'><BehaviorTree ID='A'><AlwaysSuccess/></BehaviorTree>
         <BehaviorTree ID='B'><AlwaysSuccess/></BehaviorTree></root>",
    );
    let application = |rest| project.application("sonar:sensor.xml", "", rest);
    application("<tree name='mission' file='mission.xml'/>").refused(&[
        "a:4: the file has several trees, and does not say which is to be executed: A, B",
    ]);
    application("<tree name='sonar' file='mission.xml' main='A'/>")
        .refused(&["a:4: a component has the name sonar already"]);
    application("<tree name='m' file='mision.xml' main='A'/>")
        .refused(&["a:4: there is no file `mision.xml` (did you mean `mission.xml`)"]);
}
