//! Where rules come from, and who wins.

use std::fmt::Write as _;
use std::path::Path;

use system_model::rules::{ComponentSeverity, Preload};
use system_profile::{LoadOptions, check_file, load_application, load_rules};

use crate::project::{PERIODIC, Project, data_port, milliseconds, of, profile};

const DIALECT_EXAMPLE: &str = include_str!("../data/dialect_example.xml");

#[test]
fn a_secondary_is_ready_to_be_brought_up() {
    let rules = Project::new()
        .load(&[&of(
            "avoidance",
            "<fault><secondary preload='warm'><reference>simple.xml</reference></secondary></fault>",
        )])
        .sound();
    let secondary = &rules.components[3].secondaries[0];
    assert_eq!(secondary.preload, Preload::Warm);
    let specification = &secondary.specification;
    assert_eq!(
        (&specification.name[..], &specification.library[..]),
        ("avoidance", "simple")
    );
    assert_eq!(specification.node, "base");
}

#[test]
fn the_example_of_the_dialect() {
    let project = Project::new();
    let path = project.write("rules/patrol.xml", DIALECT_EXAMPLE);
    let range = data_port("range", "output", "Range");
    let command = data_port("command", "input", "Command");
    let left = data_port("left", "output", "Ticks");
    let mut members = String::new();
    for (name, ports) in [
        ("front_sonar", &range),
        ("obstacle_avoidance", &String::new()),
        ("obstacle_avoidance_simple", &String::new()),
        ("motor_driver", &command),
        ("encoders", &left),
    ] {
        let text = profile(name, PERIODIC, ports, "");
        project.write(&format!("components/{name}.xml"), &text);
        write!(
            members,
            "<subcomponent><name>{name}</name><reference>{name}.xml</reference></subcomponent>"
        )
        .unwrap();
    }
    project.write(
        "applications/target_following.xml",
        &format!(
            "<package_profile><name>target_following</name><subcomponents>{members}</subcomponents>\
             <port_connections/></package_profile>"
        ),
    );
    assert_eq!(project.check(&path), [""; 0]);
}

#[test]
fn the_rules_of_the_reference_robot_have_no_problem_of_any_kind() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let path = root.join("rules/target_following.xml");
    let options = LoadOptions::default();
    let reports = check_file(&path, &options);
    assert_eq!(reports.len(), 1, "{reports:#?}");
    assert!(reports[0].problems.is_empty(), "{:#?}", reports[0].problems);

    let application = root.join("profiles/applications/target_following.xml");
    let application = load_application(&application, &options)
        .specification
        .unwrap();
    let outcome = load_rules(&application, &[path], &options);
    assert!(outcome.problems.is_empty(), "{:#?}", outcome.problems);
    let rules = outcome.rules.expect("rules");
    let position = |name: &str| application.components.iter().position(|c| c.name == name);
    let avoidance = position("obstacle_avoidance").expect("obstacle avoidance");
    let secondary = &rules.components[avoidance].secondaries[0];
    assert_eq!(
        secondary.specification.type_name,
        "obstacle_avoidance_simple"
    );
    assert_eq!(rules.dependencies[0].value.need, 3);
}

#[test]
fn inline_rules_and_who_wins() {
    let project = Project::new();
    project.write(
        "components/sonar.xml",
        &profile(
            "sonar",
            PERIODIC,
            "<data_port><name>range</name><usage>output</usage><data_type>Range</data_type>
              <validity field='a'><max>1</max></validity><validity field='b'><max>1</max></validity>
             </data_port>",
            "<watchdog deadline='10'/><severity>stop</severity><resurrect><reset>true</reset></resurrect>",
        ),
    );
    let path = project.folder.path().join("applications/patrol.xml");
    let text = std::fs::read_to_string(&path).unwrap();
    let inline = "<name>front</name><watchdog deadline='20'/>\
                  <port name='range'><validity field='b'><max>2</max></validity></port>";
    let text = text.replace("<name>front</name>", inline);
    std::fs::write(&path, text).unwrap();
    let reports = check_file(&path, &LoadOptions::default());
    assert!(reports[0].problems.is_empty(), "{:?}", reports[0].problems);

    let rules = project
        .load(&[&of("front", "<severity>ignore</severity>")])
        .sound();
    let front = &rules.components[0];
    assert_eq!(
        front.watchdog.as_ref().unwrap().value.deadline,
        Some(milliseconds(20))
    );
    assert_eq!(
        front.severity.as_ref().unwrap().value,
        ComponentSeverity::Ignore
    );
    assert!(front.resurrect.as_ref().unwrap().value.reset);
    let maxima: Vec<_> = front.ports[0]
        .checks
        .validity
        .iter()
        .map(|v| v.value.maximum)
        .collect();
    assert_eq!(maxima, [Some(1.0), Some(2.0)]);
    let left = &rules.components[1];
    assert_eq!(
        left.watchdog.as_ref().unwrap().value.deadline,
        Some(milliseconds(10))
    );
}

#[test]
fn dependencies_of_a_system_file() {
    let project = Project::new();
    let dependency = |name: &str, reference: &str| {
        format!(
            "<dependency><name>{name}</name><reference>{reference}</reference>\
             <severity>stop</severity></dependency>\n"
        )
    };
    let text = |dependencies: &str| {
        format!(
            "<system_config><package_deployer><prop name='load.type'>list</prop>\
             <app_load>patrol</app_load><app_load>mapping</app_load></package_deployer>\n\
             {dependencies}</system_config>"
        )
    };
    let sound = text(&dependency("patrol", "mapping"));
    let path = project.write("system.xml", &sound);
    assert_eq!(project.check(&path), [""; 0]);
    let rules = project.load_files(&[path]).sound();
    assert_eq!(rules.dependencies.len(), 1);

    let circular = dependency("patrol", "mapping") + &dependency("mapping", "patrol");
    let path = project.write(
        "system.xml",
        &text(&(circular + &dependency("patrl", "mapping"))),
    );
    assert_eq!(
        project.check(&path),
        [
            "3: a circular dependency: mapping needs patrol needs mapping",
            "4: there is no application `patrl`",
        ]
    );
}

#[test]
fn inline_rules_of_the_application() {
    let project = Project::new();
    project.application(
        "<fault><retry_max>7</retry_max><severity>global</severity></fault>\
         <dependency><name>motor</name><reference>avoidance</reference></dependency>",
    );
    let rules = project.load(&[]).sound();
    assert_eq!(rules.fault.unwrap().value.retry_max, 7);
    assert_eq!(rules.dependencies[0].value.need, 1);
    // A circle that is closed only by the rule file.
    let closing = "<dependency><name>avoidance</name><reference>motor</reference></dependency>";
    let text = format!("<fault_rules application='patrol'>{closing}</fault_rules>");
    let path = project.write("rules/patrol.xml", &text);
    assert_eq!(
        project.check(&path),
        ["1: a circular dependency: avoidance needs motor needs avoidance"]
    );
}

#[test]
fn a_voter_of_a_composite() {
    let project = Project::new();
    project.write(
        "components/trio.xml",
        "<composite_component_profile><name>trio</name><subcomponents>
         <subcomponent><name>a</name><reference>sonar.xml</reference></subcomponent>
         <subcomponent><name>b</name><reference>sonar.xml</reference></subcomponent>
         <subcomponent><name>c</name><reference>sonar.xml</reference></subcomponent>
         <subcomponent><name>user</name><reference>avoidance.xml</reference></subcomponent>
         </subcomponents><port_connections/><export_ports/>
         <voting of='3' tolerance='0.1'><input component='a' port='range'/>
         <input component='b' port='range'/><input component='c' port='range'/>
         <output component='user' port='range'/></voting></composite_component_profile>",
    );
    project.write(
        "applications/patrol.xml",
        "<package_profile><name>patrol</name><subcomponents><subcomponent><name>t</name>
         <reference>trio.xml</reference></subcomponent></subcomponents><port_connections/>
         </package_profile>",
    );
    let rules = project.load(&[]).sound();
    assert_eq!(rules.votings[0].sources[2].port.component, 2);
    assert_eq!(rules.votings[0].output.component, 3);
}

#[test]
fn the_facts_of_a_rule_file() {
    let project = Project::new();
    let path = project.write(
        "rules/r.xml",
        "<fault_rules application='patrol'><component name='front'/><component name='left'/>\
         </fault_rules>",
    );
    let reading = &check_file(&path, &LoadOptions::default())[0].reading;
    assert_eq!(reading["root"], "fault_rules");
    assert_eq!(reading["application"], "patrol");
    assert_eq!(reading["components"], serde_json::json!(["front", "left"]));
    assert_eq!(reading["wellformed"], true);
}
