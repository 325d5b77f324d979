//! Figures as text, by the conventions of Prometheus: base units, counters that end in `_total`.

use std::sync::atomic::AtomicU64;

use prometheus_client::encoding::text::encode;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::registry::{Metric, Registry, Unit};
use system_model::life_cycle::LifeCycleState;

use super::tally::{Labels, Tally};
use crate::control::view::{ComponentView, LinkView, SystemView};

type Counters = Family<Labels, Counter>;
type Gauges = Family<Labels, Gauge<f64, AtomicU64>>;

const STATES: [LifeCycleState; 6] = [
    LifeCycleState::Created,
    LifeCycleState::Ready,
    LifeCycleState::Active,
    LifeCycleState::Inactive,
    LifeCycleState::Error,
    LifeCycleState::Destroyed,
];

/// All figures of a system, and what has been counted.
pub(super) fn of(view: &SystemView, links: &[LinkView], tally: &Tally) -> String {
    let mut registry = Registry::with_prefix("steadfast");
    components(&mut registry, view);
    registry.register(
        "component_faults",
        "Faults that were confirmed",
        tally.faults.clone(),
    );
    registry.register_with_unit(
        "component_recovery_duration",
        "Time from the first symptom of a root cause until it was handled",
        Unit::Seconds,
        tally.recoveries.clone(),
    );
    let drops = Counters::default();
    for link in links {
        let labels = vec![
            ("source", link.source.clone()),
            ("target", link.target.clone()),
        ];
        drops.get_or_create(&labels).inc_by(link.dropped);
    }
    registry.register(
        "port_data_dropped",
        "Data that were overwritten before they were read",
        drops,
    );
    container(&mut registry, view);
    let mut text = String::new();
    // Writing to a text does not fail.
    let _infallible = encode(&mut text, &registry);
    text
}

fn components(registry: &mut Registry, view: &SystemView) {
    let all = || view.components.iter();
    let counters = |of: fn(&ComponentView) -> u64| {
        let family = Counters::default();
        for (name, one) in all() {
            let labels = vec![("component", name.clone())];
            family.get_or_create(&labels).inc_by(of(one));
        }
        family
    };
    let gauges = |of: fn(&ComponentView) -> Option<f64>| {
        let family = Gauges::default();
        for (name, one) in all() {
            if let Some(figure) = of(one) {
                let labels = vec![("component", name.clone())];
                family.get_or_create(&labels).set(figure);
            }
        }
        family
    };
    let states = Gauges::default();
    for (name, one) in all() {
        for state in STATES.map(LifeCycleState::name) {
            let labels = vec![("component", name.clone()), ("state", state.to_owned())];
            let is_in = f64::from(u8::from(one.summary.state == state));
            states.get_or_create(&labels).set(is_in);
        }
    }
    let help = "Whether the component is in this life-cycle state";
    registry.register("component_state", help, states);
    let cycles = counters(|one| one.summary.cycles);
    registry.register("component_cycles", "Completed cycles", cycles);
    let overruns = counters(|one| one.summary.overruns);
    let help = "Cycles of its executor that took longer than the period";
    registry.register("component_overruns", help, overruns);
    let incarnations = gauges(|one| Some(f64::from(one.summary.incarnation)));
    let help = "Which instance of the component runs, counted from 1";
    registry.register("component_incarnation", help, incarnations);
    let open = gauges(|one| u32::try_from(one.open_faults).ok().map(f64::from));
    let help = "Faults that are confirmed and not healed";
    registry.register("component_open_faults", help, open);
    let loads = gauges(|one| one.load_percent.map(|percent| percent / 1e2));
    let help = "How much of its period its executor's cycle takes, over the last second";
    registry.register("component_load_ratio", help, loads);
}

fn container(registry: &mut Registry, view: &SystemView) {
    let container = &view.container;
    let counter = |count: u64| {
        let counter: Counter = Counter::default();
        counter.inc_by(count);
        counter
    };
    fn gauge(figure: f64) -> impl Metric {
        let gauge = Gauge::<f64, AtomicU64>::default();
        gauge.set(figure);
        gauge
    }
    registry.register(
        "events_lost",
        "Events that the event file's writer did not keep up with",
        counter(container.events_lost),
    );
    registry.register(
        "symptoms_dropped",
        "Symptoms that were not judged because too many came at once",
        counter(container.symptoms_dropped),
    );
    registry.register(
        "container_restarts",
        "How often the container was restarted by its parent",
        counter(container.restarts.into()),
    );
    let threads = u32::try_from(container.threads).unwrap_or(u32::MAX);
    registry.register(
        "container_threads",
        "Threads of the container",
        gauge(threads.into()),
    );
    registry.register_with_unit(
        "container_uptime",
        "Since the container was started",
        Unit::Seconds,
        gauge(container.uptime_s),
    );
    registry.register(
        "emergency_stop",
        "Whether an emergency stop is latched",
        gauge(f64::from(u8::from(view.emergency_stop))),
    );
}

#[cfg(test)]
mod tests;
