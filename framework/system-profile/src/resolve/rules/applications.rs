//! Applications by name: each is the file of its name.

use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use system_model::profile::Profile;
use system_model::specification::ApplicationSpecification;

use crate::resolve::{Assembly, LoadedFile};

/// The applications that rules can name.
#[derive(Debug)]
pub(super) struct Applications {
    own: String,
    /// Those that a system file starts.
    deployed: Vec<String>,
    folders: Vec<PathBuf>,
    looked_up: RefCell<HashMap<String, bool>>,
}

impl Applications {
    pub(super) fn new(assembly: &Assembly<'_>, application: &ApplicationSpecification) -> Self {
        let mut folders = vec![parent(&application.file)];
        let mut deployed = Vec::new();
        for file in assembly.files.in_order() {
            if let Some(Profile::System(system)) = &file.profile {
                let names = system.deployment.applications.iter();
                deployed.extend(names.map(|name| name.value.clone()));
                folders.extend(candidates(file.document.path()));
            }
        }
        folders.extend(assembly.options.search_paths.iter().cloned());
        Self {
            own: application.name.clone(),
            deployed,
            folders,
            looked_up: RefCell::default(),
        }
    }

    /// Whether there is an application of a name.
    pub(super) fn contain(&self, name: &str) -> bool {
        if name == self.own || self.deployed.iter().any(|other| other == name) {
            return true;
        }
        let mut looked_up = self.looked_up.borrow_mut();
        *looked_up
            .entry(name.to_owned())
            .or_insert_with(|| find_in(&self.folders, name).is_some())
    }

    /// The names that are known without looking for a file.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        let own = Some(self.own.as_str()).filter(|own| !own.is_empty());
        own.into_iter()
            .chain(self.deployed.iter().map(String::as_str))
    }
}

/// The file of the application that a rule file is about.
pub(super) fn find(assembly: &Assembly<'_>, rules: &Rc<LoadedFile>, name: &str) -> Option<PathBuf> {
    let mut folders = candidates(rules.document.path());
    folders.extend(assembly.options.search_paths.iter().cloned());
    find_in(&folders, name)
}

/// Where applications stand, seen from a rule file or a system file.
fn candidates(file: &Path) -> Vec<PathBuf> {
    let own = parent(file);
    ["", "../profiles/applications", "../applications"]
        .into_iter()
        .map(|folder| own.join(folder))
        .collect()
}

fn parent(file: &Path) -> PathBuf {
    match file.parent() {
        Some(parent) if parent != Path::new("") => parent.to_owned(),
        _ => PathBuf::from("."),
    }
}

/// A name is one component of a path, so that it cannot lead anywhere else.
fn find_in(folders: &[PathBuf], name: &str) -> Option<PathBuf> {
    if name.contains(['/', '\\', '\0', ':']) || name.starts_with('.') {
        return None;
    }
    let files = folders
        .iter()
        .map(|folder| folder.join(format!("{name}.xml")));
    files
        .into_iter()
        .find(|path| path.is_file() && is_application(path))
}

/// A rule file may bear the name of its application.
fn is_application(path: &Path) -> bool {
    let document = crate::document::Document::open(path);
    matches!(
        document.root_name(),
        Some("package_profile" | "application_profile")
    )
}
