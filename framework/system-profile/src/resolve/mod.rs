//! From an application profile to the specification that the container assembles: references
//! followed, composites flattened, every name resolved, all problems of all files collected.

mod connections;
mod coordination;
mod files;
pub(crate) mod injections;
mod instances;
mod manager;
mod missions;
mod network;
mod ports;
mod references;
pub(crate) mod rules;

use std::path::{Path, PathBuf};
use std::rc::Rc;

use behavior_tree::Plan;
use system_model::network::NetworkSpecification;
use system_model::profile::{ApplicationProfile, CompositeProfile, FetchProfile, Profile};
use system_model::specification::{
    ApplicationSpecification, ComponentSpecification, ManagerConnection,
};

use crate::check::FileReport;
use crate::problem::{Problem, Severity};
use crate::suggest;
use connections::Wire;
use coordination::Edge;
pub(crate) use files::{Files, LoadedFile};
pub use injections::{InjectionsOutcome, load_injections, read_injection};
pub(crate) use references::Sibling;
pub use references::find_component;
use rules::Site;
pub use rules::{RulesOutcome, load_rules};

/// Where references are looked up, and how a dangling one is taken.
#[derive(Debug, Clone)]
pub struct LoadOptions {
    /// Folders that are searched after the folder of the referring file and its siblings.
    pub search_paths: Vec<PathBuf>,
    /// What a reference to a file that is not there is: an error for a run, a warning for a check.
    pub dangling: Severity,
}

impl Default for LoadOptions {
    fn default() -> Self {
        Self {
            search_paths: Vec::new(),
            dangling: Severity::Error,
        }
    }
}

/// What came of loading an application.
#[derive(Debug)]
pub struct LoadOutcome {
    /// The application, if no file has an error and no reference dangles.
    pub specification: Option<ApplicationSpecification>,
    /// The robot's place in the network, if the application has one; as sound as the specification.
    pub network: Option<NetworkSpecification>,
    /// The plans of its behaviour trees, in the order of the specification.
    pub plans: Vec<Plan>,
    /// All problems of all files involved, file by file in the order they were opened.
    pub problems: Vec<Problem>,
}

/// Loads an application and everything that it refers to.
///
/// References are looked up in the folder of the file that has them, in the folder `components`
/// (for a world `worlds`) beside that folder, and in the search paths. They may not leave these
/// folders.
pub fn load_application(path: &Path, options: &LoadOptions) -> LoadOutcome {
    let mut assembly = Assembly::new(options);
    let file = assembly.files.open(path);
    let specification = match &file.profile {
        Some(Profile::Application(profile)) => assembly.application(&file, profile),
        // A world is no profile, and a file with an unknown root has been reported.
        _ if file.profile.is_some() || !file.document.has_errors() => {
            let root = file.document.tree().map(|root| root.name.as_str());
            let root = suggest::quoted(root.unwrap_or_default());
            file.document.report_root(
                format!("<{root}> is no application"),
                "name a file whose outermost element is package_profile or application_profile",
            );
            None
        }
        _ => None,
    };
    let mut problems = assembly.files.problems();
    let reports = assembly.tree_files.iter();
    problems.extend(reports.flat_map(|report| report.problems.iter().cloned()));
    LoadOutcome {
        specification: specification.filter(|_| assembly.is_sound()),
        network: assembly.network.take().filter(|_| assembly.is_sound()),
        plans: std::mem::take(&mut assembly.plans),
        problems,
    }
}

/// An application under assembly.
#[derive(Debug)]
pub(crate) struct Assembly<'o> {
    options: &'o LoadOptions,
    pub(crate) files: Files,
    components: Vec<ComponentSpecification>,
    wires: Vec<Wire>,
    manager_connections: Vec<ManagerConnection>,
    edges: Vec<Edge>,
    open_composites: Vec<PathBuf>,
    instances: usize,
    dangling: bool,
    /// Components that other robots send.
    fetches: Vec<FetchProfile>,
    network: Option<NetworkSpecification>,
    /// Where each of the components comes from, in the same order.
    sites: Vec<Site>,
    /// The composites that were expanded, and what the names of their members begin with.
    expanded: Vec<(Rc<LoadedFile>, String)>,
    /// The behaviour trees' plans, and the files that they come from.
    plans: Vec<Plan>,
    pub(crate) tree_files: Vec<FileReport>,
}

impl<'o> Assembly<'o> {
    pub(crate) fn new(options: &'o LoadOptions) -> Self {
        Self {
            options,
            files: Files::default(),
            components: Vec::new(),
            wires: Vec::new(),
            manager_connections: Vec::new(),
            edges: Vec::new(),
            open_composites: Vec::new(),
            instances: 0,
            dangling: false,
            fetches: Vec::new(),
            network: None,
            sites: Vec::new(),
            expanded: Vec::new(),
            plans: Vec::new(),
            tree_files: Vec::new(),
        }
    }

    /// Assembles an application as far as its problems allow.
    pub(crate) fn application(
        &mut self,
        file: &Rc<LoadedFile>,
        profile: &ApplicationProfile,
    ) -> Option<ApplicationSpecification> {
        let network = profile.network.as_deref();
        self.fetches = network.map_or_else(Vec::new, |network| network.fetches.clone());
        let scope = self.members(file, &profile.subcomponents, "", "");
        self.connect(&scope, &profile.connections);
        self.coordinate(&scope, &profile.coordination);
        let beside = profile.header.file.parent().unwrap_or(Path::new(""));
        self.network = network.map(|network| self.network(&scope, network, beside));
        let world = profile
            .world
            .as_ref()
            .map(|reference| self.find(file, reference, Sibling::Worlds));
        connections::check(&self.wires);
        coordination::check(&self.edges, &self.components);
        let trees = self.trees(file, &profile.trees);
        if matches!(world, Some(None)) {
            return None;
        }
        Some(ApplicationSpecification {
            name: profile.header.name.value.clone(),
            file: profile.header.file.clone(),
            components: std::mem::take(&mut self.components),
            manager_connections: std::mem::take(&mut self.manager_connections),
            connections: self.wires.drain(..).map(|wire| wire.connection).collect(),
            coordination: self.edges.drain(..).map(|edge| edge.ends).collect(),
            world: world.flatten(),
            trees,
        })
    }

    /// Assembles a composite for its problems' sake.
    pub(crate) fn composite(&mut self, file: &Rc<LoadedFile>, profile: &CompositeProfile) {
        self.open_composites.push(file.identity.clone());
        let _exports = self.expand(file, profile, "", "");
        connections::check(&self.wires);
        coordination::check(&self.edges, &self.components);
    }

    fn is_sound(&self) -> bool {
        !self.dangling && !self.files.have_errors()
    }
}
