//! What is supposed to go wrong: the faults that can be injected, each of a size that it is seen if
//! anything looks.

use std::time::Duration;

use system_model::fault::FaultKind;
use system_model::injection::{
    ContainerFailure, DEFAULT_EXIT_CODE, Distortion, InjectedFault, Misbehaviour,
};
use system_model::specification::{
    ComponentSpecification, ExecutionKind, ExecutionSemantics, PortKind,
};

use crate::system::Scope;

/// How late supposed late data are: so late that nobody goes on with what came before.
pub const DELAY: Duration = Duration::from_secs(1);

/// What a callback that fails is supposed to return: the callee's own mistake.
pub const ERROR_CODE: u32 = 500;

/// What a leak is supposed to lose in each cycle. How much is all the same: it does not stop.
pub const LEAK_BYTES: u64 = 4096;

/// How much longer a slow component without a period takes.
const SLOWNESS_WITHOUT_PERIOD: Duration = Duration::from_millis(100);

/// Larger than any quantity of a robot in the units of its data.
const FAR_OUT: f64 = 1e9;

/// A fault that a component can be supposed to have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SupposedFault {
    /// In `onExecute`. All happen once, but for `slow` and `leak`, which last.
    Callback(Misbehaviour),
    /// In the data of a port, for ever.
    Port(Distortion),
    /// In the container's own handling of a segmentation fault of the component.
    Handling(ContainerFailure),
}

impl SupposedFault {
    /// All of them, in the order of the injection dialect. The time that `slow` takes is that of
    /// [`slowness`].
    pub const ALL: [Self; 24] = [
        Self::Callback(Misbehaviour::Panic),
        Self::Callback(Misbehaviour::Segfault),
        Self::Callback(Misbehaviour::BusError),
        Self::Callback(Misbehaviour::DivideByZero),
        Self::Callback(Misbehaviour::IllegalInstruction),
        Self::Callback(Misbehaviour::Abort),
        Self::Callback(Misbehaviour::StackOverflow),
        Self::Callback(Misbehaviour::Exit(DEFAULT_EXIT_CODE)),
        Self::Callback(Misbehaviour::Hang),
        Self::Callback(Misbehaviour::Slow(Duration::ZERO)),
        Self::Callback(Misbehaviour::Leak(LEAK_BYTES)),
        Self::Callback(Misbehaviour::ErrorReturn(ERROR_CODE)),
        Self::Port(Distortion::OutOfRange(FAR_OUT)),
        Self::Port(Distortion::NotANumber),
        Self::Port(Distortion::Stuck),
        Self::Port(Distortion::Offset(FAR_OUT)),
        Self::Port(Distortion::Drift(FAR_OUT)),
        Self::Port(Distortion::Noise(FAR_OUT)),
        Self::Port(Distortion::Drop),
        Self::Port(Distortion::Delay(DELAY)),
        Self::Port(Distortion::Duplicate),
        Self::Handling(ContainerFailure::LibraryMissing),
        Self::Handling(ContainerFailure::CheckpointCorrupt),
        Self::Handling(ContainerFailure::RecoveryFails),
    ];

    /// Its name in injection files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Callback(misbehaviour) => misbehaviour.name(),
            Self::Port(distortion) => distortion.name(),
            Self::Handling(failure) => failure.name(),
        }
    }

    /// The fault of this name.
    pub fn find(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|fault| fault.name() == name)
    }

    /// What the guard makes of a callback that does not come back; none of one that does.
    pub(super) fn exception(self) -> Option<FaultKind> {
        let Self::Callback(misbehaviour) = self else {
            return None;
        };
        Some(match misbehaviour {
            Misbehaviour::Panic => FaultKind::Panic,
            Misbehaviour::Segfault => FaultKind::Segfault,
            Misbehaviour::BusError => FaultKind::BusError,
            Misbehaviour::DivideByZero => FaultKind::DivideByZero,
            Misbehaviour::IllegalInstruction => FaultKind::IllegalInstruction,
            Misbehaviour::Abort => FaultKind::Abort,
            Misbehaviour::StackOverflow => FaultKind::StackOverflow,
            Misbehaviour::Exit(_) => FaultKind::Exit,
            Misbehaviour::ErrorReturn(_) => FaultKind::ErrorReturn,
            Misbehaviour::Hang | Misbehaviour::Slow(_) | Misbehaviour::Leak(_) => return None,
        })
    }
}

/// How much longer a slow component takes: two periods, so that it runs over its own, and no hang
/// comes of it where the rules leave the watchdog at its default.
pub fn slowness(execution: &ExecutionSemantics) -> Duration {
    match execution.period {
        Duration::ZERO => SLOWNESS_WITHOUT_PERIOD,
        period => period.saturating_mul(2),
    }
}

/// One fault of one component.
#[derive(Debug, Clone, PartialEq)]
pub struct Supposition {
    /// Index of the application.
    pub application: usize,
    /// Index of the component in it.
    pub component: usize,
    /// The data port, for a fault of its data.
    pub port: Option<String>,
    /// What goes wrong.
    pub fault: SupposedFault,
}

/// Why a component cannot have a fault.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Inapplicable {
    /// There is no such component.
    #[error("there is no such component")]
    NoComponent,
    /// Its `onExecute` is never called.
    #[error("'{component}' is passive: its onExecute is never called")]
    Passive {
        /// The component.
        component: String,
    },
    /// A fault of data needs to be told where.
    #[error("'{fault}' is a fault of a port's data: say of which, as {component}.PORT")]
    NeedsPort {
        /// The fault.
        fault: &'static str,
        /// The component.
        component: String,
    },
    /// There is no such data port.
    #[error("'{component}' has no data port '{port}'")]
    NoPort {
        /// The component.
        component: String,
        /// The port.
        port: String,
    },
    /// A fault of the component itself.
    #[error("'{fault}' is no fault of a port's data: leave the port out")]
    NotOfPort {
        /// The fault.
        fault: &'static str,
    },
}

impl Supposition {
    /// Whether the component can have the fault.
    ///
    /// # Errors
    /// Why not.
    pub fn check(&self, scopes: &[Scope]) -> Result<(), Inapplicable> {
        let scope = scopes.get(self.application);
        let component = scope.and_then(|scope| scope.specification.components.get(self.component));
        let component = component.ok_or(Inapplicable::NoComponent)?;
        let name = || component.name.clone();
        match (self.fault, &self.port) {
            (SupposedFault::Port(_), None) => Err(Inapplicable::NeedsPort {
                fault: self.fault.name(),
                component: name(),
            }),
            (SupposedFault::Port(_), Some(port))
                if data_ports(component).any(|own| own == port) =>
            {
                Ok(())
            }
            (SupposedFault::Port(_), Some(port)) => Err(Inapplicable::NoPort {
                component: name(),
                port: port.clone(),
            }),
            (_, Some(_)) => Err(Inapplicable::NotOfPort {
                fault: self.fault.name(),
            }),
            (_, None) if component.execution.kind == ExecutionKind::Passive => {
                Err(Inapplicable::Passive { component: name() })
            }
            (_, None) => Ok(()),
        }
    }

    /// The same as a fault that can be injected. A fault of the handling shows when the component
    /// has another one.
    pub fn injected(&self, scopes: &[Scope]) -> Option<InjectedFault> {
        use system_model::injection::CallbackName::Execute;
        self.check(scopes).ok()?;
        let specification = &scopes[self.application].specification;
        let execution = &specification.components[self.component].execution;
        let component = self.component;
        Some(match self.fault {
            SupposedFault::Callback(misbehaviour) => InjectedFault::Callback {
                component,
                callback: Execute,
                misbehaviour: match misbehaviour {
                    Misbehaviour::Slow(_) => Misbehaviour::Slow(slowness(execution)),
                    other => other,
                },
            },
            SupposedFault::Port(distortion) => InjectedFault::Port {
                component,
                port: self.port.clone()?,
                field: None,
                distortion,
            },
            SupposedFault::Handling(failure) => InjectedFault::Container { component, failure },
        })
    }
}

/// Names of a component's data ports.
pub(super) fn data_ports(component: &ComponentSpecification) -> impl Iterator<Item = &String> {
    let data = component
        .ports
        .iter()
        .filter(|port| port.kind == PortKind::Data);
    data.map(|port| &port.name)
}
