//! From a reference to the file it means, without ever leaving the search path.

use std::path::{Component, Path, PathBuf};
use std::rc::Rc;

use system_model::profile::Located;

use super::{Assembly, LoadedFile};
use crate::problem::Severity;
use crate::suggest::{self, quoted};

/// A folder has to be listed for a suggestion; one with more files than this is only begun.
const MAX_FILES_LISTED: usize = 1000;

/// The folder that is searched beside the folder of the referring file.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Sibling {
    /// `components`, for profiles of components and composites.
    Components,
    /// `worlds`, for simulated worlds.
    Worlds,
    /// `services`, for service types.
    Services,
    /// `types`, for data types.
    DataTypes,
    /// `trees`, for behaviour trees.
    Trees,
}

impl Sibling {
    fn folder(self) -> &'static str {
        match self {
            Self::Components => "components",
            Self::Worlds => "worlds",
            Self::Services => "services",
            Self::DataTypes => "types",
            Self::Trees => "trees",
        }
    }
}

impl Assembly<'_> {
    /// The file that `reference` of `file` means. A problem is reported if there is none.
    pub(crate) fn find(
        &mut self,
        file: &Rc<LoadedFile>,
        reference: &Located<String>,
        sibling: Sibling,
    ) -> Option<PathBuf> {
        if reference.value.is_empty() {
            return None;
        }
        let Some(relative) = inside(&reference.value) else {
            file.document.report(
                Severity::Error,
                reference,
                format!(
                    "`{}` is a reference outside the search path",
                    quoted(&reference.value)
                ),
                Some(
                    "references are relative and have no `..`; add a folder to the search path \
                     and name the file in it"
                        .into(),
                ),
            );
            return None;
        };
        let folders = folders(file.document.path(), sibling, &self.options.search_paths);
        let found = first_file(&relative, &folders);
        if found.is_none() {
            self.dangling = true;
            let missing = format!("there is no file `{}`", quoted(&reference.value));
            let sender = match sibling {
                Sibling::Components => self.sender(&relative),
                _ => None,
            };
            let (severity, message, help) = match sender {
                Some(robot) => (
                    fetched_later(self.options.dangling),
                    format!("{missing}; robot `{robot}` sends it"),
                    "it is fetched before a run with --clock real".to_owned(),
                ),
                None => (
                    self.options.dangling,
                    missing,
                    near_help(&relative, &folders),
                ),
            };
            let document = &file.document;
            document.report(severity, reference, message, Some(help));
        }
        found
    }

    /// The robot that sends the component with this profile.
    fn sender(&self, profile: &Path) -> Option<&str> {
        let name = profile.to_str()?.strip_suffix(".xml")?;
        let mut fetches = self.fetches.iter();
        let fetch = fetches.find(|fetch| fetch.component.value == name)?;
        Some(&fetch.robot.value)
    }
}

/// What a reference is that only a fetch satisfies: no mistake, unless the file is needed now.
fn fetched_later(dangling: Severity) -> Severity {
    match dangling {
        Severity::Error => Severity::Error,
        Severity::Warning | Severity::Note => Severity::Note,
    }
}

/// The file that a reference to a component means in an application: as a run finds it.
pub fn find_component(
    application: &Path,
    reference: &str,
    search_paths: &[PathBuf],
) -> Option<PathBuf> {
    let folders = folders(application, Sibling::Components, search_paths);
    first_file(&inside(reference)?, &folders)
}

fn first_file(relative: &Path, folders: &[PathBuf]) -> Option<PathBuf> {
    let mut candidates = folders.iter().map(|folder| folder.join(relative));
    candidates.find(|path| path.is_file())
}

fn folders(file: &Path, sibling: Sibling, search_paths: &[PathBuf]) -> Vec<PathBuf> {
    let own = match file.parent() {
        Some(parent) if parent != Path::new("") => parent.to_owned(),
        _ => PathBuf::from("."),
    };
    let beside = match own.file_name() {
        Some(_) => own.with_file_name(sibling.folder()),
        None => own.join("..").join(sibling.folder()),
    };
    let mut folders = vec![own, beside];
    folders.extend_from_slice(search_paths);
    folders
}

/// The reference as a path that stays inside whatever folder it is joined to. Profiles written on
/// Windows separate folders with `\`.
pub(super) fn inside(reference: &str) -> Option<PathBuf> {
    let reference = reference.replace('\\', "/");
    let has_drive = reference.split('/').next()?.contains(':');
    let path = PathBuf::from(&reference);
    let stays = path
        .components()
        .all(|component| matches!(component, Component::Normal(_) | Component::CurDir));
    (stays && !has_drive && !reference.contains('\0')).then_some(path)
}

/// The help line for a file that is not there: the nearest name, and where it was looked for.
pub(super) fn near_help(relative: &Path, folders: &[PathBuf]) -> String {
    let looked = folders
        .iter()
        .map(|folder| folder.display().to_string())
        .collect::<Vec<_>>()
        .join(", ");
    let wanted = relative.file_name().unwrap_or_default().to_string_lossy();
    let names: Vec<String> = folders
        .iter()
        .filter_map(|folder| std::fs::read_dir(folder).ok())
        .flat_map(|entries| entries.take(MAX_FILES_LISTED))
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .collect();
    match suggest::nearest(&wanted, names.iter().map(String::as_str)) {
        Some(near) => format!("did you mean `{near}`? looked in {looked}"),
        None => format!("looked in {looked}; add its folder to the search path"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn references_stay_inside() {
        for reference in ["a.xml", "sub/a.xml", "./a.xml", "sub\\a.xml"] {
            assert!(inside(reference).is_some(), "{reference}");
        }
        for reference in [
            "/etc/passwd",
            "../a.xml",
            "sub/../../a.xml",
            "..\\a.xml",
            "C:\\a.xml",
            "c:a.xml",
            "\\\\server\\a.xml",
            "a\0.xml",
        ] {
            assert!(inside(reference).is_none(), "{reference}");
        }
    }
}
