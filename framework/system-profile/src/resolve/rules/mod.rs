//! From rules as they are written to the rules of an application: inline elements and rule files
//! merged, every name resolved, everything checked that can be known before libraries are loaded.
//!
//! Left to whoever loads the libraries, because only they know: whether a data type has the field
//! that a rule names, whether a component with a `backup` registers any memory, and whether the
//! model of a `process_model` is there.

pub(super) mod applications;
mod components;
mod dependencies;
mod executions;
mod inline;
mod limits;
mod merge;
mod monitors;
mod names;
mod port_checks;
mod secondaries;

use std::path::PathBuf;
use std::rc::Rc;

use system_model::profile::{ComponentProfile, CompositeProfile, Located, Profile, Subcomponent};
use system_model::rules::FaultRules;
use system_model::specification::{ApplicationSpecification, Place};

use super::{Assembly, LoadOptions, LoadedFile};
use crate::problem::{Problem, Severity};
use crate::readers::rules::{DeclaredRules, RULES_ROOT};
use crate::readers::{PROFILE_ROOTS, rules as reader};
use crate::suggest::quoted;
use applications::Applications;
use names::Names;

/// Where a component of an application comes from.
#[derive(Debug)]
pub(super) struct Site {
    /// The file of its profile.
    pub(super) profile: Rc<LoadedFile>,
    /// The application or composite that names it.
    pub(super) holder: Rc<LoadedFile>,
    /// As what it is named there.
    pub(super) subcomponent: Subcomponent,
    /// What its name begins with, for a member of a composite.
    pub(super) prefix: String,
}

/// What came of loading rules.
#[derive(Debug)]
pub struct RulesOutcome {
    /// The rules, if nothing about them is an error.
    pub rules: Option<FaultRules>,
    /// All problems of the rules, wherever they stand. Those that [`load_application`] reports are
    /// not repeated.
    ///
    /// [`load_application`]: crate::load_application
    pub problems: Vec<Problem>,
}

/// Loads the rules of an application: those that stand inline in its profiles, and those of
/// `rule_files`, which win over them. A file of the list is a rule file (`fault_rules`) or a system
/// file (`system_config`) with its `dependency` elements.
///
/// What can be known without loading a library is checked here. Three things cannot: whether a data
/// type has the field that a rule names, whether a component with a `backup` registers any memory,
/// and whether the model of a `process_model` is there.
///
/// Secondaries are looked up beside the rule file, where the application's own components are, and
/// in the search paths.
///
/// ```no_run
/// use system_profile::{LoadOptions, load_application, load_rules};
///
/// let options = LoadOptions::default();
/// let loaded = load_application("applications/patrol.xml".as_ref(), &options);
/// if let Some(application) = &loaded.specification {
///     let outcome = load_rules(application, &["rules/patrol.xml".into()], &options);
///     for problem in &outcome.problems {
///         eprintln!("{}: {problem}", problem.place);
///     }
/// }
/// ```
pub fn load_rules(
    application: &ApplicationSpecification,
    rule_files: &[PathBuf],
    options: &LoadOptions,
) -> RulesOutcome {
    let mut assembly = Assembly::new(options);
    let file = assembly.files.open(&application.file);
    if let Some(Profile::Application(profile)) = &file.profile {
        let _opens_all_files = assembly.application(&file, profile);
    }
    let facts = |problem: &Problem| (problem.place.clone(), problem.message.clone());
    let reported: Vec<(Place, String)> = assembly.files.problems().iter().map(facts).collect();
    let files = rule_files.iter().map(|path| assembly.files.open(path));
    let files: Vec<_> = files.collect();
    let rules = resolve(&mut assembly, application, &files);
    let mut problems = assembly.files.problems();
    problems.retain(|problem| !reported.contains(&facts(problem)));
    let sound = problems
        .iter()
        .all(|problem| problem.severity != Severity::Error);
    RulesOutcome {
        rules: sound.then_some(rules),
        problems,
    }
}

/// Merges and resolves all rules of an application, and reports what is wrong with them.
fn resolve(
    assembly: &mut Assembly<'_>,
    application: &ApplicationSpecification,
    files: &[Rc<LoadedFile>],
) -> FaultRules {
    let inline = inline::read(assembly, application);
    let mut declared: Vec<DeclaredRules> = Vec::new();
    let mut seen: Vec<&Rc<LoadedFile>> = Vec::new();
    for file in files {
        if seen.iter().any(|other| other.identity == file.identity) {
            continue;
        }
        seen.push(file);
        declared.extend(read(file, application));
    }
    resolve_declared(assembly, application, inline, declared)
}

fn resolve_declared(
    assembly: &mut Assembly<'_>,
    application: &ApplicationSpecification,
    inline: DeclaredRules,
    declared: Vec<DeclaredRules>,
) -> FaultRules {
    let applications = Applications::new(assembly, application);
    let names = Names::new(application, applications);
    let merged = merge::merge(assembly, &names, inline, declared);
    components::finish(assembly, &names, merged)
}

/// The rules that one of the files given holds.
fn read(file: &Rc<LoadedFile>, application: &ApplicationSpecification) -> Option<DeclaredRules> {
    let document = &file.document;
    let root = document.root(&PROFILE_ROOTS)?;
    match (root.name(), &file.profile) {
        (RULES_ROOT, _) => {
            let rules = reader::read(&root)?;
            if rules.application.value != application.name && !rules.application.value.is_empty() {
                document.report(
                    Severity::Error,
                    &rules.application,
                    format!(
                        "these are rules of `{}`, not of `{}`",
                        quoted(&rules.application.value),
                        quoted(&application.name)
                    ),
                    Some(format!(
                        "write application=\"{}\"",
                        quoted(&application.name)
                    )),
                );
                return None;
            }
            Some(rules)
        }
        (_, Some(Profile::System(_))) => Some(inline::system(&root)),
        _ => {
            document.report_root(
                format!("<{}> holds no rules", quoted(root.name())),
                "name a file whose outermost element is fault_rules or system_config",
            );
            None
        }
    }
}

/// Reports everything about a rule file that can be known: with its application, if that is found.
pub(crate) fn check_rule_file(assembly: &mut Assembly<'_>, file: &Rc<LoadedFile>) {
    let Some(root) = file.document.root(&[RULES_ROOT]) else {
        return;
    };
    let Some(declared) = reader::read(&root) else {
        return;
    };
    let name = declared.application.clone();
    if name.value.is_empty() {
        return;
    }
    applications::with_application(assembly, file, &name, |assembly, specification| {
        resolve(assembly, specification, std::slice::from_ref(file));
    });
}

/// Reports what is wrong with the inline rules of an application that has just been assembled.
pub(crate) fn check_inline(assembly: &mut Assembly<'_>, application: &ApplicationSpecification) {
    resolve(assembly, application, &[]);
}

/// Reports what is wrong with the inline rules of a component profile, whoever may use it.
pub(crate) fn check_component(
    assembly: &mut Assembly<'_>,
    file: &Rc<LoadedFile>,
    profile: &ComponentProfile,
) {
    let name = profile.header.name.clone();
    let subcomponent = Subcomponent {
        name: name.clone(),
        reference: Located::default(),
        node: String::new(),
        properties: Vec::new(),
    };
    let component = super::instances::component(profile, &subcomponent, name.value.clone(), "");
    let Some(mut rules) = inline::profile(file, &name) else {
        return;
    };
    // Other components are known only to an application.
    rules.dependencies.clear();
    rules.monitors.clear();
    rules.votings.clear();
    let application = ApplicationSpecification {
        name: String::new(),
        file: profile.header.file.clone(),
        components: vec![component],
        connections: Vec::new(),
        manager_connections: Vec::new(),
        coordination: Vec::new(),
        world: None,
        trees: Vec::new(),
    };
    assembly.sites.push(Site {
        profile: Rc::clone(file),
        holder: Rc::clone(file),
        subcomponent,
        prefix: String::new(),
    });
    let mut inline = DeclaredRules::default();
    inline.take(rules);
    resolve_declared(assembly, &application, inline, Vec::new());
}

/// Reports what is wrong with the voters in a composite as such; what they name is known only to an
/// application.
pub(crate) fn check_composite(file: &LoadedFile, profile: &CompositeProfile) {
    if let Some(root) = file.document.root(&PROFILE_ROOTS) {
        reader::composite_elements(&root, &profile.header.name, "");
    }
}

/// Reports what is wrong with the dependencies in a system file.
pub(crate) fn check_system(assembly: &mut Assembly<'_>, file: &Rc<LoadedFile>) {
    let Some(root) = file.document.root(&PROFILE_ROOTS) else {
        return;
    };
    let declared = inline::system(&root);
    let application = ApplicationSpecification {
        name: String::new(),
        file: file.document.path().to_owned(),
        components: Vec::new(),
        connections: Vec::new(),
        manager_connections: Vec::new(),
        coordination: Vec::new(),
        world: None,
        trees: Vec::new(),
    };
    resolve_declared(
        assembly,
        &application,
        DeclaredRules::default(),
        vec![declared],
    );
}

impl Assembly<'_> {
    /// Reports a problem with the word at a place of any file that was opened.
    pub(super) fn report_at(
        &self,
        severity: Severity,
        place: &Place,
        message: impl Into<String>,
        help: impl Into<String>,
    ) {
        let mut files = self.files.in_order().iter();
        if let Some(file) = files.find(|file| file.document.path() == place.file) {
            let document = &file.document;
            document.report_at(severity, place, message, Some(help.into()));
        }
    }
}
