//! The simulated worlds of a run: each application's own, shared by those that name the same file.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use robot_simulation::RobotSummary;

use super::World;
use crate::component::Environment;
use crate::event_log::Event;

/// Seeds of worlds of one run are so far apart, so that no two runs with seeds that people choose
/// share one: the golden ratio of 64 bits.
const SEED_DISTANCE: u64 = 0x9e37_79b9_7f4a_7c15;

/// The seed of a run's n-th world, counted from 0; that of the first one is the run's.
pub fn world_seed(seed: u64, world: usize) -> u64 {
    seed.wrapping_add(SEED_DISTANCE.wrapping_mul(world as u64))
}

/// The world files of a run, each once: those that applications name, in their order.
pub fn world_files<'file>(named: impl IntoIterator<Item = Option<&'file Path>>) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = Vec::new();
    for file in named.into_iter().flatten() {
        if !files.iter().any(|known| is_same(known, file)) {
            files.push(file.to_owned());
        }
    }
    files
}

fn is_same(one: &Path, other: &Path) -> bool {
    let identity = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
    one == other || identity(one) == identity(other)
}

/// The worlds of a run.
#[derive(Debug, Default)]
pub struct Worlds {
    worlds: Vec<Named>,
    applications: Vec<Driver>,
}

#[derive(Debug)]
struct Named {
    /// The first application that drives in it.
    application: String,
    world: Arc<World>,
}

/// An application, as worlds see it.
#[derive(Debug)]
struct Driver {
    /// The number of its first component among all.
    first: usize,
    /// The number of its world.
    world: Option<usize>,
}

/// What is asked of an application.
#[derive(Debug)]
pub struct Drives<'application> {
    /// Its name.
    pub application: &'application str,
    /// The number of its first component among all.
    pub first: usize,
    /// Its world's file.
    pub file: Option<&'application Path>,
}

impl Worlds {
    /// The worlds of these applications: those of the files that [`world_files`] finds, in its
    /// order. An application that names none drives in the only one, if there is one.
    pub fn new(applications: &[Drives<'_>], worlds: impl IntoIterator<Item = Arc<World>>) -> Self {
        let files = world_files(applications.iter().map(|it| it.file));
        let number = |file: &Path| files.iter().position(|known| is_same(known, file));
        let only = (files.len() == 1).then_some(0);
        let driver = |it: &Drives<'_>| Driver {
            first: it.first,
            world: it.file.map_or(only, number),
        };
        let first_in = |file: &Path| {
            let mut all = applications.iter();
            let found = all.find(|it| it.file.is_some_and(|named| is_same(named, file)));
            found.map_or_else(String::new, |it| it.application.to_owned())
        };
        let named = files.iter().zip(worlds).map(|(file, world)| Named {
            application: first_in(file),
            world,
        });
        Self {
            worlds: named.collect(),
            applications: applications.iter().map(driver).collect(),
        }
    }

    /// The world of a component, by its number among all.
    pub fn of_component(&self, component: usize) -> Option<&Arc<World>> {
        let behind = (self.applications).partition_point(|it| it.first <= component);
        let driver = self.applications.get(behind.checked_sub(1)?)?;
        self.worlds.get(driver.world?).map(|it| &it.world)
    }

    /// The first application's world.
    pub fn first(&self) -> Option<&Arc<World>> {
        self.worlds.first().map(|it| &it.world)
    }

    /// Every world, with the first application that drives in it.
    pub fn by_application(&self) -> impl Iterator<Item = (&str, &Arc<World>)> {
        let all = self.worlds.iter();
        all.map(|it| (it.application.as_str(), &it.world))
    }

    /// Whether there are several.
    pub fn are_several(&self) -> bool {
        self.worlds.len() > 1
    }

    /// Moves all worlds to `now`, one after the other; true once every robot has reached its target.
    pub fn advance_to(&self, now: Duration, environment: &Environment) -> bool {
        for one in &self.worlds {
            if let Some((time_ns, time_s)) = one.world.advance_to(now) {
                environment.clock.advance_to(time_ns);
                let application = self.are_several().then(|| one.application.clone());
                let reached = Event::TargetReached {
                    application,
                    time_s,
                };
                environment.events.record(time_ns, reached);
            }
        }
        self.have_reached_targets()
    }

    /// Whether every robot has reached its target; false without any.
    pub fn have_reached_targets(&self) -> bool {
        let mut all = self.worlds.iter();
        !self.worlds.is_empty() && all.all(|it| it.world.has_reached_target())
    }

    /// Time between two steps, or two looks, of the world that wants the shortest; none without any.
    pub fn step_period(&self) -> Option<Duration> {
        let all = self.worlds.iter();
        all.map(|it| it.world.step_period()).min()
    }

    /// How each drive went so far, by the first application in each world.
    pub fn summaries(&self) -> impl Iterator<Item = (String, RobotSummary)> {
        let all = self.by_application();
        all.map(|(application, world)| (application.to_owned(), world.summary()))
    }
}

#[cfg(test)]
mod tests {
    use robot_simulation::Simulation;
    use system_model::world::WorldSpecification;

    use super::*;

    fn worlds(applications: &[Drives<'_>]) -> Worlds {
        let files = world_files(applications.iter().map(|it| it.file));
        let world = |_| {
            let simulation = Simulation::new(&WorldSpecification::default(), 1).unwrap();
            Arc::new(World::new(simulation, false))
        };
        Worlds::new(applications, files.iter().map(world))
    }

    fn drives<'it>(application: &'it str, first: usize, file: Option<&'it str>) -> Drives<'it> {
        Drives {
            application,
            first,
            file: file.map(Path::new),
        }
    }

    /// The name under which the world of each component is known.
    fn names(worlds: &Worlds, components: usize) -> Vec<Option<&str>> {
        let name = |component| {
            let own = worlds.of_component(component)?;
            let mut all = worlds.by_application();
            all.find(|(_, world)| Arc::ptr_eq(world, own))
                .map(|(name, _)| name)
        };
        (0..components).map(name).collect()
    }

    #[test]
    fn each_component_is_in_the_world_of_its_application() {
        let all = [
            drives("a", 0, Some("one.xml")),
            drives("b", 2, Some("two.xml")),
            drives("empty", 3, None),
            drives("c", 3, Some("one.xml")),
            drives("d", 4, None),
        ];
        let worlds = worlds(&all);
        assert_eq!(
            names(&worlds, 5),
            [Some("a"), Some("a"), Some("b"), Some("a"), None]
        );
        assert!(worlds.are_several() && !worlds.have_reached_targets());
    }

    #[test]
    fn who_names_no_world_is_in_the_only_one() {
        let all = [drives("a", 0, None), drives("b", 1, Some("one.xml"))];
        assert_eq!(names(&worlds(&all), 2), [Some("b"), Some("b")]);
        assert_eq!(names(&worlds(&all[..1]), 1), [None]);
    }

    #[test]
    fn worlds_have_seeds_of_their_own() {
        assert_eq!(world_seed(7, 0), 7);
        let seeds = (0..100).flat_map(|seed| [world_seed(seed, 1), world_seed(seed, 2)]);
        let seeds: std::collections::BTreeSet<u64> = seeds.chain(0..100).collect();
        assert_eq!(seeds.len(), 300);
    }
}
