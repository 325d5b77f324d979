//! What an injection makes go wrong, by its KIND, with the attributes that each KIND needs.

use system_model::injection::{
    CallbackName, ContainerFailure, DEFAULT_EXIT_CODE, Distortion, Misbehaviour, RobotSide,
    WorldFault,
};
use system_model::profile::Located;
use system_model::world::SONAR_COUNT;

use super::DeclaredFault;
use crate::node::Node;
use crate::readers::rules::measure::{positive, positive_duration};
use crate::suggest::{self, quoted};
use crate::value::Value;

/// Every attribute that some KIND has.
pub(super) const ATTRIBUTES: [&str; 13] = [
    "callback",
    "duration",
    "bytes",
    "code",
    "port",
    "field",
    "value",
    "per_second",
    "deviation",
    "index",
    "side",
    "density",
    "component",
];

/// Statuses by which a callback says that it succeeded.
const SUCCESSES: [u32; 2] = [200, 202];

/// Reads what one KIND needs; `None` where something is missing, which has then been reported.
type Reader<T> = fn(&Node<'_>) -> Option<T>;

const MISBEHAVIOURS: [(&str, Reader<Misbehaviour>); 12] = [
    ("panic", |_| Some(Misbehaviour::Panic)),
    ("segfault", |_| Some(Misbehaviour::Segfault)),
    ("bus_error", |_| Some(Misbehaviour::BusError)),
    ("divide_by_zero", |_| Some(Misbehaviour::DivideByZero)),
    ("illegal_instruction", |_| {
        Some(Misbehaviour::IllegalInstruction)
    }),
    ("abort", |_| Some(Misbehaviour::Abort)),
    ("stack_overflow", |_| Some(Misbehaviour::StackOverflow)),
    ("exit", exit),
    ("hang", |_| Some(Misbehaviour::Hang)),
    ("slow", |node| {
        let duration = needed(node, "duration", "80ms")?;
        positive_duration(&duration).map(Misbehaviour::Slow)
    }),
    ("leak", leak),
    ("error_return", error_return),
];

const DISTORTIONS: [(&str, Reader<Distortion>); 9] = [
    ("out_of_range", |node| {
        number(node, "value").map(Distortion::OutOfRange)
    }),
    ("not_a_number", |_| Some(Distortion::NotANumber)),
    ("stuck", |_| Some(Distortion::Stuck)),
    ("offset", |node| {
        number(node, "value").map(Distortion::Offset)
    }),
    ("drift", |node| {
        number(node, "per_second").map(Distortion::Drift)
    }),
    ("noise", |node| {
        let deviation = needed(node, "deviation", "0.05")?;
        positive(&deviation).map(Distortion::Noise)
    }),
    ("drop", |_| Some(Distortion::Drop)),
    ("delay", |node| {
        let duration = needed(node, "duration", "80ms")?;
        positive_duration(&duration).map(Distortion::Delay)
    }),
    ("duplicate", |_| Some(Distortion::Duplicate)),
];

const WORLD_FAULTS: [(&str, Reader<WorldFault>); 4] = [
    ("unplug_sonar", |node| {
        socket(&needed(node, "index", "0")?).map(WorldFault::UnplugSonar)
    }),
    ("motor_driver_off", |node| {
        side(node).map(WorldFault::MotorDriverOff)
    }),
    ("encoder_dead", |node| {
        side(node).map(WorldFault::EncoderDead)
    }),
    ("camera_smoke", camera_smoke),
];

const CONTAINER_FAILURES: [(&str, ContainerFailure); 3] = [
    ("library_missing", ContainerFailure::LibraryMissing),
    ("checkpoint_corrupt", ContainerFailure::CheckpointCorrupt),
    ("recovery_fails", ContainerFailure::RecoveryFails),
];

/// Reads what goes wrong; `None` where that cannot be understood, which has then been reported.
/// `of_component`: whether the injection names a component.
pub(super) fn read(node: &Node<'_>, kind: &Value<'_>, of_component: bool) -> Option<DeclaredFault> {
    let name = kind.as_str();
    if let Some(read) = find(&MISBEHAVIOURS, name) {
        let callback = callback(node, kind);
        let misbehaviour = read(node);
        return Some(DeclaredFault::Callback {
            callback: callback?,
            misbehaviour: misbehaviour?,
        });
    }
    if let Some(read) = find(&DISTORTIONS, name) {
        return port_fault(node, read);
    }
    if name == "unplug_sonar" && of_component && node.attribute("index").is_none() {
        return Some(DeclaredFault::UnplugSonarOfComponent);
    }
    if let Some(read) = find(&WORLD_FAULTS, name) {
        return read(node).map(DeclaredFault::World);
    }
    if let Some(failure) = find(&CONTAINER_FAILURES, name) {
        return Some(DeclaredFault::Container(failure));
    }
    kind.error(
        format!("there is no fault `{}` to inject", quoted(name)),
        suggest::help(name, "there are", names()),
    );
    None
}

fn find<T: Copy>(table: &[(&str, T)], name: &str) -> Option<T> {
    let found = table.iter().find(|(kind, _)| *kind == name);
    found.map(|(_, meaning)| *meaning)
}

fn names() -> impl Iterator<Item = &'static str> {
    let misbehaviours = MISBEHAVIOURS.iter().map(|(name, _)| *name);
    let distortions = DISTORTIONS.iter().map(|(name, _)| *name);
    let world = WORLD_FAULTS.iter().map(|(name, _)| *name);
    let container = CONTAINER_FAILURES.iter().map(|(name, _)| *name);
    misbehaviours
        .chain(distortions)
        .chain(world)
        .chain(container)
}

fn callback(node: &Node<'_>, kind: &Value<'_>) -> Option<Located<CallbackName>> {
    let Some(value) = node.attribute("callback") else {
        return Some(Located {
            value: CallbackName::Execute,
            place: kind.place(),
        });
    };
    Some(Located {
        value: value.choice(&CallbackName::ALL)?,
        place: value.place(),
    })
}

fn port_fault(node: &Node<'_>, read: Reader<Distortion>) -> Option<DeclaredFault> {
    let port = needed(node, "port", "range");
    let distortion = read(node);
    let whole = |distortion: &Distortion| {
        matches!(
            distortion,
            Distortion::Drop | Distortion::Delay(_) | Distortion::Duplicate
        )
    };
    let field = match &distortion {
        // A datum is lost, late or doubled as a whole.
        Some(distortion) if whole(distortion) => None,
        _ => node.attribute("field"),
    };
    Some(DeclaredFault::Port {
        port: port?.located(),
        field: field.map(|field| field.as_str().to_owned()),
        distortion: distortion?,
    })
}

/// An attribute that the KIND needs.
fn needed<'a>(node: &Node<'a>, name: &'static str, example: &str) -> Option<Value<'a>> {
    let found = node.attribute(name);
    if found.is_none() {
        let kind = node.attribute("fault");
        let kind = kind.as_ref().map_or("fault", Value::as_str);
        node.error(
            format!("`{}` needs {name}", quoted(kind)),
            Some(format!("write {name}=\"{example}\"")),
        );
    }
    found
}

fn number(node: &Node<'_>, name: &'static str) -> Option<f64> {
    needed(node, name, "0.5")?.number()
}

fn exit(node: &Node<'_>) -> Option<Misbehaviour> {
    let Some(code) = node.attribute("code") else {
        return Some(Misbehaviour::Exit(DEFAULT_EXIT_CODE));
    };
    let code: u8 = code.number()?;
    Some(Misbehaviour::Exit(i32::from(code)))
}

fn leak(node: &Node<'_>) -> Option<Misbehaviour> {
    let value = needed(node, "bytes", "4096")?;
    let bytes: u32 = value.number()?;
    if bytes == 0 {
        value.error("a leak of nothing", Some("write bytes=\"4096\"".into()));
        return None;
    }
    Some(Misbehaviour::Leak(u64::from(bytes)))
}

fn error_return(node: &Node<'_>) -> Option<Misbehaviour> {
    let value = needed(node, "code", "500")?;
    let code: u32 = value.number()?;
    if SUCCESSES.contains(&code) {
        value.error(
            format!("{code} is no error"),
            Some("write the code of a failure, 500 for one of the callee".into()),
        );
        return None;
    }
    Some(Misbehaviour::ErrorReturn(code))
}

/// The index of a sonar's socket on the board.
fn socket(value: &Value<'_>) -> Option<usize> {
    let index: usize = value.number()?;
    if index < SONAR_COUNT {
        return Some(index);
    }
    value.error(
        format!("the board has no socket {index}"),
        Some(format!("write a number from 0 to {}", SONAR_COUNT - 1)),
    );
    None
}

fn side(node: &Node<'_>) -> Option<RobotSide> {
    needed(node, "side", "left")?.choice(&[("left", RobotSide::Left), ("right", RobotSide::Right)])
}

fn camera_smoke(node: &Node<'_>) -> Option<WorldFault> {
    let value = needed(node, "density", "0.8")?;
    let density: f64 = value.number()?;
    if (0.0..=1.0).contains(&density) {
        return Some(WorldFault::CameraSmoke(density));
    }
    value.error(
        "smoke has a density from 0 to 1",
        Some("0 is clear, 1 is nothing but grey".into()),
    );
    None
}
