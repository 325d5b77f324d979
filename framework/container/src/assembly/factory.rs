//! Where instances of a component come from: the first one, those that follow it when it failed,
//! and those of its secondaries. Each is made from a fresh copy of its library.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use system_model::injection::ContainerFailure;
use system_model::rules::{ComponentRules, IsolationTier, Preload};
use system_model::specification::{ComponentSpecification, ExecutionKind, PortDirection, PortKind};

use crate::component::Instance;
use crate::component::{
    CallLimits, Calls, Component, DataInput, DataOutput, Environment, EventOutput, PortEnd,
    Services,
};
use crate::guard::Guarded;
use crate::host::{Hosted, HostedComponent, Hosts};
use crate::library::{ComponentDescription, LoadedLibrary, PortDescription};
use crate::replay::Player;
use crate::status::ComponentStatus;

/// Makes the instances of one component.
pub struct Factory {
    environment: Arc<Environment>,
    /// The component's number in the application.
    number: u32,
    /// The component itself, then its secondaries in order.
    variants: Vec<Variant>,
    rules: ComponentRules,
    hosts: Arc<Hosts>,
}

/// One of the libraries that can play the component's part.
pub struct Variant {
    /// What the profile says.
    pub specification: ComponentSpecification,
    /// The library's file.
    pub path: PathBuf,
    /// What the library says of itself.
    pub description: ComponentDescription,
    /// What is prepared before it is needed.
    pub preload: Preload,
}

impl Factory {
    /// A factory for the component of this number.
    pub fn new(
        number: usize,
        variants: Vec<Variant>,
        rules: ComponentRules,
        environment: Arc<Environment>,
        hosts: Arc<Hosts>,
    ) -> Self {
        Self {
            hosts,
            rules,
            environment,
            number: u32::try_from(number).unwrap_or(u32::MAX),
            variants,
        }
    }

    /// The component itself (0) and its secondaries (from 1).
    pub fn variants(&self) -> &[Variant] {
        &self.variants
    }

    /// Makes an instance from a fresh copy of the library, with nothing connected and nothing run.
    ///
    /// # Errors
    /// If the library cannot be loaded, or the machine has no room; in words.
    pub fn make(&self, variant: usize, status: Arc<ComponentStatus>) -> Result<Component, String> {
        let Some(chosen) = self.variants.get(variant) else {
            return Err("there is no such secondary".to_owned());
        };
        let injections = &self.environment.injections;
        if injections.fails(self.number as usize, ContainerFailure::LibraryMissing) {
            return Err(format!(
                "library {} is missing (injected)",
                chosen.path.display()
            ));
        }
        if self.isolation() == IsolationTier::Process || self.player(variant).is_some() {
            return self.instantiate(variant, None, status);
        }
        let library = LoadedLibrary::load(&chosen.path).map_err(|error| error.to_string())?;
        self.instantiate(variant, Some(&library), status)
    }

    /// Where its instances run.
    pub fn isolation(&self) -> IsolationTier {
        let rule = self.rules.isolation.as_ref();
        rule.map_or_else(IsolationTier::default, |rule| rule.value.tier)
    }

    /// Makes an instance: behind the guard from a copy that was loaded for it, if there is one, else
    /// in a host.
    ///
    /// # Errors
    /// If the machine has no room for its stack, or a host does not start; in words.
    pub fn instantiate(
        &self,
        variant: usize,
        library: Option<&LoadedLibrary>,
        status: Arc<ComponentStatus>,
    ) -> Result<Component, String> {
        let specification = &self.variants[variant].specification;
        let description = &self.variants[variant].description;
        let instance = match (self.player(variant), library) {
            (Some(player), _) => Instance::from(player),
            (None, Some(library)) => {
                let callbacks = library.description.callbacks;
                Guarded::new(callbacks, library.code, self.number)
                    .map(Instance::from)
                    .map_err(|error| format!("no stack for it: {error}"))?
            }
            (None, None) => Instance::from(self.host(variant, status.is_standby())?),
        };
        let mut services = Services::new(
            Arc::from(specification.name.as_str()),
            status.incarnation(),
            Arc::clone(&self.environment),
            description.ports.clone().into(),
            description.ports.iter().map(unconnected).collect(),
            specification.properties.clone(),
        );
        let world = self.environment.worlds.of_component(self.number as usize);
        services.set_world(world.cloned());
        let period = match specification.execution.kind {
            ExecutionKind::Periodic | ExecutionKind::PeriodicShared => {
                specification.execution.period
            }
            ExecutionKind::Passive | ExecutionKind::Aperiodic => Duration::ZERO,
        };
        let mut component = Component::new(instance, services, status, period);
        let limits = CallLimits::by_rules(&self.rules, &specification.execution);
        component.set_limits(limits);
        if self.rules.memory.is_some() {
            component.count_allocations();
        }
        Ok(component)
    }

    /// What plays the component, if a recording is played.
    fn player(&self, variant: usize) -> Option<Player> {
        let score = self.environment.score.as_ref()?;
        let played = score.plays(&self.variants[0].specification.name);
        let ports = &self.variants[variant].description.ports;
        played.then(|| Player::new(self.number as usize, Arc::clone(score), ports))
    }

    /// An instance in a host.
    fn host(&self, variant: usize, stands_by: bool) -> Result<Hosted, String> {
        let chosen = &self.variants[variant];
        let rule = self.rules.isolation.as_ref().map(|rule| &rule.value);
        let component = HostedComponent {
            name: &chosen.specification.name,
            number: self.number,
            library: chosen.path.clone(),
            ports: &chosen.description.ports,
            group: rule.and_then(|rule| rule.group.as_deref()),
            stands_by,
            counts_allocations: self.rules.memory.is_some(),
            limits: rule.map(|rule| rule.limits).unwrap_or_default(),
        };
        Hosted::new(&self.hosts, component, &self.environment.clock)
    }
}

fn unconnected(port: &PortDescription) -> PortEnd {
    let size = port
        .data_type
        .as_ref()
        .map_or(0, |data_type| data_type.size);
    match (port.kind, port.direction) {
        (PortKind::Data, PortDirection::Input) => PortEnd::DataInput(DataInput {
            size,
            source: None,
            newest_from_afar: None,
            tap: None,
        }),
        (PortKind::Data, PortDirection::Output) => PortEnd::DataOutput(DataOutput {
            size,
            connections: Vec::new(),
            tap: None,
        }),
        (PortKind::Event, PortDirection::Input) => PortEnd::EventInput,
        (PortKind::Event, PortDirection::Output) => PortEnd::EventOutput(EventOutput {
            size,
            connections: Vec::new(),
            fault: None,
            recorder: None,
        }),
        (PortKind::Service, PortDirection::Output) => PortEnd::Required(Calls {
            methods: Vec::new(),
            provider: None,
        }),
        (PortKind::Service, PortDirection::Input) => PortEnd::Provided,
    }
}
