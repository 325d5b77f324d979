//! The libraries of an application, each found, probed once, and loaded for every instance.

use std::path::PathBuf;

use system_model::specification::ComponentSpecification;

use super::{AssemblyProblem, LibraryOptions};
use crate::library::{LoadedLibrary, probe};

/// Loads libraries; every instance gets a copy of its own: see `LoadedLibrary`.
pub(super) struct Libraries<'options> {
    options: &'options LibraryOptions,
    probed: Vec<PathBuf>,
    pub(super) problems: Vec<AssemblyProblem>,
}

impl<'options> Libraries<'options> {
    pub(super) fn new(options: &'options LibraryOptions) -> Self {
        Self {
            options,
            probed: Vec::new(),
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

    pub(super) fn load(&mut self, component: &ComponentSpecification) -> Option<LoadedLibrary> {
        let beside_profile = component.profile.parent().map(PathBuf::from);
        let search = self.options.search.preceded_by(beside_profile);
        let result = search.find(&component.library).and_then(|path| {
            if let Some(executable) = &self.options.executable
                && !self.probed.contains(&path)
            {
                probe(executable, &path)?;
                self.probed.push(path.clone());
            }
            LoadedLibrary::load(&path)
        });
        match result {
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
