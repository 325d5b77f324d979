//! From a file of behaviour trees, with all that it includes, to a plan that can be ticked.

use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};

use behavior_tree::definition::{Include, TreeFile};
use behavior_tree::{CompileOptions, Finding, Library, Plan};
use serde_json::json;

use crate::check::FileReport;
use crate::document::Document;
use crate::problem::Severity;
use crate::readers::behavior_tree::read;
use crate::suggest;

/// A file includes others, which include others; more are a mistake.
const MAX_FILES: usize = 1000;

/// How trees are loaded.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TreeOptions {
    /// How they are compiled.
    pub compile: CompileOptions,
    /// Files whose trees and models are known, too.
    pub models: Vec<PathBuf>,
    /// The tree to execute; none for that which the file names, or its only one.
    pub main: Option<String>,
}

/// What became of a file of trees.
#[derive(Debug)]
pub struct TreeOutcome {
    /// The tree to execute, unless a file has errors or does not say which it is.
    pub plan: Option<Plan>,
    /// Why the file does not say which; empty where it does, and where nothing can be executed anyway.
    pub undecided: Option<String>,
    /// The file first, then what it includes, then the models.
    pub files: Vec<FileReport>,
}

/// Loads a file of trees and looks through all that is in it.
pub fn load_trees(path: &Path, options: &TreeOptions) -> TreeOutcome {
    load_trees_for(path, options, &|_plan| Vec::new())
}

/// As [`load_trees`], with what else somebody finds in the plan.
pub(crate) fn load_trees_for(
    path: &Path,
    options: &TreeOptions,
    look: &dyn Fn(&Plan) -> Vec<Finding>,
) -> TreeOutcome {
    let mut files = Files::default();
    files.open(path);
    let own = files.opened.len();
    for model in &options.models {
        files.open(model);
    }
    let (library, mut findings) = Library::new(files.opened.iter().filter_map(|it| it.1.as_ref()));
    findings.extend(library.check(&options.compile));
    for finding in &findings {
        files.report(finding);
    }
    let has_errors = files
        .opened
        .iter()
        .any(|(document, _)| document.has_errors());
    let (plan, undecided) = match has_errors {
        true => (None, None),
        false => match main_tree(&files.opened[..own], options) {
            Ok(id) => match library.compile(&id, &options.compile).0 {
                Some(plan) => (Some(plan), None),
                None => (None, Some(no_such_tree(&id, &library))),
            },
            Err(reason) => (None, Some(reason)),
        },
    };
    let found: Vec<Finding> = plan.iter().flat_map(look).collect();
    for finding in &found {
        files.report(finding);
    }
    TreeOutcome {
        plan: plan.filter(|_| !found.iter().any(|finding| finding.is_error)),
        undecided,
        files: files.opened.iter().map(report).collect(),
    }
}

/// Which tree is to be executed, or why that is not known.
fn main_tree(
    files: &[(Document, Option<TreeFile>)],
    options: &TreeOptions,
) -> Result<String, String> {
    let first = files.first().and_then(|(_, file)| file.as_ref());
    let said = first.and_then(|file| file.main_tree.as_ref());
    if let Some(id) = options.main.as_ref().or(said.map(|said| &said.value)) {
        return Ok(id.clone());
    }
    let trees = first.map_or(&[][..], |file| &file.trees);
    match trees {
        [tree] => Ok(tree.id.value.clone()),
        [] => Err("the file has no tree, only what others need".to_owned()),
        several => {
            let ids: Vec<&str> = several.iter().map(|tree| tree.id.value.as_str()).collect();
            Err(format!(
                "the file has several trees, and does not say which is to be executed: {}",
                ids.join(", ")
            ))
        }
    }
}

fn no_such_tree(id: &str, library: &Library<'_>) -> String {
    let help = suggest::help(id, "there are", library.tree_ids());
    let help = help.map(|help| format!(" ({help})")).unwrap_or_default();
    format!("there is no tree {}{help}", suggest::quoted(id))
}

#[derive(Default)]
struct Files {
    opened: Vec<(Document, Option<TreeFile>)>,
    known: HashSet<PathBuf>,
}

impl Files {
    /// Opens a file and all that it includes, each once.
    fn open(&mut self, path: &Path) {
        let mut waiting = vec![path.to_owned()];
        while let Some(path) = waiting.pop() {
            let identity = std::fs::canonicalize(&path).unwrap_or_else(|_| path.clone());
            if !self.known.insert(identity) {
                continue;
            }
            let document = Document::open_forgiving(&path);
            let file = read(&document);
            let folder = path.parent().unwrap_or(Path::new(""));
            for include in file.iter().flat_map(|file| &file.includes).rev() {
                if let Some(target) = included(&document, folder, include) {
                    waiting.push(target);
                }
            }
            self.opened.push((document, file));
            if self.opened.len() >= MAX_FILES {
                return;
            }
        }
    }

    /// Reports a finding in the file in which it was made.
    fn report(&self, finding: &Finding) {
        let place = &finding.at.place;
        let document = self.opened.iter().map(|(document, _)| document);
        let Some(document) = document.into_iter().find(|it| it.path() == place.file) else {
            return;
        };
        let severity = match finding.is_error {
            true => Severity::Error,
            false => Severity::Warning,
        };
        let candidates = finding.candidates.iter().map(String::as_str);
        let help = match suggest::nearest(&finding.at.value, candidates) {
            Some(near) => format!("did you mean `{near}`? Else {}", finding.help),
            None => finding.help.clone(),
        };
        document.report(severity, &finding.at, &finding.message, Some(help));
    }
}

/// The file that is included, if it is there.
fn included(document: &Document, folder: &Path, include: &Include) -> Option<PathBuf> {
    if let Some(package) = &include.ros_package {
        document.report(
            Severity::Error,
            package,
            "a file of a ROS package cannot be found without ROS",
            Some("write the path relative to this file, and no ros_pkg".into()),
        );
        return None;
    }
    let target = folder.join(&include.path.value);
    if target.is_file() {
        return Some(target);
    }
    document.report(
        Severity::Error,
        &include.path,
        format!("the included file {} is not there", target.display()),
        Some("the path is relative to the file that includes".into()),
    );
    None
}

fn report((document, file): &(Document, Option<TreeFile>)) -> FileReport {
    let mut facts = BTreeMap::from([("kind", json!("behavior_trees"))]);
    if let Some(file) = file {
        let trees = file.trees.iter().map(|tree| json!(tree.id.value));
        let models = file.models.iter().map(|model| json!(model.id.value));
        facts.insert("trees", trees.collect());
        facts.insert("models", models.collect());
    }
    FileReport {
        path: document.path().to_owned(),
        sha256: document.sha256().map(str::to_owned),
        readable: document.is_readable(),
        problems: document.problems(),
        reading: json!(facts),
    }
}
