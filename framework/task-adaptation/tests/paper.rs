//! The experiments of the ReFrESH paper: its candidates, its choices.

use std::path::Path;

use system_model::task::TaskSpecification;
use task_adaptation::{Choice, Plan, plan};

fn task(name: &str) -> TaskSpecification {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../profiles/tasks");
    let outcome = system_profile::load_task(&folder.join(name));
    assert!(outcome.problems.is_empty(), "{:#?}", outcome.problems);
    outcome.task.expect("a good task")
}

/// Candidates as the paper writes them, robots before components.
fn listed(task: &TaskSpecification, plan: &Plan) -> Vec<String> {
    let candidates = plan.generation.candidates.iter();
    let listed = candidates.map(|candidate| {
        let names = candidate
            .placements
            .iter()
            .map(|it| task.placement_name(*it));
        names.collect::<Vec<_>>().join(" ")
    });
    listed.collect()
}

/// Section 6.2, the list of twelve.
const TWELVE: [&str; 12] = [
    "R1:Cam_reader R1:SSD R1:Traj_Gen_1 R1:PID R1:Tbot_motor",
    "R1:Cam_reader R1:SSD R1:Traj_Gen_1 R1:PID R2:Tbot_motor",
    "R2:Cam_reader R1:SSD R1:Traj_Gen_1 R1:PID R1:Tbot_motor",
    "R2:Cam_reader R2:SSD R2:Traj_Gen_1 R2:PID R2:Tbot_motor",
    "R1:Cam_reader R1:Dehazer(HW) R1:SSD R1:Traj_Gen_1 R1:PID R1:Tbot_motor",
    "R1:Cam_reader R1:Dehazer(HW) R1:SSD R1:Traj_Gen_1 R1:PID R2:Tbot_motor",
    "R2:Cam_reader R1:Dehazer(HW) R1:SSD R1:Traj_Gen_1 R1:PID R1:Tbot_motor",
    "R2:Cam_reader R1:Dehazer(HW) R2:SSD R2:Traj_Gen_1 R2:PID R2:Tbot_motor",
    "R1:Cam_reader R2:Dehazer(SW) R1:SSD R1:Traj_Gen_1 R1:PID R1:Tbot_motor",
    "R1:Cam_reader R2:Dehazer(SW) R1:SSD R1:Traj_Gen_1 R1:PID R2:Tbot_motor",
    "R2:Cam_reader R2:Dehazer(SW) R1:SSD R1:Traj_Gen_1 R1:PID R1:Tbot_motor",
    "R2:Cam_reader R2:Dehazer(SW) R2:SSD R2:Traj_Gen_1 R2:PID R2:Tbot_motor",
];

#[test]
fn two_robots_have_the_twelve_candidates_of_the_paper() {
    let task = task("visual_servoing_two_robots.xml");
    let plan = plan(&task).expect("a plan");
    assert_eq!(
        (plan.generation.combinations, plan.generation.groups),
        (96, 12)
    );
    assert_eq!(listed(&task, &plan), TWELVE);
    assert_eq!(plan.choice, Choice::Take(9));
    let feasible = plan.judged.iter().filter(|it| it.is_feasible);
    let feasible: Vec<usize> = feasible.map(|it| it.number).collect();
    assert_eq!(feasible, [9, 12]);
}

#[test]
fn along_the_whole_chain_two_of_the_twelve_are_others() {
    let task = task("visual_servoing_two_robots.xml");
    let plan = plan(&task).expect("a plan");
    let found = plan.differences.iter().map(|it| {
        let placements = it.otherwise.placements.iter();
        let names: Vec<String> = placements.map(|it| task.placement_name(*it)).collect();
        (
            it.number,
            it.hops_otherwise,
            it.otherwise.hops,
            names.join(" "),
        )
    });
    let found: Vec<_> = found.collect();
    let expected = [
        // As many hops, but the first of the group that has so few.
        (
            8,
            2,
            2,
            "R2:Cam_reader R1:Dehazer(HW) R1:SSD R1:Traj_Gen_1 R1:PID R2:Tbot_motor",
        ),
        (
            10,
            3,
            1,
            "R1:Cam_reader R2:Dehazer(SW) R2:SSD R2:Traj_Gen_1 R2:PID R2:Tbot_motor",
        ),
    ];
    assert_eq!(
        found,
        expected.map(|(number, here, there, names)| (number, here, there, names.to_owned()))
    );
}

#[test]
fn one_robot_has_two_candidates_and_no_power_for_the_hardware() {
    let task = task("visual_servoing_one_robot.xml");
    let plan = plan(&task).expect("a plan");
    assert_eq!(
        listed(&task, &plan),
        [
            "R1:Cam_reader R1:Dehazer(SW) R1:SSD R1:Traj_Gen_1 R1:PID R1:Tbot_motor",
            "R1:Cam_reader R1:Dehazer(HW) R1:SSD R1:Traj_Gen_1 R1:PID R1:Tbot_motor",
        ]
    );
    assert_eq!(plan.choice, Choice::Take(1));
    let reasons = plan.judged[1]
        .rejections
        .iter()
        .map(|it| it.in_words(&task));
    assert!(
        { reasons }.any(|it| it.contains("R1 has 8 W of power")),
        "{plan:#?}"
    );
}
