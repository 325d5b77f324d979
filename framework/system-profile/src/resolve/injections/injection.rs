//! One injection: its component, its port, and whether it could ever happen.

use system_model::injection::{CallbackName, InjectedFault, Injection, Trigger, WorldFault};
use system_model::profile::Located;
use system_model::specification::{
    ApplicationSpecification, ComponentSpecification, ExecutionKind, Place, PortDirection, PortKind,
};
use system_model::world::SONAR_COUNT;

use crate::document::Document;
use crate::problem::Severity;
use crate::readers::injection::{DeclaredFault, DeclaredInjection, DeclaredTrigger};
use crate::resolve::ports::description;
use crate::suggest::{self, quoted};

/// An injection with its names resolved; none if anything about it is an error.
pub(super) fn resolve(
    document: &Document,
    application: &ApplicationSpecification,
    declared: &DeclaredInjection,
) -> Option<Injection> {
    let context = Context {
        document,
        application,
        declared,
    };
    let component = match &declared.component {
        Some(name) => Some(context.component(name)?),
        None => None,
    };
    let what = context.fault(component);
    let trigger = context.trigger(component);
    let (what, trigger) = (what?, trigger?);
    if !context.timing_fits(&what) {
        return None;
    }
    Some(Injection {
        trigger,
        lasting: declared.timing.lasting,
        repetition: declared.timing.repetition,
        probability: declared.timing.probability,
        what,
        place: declared.place.clone(),
    })
}

struct Context<'a> {
    document: &'a Document,
    application: &'a ApplicationSpecification,
    declared: &'a DeclaredInjection,
}

impl Context<'_> {
    fn component(&self, name: &Located<String>) -> Option<usize> {
        let components = &self.application.components;
        let found = components
            .iter()
            .position(|component| component.name == name.value);
        if found.is_none() {
            let names = components.iter().map(|component| component.name.as_str());
            self.error(
                name,
                format!("there is no component `{}`", quoted(&name.value)),
                suggest::help(&name.value, "there are", names)
                    .unwrap_or_else(|| "the application has no component at all".into()),
            );
        }
        found
    }

    fn specification(&self, component: usize) -> &ComponentSpecification {
        &self.application.components[component]
    }

    fn trigger(&self, component: Option<usize>) -> Option<Trigger> {
        let cycle = match self.declared.timing.trigger {
            DeclaredTrigger::At(time) => return Some(Trigger::At(time)),
            DeclaredTrigger::AtCycle(cycle) => cycle,
        };
        let Some(component) = component else {
            self.error_at_word(
                self.declared.timing.places.at_cycle.as_ref(),
                "at_cycle does not say whose cycles it counts",
                "name the component, or write at=\"5s\"",
            );
            return None;
        };
        if self.specification(component).execution.kind == ExecutionKind::Passive {
            self.error_at_word(
                self.declared.timing.places.at_cycle.as_ref(),
                "a passive component has no cycles",
                "write at=\"5s\"",
            );
            return None;
        }
        Some(Trigger::AtCycle { component, cycle })
    }

    fn fault(&self, component: Option<usize>) -> Option<InjectedFault> {
        match &self.declared.what {
            DeclaredFault::Callback {
                callback,
                misbehaviour,
            } => {
                let component = self.required(component)?;
                self.is_ever_called(component, callback)
                    .then_some(InjectedFault::Callback {
                        component,
                        callback: callback.value,
                        misbehaviour: *misbehaviour,
                    })
            }
            DeclaredFault::Port {
                port,
                field,
                distortion,
            } => {
                let component = self.required(component)?;
                self.is_data_port(component, port)
                    .then(|| InjectedFault::Port {
                        component,
                        port: port.value.clone(),
                        field: field.clone(),
                        distortion: *distortion,
                    })
            }
            DeclaredFault::Container(failure) => Some(InjectedFault::Container {
                component: self.required(component)?,
                failure: *failure,
            }),
            DeclaredFault::World(fault) => self.world(component, *fault),
            DeclaredFault::UnplugSonarOfComponent => {
                let index = self.socket(component?)?;
                self.world(component, WorldFault::UnplugSonar(index))
            }
        }
    }

    fn required(&self, component: Option<usize>) -> Option<usize> {
        if component.is_none() {
            self.error(
                &self.declared.kind,
                format!(
                    "`{}` of which component?",
                    quoted(&self.declared.kind.value)
                ),
                "write component=\"NAME\"",
            );
        }
        component
    }

    /// Whether a callback of a component is ever called; an error if not.
    fn is_ever_called(&self, component: usize, callback: &Located<CallbackName>) -> bool {
        let component = self.specification(component);
        let passive = component.execution.kind == ExecutionKind::Passive;
        let takes_events = component
            .ports
            .iter()
            .any(|port| (port.kind, port.direction) == (PortKind::Event, PortDirection::Input));
        let why_not = match callback.value {
            CallbackName::Execute | CallbackName::Updated if passive => "it is passive",
            CallbackName::Event if !takes_events => "it has no input event port",
            _ => return true,
        };
        self.error_at_word(
            Some(&callback.place),
            &format!(
                "this callback of `{}` is never called: {why_not}",
                quoted(&component.name)
            ),
            "write callback=\"onStart\", or another one that is called",
        );
        false
    }

    fn is_data_port(&self, component: usize, name: &Located<String>) -> bool {
        let component = self.specification(component);
        let Some(port) = component.ports.iter().find(|port| port.name == name.value) else {
            let names = component.ports.iter().map(|port| port.name.as_str());
            self.error(
                name,
                format!(
                    "`{}` has no port `{}`",
                    quoted(&component.name),
                    quoted(&name.value)
                ),
                suggest::help(&name.value, "it has", names)
                    .unwrap_or_else(|| "it has no ports at all".into()),
            );
            return false;
        };
        if port.kind != PortKind::Data {
            self.error(
                name,
                format!(
                    "`{}` of the port {}, which is {}",
                    quoted(&self.declared.kind.value),
                    quoted(&name.value),
                    description(port.kind, port.direction)
                ),
                "name a data port",
            );
            return false;
        }
        true
    }

    fn world(&self, component: Option<usize>, fault: WorldFault) -> Option<InjectedFault> {
        if self.application.world.is_none() {
            self.error(
                &self.declared.kind,
                format!(
                    "the application `{}` drives in no simulated world",
                    quoted(&self.application.name)
                ),
                "give the application a <world>, or inject a fault of a component or a port",
            );
            return None;
        }
        Some(InjectedFault::World { component, fault })
    }

    /// The socket that a sonar's component reads: its property `index`.
    fn socket(&self, component: usize) -> Option<usize> {
        let component = self.specification(component);
        let properties = component.properties.iter().rev();
        let index = properties
            .filter(|(name, _)| name == "index")
            .map(|(_, value)| value.trim().parse::<usize>().ok())
            .next()
            .flatten()
            .filter(|index| *index < SONAR_COUNT);
        if let (None, Some(name)) = (index, &self.declared.component) {
            self.error(
                name,
                format!(
                    "`{}` has no property index that names a sonar's socket",
                    quoted(&component.name)
                ),
                format!(
                    "write index=\"0\"; sockets go from 0 to {}",
                    SONAR_COUNT - 1
                ),
            );
        }
        index
    }

    /// Whether what is said of time makes sense for the fault.
    fn timing_fits(&self, what: &InjectedFault) -> bool {
        let timing = &self.declared.timing;
        let of_opportunities = matches!(
            what,
            InjectedFault::Callback { .. } | InjectedFault::Port { .. }
        );
        if timing.probability.is_some() && !of_opportunities {
            self.error_at_word(
                timing.places.probability.as_ref(),
                "a probability is one of each call or each datum, and this fault has neither",
                "remove probability",
            );
            return false;
        }
        let stays = what.lasts() || timing.probability.is_some();
        if stays && timing.lasting.is_none() && timing.repetition.is_some() {
            self.error_at_word(
                timing.places.every.as_ref(),
                "it stays for ever and cannot begin again",
                "say how long it stays: for=\"500ms\"",
            );
            return false;
        }
        true
    }

    fn error(&self, at: &Located<String>, message: String, help: impl Into<String>) {
        self.document
            .report(Severity::Error, at, message, Some(help.into()));
    }

    fn error_at_word(&self, at: Option<&Place>, message: &str, help: &str) {
        let place = at.unwrap_or(&self.declared.place);
        self.document
            .report_at(Severity::Error, place, message, Some(help.into()));
    }
}
