//! Applications by name: each is the file of its name.

use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use system_model::profile::{Located, Profile};
use system_model::specification::ApplicationSpecification;

use crate::problem::Severity;
use crate::resolve::{Assembly, LoadedFile};
use crate::suggest::quoted;

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

/// Calls `then` with the application that a rule file or an injection file is about. Where that
/// cannot be had, a warning says that the file was checked alone.
pub(in crate::resolve) fn with_application(
    assembly: &mut Assembly<'_>,
    file: &Rc<LoadedFile>,
    name: &Located<String>,
    then: impl FnOnce(&mut Assembly<'_>, &ApplicationSpecification),
) {
    let alone = |why: String| {
        file.document.report(
            Severity::Warning,
            name,
            format!("{why}; only this file alone was checked"),
            Some("put the application's folder on the search path, or mend it first".into()),
        );
    };
    let Some(path) = find(assembly, file, &name.value) else {
        let wanted = quoted(&name.value);
        return alone(format!("there is no application `{wanted}` ({wanted}.xml)"));
    };
    let found = assembly.files.open(&path);
    let Some(Profile::Application(profile)) = &found.profile else {
        return alone(format!("{} is no application", path.display()));
    };
    let specification = assembly.application(&found, profile);
    let mut others = assembly.files.in_order().iter();
    let sound = !assembly.dangling
        && others.all(|other| Rc::ptr_eq(other, file) || !other.document.has_errors());
    match specification {
        Some(specification) if sound => then(assembly, &specification),
        _ => alone(format!("{} has problems of its own", path.display())),
    }
}

/// The file of the application of a name, seen from a rule file.
fn find(assembly: &Assembly<'_>, rules: &Rc<LoadedFile>, name: &str) -> Option<PathBuf> {
    let mut folders = candidates(rules.document.path());
    folders.extend(assembly.options.search_paths.iter().cloned());
    find_in(&folders, name)
}

/// Where applications stand, seen from a rule file or a system file. Rules may lie in folders of
/// their own, two deep: `rules/scenarios/unplugged_sonar/`.
fn candidates(file: &Path) -> Vec<PathBuf> {
    let own = parent(file);
    let folders = ["", "..", "../.."].map(|up| own.join(up));
    let beside = folders.iter().flat_map(|folder| {
        ["../profiles/applications", "../applications"].map(|name| folder.join(name))
    });
    std::iter::once(own.clone()).chain(beside).collect()
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
