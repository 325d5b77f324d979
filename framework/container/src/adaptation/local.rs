//! What there is of the task in this system: the components of its robots, what is heard of them, and
//! the change that is under way.

use std::sync::Arc;
use std::time::Duration;

use system_model::specification::{ExecutionKind, QueuePolicy};
use system_model::task::{Placement, QualityAttribute};

use super::binding::Binding;
use super::change::Change;
use super::losses::Losses;
use super::outlet::Outlet;
use super::overruns::Overruns;
use super::passage::Passage;
use super::wiring::{Hop, PortKey, hops};
use crate::assembly::{Assembly, Factory};
use crate::clock::nanoseconds;
use crate::component::{ComponentCell, Entered, Environment, PortEnd};
use crate::lane::{Lane, SETUP_TOKEN};
use crate::port::connection;
use crate::status::{ComponentStatus, Meter};
use crate::wake::Wake;

/// Data of one output that may wait until they are looked at: a second at 64 Hz, and what runs is
/// evaluated more often than that.
const OUTLET_QUEUE: usize = 64;

/// How long somebody who changes connections waits for a component that is in a callback: as long as
/// a service call may take by default.
const ENTER_LIMIT: Duration = Duration::from_secs(1);

/// The robots of the task whose applications this system runs; mostly one.
pub struct LocalRobot {
    pub(super) binding: Binding,
    pub(super) components: Vec<Arc<ComponentCell>>,
    pub(super) statuses: Vec<Arc<ComponentStatus>>,
    pub(super) factories: Vec<Arc<Factory>>,
    /// By component of the system: how it is executed, and who is woken by data.
    pub(super) executions: Vec<(ExecutionKind, Option<Arc<Wake>>)>,
    pub(super) environment: Arc<Environment>,
    pub(super) meter: Arc<Meter>,
    pub(super) overruns: Overruns,
    pub(super) outlets: Vec<Outlet>,
    /// Some evaluator has something new to look at.
    pub(super) has_heard: bool,
    pub(super) change: Option<Change>,
    pub(super) losses: Losses,
    /// The way to robots elsewhere, if there is one.
    pub(super) passage: Option<Box<dyn Passage>>,
}

impl LocalRobot {
    /// Listens to all outputs that the task asks for, and leaves asleep what does not run. Nothing of
    /// any component has run yet.
    pub fn new(
        binding: Binding,
        assembly: &Assembly,
        environment: Arc<Environment>,
        meter: Arc<Meter>,
        passage: Option<Box<dyn Passage>>,
    ) -> Self {
        let execution = |component: usize| {
            let runs = |number: u32| usize::try_from(number) == Ok(component);
            let mut executors = assembly.executors.iter();
            let executor = executors.find(|it| it.members.iter().any(|member| runs(member.number)));
            let kind = executor.map_or(ExecutionKind::Passive, |it| it.kind);
            let woken = executor.filter(|it| it.kind == ExecutionKind::Aperiodic);
            (kind, woken.map(|it| Arc::clone(&it.wake)))
        };
        let mut robot = Self {
            components: assembly.components.clone(),
            statuses: assembly.statuses.clone(),
            factories: assembly.factories.clone(),
            executions: (0..assembly.components.len()).map(execution).collect(),
            environment,
            meter,
            overruns: Overruns::default(),
            outlets: Vec::new(),
            has_heard: false,
            change: None,
            losses: Losses::default(),
            passage,
            binding,
        };
        for key in robot.binding.outlets() {
            robot.listen_to(key);
        }
        robot.keep_windows();
        let running = robot.binding.task.running.clone().unwrap_or_default();
        for part in &robot.binding.parts {
            robot.components[part.component].share();
            robot.statuses[part.component].set_dormant(!running.contains(&part.placement));
        }
        robot
    }

    fn listen_to(&mut self, key: PortKey) {
        let heard = self.with_port(&key, SETUP_TOKEN, |end| {
            let PortEnd::DataOutput(output) = end else {
                return None;
            };
            let (sender, receiver) = connection(QueuePolicy::Fifo, OUTLET_QUEUE, output.size);
            output.connections.push((sender, None));
            Some(receiver)
        });
        if let Some(receiver) = heard.flatten() {
            self.outlets.push(Outlet::new(key, receiver));
        }
    }

    /// Evaluators of a deviation need more than the newest datum.
    fn keep_windows(&mut self) {
        let Self {
            binding, outlets, ..
        } = self;
        let parts = binding.parts.iter_mut();
        for evaluator in parts.flat_map(|part| &mut part.evaluators) {
            let outlet = outlets.iter_mut().find(|it| it.key == evaluator.key);
            if let QualityAttribute::StandardDeviation { window } = evaluator.rule.attribute
                && let (Some(outlet), Some(reader)) = (outlet, &evaluator.reader)
            {
                evaluator.window = Some(outlet.keep(reader.clone(), window));
            }
        }
    }

    /// Takes what has come on all outputs.
    pub(super) fn hear(&mut self) {
        for outlet in &mut self.outlets {
            let came = outlet.listen();
            let key = &outlet.key;
            let mut parts = self.binding.parts.iter();
            self.has_heard |=
                came && parts.any(|part| part.evaluators.iter().any(|it| it.key == *key));
        }
        self.overruns.look(self.now(), &self.statuses);
    }

    pub(super) fn now(&self) -> Duration {
        self.environment.clock.now()
    }

    pub(super) fn now_ns(&self) -> u64 {
        nanoseconds(self.now())
    }

    /// What is heard of an output.
    pub(super) fn outlet(&self, key: &PortKey) -> Option<&Outlet> {
        self.outlets.iter().find(|outlet| outlet.key == *key)
    }

    /// The connections that the task needs where these components are in use.
    pub(super) fn hops(&self, placements: &[Placement]) -> Vec<Hop> {
        hops(&self.binding.task.links, placements)
    }

    /// Components of the system that placements are, in the order of the task.
    pub(super) fn members(&self, placements: &[Placement]) -> Vec<usize> {
        let parts = placements.iter().filter_map(|it| self.binding.part(*it));
        parts.map(|part| part.component).collect()
    }

    /// Enters a component between two of its callbacks.
    pub(super) fn enter(&self, component: usize, lane: &Lane) -> Result<Entered<'_>, String> {
        let entered = self.components[component].enter(lane.token(), ENTER_LIMIT);
        entered.ok_or_else(|| {
            format!(
                "'{}' was in a callback for more than {ENTER_LIMIT:?}",
                self.statuses[component].name
            )
        })
    }

    /// Does something with a port between two callbacks of its component; none if the component is in
    /// one for too long, or has no such port.
    pub(super) fn with_port<T>(
        &self,
        key: &PortKey,
        token: u32,
        change: impl FnOnce(&mut PortEnd) -> T,
    ) -> Option<T> {
        let mut component = self.components[key.component].enter(token, ENTER_LIMIT)?;
        let services = component.services_mut();
        let mut ports = services.interface().iter();
        let index = ports.position(|port| port.name == key.port)?;
        services.port_mut(index).map(change)
    }
}
