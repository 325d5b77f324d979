//! The libraries of an application, each found, probed once, and loaded for every instance.

use std::path::{Path, PathBuf};

use system_model::specification::ComponentSpecification;

use super::{AssemblyProblem, LibraryOptions};
use crate::library::{LibraryError, LoadedLibrary, probe};

/// Loads libraries; every instance gets a copy of its own: see `LoadedLibrary`.
pub(super) struct Libraries<'options> {
    options: &'options LibraryOptions,
    probed: Vec<PathBuf>,
    /// The first copy of each file.
    first: Vec<LoadedLibrary>,
    pub(super) problems: Vec<AssemblyProblem>,
}

impl<'options> Libraries<'options> {
    pub(super) fn new(options: &'options LibraryOptions) -> Self {
        Self {
            options,
            probed: Vec::new(),
            first: Vec::new(),
            problems: Vec::new(),
        }
    }

    pub(super) fn load_all(
        &mut self,
        components: &[ComponentSpecification],
    ) -> Vec<Option<LoadedLibrary>> {
        components
            .iter()
            .map(|component| self.load(component))
            .collect()
    }

    /// A copy of a component's library.
    fn load(&mut self, component: &ComponentSpecification) -> Option<LoadedLibrary> {
        let loaded = self.find(component).and_then(|path| {
            if let Some(executable) = &self.options.executable
                && !self.probed.contains(&path)
            {
                probe(executable, &path)?;
                self.probed.push(path.clone());
            }
            let library = LoadedLibrary::load(&path)?;
            if self.first_of(&path).is_none() {
                self.first.push(library.clone());
            }
            Ok(library)
        });
        self.noted(component, loaded)
    }

    /// What a component's library says of itself: no instance is made of it, so a file that was
    /// loaded before is not loaded again.
    pub(super) fn look_at(&mut self, component: &ComponentSpecification) -> Option<LoadedLibrary> {
        let known = self.find(component).ok();
        let known = known.and_then(|path| self.first_of(&path).cloned());
        known.or_else(|| self.load(component))
    }

    fn find(&self, component: &ComponentSpecification) -> Result<PathBuf, LibraryError> {
        let beside_profile = component.profile.parent().map(PathBuf::from);
        let search = self.options.search.preceded_by(beside_profile);
        search.find(&component.library)
    }

    fn first_of(&self, path: &Path) -> Option<&LoadedLibrary> {
        self.first.iter().find(|library| library.path == path)
    }

    fn noted(
        &mut self,
        component: &ComponentSpecification,
        loaded: Result<LoadedLibrary, LibraryError>,
    ) -> Option<LoadedLibrary> {
        match loaded {
            Ok(library) => Some(library),
            Err(error) => {
                self.problems.push(AssemblyProblem::Library {
                    component: component.name.clone(),
                    place: component.place.clone(),
                    error: Box::new(error),
                });
                None
            }
        }
    }
}
