//! Components that other robots send before a run, and where profiles and libraries are looked for
//! with them.
//!
//! What was sent lies in a folder of this run's own, which nobody else may enter, behind all other
//! folders of the search, and is removed with the run: no later run finds code that nobody has
//! checked since. Nothing is written before all that is needed has come and was found to be good.

mod folder;

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use container::assembly::LibraryOptions;
use container::library::LibrarySearch;
use indicatif::ProgressBar;
use robot_network::package::{Package, TrustedKeys};
use robot_network::{OpenOptions, Visitor};
use system_model::network::NetworkSecurity;
use system_model::profile::{FetchProfile, Located, NetworkProfile, Profile};
use system_profile::{Document, Severity, find_component, read_profile};

use super::applications::not_started;
use super::{ClockArgument, Failed, RunArguments, exit_code, library_folders};
use crate::commands::package::fetch::{Deadlines, NotSent, ask, give_away};
use crate::commands::package::files::{checked, trusted_keys, unpack};
use folder::PrivateFolder;

/// A robot that is asked counts as lost when it was silent for so long.
const SILENCE_LIMIT: Duration = Duration::from_secs(10);
/// How often a person sees that something is waited for.
const TICK: Duration = Duration::from_millis(100);

/// Where profiles and libraries of a run are.
pub(super) struct Places {
    /// Folders with profiles: those given, then those of components that were sent.
    pub(super) search_path: Vec<PathBuf>,
    /// Folders of components that were sent.
    pub(super) sent: Vec<PathBuf>,
    library_path: Vec<PathBuf>,
    _folder: Option<PrivateFolder>,
}

impl Places {
    /// Fetches what the applications want from other robots and this one lacks. In simulated time no
    /// network is entered; a container that is supervised takes what its parent has fetched.
    ///
    /// # Errors
    /// When a component does not come, or is refused.
    pub(super) fn gather(arguments: &RunArguments) -> Result<Self, Failed> {
        let mut sent = arguments.supervision.sent.clone();
        let mut packages = Vec::new();
        if arguments.clock == ClockArgument::Real && !arguments.supervision.has_parent() {
            for file in &arguments.applications {
                packages.extend(fetch_for(file, arguments)?);
            }
        }
        let folder = match packages.is_empty() {
            true => None,
            false => Some(PrivateFolder::new()?),
        };
        if let Some(folder) = &folder {
            for package in &packages {
                let into = folder.path().join(&package.manifest.component);
                unpack(package, &into)?;
                sent.push(into);
            }
        }
        let behind = |first: Vec<PathBuf>| first.into_iter().chain(sent.iter().cloned()).collect();
        Ok(Self {
            search_path: behind(arguments.search_path.clone()),
            library_path: behind(library_folders(&arguments.library_path)),
            sent,
            _folder: folder,
        })
    }

    /// Where libraries are found and how they are probed.
    pub(super) fn libraries(&self) -> LibraryOptions {
        LibraryOptions {
            search: LibrarySearch::new(self.library_path.clone()),
            executable: std::env::current_exe().ok(),
        }
    }
}

/// The packages of what an application lacks. Mistakes of its file are for its reader to say.
fn fetch_for(file: &Path, arguments: &RunArguments) -> Result<Vec<Package>, Failed> {
    let document = Document::open(file);
    let network = match read_profile(&document) {
        Some(Profile::Application(profile)) if !document.has_errors() => profile.network,
        _ => None,
    };
    let Some(network) = network else {
        return Ok(Vec::new());
    };
    let is_lacking = |fetch: &&FetchProfile| !is_here(file, &fetch.component.value, arguments);
    let lacking: Vec<&FetchProfile> = network.fetches.iter().filter(is_lacking).collect();
    if lacking.is_empty() {
        return Ok(Vec::new());
    }
    let fetching = Fetching {
        document: &document,
        network: &network,
    };
    let keys = lacking.iter().map(|fetch| fetching.keys(fetch));
    let keys: Vec<TrustedKeys> = keys.collect::<Result<_, _>>()?;
    let visitor = fetching.enter()?;
    let lacking = lacking.into_iter().zip(&keys);
    let packages = lacking.map(|(fetch, keys)| fetching.fetch(&visitor, fetch, keys));
    packages.collect()
}

/// Whether profile and library of a component are found by the usual search.
fn is_here(file: &Path, component: &str, arguments: &RunArguments) -> bool {
    let reference = format!("{component}.xml");
    let Some(path) = find_component(file, &reference, &arguments.search_path) else {
        return false;
    };
    let library = match read_profile(&Document::open(&path)) {
        Some(Profile::Component(profile)) => profile.environment.library_name,
        _ => None,
    };
    // A profile without a library is a mistake, which its reader says.
    library.is_none_or(|library| {
        let folders = library_folders(&arguments.library_path);
        let beside = path.parent().map(PathBuf::from);
        let search = LibrarySearch::new(folders).preceded_by(beside);
        search.find(&library.value).is_ok()
    })
}

/// What an application wants from other robots.
struct Fetching<'run> {
    document: &'run Document,
    network: &'run NetworkProfile,
}

impl Fetching<'_> {
    fn keys(&self, fetch: &FetchProfile) -> Result<TrustedKeys, Failed> {
        trusted_keys(&self.beside(&fetch.key)).map_err(|failed| {
            let help = "write public keys into it that `steadfast package key` prints, one a line";
            self.refused(fetch, &fetch.key, (failed.code, &failed.text), help)
        })
    }

    fn enter(&self) -> Result<Visitor, Failed> {
        let network = self.network;
        let visitor = Visitor::enter(&OpenOptions {
            robot: network.robot.value.clone(),
            incarnation: 1,
            listen: network.listen.clone(),
            connect: network.connect.clone(),
            scouting: network.scouting,
            silence_limit: SILENCE_LIMIT,
            security: self.security(),
        });
        visitor.map_err(|error| Failed {
            code: exit_code::SYSTEM,
            text: error.to_string(),
        })
    }

    /// The same as the robot's own when it runs.
    fn security(&self) -> Option<NetworkSecurity> {
        let tls = self.network.tls.as_ref()?;
        let allowed = self.network.allowed.iter();
        Some(NetworkSecurity {
            certificate: self.beside(&tls.certificate),
            private_key: self.beside(&tls.private_key),
            authority: self.beside(&tls.authority),
            allowed: allowed.map(|robot| robot.value.clone()).collect(),
        })
    }

    /// A file as the application names it.
    fn beside(&self, file: &Located<String>) -> PathBuf {
        let folder = self.document.path().parent().unwrap_or(Path::new(""));
        folder.join(&file.value)
    }

    fn fetch(
        &self,
        visitor: &Visitor,
        fetch: &FetchProfile,
        keys: &TrustedKeys,
    ) -> Result<Package, Failed> {
        let (component, robot) = (&fetch.component.value, &fetch.robot.value);
        let end = Instant::now() + fetch.limit;
        let deadlines = Deadlines {
            seen: end,
            sent: end,
        };
        let waiting = ProgressBar::new_spinner().with_message(format!("{component} from {robot}"));
        waiting.enable_steady_tick(TICK);
        let bytes = ask(visitor, robot, component, deadlines);
        waiting.finish_and_clear();
        let bytes = bytes.map_err(|error| self.not_sent(fetch, &error))?;
        let package = checked(&bytes, keys, Some(component)).map_err(|reason| {
            let help = "nothing of it was written or loaded; name the right robot and key, or put the \
                        component on this robot by hand";
            self.refused(fetch, &fetch.component, (exit_code::PROFILE, &reason), help)
        })?;
        let manifest = &package.manifest;
        // If nobody reads it the run goes on all the same.
        let _unread = writeln!(
            io::stderr(),
            "{component} {} has come from robot {robot}, signed by a trusted key; library {}",
            manifest.version,
            manifest.library_sha256
        );
        Ok(package)
    }

    fn not_sent(&self, fetch: &FetchProfile, error: &NotSent) -> Failed {
        let robot = &fetch.robot.value;
        let limit_ms = fetch.limit.as_millis();
        let not_there = format!(
            "does it run with a <network>, and do addresses lead from one to the other? within=\"…\" \
             waits longer than {limit_ms} ms"
        );
        let (code, reason, help) = match error {
            NotSent::Absent => (
                exit_code::FILE,
                format!("it has not answered within {limit_ms} ms"),
                not_there,
            ),
            NotSent::Late => (
                exit_code::FILE,
                format!("it has not sent all of it within {limit_ms} ms"),
                "is the connection slow? within=\"…\" waits longer".to_owned(),
            ),
            NotSent::NotGiven => (
                exit_code::PROFILE,
                "it gives away no such package".to_owned(),
                format!("on '{robot}': {}", give_away(&fetch.component.value)),
            ),
            NotSent::Network(error) => (exit_code::SYSTEM, error.to_string(), not_there),
        };
        self.refused(fetch, &fetch.robot, (code, &reason), &help)
    }

    /// The start that is refused because of a component.
    fn refused(
        &self,
        fetch: &FetchProfile,
        place: &Located<String>,
        (code, reason): (u8, &str),
        help: &str,
    ) -> Failed {
        let (component, robot) = (&fetch.component.value, &fetch.robot.value);
        let message = format!("`{component}` cannot be taken from robot `{robot}`: {reason}");
        let document = self.document;
        document.report(Severity::Error, place, message, Some(help.to_owned()));
        let text = not_started(&[document.path().to_owned()], &document.problems()).text;
        Failed { code, text }
    }
}
