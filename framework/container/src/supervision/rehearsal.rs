//! A rehearsal of the way that every fault takes: handler, judgement, fault manager, orders, takeover
//! by a warm standby, restored checkpoint, first cycle. It is done on each executor's thread before
//! its first cycle, on a component that is nobody's and leaves no record, so that the first fault of
//! a real one finds the pages of code and stack there that all of them share.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use component_abi::{Callbacks, HostContext, HostTable, Instance};
use fault_manager::{FaultManager, Observation, Scope};
use system_model::life_cycle::Operation;
use system_model::profile::Located;
use system_model::rules::{ComponentRules, FaultRules, Preload, ResurrectRule};
use system_model::specification::{
    ApplicationSpecification, ComponentSpecification, ExecutionKind, ExecutionSemantics, Place,
    SchedulingPolicy,
};

use super::{Emergency, Monitors, Standbys, Supervisor};
use crate::adaptation::AdaptationRequests;
use crate::assembly::{Factory, Variant};
use crate::clock::Clock;
use crate::component::{Component, ComponentCell, Detectors, Environment};
use crate::event_log::EventLog;
use crate::executor::{Executor, Member};
use crate::guard::{CodeRange, Misbehaviour};
use crate::host::Hosts;
use crate::injection::Injections;
use crate::lane::Lane;
use crate::library::{ComponentDescription, LoadedLibrary};
use crate::schedule::BusyTime;
use crate::status::ComponentStatus;
use crate::supervision::{Observations, Scenes};
use crate::world::Worlds;

/// One that traps, one that does not; each takes its own way through the guard.
const FAULTS: [Misbehaviour; 2] = [Misbehaviour::Segfault, Misbehaviour::Panic];

/// Of the component, which never runs by itself.
const PERIOD: Duration = Duration::from_secs(1);

/// What it says; nobody reads it.
const NAME: &str = "rehearsal";

const CALLBACKS: Callbacks = Callbacks {
    create: Some(create),
    destroy_instance: Some(destroy_instance),
    ..Callbacks::NONE
};

extern "C" fn create(_: *const HostTable, _: *mut HostContext) -> *mut Instance {
    std::ptr::dangling_mut()
}

extern "C" fn destroy_instance(_: *mut Instance) {}

/// Lets a component fail and be replaced, once for each way to fail.
///
/// # Errors
/// If the machine has no room for it. Then nothing is rehearsed, and nothing else is amiss.
pub fn rehearse(lane: &Lane) -> io::Result<()> {
    let mut stage = Stage::new(lane)?;
    for misbehaviour in FAULTS {
        stage.play(misbehaviour, lane)?;
    }
    Ok(())
}

/// A container of one component.
struct Stage {
    executor: Executor,
    supervisor: Supervisor,
    library: LoadedLibrary,
}

impl Stage {
    fn new(lane: &Lane) -> io::Result<Self> {
        let environment = Arc::new(environment());
        let factory = factory(&environment);
        let library = library();
        let scope = Scope {
            specification: application(),
            rules: FaultRules {
                components: vec![rules()],
                ..FaultRules::default()
            },
        };
        let manager = FaultManager::new(vec![scope]);
        let status = Arc::new(ComponentStatus::new(NAME.to_owned()));
        let mut component = factory
            .instantiate(0, Some(&library), Arc::clone(&status))
            .map_err(io::Error::other)?;
        let detector = |kind| {
            manager
                .detector(0, &kind)
                .unwrap_or(fault_manager::DetectorId(0))
        };
        component.services_mut().set_detectors(Detectors {
            component: 0,
            exception: detector(fault_manager::DetectorKind::Exception),
            hang: detector(fault_manager::DetectorKind::Hang),
            reported: detector(fault_manager::DetectorKind::FaultEvent(None)),
        });
        component.keep_checkpoints(PERIOD);
        bring_up(&mut component, lane);
        let mut executor = Executor::new(
            NAME.to_owned(),
            ExecutionKind::Periodic,
            PERIOD,
            0,
            SchedulingPolicy::Other,
            Arc::default(),
        );
        executor.members.push(Member {
            component: Arc::new(ComponentCell::new(component)),
            number: 0,
            triggers: Vec::new(),
            followers: Vec::new(),
        });
        let (supervisor, _wanted) = Supervisor::new(
            environment,
            manager,
            vec![Arc::clone(&executor.orders)],
            vec![Standbys::new(Arc::new(factory), false)],
            vec![status],
            Emergency::default(),
            Monitors::default(),
        );
        supervisor.observe(Observation::Running);
        Ok(Self {
            executor,
            supervisor,
            library,
        })
    }

    /// One cycle, in which the component fails and another one takes over and works.
    fn play(&mut self, misbehaviour: Misbehaviour, lane: &Lane) -> io::Result<()> {
        let Some(standbys) = self.supervisor.standbys(0) else {
            return Ok(());
        };
        let status = Arc::new(ComponentStatus::standby(NAME.to_owned()));
        let mut standby = standbys
            .factory()
            .instantiate(0, Some(&self.library), status)
            .map_err(std::io::Error::other)?;
        bring_up(&mut standby, lane);
        standbys.add(0, Box::new(standby));
        let cell = Arc::clone(&self.executor.members[0].component);
        if let Some(mut component) = cell.enter(lane.token(), Duration::ZERO)
            && (component.is_active() || component.operate(Operation::Start, lane.loss()).is_ok())
        {
            component.misbehave(misbehaviour);
        }
        let now_ns = self.supervisor.environment().clock.now_ns();
        while self.executor.step(now_ns, lane) {
            self.supervisor.attend();
            if !self.executor.orders.is_empty() {
                self.executor.obey(&self.supervisor, lane);
            }
        }
        standbys.free_retired();
        Ok(())
    }
}

/// To READY, as a warm standby is. What goes wrong with it goes wrong in the rehearsal too.
fn bring_up(component: &mut Component, lane: &Lane) {
    let _fails_later = component.construct(lane.loss());
    component.set_constructed();
    let _fails_later = component.operate(Operation::Initialize, lane.loss());
}

fn environment() -> Environment {
    Environment {
        clock: Clock::real(),
        events: EventLog::nowhere(),
        observations: Observations::default(),
        scenes: Scenes::default(),
        injections: Injections::default(),
        worlds: Worlds::default(),
        score: None,
        adaptation_requests: AdaptationRequests::default(),
        busy: BusyTime::default(),
    }
}

fn factory(environment: &Arc<Environment>) -> Factory {
    let variant = Variant {
        specification: specification(),
        path: PathBuf::new(),
        description: library().description,
        preload: Preload::Warm,
    };
    let hosts = Hosts::new(None);
    Factory::new(0, vec![variant], rules(), Arc::clone(environment), hosts)
}

fn library() -> LoadedLibrary {
    LoadedLibrary {
        description: ComponentDescription {
            name: NAME.to_owned(),
            version: String::new(),
            ports: Vec::new(),
            callbacks: CALLBACKS,
        },
        // It does nothing; what traps in it is the injection's.
        code: CodeRange { start: 0, end: 0 },
        path: PathBuf::new(),
    }
}

fn rules() -> ComponentRules {
    let resurrect = ResurrectRule {
        reset: true,
        backup: Some(PERIOD),
        persist: None,
    };
    ComponentRules {
        resurrect: Some(Located {
            value: resurrect,
            place: Place::default(),
        }),
        ..ComponentRules::default()
    }
}

fn application() -> ApplicationSpecification {
    ApplicationSpecification {
        name: NAME.to_owned(),
        file: PathBuf::new(),
        components: vec![specification()],
        connections: Vec::new(),
        manager_connections: Vec::new(),
        coordination: Vec::new(),
        world: None,
        trees: Vec::new(),
    }
}

fn specification() -> ComponentSpecification {
    ComponentSpecification {
        name: NAME.to_owned(),
        type_name: NAME.to_owned(),
        profile: PathBuf::new(),
        place: Place::default(),
        library: String::new(),
        execution: ExecutionSemantics {
            kind: ExecutionKind::Periodic,
            period: PERIOD,
            priority: 0,
            policy: SchedulingPolicy::Other,
        },
        properties: Vec::new(),
        ports: Vec::new(),
        node: String::new(),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;
    use crate::guard::loss::LostThread;
    use crate::lane::{Crew, Work};

    /// Incarnations and completed cycles of the component afterwards.
    struct Rehearsal(Arc<Mutex<Option<(u32, u64)>>>);

    impl Work for Rehearsal {
        fn run(&mut self, lane: &Lane) {
            let mut stage = Stage::new(lane).expect("there is room");
            for misbehaviour in FAULTS {
                stage.play(misbehaviour, lane).expect("there is room");
            }
            let status = &stage.supervisor.statuses[0];
            let found = (status.incarnation(), status.cycles());
            *self.0.lock().expect("nobody panics") = Some(found);
        }

        fn after_loss(&mut self, lost: &LostThread) {
            panic!("nothing of it is in the C library: {lost:?}");
        }
    }

    #[test]
    fn each_fault_comes_to_a_successor_that_works() {
        let found = Arc::default();
        let crew = Crew::new().expect("a crew");
        let lane = Lane::new(NAME, Box::new(Rehearsal(Arc::clone(&found))));
        crew.start(&lane, || {}).expect("a thread");
        assert!(lane.wait(Duration::from_secs(60)), "it ends");
        crew.dismiss();
        let faults = u32::try_from(FAULTS.len()).expect("few");
        let expected = (1 + faults, u64::from(faults));
        assert_eq!(*found.lock().expect("nobody panics"), Some(expected));
    }
}
