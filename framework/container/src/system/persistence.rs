//! What outlives the container: given to the components that it belongs to when they are
//! initialised, kept up to date while they run, removed when the run ends in order. A robot whose
//! disk refuses runs all the same, and says so.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, SystemTime};

use super::StateOptions;
use super::applications::Applications;
use crate::assembly::Factory;
use crate::component::{Component, ComponentCell, Environment, Inheritance};
use crate::event_log::Event;
use crate::lane::SETUP_TOKEN;
use crate::persistence::{
    Found, Kept, LARGEST_MEMORY, LibraryIdentity, Origin, Record, Store, StoreError, Writer,
    base_folder, handover,
};

/// How long a disk may take for its last writing when the run ends: a busy flash card stalls for some
/// hundred milliseconds.
const LAST_WRITING_LIMIT: Duration = Duration::from_secs(1);

/// What of a run outlives the container.
#[derive(Debug, Default)]
pub(super) struct Persistence {
    /// By application.
    wanted: Vec<Wanted>,
    stores: Vec<Store>,
    writer: Option<Writer>,
}

/// A component whose rules ask for it.
#[derive(Debug)]
struct Wanted {
    /// In the list of all.
    component: usize,
    application: String,
    /// Its name in the application.
    name: String,
    max_age: Duration,
    /// Its own library, then those of its secondaries.
    libraries: Vec<PathBuf>,
}

impl Persistence {
    /// What the rules ask for. Nothing is opened yet.
    pub(super) fn new(applications: &Applications, factories: &[Arc<Factory>]) -> Self {
        let several = applications.parts.len() > 1;
        let mut wanted = Vec::new();
        for (application, members) in applications.names() {
            for component in members {
                let rules = applications.rules.components.get(component);
                let rule = rules.and_then(|rules| rules.resurrect.as_ref());
                let Some(max_age) = rule.and_then(|rule| rule.value.persist) else {
                    continue;
                };
                let name = &applications.specification.components[component].name;
                let own = name.split_once('/').filter(|_| several);
                wanted.push(Wanted {
                    component,
                    application: application.clone(),
                    name: own.map_or(name.as_str(), |(_, own)| own).to_owned(),
                    max_age,
                    libraries: libraries(&factories[component]),
                });
            }
        }
        Self {
            wanted,
            ..Self::default()
        }
    }

    /// Opens the folders, leaves to each component what a run that died has left, and begins to write
    /// down what they do from now on.
    ///
    /// # Errors
    /// If the system refuses a thread. All else is said, and the run goes on without it.
    pub(super) fn open(
        &mut self,
        options: &StateOptions,
        components: &[Arc<ComponentCell>],
        environment: &Arc<Environment>,
    ) -> io::Result<()> {
        if self.wanted.is_empty() {
            return Ok(());
        }
        if environment.clock.is_simulated() {
            let message = "in simulated time no checkpoint outlives the container";
            say(environment, message.to_owned());
            return Ok(());
        }
        let base = match base_folder(options.folder.as_deref(), |name| std::env::var_os(name)) {
            Ok(base) => base,
            Err(error) => {
                say(environment, not_kept("any component", &error));
                return Ok(());
            }
        };
        let mut kept = Vec::new();
        for wanted in self.wanted.chunk_by(|a, b| a.application == b.application) {
            let application = &wanted[0].application;
            let store = match open_store(&base, application, options.fresh) {
                Ok(store) => store,
                Err(error) => {
                    say(environment, not_kept(application, &error));
                    continue;
                }
            };
            for one in wanted {
                let mut component = components[one.component].enter(SETUP_TOKEN, Duration::ZERO);
                let component = component.as_deref_mut();
                kept.extend(component.and_then(|it| one.open(&store, it, environment)));
            }
            self.stores.push(store);
        }
        if !kept.is_empty() {
            self.writer = Some(Writer::start(kept, Arc::clone(environment))?);
        }
        Ok(())
    }

    /// The run ends in order: nothing of it is to be restored.
    pub(super) fn end(&mut self, environment: &Environment) {
        let writer = self.writer.take();
        if !writer.is_none_or(|writer| writer.stop(LAST_WRITING_LIMIT)) {
            let message = "the disk did not take the last checkpoint in time: the next run may go on \
                           from it";
            say(environment, message.to_owned());
        }
        for store in self.stores.drain(..) {
            if let Err(error) = store.clear() {
                let message = format!(
                    "checkpoints of this run cannot be removed, the next one would go on from them \
                     (--fresh ignores them): {error}"
                );
                say(environment, message);
            }
        }
    }
}

impl Wanted {
    /// Leaves to the component what is there, and says where its copies go.
    fn open(
        &self,
        store: &Store,
        component: &mut Component,
        environment: &Environment,
    ) -> Option<Kept> {
        let size = component.registered_bytes();
        if size.is_some_and(|size| size > LARGEST_MEMORY) {
            let reason = format!("its memory is larger than {LARGEST_MEMORY} bytes");
            say(environment, not_kept(&self.name, &reason));
            return None;
        }
        let libraries = match self.identities() {
            Ok(libraries) => libraries,
            Err(error) => {
                say(environment, not_kept(&self.name, &error));
                return None;
            }
        };
        let origin = Origin {
            application: self.application.clone(),
            component: self.name.clone(),
            library: libraries.first()?.clone(),
        };
        let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
        let mut slots = store.slots(&self.name);
        let found = slots.find(&origin, size, now.unwrap_or_default(), self.max_age);
        self.leave(found, component, environment);
        let (sender, receiver) = handover(size.unwrap_or(0));
        component.persist_checkpoints(sender);
        Some(Kept {
            receiver,
            slots,
            record: Record::new(origin),
            libraries,
            failing: false,
        })
    }

    fn leave(&self, found: Found, component: &mut Component, environment: &Environment) {
        let instead = match &found.fit {
            Some(_) => "the previous one is used".to_owned(),
            None => format!("'{}' begins anew", component.name()),
        };
        for refused in &found.refused {
            say(environment, format!("{refused}; {instead}"));
        }
        if let Some((record, age)) = found.fit {
            component.set_inheritance(Inheritance {
                incarnation: record.incarnation,
                sequence: record.sequence,
                age,
                memory: record.memory,
            });
        }
    }

    fn identities(&self) -> io::Result<Vec<LibraryIdentity>> {
        let identity = |path: &PathBuf| {
            let name = path.file_name().unwrap_or_default();
            let content = std::fs::read(path)?;
            Ok(LibraryIdentity::of(
                name.to_string_lossy().into_owned(),
                &content,
            ))
        };
        self.libraries.iter().map(identity).collect()
    }
}

/// The folder of an application, without what a run that died has left if that is not wanted.
fn open_store(base: &Path, application: &str, fresh: bool) -> Result<Store, StoreError> {
    let store = Store::open(base, application)?;
    if fresh {
        store.clear()?;
    }
    Ok(store)
}

fn libraries(factory: &Factory) -> Vec<PathBuf> {
    let variants = factory.variants().iter();
    variants.map(|variant| variant.path.clone()).collect()
}

fn not_kept(whose: &str, reason: &impl std::fmt::Display) -> String {
    format!("the state of '{whose}' is lost with the container: {reason}")
}

fn say(environment: &Environment, message: String) {
    let now_ns = environment.clock.now_ns();
    environment.events.record(now_ns, Event::Notice { message });
}
