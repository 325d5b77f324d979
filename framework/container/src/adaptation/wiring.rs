//! Which port gets its data from which, for any set of components in use: along each link of the
//! task through those of its components that are used.

use system_model::task::ComponentIndex;

/// A port of a component of the system, by its name: the number is the library's matter.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct PortKey {
    /// Index of the component among all of the system.
    pub component: usize,
    /// Name of the port.
    pub port: String,
}

/// One connection.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Hop {
    /// The output.
    pub from: PortKey,
    /// The input.
    pub to: PortKey,
}

/// A link of the task between two components of this system.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Route {
    /// Output of the first component.
    pub from: PortKey,
    /// Input of the last.
    pub to: PortKey,
    /// What may stand in between, in this order.
    pub through: Vec<Stage>,
    /// Size of a datum, in bytes.
    pub size: usize,
}

/// A component that may stand in a link.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stage {
    /// Which component of the task.
    pub component: ComponentIndex,
    /// Where it takes the data of the link.
    pub input: PortKey,
    /// Where it gives them on.
    pub output: PortKey,
}

/// The connections of all links where these components are in use.
pub fn hops(routes: &[Route], is_used: impl Fn(ComponentIndex) -> bool) -> Vec<Hop> {
    let mut hops = Vec::new();
    for route in routes {
        let mut from = &route.from;
        for stage in route.through.iter().filter(|it| is_used(it.component)) {
            hops.push(Hop {
                from: from.clone(),
                to: stage.input.clone(),
            });
            from = &stage.output;
        }
        hops.push(Hop {
            from: from.clone(),
            to: route.to.clone(),
        });
    }
    hops
}

/// What of `wanted` is not there yet.
pub fn added(wanted: &[Hop], present: &[Hop]) -> Vec<Hop> {
    let new = wanted.iter().filter(|hop| !present.contains(hop));
    new.cloned().collect()
}

/// Components that do not get the same data as before: those at the end of a new connection, and all
/// that get data from such.
pub fn affected(wanted: &[Hop], present: &[Hop]) -> Vec<usize> {
    let new = added(wanted, present);
    let mut affected: Vec<usize> = new.iter().map(|hop| hop.to.component).collect();
    let mut reached = 0;
    while reached < affected.len() {
        let source = affected[reached];
        reached += 1;
        for hop in wanted.iter().filter(|hop| hop.from.component == source) {
            if !affected.contains(&hop.to.component) {
                affected.push(hop.to.component);
            }
        }
    }
    affected.sort_unstable();
    affected.dedup();
    affected
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(component: usize, port: &str) -> PortKey {
        PortKey {
            component,
            port: port.to_owned(),
        }
    }

    /// A camera (0) to a tracker (1), through either of two filters (2 and 3), to a motor (4).
    fn routes() -> [Route; 2] {
        let stage = |component: usize| Stage {
            component,
            input: key(component, "in"),
            output: key(component, "out"),
        };
        [
            Route {
                from: key(0, "out"),
                to: key(1, "in"),
                through: vec![stage(2), stage(3)],
                size: 8,
            },
            Route {
                from: key(1, "out"),
                to: key(4, "in"),
                through: Vec::new(),
                size: 8,
            },
        ]
    }

    fn in_words(hops: &[Hop]) -> Vec<(usize, usize)> {
        let ends = hops
            .iter()
            .map(|hop| (hop.from.component, hop.to.component));
        ends.collect()
    }

    #[test]
    fn data_flow_through_those_that_are_used() {
        for (used, expected) in [
            (&[][..], &[(0, 1), (1, 4)][..]),
            (&[2], &[(0, 2), (2, 1), (1, 4)]),
            (&[3], &[(0, 3), (3, 1), (1, 4)]),
            (&[2, 3], &[(0, 2), (2, 3), (3, 1), (1, 4)]),
        ] {
            let hops = hops(&routes(), |component| used.contains(&component));
            assert_eq!(in_words(&hops), expected, "{used:?}");
        }
    }

    #[test]
    fn what_is_new_affects_all_behind_it() {
        let of = |used: &[usize]| hops(&routes(), |component| used.contains(&component));
        for (present, wanted, new, expected) in [
            (&[][..], &[2][..], &[(0, 2), (2, 1)][..], &[1, 2, 4][..]),
            (&[2], &[3], &[(0, 3), (3, 1)], &[1, 3, 4]),
            (&[2], &[], &[(0, 1)], &[1, 4]),
            (&[2], &[2], &[], &[]),
        ] {
            let (present, wanted) = (of(present), of(wanted));
            assert_eq!(in_words(&added(&wanted, &present)), new);
            assert_eq!(affected(&wanted, &present), expected);
        }
    }
}
