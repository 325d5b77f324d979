//! How a running system is, for an operator.

use std::ops::Range;
use std::time::Duration;

use fault_manager::Condition;
use system_model::rules::Preload;
use system_model::specification::{PortDirection, PortKind, PortReference};

use super::RunningSystem;
use super::view::{
    ComponentInfo, ComponentView, ContainerView, FaultView, LinkView, PortView, StandbyView,
    SystemView, TreeView, condition_name, level,
};
use crate::assembly::Link;
use crate::library::PortDescription;
use crate::mission::TreeStatus;
use crate::summary::{ComponentSummary, application_state};
use crate::supervision::Overview;

impl RunningSystem {
    /// The whole system.
    pub fn view(&self) -> SystemView {
        let clock = &self.supervisor.environment().clock;
        let overview = self.supervisor.overview();
        self.meter.look(clock.now());
        let state = |members: &Range<usize>| application_state(&self.statuses[members.clone()]);
        let component = |index: usize| {
            let name = self.statuses[index].name.clone();
            (name, self.component_view(index, &overview))
        };
        SystemView {
            applications: self
                .applications
                .iter()
                .map(|(name, members)| (name.clone(), state(members)))
                .collect(),
            clock: match clock.is_simulated() {
                true => "simulated",
                false => "real",
            },
            time_s: clock.now().as_secs_f64(),
            emergency_stop: overview.emergency_stop,
            verdicts_recorded: overview.recorded,
            container: self.container(),
            components: (0..self.statuses.len()).map(component).collect(),
            trees: (self.trees.iter())
                .map(|tree| (tree.name.clone(), tree_view(tree)))
                .collect(),
        }
    }

    /// The process.
    pub fn container(&self) -> ContainerView {
        let environment = self.supervisor.environment();
        let threads = std::fs::read_dir("/proc/self/task");
        ContainerView {
            process: std::process::id(),
            uptime_s: self.began.elapsed().as_secs_f64(),
            threads: threads.map_or(0, Iterator::count),
            restarts: self.restarts,
            port_data_dropped: self.links.iter().map(|link| link.drops.count()).sum(),
            events_lost: environment.events.lost(),
            symptoms_dropped: environment.observations.dropped(),
        }
    }

    /// One component.
    pub fn component_view(&self, index: usize, overview: &Overview) -> ComponentView {
        let status = &self.statuses[index];
        let (condition, open_faults) = overview
            .components
            .get(index)
            .copied()
            .unwrap_or((Condition::Working, 0));
        let figures = self.meter.figures(index);
        let executor = self.meter.executor(index);
        let period = executor.map(|it| it.period.as_secs_f64() * 1e3);
        ComponentView {
            application: self.application_of(index).to_owned(),
            level: level(status.state(), condition, open_faults),
            summary: ComponentSummary::of(status),
            condition: condition_name(condition),
            open_faults,
            runs: self.variant(index, status.variant()),
            executor: executor.map(|it| it.name.clone()).unwrap_or_default(),
            execution: executor.map_or("", |it| it.kind_name()),
            period_ms: period.filter(|period| *period > 0.0),
            rate_hz: figures.rate_hz,
            load_percent: figures.load_percent,
            standbys: self.standbys(index),
        }
    }

    /// Everything that is known of one component.
    pub fn info(&self, index: usize) -> ComponentInfo {
        let specification = &self.specification.components[index];
        let status = &self.statuses[index];
        let executor = self.meter.executor(index);
        let verdicts = self.supervisor.verdicts().into_iter();
        let own = verdicts.filter(|verdict| verdict.component == status.name);
        let variants = self.supervisor.standbys(index);
        let variants = variants.map(|it| it.factory().variants());
        let variants = variants.unwrap_or_default();
        let library = variants.get(status.variant());
        let ports = self.interfaces.get(index).into_iter().flatten();
        ComponentInfo {
            name: status.name.clone(),
            view: self.component_view(index, &self.supervisor.overview()),
            profile: specification.profile.display().to_string(),
            library: library.map_or_else(String::new, |it| it.path.display().to_string()),
            node: specification.node.clone(),
            priority: executor.map_or(0, |it| it.priority),
            policy: executor.map_or("", |it| it.policy_name()),
            allocated_bytes: status.allocated_bytes(),
            properties: specification.properties.clone(),
            secondaries: (1..variants.len())
                .map(|it| self.variant(index, it))
                .collect(),
            ports: ports.map(|port| self.port_view(index, port)).collect(),
            faults: own
                .map(|verdict| FaultView {
                    id: verdict.id.0,
                    kind: verdict.kind,
                    state: verdict.state,
                })
                .collect(),
        }
    }

    /// The connections of data ports.
    pub fn links(&self) -> Vec<LinkView> {
        let end = |end: &PortReference| {
            let component = &self.specification.components[end.component].name;
            format!("{component}.{}", end.port)
        };
        let view = |link: &Link| LinkView {
            source: end(&link.source),
            target: end(&link.target),
            dropped: link.drops.count(),
        };
        self.links.iter().map(view).collect()
    }

    /// The application of a component.
    fn application_of(&self, index: usize) -> &str {
        let applications = self.applications.iter();
        let mut own = applications.filter(|(_, members)| members.contains(&index));
        own.next().map_or("", |(name, _)| name)
    }

    /// The component type of one of a component's libraries.
    pub(super) fn variant(&self, index: usize, variant: usize) -> String {
        let standbys = self.supervisor.standbys(index);
        let chosen = standbys.and_then(|it| it.factory().variants().get(variant));
        chosen.map_or_else(String::new, |it| it.specification.type_name.clone())
    }

    fn standbys(&self, index: usize) -> Vec<StandbyView> {
        let Some(standbys) = self.supervisor.standbys(index) else {
            return Vec::new();
        };
        let variants = standbys.factory().variants();
        let view = |(variant, ready): (usize, bool)| StandbyView {
            of: self.variant(index, variant),
            preload: match variants[variant].preload {
                Preload::Cold => "cold",
                Preload::Loaded => "loaded",
                Preload::Warm => "warm",
            },
            ready,
        };
        standbys.readiness().map(view).collect()
    }

    fn port_view(&self, index: usize, port: &PortDescription) -> PortView {
        let connections = self.specification.connections.iter();
        let others = connections.filter_map(|connection| {
            let (source, target) = (&connection.source, &connection.target);
            let is_own = |end: &PortReference| end.component == index && end.port == port.name;
            match (is_own(source), is_own(target)) {
                (true, _) => Some(target),
                (_, true) => Some(source),
                _ => None,
            }
        });
        let others = others.map(|other| {
            let component = &self.specification.components[other.component].name;
            format!("{component}.{}", other.port)
        });
        let arrives =
            |link: &&Link| link.target.component == index && link.target.port == port.name;
        PortView {
            name: port.name.clone(),
            kind: port.kind.name(),
            usage: match (port.kind, port.direction) {
                (PortKind::Service, PortDirection::Input) => "provided",
                (PortKind::Service, PortDirection::Output) => "required",
                (_, PortDirection::Input) => "input",
                (_, PortDirection::Output) => "output",
            },
            data_type: (port.data_type.as_ref()).map_or_else(String::new, |it| it.name.clone()),
            connected: others.collect(),
            dropped: (self.links.iter().filter(arrives))
                .map(|link| link.drops.count())
                .sum(),
        }
    }
}

fn tree_view(tree: &TreeStatus) -> TreeView {
    let running = tree.running().into_iter();
    let leaves = running.filter(|node| tree.plan.children(*node).is_empty());
    TreeView {
        state: tree.phase().name(),
        doing: leaves
            .map(|node| tree.plan.describe(node).path.clone())
            .collect(),
        ticks: tree.ticks(),
        longest_tick_ms: Duration::from_nanos(tree.longest_ns()).as_secs_f64() * 1e3,
    }
}
