//! When an injection begins, how long it stays, when it begins again, and how probable it is.

use std::time::Duration;

use system_model::injection::{Interval, Repetition};
use system_model::specification::Place;

use crate::node::Node;
use crate::readers::rules::measure::{count, duration, positive_duration};
use crate::suggest::quoted;
use crate::value::Value;

/// When an injection begins first; whose cycles are counted is said by its component.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum DeclaredTrigger {
    At(Duration),
    AtCycle(u64),
}

/// All that an injection says of time.
#[derive(Debug)]
pub(crate) struct Timing {
    pub(crate) trigger: DeclaredTrigger,
    pub(crate) lasting: Option<Duration>,
    pub(crate) repetition: Option<Repetition>,
    pub(crate) probability: Option<f64>,
    pub(crate) places: TimingPlaces,
}

/// Where the attributes stand that may not suit the fault.
#[derive(Debug, Default)]
pub(crate) struct TimingPlaces {
    pub(crate) at_cycle: Option<Place>,
    pub(crate) every: Option<Place>,
    pub(crate) probability: Option<Place>,
}

/// Reads the times of an injection; what cannot be understood is reported, and then there are none.
pub(super) fn read(node: &Node<'_>) -> Option<Timing> {
    let (at, at_cycle) = (node.attribute("at"), node.attribute("at_cycle"));
    let every = node.attribute("every");
    let every_cycles = node.attribute("every_cycles");
    let probability = node.attribute("probability");
    let places = TimingPlaces {
        at_cycle: at_cycle.as_ref().map(Value::place),
        every: every.as_ref().or(every_cycles.as_ref()).map(Value::place),
        probability: probability.as_ref().map(Value::place),
    };
    let counts_cycles = at_cycle.is_some();
    let trigger = trigger(at.as_ref(), at_cycle.as_ref());
    let lasting = optional(node.attribute("for"), positive_duration);
    let repetition = repetition(node, every, every_cycles, counts_cycles);
    let probability = optional(probability, chance);
    Some(Timing {
        trigger: trigger?,
        lasting: lasting?,
        repetition: repetition?,
        probability: probability?,
        places,
    })
}

/// What an attribute says, where it is written; the outer `None` for one that cannot be understood.
fn optional<T>(
    value: Option<Value<'_>>,
    read: impl Fn(&Value<'_>) -> Option<T>,
) -> Option<Option<T>> {
    match value {
        Some(value) => read(&value).map(Some),
        None => Some(None),
    }
}

/// Without either attribute an injection begins at once.
fn trigger(at: Option<&Value<'_>>, at_cycle: Option<&Value<'_>>) -> Option<DeclaredTrigger> {
    let time = at.map(duration);
    let cycle = at_cycle.map(cycle);
    if let (Some(_), Some(both)) = (at, at_cycle) {
        both.error(
            "both at and at_cycle say when it begins",
            Some("write only one of them".into()),
        );
        return None;
    }
    match (time, cycle) {
        (Some(time), _) => time.map(DeclaredTrigger::At),
        (None, Some(cycle)) => cycle.map(DeclaredTrigger::AtCycle),
        (None, None) => Some(DeclaredTrigger::At(Duration::ZERO)),
    }
}

/// A number of cycles, counted from 1.
fn cycle(value: &Value<'_>) -> Option<u64> {
    let number: u64 = value.number()?;
    if number == 0 {
        value.error(
            format!("`0` in {} is no cycle", value.owner()),
            Some("cycles are counted from 1".into()),
        );
        return None;
    }
    Some(number)
}

fn repetition(
    node: &Node<'_>,
    every: Option<Value<'_>>,
    every_cycles: Option<Value<'_>>,
    counts_cycles: bool,
) -> Option<Option<Repetition>> {
    let times = optional(node.attribute("repeat"), |value| count(value, 1));
    let time = optional(every.clone(), positive_duration);
    let cycles = optional(every_cycles.clone(), cycle);
    let (wrong, help) = match counts_cycles {
        true => (every, "with at_cycle write every_cycles=\"50\""),
        false => (every_cycles, "with at write every=\"2s\""),
    };
    if let Some(wrong) = wrong {
        let message = format!("{} does not fit when it begins", wrong.owner());
        wrong.error(message, Some(help.into()));
        return None;
    }
    let (times, time, cycles) = (times?, time?, cycles?);
    let every = match (time, cycles) {
        (Some(time), _) => Interval::Time(time),
        (None, Some(cycles)) => Interval::Cycles(cycles),
        (None, None) if times.is_none_or(|times| times == 1) => return Some(None),
        (None, None) => {
            node.error(
                "repeat does not say how far apart",
                Some(
                    "write repeat=\"3\" every=\"2s\", or every_cycles=\"50\" with at_cycle".into(),
                ),
            );
            return None;
        }
    };
    Some(Some(Repetition { times, every }))
}

fn chance(value: &Value<'_>) -> Option<f64> {
    let number: f64 = value.number()?;
    if (0.0..=1.0).contains(&number) {
        return Some(number);
    }
    value.error(
        format!(
            "`{}` in {} is no probability",
            quoted(value.as_str()),
            value.owner()
        ),
        Some("write a number from 0 to 1".into()),
    );
    None
}
