//! What sound injections become.

use std::time::Duration;

use system_model::injection::{
    CallbackName, ContainerFailure, Distortion, InjectedFault, Injection, Interval, Misbehaviour,
    Repetition, RobotSide, Trigger, WorldFault,
};
use system_profile::read_injection;

use crate::project::{Project, milliseconds};

const FRONT: usize = 0;
const AVOIDANCE: usize = 3;

fn one(attributes: &str) -> Injection {
    let project = Project::new();
    project.in_a_world();
    let (injections, problems) = project.inject(&format!("<inject {attributes}/>"));
    assert_eq!(problems, [""; 0], "{attributes}");
    let mut injections = injections.expect("injections");
    assert_eq!(injections.len(), 1);
    let injection = injections.remove(0);
    assert!(
        attributes.contains(&format!("fault='{}'", injection.what.name())),
        "{attributes}"
    );
    injection
}

#[test]
fn faults_of_callbacks() {
    for (attributes, callback, misbehaviour) in [
        ("fault='panic'", CallbackName::Execute, Misbehaviour::Panic),
        (
            "fault='segfault' callback='onStart'",
            CallbackName::Start,
            Misbehaviour::Segfault,
        ),
        (
            "fault='bus_error' callback='onUpdated'",
            CallbackName::Updated,
            Misbehaviour::BusError,
        ),
        (
            "fault='divide_by_zero'",
            CallbackName::Execute,
            Misbehaviour::DivideByZero,
        ),
        (
            "fault='illegal_instruction'",
            CallbackName::Execute,
            Misbehaviour::IllegalInstruction,
        ),
        ("fault='abort'", CallbackName::Execute, Misbehaviour::Abort),
        (
            "fault='stack_overflow'",
            CallbackName::Execute,
            Misbehaviour::StackOverflow,
        ),
        ("fault='exit'", CallbackName::Execute, Misbehaviour::Exit(1)),
        (
            "fault='exit' code='3'",
            CallbackName::Execute,
            Misbehaviour::Exit(3),
        ),
        (
            "fault='hang' callback='onReset'",
            CallbackName::Reset,
            Misbehaviour::Hang,
        ),
        (
            "fault='slow' duration='80ms'",
            CallbackName::Execute,
            Misbehaviour::Slow(milliseconds(80)),
        ),
        (
            "fault='leak' bytes='4096'",
            CallbackName::Execute,
            Misbehaviour::Leak(4096),
        ),
        (
            "fault='error_return' code='268435456'",
            CallbackName::Execute,
            Misbehaviour::ErrorReturn(0x1000_0000),
        ),
    ] {
        let injection = one(&format!("component='avoidance' {attributes}"));
        let expected = InjectedFault::Callback {
            component: AVOIDANCE,
            callback,
            misbehaviour,
        };
        assert_eq!(injection.what, expected, "{attributes}");
    }
}

#[test]
fn faults_of_ports() {
    for (attributes, field, distortion) in [
        (
            "fault='out_of_range' value='-1' field='distance'",
            Some("distance"),
            Distortion::OutOfRange(-1.0),
        ),
        (
            "fault='not_a_number' field='x'",
            Some("x"),
            Distortion::NotANumber,
        ),
        ("fault='stuck'", None, Distortion::Stuck),
        ("fault='offset' value='0.4'", None, Distortion::Offset(0.4)),
        (
            "fault='drift' per_second='-0.1'",
            None,
            Distortion::Drift(-0.1),
        ),
        (
            "fault='noise' deviation='0.05'",
            None,
            Distortion::Noise(0.05),
        ),
        ("fault='drop'", None, Distortion::Drop),
        (
            "fault='delay' duration='1.5s'",
            None,
            Distortion::Delay(milliseconds(1500)),
        ),
        ("fault='duplicate'", None, Distortion::Duplicate),
    ] {
        let injection = one(&format!("component='front' port='range' {attributes}"));
        let expected = InjectedFault::Port {
            component: FRONT,
            port: "range".into(),
            field: field.map(str::to_owned),
            distortion,
        };
        assert_eq!(injection.what, expected, "{attributes}");
        assert!(injection.what.lasts());
    }
}

#[test]
fn faults_of_the_world_and_of_the_container() {
    let world = |component, fault| InjectedFault::World { component, fault };
    let container = |failure| InjectedFault::Container {
        component: AVOIDANCE,
        failure,
    };
    for (attributes, expected) in [
        (
            "fault='unplug_sonar' index='3'",
            world(None, WorldFault::UnplugSonar(3)),
        ),
        (
            "fault='unplug_sonar' component='front'",
            world(Some(FRONT), WorldFault::UnplugSonar(2)),
        ),
        (
            "fault='unplug_sonar' component='front' index='1'",
            world(Some(FRONT), WorldFault::UnplugSonar(1)),
        ),
        (
            "fault='motor_driver_off' side='left'",
            world(None, WorldFault::MotorDriverOff(RobotSide::Left)),
        ),
        (
            "fault='encoder_dead' side='right'",
            world(None, WorldFault::EncoderDead(RobotSide::Right)),
        ),
        (
            "fault='camera_smoke' density='0.8'",
            world(None, WorldFault::CameraSmoke(0.8)),
        ),
        (
            "fault='library_missing' component='avoidance'",
            container(ContainerFailure::LibraryMissing),
        ),
        (
            "fault='checkpoint_corrupt' component='avoidance'",
            container(ContainerFailure::CheckpointCorrupt),
        ),
        (
            "fault='recovery_fails' component='avoidance'",
            container(ContainerFailure::RecoveryFails),
        ),
    ] {
        assert_eq!(one(attributes).what, expected, "{attributes}");
    }
}

#[test]
fn times() {
    let at = |time| Trigger::At(milliseconds(time));
    let cycle = |cycle| Trigger::AtCycle {
        component: AVOIDANCE,
        cycle,
    };
    let every = |times, every| Some(Repetition { times, every });
    let second = milliseconds(1000);
    type Expected = (Trigger, Option<Duration>, Option<Repetition>, Option<f64>);
    let table: [(&str, Expected); 9] = [
        ("", (at(0), None, None, None)),
        ("at='5s' for='2s'", (at(5000), Some(2 * second), None, None)),
        ("at='20'", (at(20), None, None, None)),
        ("at_cycle='120' repeat='1'", (cycle(120), None, None, None)),
        (
            "at='1s' repeat='3' every='1s'",
            (at(1000), None, every(Some(3), Interval::Time(second)), None),
        ),
        (
            "at='1s' every='1s'",
            (at(1000), None, every(None, Interval::Time(second)), None),
        ),
        (
            "at_cycle='100' repeat='3' every_cycles='50'",
            (cycle(100), None, every(Some(3), Interval::Cycles(50)), None),
        ),
        ("probability='0.1'", (at(0), None, None, Some(0.1))),
        (
            "probability='1' for='1s' every='1s'",
            (
                at(0),
                Some(second),
                every(None, Interval::Time(second)),
                Some(1.0),
            ),
        ),
    ];
    for (attributes, expected) in table {
        let found = one(&format!("component='avoidance' fault='panic' {attributes}"));
        let Injection {
            trigger,
            lasting,
            repetition,
            probability,
            ..
        } = found;
        let found = (trigger, lasting, repetition, probability);
        assert_eq!(found, expected, "{attributes}");
    }
}

#[test]
fn a_world_fault_may_wait_for_a_cycle() {
    let injection = one("fault='encoder_dead' side='left' component='motor' at_cycle='7'");
    let expected = Trigger::AtCycle {
        component: 4,
        cycle: 7,
    };
    assert_eq!(injection.trigger, expected);
}

#[test]
fn the_file_is_checked_with_its_application() {
    let project = Project::new();
    let text = |component: &str| {
        format!(
            "<fault_injections application='patrol'>\n\
             <inject component='{component}' fault='panic'/></fault_injections>"
        )
    };
    for folder in ["rules", "rules/scenarios/crash"] {
        let path = project.write(&format!("{folder}/injections.xml"), &text("motor"));
        assert_eq!(project.check(&path), [""; 0], "{folder}");
        let path = project.write(&format!("{folder}/injections.xml"), &text("motr"));
        let expected = ["2: there is no component `motr`"];
        assert_eq!(project.check(&path), expected, "{folder}");
    }
}

#[test]
fn one_injection_may_stand_alone() {
    let application = Project::new().specification();
    let read = |text: &str| read_injection(&application, "request", text);
    let sound = read("<inject component='motor' fault='hang'/>");
    assert_eq!(sound.injections.map(|injections| injections.len()), Some(1));
    for wrong in [
        "",
        "<inject",
        "<fault_injections application='patrol'/>",
        "<inject component='motr' fault='hang'/>",
    ] {
        let outcome = read(wrong);
        assert!(outcome.injections.is_none(), "{wrong}");
        assert_eq!(outcome.problems.len(), 1, "{wrong}");
    }
}
