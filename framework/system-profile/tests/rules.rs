//! Rules: what they mean when they are sound, and what each mistake is called.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

use proptest::prelude::*;
use system_model::fault::FaultKind;
use system_model::rules::{
    Arming, ComponentSeverity, DecisionRule, DependencySeverity, Entity, FaultRules, IsolationTier,
    Preload, StopCategory, VotingMethod,
};
use system_profile::{
    Document, LoadOptions, Problem, Severity, check_file, load_application, load_rules,
    read_profile,
};
use tempfile::TempDir;

const ALL_MISTAKES: &str = include_str!("data/all_mistakes.xml");
const EXPECTED: &str = include_str!("data/all_mistakes.txt");
const DIALECT_EXAMPLE: &str = include_str!("data/dialect_example.xml");

fn data_port(name: &str, usage: &str, data_type: &str) -> String {
    format!(
        "<data_port><name>{name}</name><usage>{usage}</usage><data_type>{data_type}</data_type>\
         </data_port>"
    )
}

fn profile(name: &str, execution: &str, ports: &str, rules: &str) -> String {
    format!(
        "<component_profile><name>{name}</name>\n\
         <execution_environment><library_name>{name}</library_name></execution_environment>\n\
         <execution_semantics>{execution}</execution_semantics>\n{rules}\n\
         <ports>{ports}</ports></component_profile>"
    )
}

const PERIODIC: &str = "<type>periodic</type><period>20</period>";
const EVENTS: &str = "<event_port><name>alarm</name><usage>output</usage></event_port>
    <event_port><name>reset</name><usage>input</usage></event_port>";

/// A folder with the application `patrol`: three sonars and a passive map, an avoidance that reads
/// one sonar, and a motor that it drives.
struct Project {
    folder: TempDir,
}

impl Project {
    fn new() -> Self {
        let project = Self {
            folder: tempfile::tempdir().unwrap(),
        };
        let range_out = data_port("range", "output", "Range");
        let range_in = data_port("range", "input", "Range");
        let command_in = data_port("command", "input", "Command");
        let command_out = data_port("command", "output", "Command");
        let all_events = format!("{range_out}{EVENTS}");
        let avoidance = format!("{range_in}{command_out}");
        let encoders = data_port("left", "output", "Ticks");
        for (name, execution, ports) in [
            ("sonar", PERIODIC, &all_events),
            ("avoidance", PERIODIC, &avoidance),
            ("simple", PERIODIC, &avoidance),
            ("blind", PERIODIC, &data_port("range", "input", "Image")),
            ("motor", PERIODIC, &command_in),
            ("encoders", "<type>aperiodic</type>", &encoders),
            ("map", "<type>passive</type>", &String::new()),
        ] {
            project.write(
                &format!("components/{name}.xml"),
                &profile(name, execution, ports, ""),
            );
        }
        project.application("");
        project
    }

    /// Writes the application anew, with further elements in it.
    fn application(&self, rest: &str) {
        let members = [
            ("front", "sonar"),
            ("left", "sonar"),
            ("right", "sonar"),
            ("avoidance", "avoidance"),
            ("motor", "motor"),
            ("encoders", "encoders"),
            ("map", "map"),
        ];
        let mut text = "<package_profile><name>patrol</name>\n<subcomponents>\n".to_owned();
        for (name, reference) in members {
            writeln!(
                text,
                "<subcomponent><name>{name}</name><reference>{reference}.xml</reference>\
                 <node_id>base</node_id></subcomponent>"
            )
            .unwrap();
        }
        text += "</subcomponents>\n<port_connections>\n";
        for (source, target, port) in [
            ("front", "avoidance", "range"),
            ("avoidance", "motor", "command"),
        ] {
            writeln!(
                text,
                "<port_connection port_type='data'>\
                 <source component_name='{source}' port_name='{port}'/>\
                 <target component_name='{target}' port_name='{port}'/></port_connection>"
            )
            .unwrap();
        }
        let text = format!("{text}</port_connections>\n{rest}</package_profile>");
        self.write("applications/patrol.xml", &text);
    }

    fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, text).unwrap();
        path
    }

    /// Loads rule files, given by what stands in their `fault_rules`.
    fn load(&self, contents: &[&str]) -> Loaded {
        let files = contents.iter().enumerate().map(|(number, content)| {
            self.write(
                &format!("rules/r{number}.xml"),
                &format!("<fault_rules application=\"patrol\">{content}</fault_rules>"),
            )
        });
        self.load_files(&files.collect::<Vec<_>>())
    }

    fn load_files(&self, files: &[PathBuf]) -> Loaded {
        let options = LoadOptions::default();
        let path = self.folder.path().join("applications/patrol.xml");
        let application = load_application(&path, &options);
        let specification = application.specification.expect("a sound application");
        let outcome = load_rules(&specification, files, &options);
        let problems = outcome.problems.iter().map(|problem| {
            let file = problem.place.file.file_stem().unwrap().to_string_lossy();
            format!("{file}:{}: {}", problem.place.line, self.describe(problem))
        });
        Loaded {
            problems: problems.collect(),
            rules: outcome.rules,
        }
    }

    /// What `check` says of a file.
    fn check(&self, path: &Path) -> Vec<String> {
        let reports = check_file(path, &LoadOptions::default());
        let problems = reports.iter().flat_map(|report| &report.problems);
        let problems = problems.map(|problem| {
            let line = problem.place.line;
            format!("{line}: {}", self.describe(problem))
        });
        problems.collect()
    }

    fn describe(&self, problem: &Problem) -> String {
        assert!(problem.help.is_some(), "no help: {problem}");
        assert!(
            problem.place.line > 0 && problem.length > 0,
            "no place: {problem}"
        );
        let folder = self.folder.path().to_string_lossy();
        let message = problem.message.replace(&*folder, "");
        match problem.severity {
            Severity::Error => message,
            Severity::Warning => format!("warning: {message}"),
        }
    }
}

struct Loaded {
    rules: Option<FaultRules>,
    problems: Vec<String>,
}

impl Loaded {
    #[track_caller]
    fn sound(self) -> FaultRules {
        assert_eq!(self.problems, [""; 0]);
        self.rules.expect("rules")
    }
}

fn of(component: &str, rules: &str) -> String {
    format!("<component name=\"{component}\">{rules}</component>")
}

fn milliseconds(number: u64) -> Duration {
    Duration::from_millis(number)
}

#[test]
fn without_rules_everything_has_its_default() {
    let rules = Project::new().load(&[]).sound();
    assert_eq!(rules.application, "patrol");
    assert_eq!(rules.components.len(), 7);
    let severity = rules.components[0].exception_severity(FaultKind::Segfault, 0);
    assert_eq!(severity, ComponentSeverity::Reset);
}

#[test]
fn rules_of_ports() {
    let project = Project::new();
    let rules = project
        .load(&[&of(
            "avoidance",
            "<port name='range'>
              <validity field='distance'><min>0.03</min><max>3</max></validity>
              <validation field='angle' latch='true' armed='always' severity='stop'>
                <rang_min>-1</rang_min><range_max>1</range_max><confirm count='3' within='1s'/>
              </validation>
              <freshness max_age='60' safe_value='0.5'/>
              <rate_of_change field='distance' max='2.5'/><stuck count='10'/>
            </port>",
        )])
        .sound();
    let port = &rules.components[3].ports[0];
    assert_eq!((&port.port[..], &port.data_type[..]), ("range", "Range"));
    let checks = &port.checks;
    let interval = &checks.validity[0];
    assert_eq!(
        (interval.value.minimum, interval.value.maximum),
        (Some(0.03), Some(3.0))
    );
    assert_eq!(interval.place.line, 2);
    assert!(interval.place.file.ends_with("rules/r0.xml"));
    let alias = &checks.validity[1].value;
    assert_eq!((alias.minimum, alias.maximum), (Some(-1.0), Some(1.0)));
    let judgement = alias.judgement;
    assert!(judgement.latched && judgement.arming == Arming::Always);
    assert_eq!(judgement.severity, Some(ComponentSeverity::Stop));
    let confirmation = rules.components[3].confirmation(&judgement);
    assert_eq!(
        (confirmation.count, confirmation.within),
        (3, Some(milliseconds(1000)))
    );
    let freshness = checks.freshness.as_ref().unwrap();
    assert_eq!(freshness.value.maximum_age, milliseconds(60));
    assert_eq!(checks.safe_values[0].value.value, 0.5);
    assert_eq!(checks.rate_of_change[0].value.maximum_per_second, 2.5);
    assert_eq!(checks.stuck[0].value.count, 10);
}

#[test]
fn rules_of_components() {
    let project = Project::new();
    let rules = project
        .load(&[&of(
            "motor",
            "<severity>emergency</severity><confirm count='2'/>
            <exception signal='SIGSEGV' severity='reset'/><exception class='panic' severity='stop'/>
            <exception return_code='0x10000001' severity='ignore'/>
            <exception return_code='callee' severity='reset'/>
            <fault_event name='too_hot' severity='stop'/>
            <watchdog deadline='10ms' startup='2s'/><overrun tolerated='3' within='1s'/>
            <heartbeat period='100' missed='2'/>
            <resurrect><reset>on</reset><backup persist='true'>40</backup></resurrect>
            <fault window='10s' backoff='5' retry_max='2'><severity>global</severity></fault>
            <recovery deadline='20'/><isolation group='drive'>process</isolation>
            <actuator stop_category='1'><command port='command' safe_value='0'/></actuator>
            <adapt>adapt.xml</adapt><handle><reference>handle.xml</reference></handle>",
        )])
        .sound();
    let motor = &rules.components[4];
    let severity = |kind, code| motor.exception_severity(kind, code);
    assert_eq!(severity(FaultKind::Segfault, 0), ComponentSeverity::Reset);
    assert_eq!(severity(FaultKind::Panic, 0), ComponentSeverity::Stop);
    assert_eq!(
        severity(FaultKind::ErrorReturn, 0x1000_0001),
        ComponentSeverity::Ignore
    );
    assert_eq!(
        severity(FaultKind::ErrorReturn, 500),
        ComponentSeverity::Reset
    );
    assert_eq!(severity(FaultKind::Abort, 0), ComponentSeverity::Emergency);
    let watchdog = motor.watchdog.as_ref().unwrap().value;
    assert_eq!(watchdog.deadline, Some(milliseconds(10)));
    assert_eq!(watchdog.startup, Duration::from_secs(2));
    assert_eq!(motor.confirmation(&watchdog.judgement).count, 2);
    assert_eq!(motor.overrun.as_ref().unwrap().value.tolerated, 3);
    assert_eq!(motor.heartbeat.as_ref().unwrap().value.missed, 2);
    let resurrect = motor.resurrect.as_ref().unwrap().value;
    assert!(resurrect.reset && resurrect.persist);
    assert_eq!(resurrect.backup, Some(milliseconds(40)));
    let fault = motor.fault.as_ref().unwrap().value;
    assert_eq!(
        (fault.retry_max, fault.window),
        (2, Duration::from_secs(10))
    );
    assert_eq!(fault.backoff, milliseconds(5));
    let isolation = &motor.isolation.as_ref().unwrap().value;
    assert_eq!(
        (isolation.tier, isolation.group.as_deref()),
        (IsolationTier::Process, Some("drive"))
    );
    let actuator = motor.actuator.as_ref().unwrap().value;
    assert_eq!(actuator.stop_category, StopCategory::ControlledThenOff);
    assert_eq!(motor.ports[0].checks.safe_values[0].value.value, 0.0);
    assert_eq!(motor.adapt.as_ref().unwrap().value, "adapt.xml");
    assert_eq!(motor.handle.as_ref().unwrap().value, "handle.xml");
}

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
fn rules_of_everything_else() {
    let project = Project::new();
    project.write(
        "applications/mapping.xml",
        "<package_profile><name>mapping</name><subcomponents/><port_connections/></package_profile>",
    );
    let rules = project
        .load(&["<fault retry_max='1'/><heartbeat period='1s'/>
            <executor name='motor'><overrun tolerated='1' within='1s'/></executor>
            <node name='base'><heartbeat period='1s'/></node>
            <application name='patrol'><dependency><reference>mapping</reference></dependency></application>
            <dependency need='2' severity='destroy'><name>avoidance</name>
              <reference>front</reference><reference>left</reference>
              <reference kind='executor'>right</reference></dependency>
            <monitor name='drive'>
              <process_model model='dc.xml' window='200' threshold='0.5' method='cusum' drift='0.1'>
                <input component='motor' port='command' field='rpm'/>
                <output component='encoders' port='left'/><parameter name='gain'>2</parameter>
              </process_model></monitor>
            <monitor name='sonars'><voting of='3' method='weighted' tolerance='0.1' weights='1, 2 1'>
                <input component='front' port='range'/><input component='left' port='range'/>
                <input component='right' port='range'/><output component='avoidance' port='range'/>
              </voting></monitor>"])
        .sound();
    assert_eq!(rules.fault.unwrap().value.retry_max, 1);
    assert!(rules.heartbeat.is_some());
    assert_eq!(rules.executors[0].first_component, 4);
    assert_eq!(rules.nodes[0].0, "base");
    let [avoidance, patrol] = &rules.dependencies[..] else {
        panic!("two dependencies");
    };
    assert_eq!(
        (avoidance.value.need, avoidance.value.severity),
        (2, DependencySeverity::Destroy)
    );
    let providers: Vec<_> = avoidance
        .value
        .providers
        .iter()
        .map(|p| p.entity.clone())
        .collect();
    let expected = [
        Entity::Component(0),
        Entity::Component(1),
        Entity::Executor(2),
    ];
    assert_eq!(providers, expected);
    assert_eq!(
        patrol.value.dependent.entity,
        Entity::Application("patrol".into())
    );
    let drive = &rules.monitors[0];
    assert_eq!(
        drive.rule.value.method,
        DecisionRule::Cusum { drift: Some(0.1) }
    );
    assert_eq!(
        (drive.inputs[0].component, drive.inputs[0].field.as_deref()),
        (4, Some("rpm"))
    );
    assert_eq!(drive.rule.value.parameters, [("gain".to_owned(), 2.0)]);
    let voting = &rules.votings[0];
    assert_eq!(voting.rule.value.method, VotingMethod::Weighted);
    let weights: Vec<f64> = voting.sources.iter().map(|source| source.weight).collect();
    assert_eq!(weights, [1.0, 2.0, 1.0]);
}

#[test]
fn all_mistakes_are_reported_at_once() {
    let project = Project::new();
    let path = project.write("rules/all_mistakes.xml", ALL_MISTAKES);
    let found = project.check(&path).join("\n");
    assert!(found == EXPECTED.trim_end(), "{found}");
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
fn mistakes_in_inline_rules() {
    let project = Project::new();
    let path = project.write(
        "components/sonar.xml",
        &profile(
            "sonar",
            PERIODIC,
            "<event_port><name>alarm</name><usage>output</usage><stuck count='3'/></event_port>",
            "<watchdog deadlne='10'/>",
        ),
    );
    assert_eq!(
        project.check(&path),
        [
            "4: warning: unknown attribute deadlne in <watchdog>",
            "5: a stuck value of the port alarm, which is an output event port",
        ]
    );
}

#[test]
fn two_rule_files_must_not_contradict_each_other() {
    let project = Project::new();
    let watchdog = |deadline: &str| of("motor", &format!("<watchdog deadline='{deadline}'/>"));
    project.load(&[&watchdog("60"), &watchdog("0.06s")]).sound();
    let loaded = project.load(&[&watchdog("60"), &watchdog("70")]);
    assert!(loaded.rules.is_none());
    assert_eq!(
        loaded.problems,
        ["r1:1: this <watchdog> contradicts the one at /rules/r0.xml:1:60"]
    );
    let secondary = |reference: &str| {
        let text =
            format!("<fault><secondary><reference>{reference}</reference></secondary></fault>");
        of("avoidance", &text)
    };
    let loaded = project.load(&[&secondary("simple.xml"), &of("avoidance", "<fault/>")]);
    assert_eq!(
        loaded.problems,
        ["r1:1: this list of secondaries contradicts the one at /rules/r0.xml:1:64"]
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
fn a_rule_file_without_its_application_is_checked_alone() {
    let project = Project::new();
    let path = project.write("rules/x.xml", "<fault_rules application='patrl'/>");
    assert_eq!(
        project.check(&path),
        [
            "1: warning: there is no application `patrl` (patrl.xml); only this file alone was checked"
        ]
    );
    let path = project.write("rules/x.xml", "<fault_rules/>");
    assert_eq!(
        project.check(&path),
        ["1: <fault_rules> has no application"]
    );
    let loaded = project.load_files(&[path]);
    assert!(loaded.rules.is_none());
}

#[test]
fn rules_of_another_application_and_no_rules_at_all() {
    let project = Project::new();
    let other = project.write("rules/x.xml", "<fault_rules application='mapping'/>");
    let none = project.write(
        "rules/y.xml",
        "<package_profile><name>y</name><subcomponents/>\
        <port_connections/></package_profile>",
    );
    assert_eq!(
        project.load_files(&[other, none]).problems,
        [
            "x:1: these are rules of `mapping`, not of `patrol`",
            "y:1: <package_profile> holds no rules",
        ]
    );
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

#[test]
fn too_many_rules_are_refused() {
    let many = "<component/>".repeat(20_001);
    let text = format!("<fault_rules application='a'>{many}</fault_rules>");
    let document = Document::from_bytes("r.xml", text.as_bytes());
    assert!(read_profile(&document).is_none());
    assert_eq!(document.problems().len(), 1);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_damaged_rule_file_never_panics(
        cut in 0..ALL_MISTAKES.len(),
        edits in prop::collection::vec((0..ALL_MISTAKES.len(), any::<u8>()), 0..6),
        swaps in prop::collection::vec((0..110_usize, 0..110_usize), 0..6),
    ) {
        let project = Project::new();
        let mut lines: Vec<&str> = ALL_MISTAKES.lines().collect();
        for (a, b) in swaps {
            let count = lines.len();
            lines.swap(a % count, b % count);
        }
        let mut bytes = lines.join("\n").into_bytes();
        project.write("rules/swapped.xml", std::str::from_utf8(&bytes).unwrap());
        check_file(&project.folder.path().join("rules/swapped.xml"), &LoadOptions::default());
        let count = bytes.len();
        for (at, byte) in edits {
            bytes[at % count] = byte;
        }
        for part in [&bytes[..], &bytes[..cut.min(count)], &bytes[cut.min(count)..]] {
            let path = project.folder.path().join("rules/damaged.xml");
            std::fs::write(&path, part).unwrap();
            check_file(&path, &LoadOptions::default());
        }
    }
}
