//! The files of one application, each opened once.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use system_model::profile::Profile;

use crate::document::Document;
use crate::problem::Problem;
use crate::readers::read_profile;

/// One file and the profile it holds.
#[derive(Debug)]
pub(crate) struct LoadedFile {
    pub(crate) document: Document,
    pub(crate) profile: Option<Profile>,
    /// The path without symbolic links, by which a file is known.
    pub(crate) identity: PathBuf,
}

/// All files opened so far.
#[derive(Debug, Default)]
pub(crate) struct Files {
    positions: BTreeMap<PathBuf, usize>,
    opened: Vec<Rc<LoadedFile>>,
}

impl Files {
    /// Opens and reads a file, or returns it if it was opened before under any name.
    pub(crate) fn open(&mut self, path: &Path) -> Rc<LoadedFile> {
        let identity = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        if let Some(position) = self.positions.get(&identity) {
            return Rc::clone(&self.opened[*position]);
        }
        let document = Document::open(path);
        let profile = read_profile(&document);
        let file = Rc::new(LoadedFile {
            document,
            profile,
            identity: identity.clone(),
        });
        self.positions.insert(identity, self.opened.len());
        self.opened.push(Rc::clone(&file));
        file
    }

    /// The files in the order they were opened.
    pub(crate) fn in_order(&self) -> &[Rc<LoadedFile>] {
        &self.opened
    }

    /// The problems of all files, file by file.
    pub(crate) fn problems(&self) -> Vec<Problem> {
        let problems = self.opened.iter().map(|file| file.document.problems());
        problems.flatten().collect()
    }

    /// Whether any file has an error.
    pub(crate) fn have_errors(&self) -> bool {
        self.opened.iter().any(|file| file.document.has_errors())
    }
}
