//! Indices of an application's components become those of all components.

use system_model::injection::{InjectedFault, Injection, Trigger};
use system_model::rules::{ComponentRules, FaultRules};

/// Rules whose components begin with the one of this index; those before have no rules.
pub(super) fn rules(rules: &FaultRules, first: usize) -> FaultRules {
    let mut shifted = rules.clone();
    shifted.components = std::iter::repeat_with(ComponentRules::default)
        .take(first)
        .chain(rules.components.iter().cloned())
        .collect();
    for executor in &mut shifted.executors {
        executor.first_component += first;
    }
    for monitor in &mut shifted.monitors {
        for port in monitor.inputs.iter_mut().chain(&mut monitor.outputs) {
            port.component += first;
        }
    }
    for voting in &mut shifted.votings {
        voting.output.component += first;
        for source in &mut voting.sources {
            source.port.component += first;
        }
    }
    shifted
}

/// An injection into an application whose components begin with the one of this index.
pub(super) fn injection(injection: &Injection, first: usize) -> Injection {
    let mut shifted = injection.clone();
    match &mut shifted.what {
        InjectedFault::Callback { component, .. }
        | InjectedFault::Port { component, .. }
        | InjectedFault::Container { component, .. } => *component += first,
        InjectedFault::World { component, .. } => *component = Some(first + component.unwrap_or(0)),
    }
    if let Trigger::AtCycle { component, .. } = &mut shifted.trigger {
        *component += first;
    }
    shifted
}

#[cfg(test)]
mod tests {
    use system_model::injection::{ContainerFailure, WorldFault};
    use system_model::rules::HandleRule;
    use system_model::specification::Place;

    use super::*;

    #[test]
    fn injections_are_into_the_same_component_as_before() {
        let at = |component| Injection {
            trigger: Trigger::AtCycle {
                component,
                cycle: 7,
            },
            lasting: None,
            repetition: None,
            probability: None,
            what: InjectedFault::Container {
                component,
                failure: ContainerFailure::RecoveryFails,
            },
            place: Place::default(),
        };
        assert_eq!(injection(&at(2), 5), at(7));
        let world = Injection {
            what: InjectedFault::World {
                component: None,
                fault: WorldFault::UnplugSonar(1),
            },
            ..at(0)
        };
        let shifted = InjectedFault::World {
            component: Some(3),
            fault: WorldFault::UnplugSonar(1),
        };
        assert_eq!(injection(&world, 3).what, shifted);
    }

    #[test]
    fn rules_of_components_lie_at_their_indices() {
        let own = ComponentRules {
            handle: Some(system_model::profile::Located {
                value: HandleRule {
                    tree: "rescue".to_owned(),
                    deadline: std::time::Duration::from_secs(1),
                },
                place: Place::default(),
            }),
            ..ComponentRules::default()
        };
        let rules = rules(
            &FaultRules {
                components: vec![ComponentRules::default(), own.clone()],
                ..FaultRules::default()
            },
            3,
        );
        assert_eq!(rules.components.len(), 5);
        assert_eq!(rules.components[4], own);
    }
}
