//! What is said of names, connections and coordination inside one application.

use crate::project::{BOTH, Project, connect_all};

#[test]
fn mistakes_in_names() {
    let project = Project::new();
    project
        .application(
            "sonar:sensor.xml sonar:sensor.xml a/b:sensor.xml",
            &connect_all(&["data snar.range sonar.range", "data sonar.rnge sonar.range"]),
            "<coordination><depends source='sonar' target='sonr'/></coordination>",
        )
        .refused(&[
            "a:2: a second subcomponent of the name sonar",
            "a:2: the instance name a/b contains a `/`",
            "a:3: there is no subcomponent `snar` (did you mean `sonar`)",
            "a:3: `sonar` has no port `rnge` (did you mean `range`)",
            "a:4: there is no subcomponent `sonr` (did you mean `sonar`)",
        ]);
}

#[test]
fn mistakes_in_connections_are_all_listed() {
    let project = Project::new();
    project
        .application(
            "s:sensor.xml t:sensor.xml p:planner.xml",
            &connect_all(&[
                "data p.range s.range",
                "data s.alarm p.range",
                "data s.range p.image",
                "service s.setup p.setup",
            ]),
            "",
        )
        .refused(&[
            "a:3: the port range is an input data port",
            "a:3: the port range is an output data port",
            "a:3: the port alarm is an output event port, the connection one of kind data",
            "a:3: the types differ: the source has Range, the target Image",
            "a:3: the port setup is a provided service port",
            "a:3: the port setup is a required service port",
        ]);
    project
        .application(
            "s:sensor.xml t:sensor.xml p:planner.xml q:planner.xml",
            &connect_all(&[
                "data s.range p.range",
                "data s.range q.range",
                "event s.alarm p.alarm",
                "event t.alarm p.alarm",
                "event t.alarm p.alarm",
                "data t.range p.range",
                "service p.setup s.setup",
                "service p.setup t.setup",
            ]),
            "",
        )
        .refused(&[
            "a:3: this connection was already made",
            "a:3: a second writer into one data input",
            "a:3: a second provider for one required service",
        ]);
}

#[test]
fn mistakes_in_connection_elements() {
    let project = Project::new();
    project
        .application(
            BOTH,
            "<port_connection><source component_name='s'/></port_connection>\
             <port_connection port_type='method'/>",
            "",
        )
        .refused(&[
            "a:3: <port_connection> has no port_type",
            "a:3: <port_connection> has no <target>",
            "a:3: <source> has no port_name",
            "a:3: <port_connection> has no <source>",
            "a:3: <port_connection> has no <target>",
            "a:3: `method` in attribute port_type of <port_connection> is not understood",
        ]);
}

#[test]
fn circles_of_coordination_are_named() {
    let project = Project::new();
    let rules = |pairs: &[(&str, &str)]| {
        let rules = pairs
            .iter()
            .map(|(source, target)| format!("<depends source='{source}' target='{target}'/>"));
        format!("<coordination>{}</coordination>", rules.collect::<String>())
    };
    let three = "a:sensor.xml b:sensor.xml c:sensor.xml";
    project
        .application(three, "", &rules(&[("a", "b"), ("b", "c"), ("c", "b")]))
        .refused(&["a:4: components wait for each other: b after c after b"]);
    project
        .application(three, "", &rules(&[("a", "a")]))
        .refused(&["a:4: components wait for each other: a after a"]);
    let sound = project.application(three, "", &rules(&[("a", "b"), ("a", "c"), ("b", "c")]));
    assert_eq!(sound.sound().coordination, [(0, 1), (0, 2), (1, 2)]);
}

#[test]
fn the_fault_manager_has_event_ports_and_a_name_of_its_own() {
    let project = Project::new();
    project
        .application(
            "fault_manager:sensor.xml s:sensor.xml p:planner.xml",
            &connect_all(&[
                "event fault_manager.smoke p.alarm",
                "data fault_manager.fault p.range",
                "event s.alarm fault_manager.emergency_stop",
                "event fault_manager.emergency_stop s.alarm",
            ]),
            "",
        )
        .refused(&[
            "a:2: `fault_manager` is the fault manager's own name",
            "a:3: the fault manager has no output `smoke`",
            "a:3: a connection of kind data with the fault manager",
            "a:3: the fault manager has no input `emergency_stop`",
            "a:3: the port alarm is an output event port",
        ]);
}
