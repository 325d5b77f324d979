//! What `check` says of a file: its own problems and, for applications and composites, those that
//! show only when everything they refer to is opened.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use serde_json::Value;
use system_model::profile::{ComponentProfile, Profile};

use crate::problem::Problem;
use crate::readers::injection::INJECTIONS_ROOT;
use crate::readers::rules::RULES_ROOT;
use crate::reading::reading;
use crate::resolve::{Assembly, LoadOptions, LoadedFile, Sibling, injections, rules};

/// What was found in one file.
#[derive(Debug)]
pub struct FileReport {
    /// The file, as it was named or found.
    pub path: PathBuf,
    /// The SHA-256 of its bytes in hexadecimal, if they could be read.
    pub sha256: Option<String>,
    /// Whether the file could be opened and decoded.
    pub readable: bool,
    /// Its problems, sorted by place.
    pub problems: Vec<Problem>,
    /// Its facts; see [`reading`](crate::reading()).
    pub reading: Value,
}

/// Checks a file. The first report is about the file itself; one more follows for each file that it
/// refers to and that has problems of its own.
pub fn check_file(path: &Path, options: &LoadOptions) -> Vec<FileReport> {
    let mut assembly = Assembly::new(options);
    let file = assembly.files.open(path);
    match &file.profile {
        Some(Profile::Application(profile)) => {
            if let Some(specification) = assembly.application(&file, profile) {
                rules::check_inline(&mut assembly, &specification);
            }
        }
        Some(Profile::Composite(profile)) => {
            assembly.composite(&file, profile);
            rules::check_composite(&file, profile);
        }
        Some(Profile::Component(profile)) => {
            look_up_types(&mut assembly, &file, profile);
            rules::check_component(&mut assembly, &file, profile);
        }
        Some(Profile::System(_)) => rules::check_system(&mut assembly, &file),
        None if file.document.root_name() == Some(RULES_ROOT) => {
            rules::check_rule_file(&mut assembly, &file);
        }
        None if file.document.root_name() == Some(INJECTIONS_ROOT) => {
            injections::check_file(&mut assembly, &file);
        }
        _ => {}
    }
    let mut reports = vec![report(&file)];
    let others = assembly.files.in_order().iter().skip(1).map(report);
    reports.extend(others.filter(|report| !report.problems.is_empty()));
    let trees = assembly.tree_files.into_iter();
    reports.extend(trees.filter(|report| !report.problems.is_empty()));
    reports
}

/// Files that describe types are not opened: the component works without them.
fn look_up_types(assembly: &mut Assembly<'_>, file: &Rc<LoadedFile>, profile: &ComponentProfile) {
    for reference in &profile.service_type_files {
        assembly.find(file, reference, Sibling::Services);
    }
    for reference in &profile.data_type_files {
        assembly.find(file, reference, Sibling::DataTypes);
    }
}

fn report(file: &Rc<LoadedFile>) -> FileReport {
    let document = &file.document;
    FileReport {
        path: document.path().to_owned(),
        sha256: document.sha256().map(str::to_owned),
        readable: document.is_readable(),
        problems: document.problems(),
        reading: reading(document),
    }
}
