//! Which component gets its data from which, for any set of components in use: along each link of the
//! task through those of its components that are used, wherever they run.

use system_model::task::{ComponentIndex, Placement, TaskLink, TaskSpecification};

/// A port of a component of the system, by its name: the number is the library's matter.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct PortKey {
    /// Index of the component among all of the system.
    pub component: usize,
    /// Name of the port.
    pub port: String,
}

/// One connection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hop {
    /// Position in the task's links.
    pub link: usize,
    /// Whose output.
    pub from: Placement,
    /// Whose input.
    pub to: Placement,
}

/// What robots that do a task together must agree upon, so that their numbers mean the same.
pub fn description(task: &TaskSpecification) -> String {
    let components = task.components.iter().map(|it| &it.name);
    let links = task.links.iter().map(|it| (it.from, it.to, &it.through));
    let robots = task.robots.iter().map(|robot| {
        let instances = robot.instances.iter().map(|it| it.component);
        (&robot.name, instances.collect::<Vec<_>>())
    });
    let resources = task.resources.iter().map(|it| &it.name);
    format!(
        "{:?}",
        (
            &task.name,
            components.collect::<Vec<_>>(),
            links.collect::<Vec<_>>(),
            robots.collect::<Vec<_>>(),
            resources.collect::<Vec<_>>(),
        )
    )
}

/// The connections of all links where these components are in use.
pub fn hops(links: &[TaskLink], placements: &[Placement]) -> Vec<Hop> {
    let used = |component: ComponentIndex| {
        let mut placements = placements.iter().copied();
        placements.find(|it| it.component == component)
    };
    let mut hops = Vec::new();
    for (link, ends) in links.iter().enumerate() {
        let (Some(mut from), Some(last)) = (used(ends.from), used(ends.to)) else {
            continue;
        };
        let between = ends.through.iter().filter_map(|component| used(*component));
        for to in between.chain([last]) {
            hops.push(Hop { link, from, to });
            from = to;
        }
    }
    hops
}

/// What of `wanted` is not there yet.
pub fn added(wanted: &[Hop], present: &[Hop]) -> Vec<Hop> {
    let new = wanted.iter().filter(|hop| !present.contains(hop));
    new.copied().collect()
}

/// Placements that do not get the same data as before: those at the end of a new connection, and all
/// that get data from such.
pub fn affected(wanted: &[Hop], present: &[Hop]) -> Vec<Placement> {
    let new = added(wanted, present);
    let mut affected: Vec<Placement> = new.iter().map(|hop| hop.to).collect();
    let mut reached = 0;
    while reached < affected.len() {
        let source = affected[reached];
        reached += 1;
        for hop in wanted.iter().filter(|hop| hop.from == source) {
            if !affected.contains(&hop.to) {
                affected.push(hop.to);
            }
        }
    }
    affected.sort_unstable();
    affected.dedup();
    affected
}

#[cfg(test)]
mod tests {
    use system_model::task::LinkPorts;

    use super::*;

    /// A camera (0) to a tracker (1), through either of two filters (2 and 3); the tracker to a
    /// motor (4).
    fn links() -> [TaskLink; 2] {
        let link = |from, to, through: &[ComponentIndex]| TaskLink {
            from,
            to,
            through: through.to_vec(),
            ports: LinkPorts::default(),
        };
        [link(0, 1, &[2, 3]), link(1, 4, &[])]
    }

    /// Camera, tracker and motor on robot 0, and filters on the robots that are given.
    fn hops_with(filters: &[(ComponentIndex, usize)]) -> Vec<Hop> {
        let own = [(0, 0), (1, 0), (4, 0)];
        let placements = own.iter().chain(filters);
        let placements: Vec<Placement> = placements
            .map(|(component, robot)| Placement {
                component: *component,
                robot: *robot,
            })
            .collect();
        hops(&links(), &placements)
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
            (&[(2, 0)], &[(0, 2), (2, 1), (1, 4)]),
            (&[(3, 1)], &[(0, 3), (3, 1), (1, 4)]),
            (&[(2, 1), (3, 0)], &[(0, 2), (2, 3), (3, 1), (1, 4)]),
        ] {
            assert_eq!(in_words(&hops_with(used)), expected, "{used:?}");
        }
        assert!(hops(&links(), &[]).is_empty());
    }

    #[test]
    fn what_is_new_affects_all_behind_it() {
        for (present, wanted, new, expected) in [
            (
                &[][..],
                &[(2, 0)][..],
                &[(0, 2), (2, 1)][..],
                &[1, 2, 4][..],
            ),
            (&[(2, 0)], &[(3, 0)], &[(0, 3), (3, 1)], &[1, 3, 4]),
            (&[(2, 0)], &[], &[(0, 1)], &[1, 4]),
            (&[(2, 0)], &[(2, 0)], &[], &[]),
            // The same filter on another robot.
            (&[(2, 0)], &[(2, 1)], &[(0, 2), (2, 1)], &[1, 2, 4]),
        ] {
            let (present, wanted) = (hops_with(present), hops_with(wanted));
            assert_eq!(in_words(&added(&wanted, &present)), new);
            let affected = affected(&wanted, &present);
            let mut affected: Vec<usize> = affected.iter().map(|it| it.component).collect();
            affected.sort_unstable();
            assert_eq!(affected, expected);
        }
    }
}
