//! The applications of a run: their files read, their rules and injections given to the one that
//! each is about, and the problems of all files listed together.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use behavior_tree::Plan;
use container::system::Application;
use system_model::specification::ApplicationSpecification;
use system_profile::{
    Document, LoadOptions, Problem, Severity, load_application, load_injections, load_rules,
};

use super::{Failed, errors_on_terminal, exit_code, models, problems, show, tasks};

/// The files of a run.
#[derive(Debug, Clone, Copy)]
pub(in crate::commands) struct Sources<'run> {
    /// Application profiles.
    pub(in crate::commands) applications: &'run [PathBuf],
    /// Fault rules.
    pub(in crate::commands) rules: &'run [PathBuf],
    /// Faults that are made on purpose.
    pub(in crate::commands) inject: &'run [PathBuf],
    /// Folders with profiles.
    pub(in crate::commands) search_path: &'run [PathBuf],
}

/// Loads all applications of a run.
pub(in crate::commands) fn load(sources: &Sources<'_>) -> Result<Vec<Application>, Failed> {
    let (mut applications, warnings) = read(sources)?;
    show(&warnings);
    for application in &mut applications {
        let (rules, specification) = (&application.rules, &application.specification);
        application.models = models::load(rules, specification, sources.search_path)?;
        application.task = tasks::load(rules, specification, sources.search_path)?;
    }
    Ok(applications)
}

/// Reads them, without their models; with warnings.
pub(in crate::commands) fn read(
    sources: &Sources<'_>,
) -> Result<(Vec<Application>, Vec<Problem>), Failed> {
    let files = (sources.applications.iter())
        .chain(sources.rules)
        .chain(sources.inject);
    for file in files {
        std::fs::File::open(file).map_err(|error| Failed {
            code: exit_code::FILE,
            text: format!(
                "{} cannot be read: {error}\n  help: check the name, and that you may read it",
                file.display()
            ),
        })?;
    }
    let mut reading = Reading {
        sources,
        options: LoadOptions {
            search_paths: sources.search_path.to_vec(),
            dangling: Severity::Error,
        },
        problems: Vec::new(),
        plans: Vec::new(),
        sound: true,
    };
    let specifications: Vec<ApplicationSpecification> = (sources.applications.iter())
        .filter_map(|file| reading.application(file))
        .collect();
    reading.check_names(&specifications);
    let mut applications: Vec<Application> = (specifications.iter())
        .map(|specification| reading.rules_of(specification, &specifications))
        .collect();
    for (application, plans) in applications.iter_mut().zip(reading.plans) {
        application.plans = plans.into_iter().map(Arc::new).collect();
    }
    if !reading.sound {
        return Err(not_started(sources.applications, &reading.problems));
    }
    Ok((applications, reading.problems))
}

fn not_started(files: &[PathBuf], found: &[Problem]) -> Failed {
    let names: Vec<String> = files
        .iter()
        .map(|file| file.display().to_string())
        .collect();
    Failed {
        code: exit_code::PROFILE,
        text: format!(
            "{}\n{} {} not started",
            problems::render(found, errors_on_terminal()),
            names.join(", "),
            if names.len() == 1 { "was" } else { "were" }
        ),
    }
}

/// Files being read.
struct Reading<'run> {
    sources: &'run Sources<'run>,
    options: LoadOptions,
    problems: Vec<Problem>,
    /// The plans of the trees of each application that can be used.
    plans: Vec<Vec<Plan>>,
    /// Whether everything read so far can be used.
    sound: bool,
}

impl Reading<'_> {
    fn application(&mut self, file: &Path) -> Option<ApplicationSpecification> {
        let outcome = load_application(file, &self.options);
        self.found(outcome.problems);
        self.sound &= outcome.specification.is_some();
        if outcome.specification.is_some() {
            self.plans.push(outcome.plans);
        }
        outcome.specification
    }

    /// The application with what is said about it; what is missing has been reported.
    fn rules_of(
        &mut self,
        specification: &ApplicationSpecification,
        all: &[ApplicationSpecification],
    ) -> Application {
        let sources = self.sources;
        let about = |files: &[PathBuf]| -> Vec<PathBuf> {
            let files = files.iter().cloned();
            files
                .filter(|file| is_about(file, specification, all))
                .collect()
        };
        let outcome = load_rules(specification, &about(sources.rules), &self.options);
        self.found(outcome.problems);
        self.sound &= outcome.rules.is_some();
        let mut injections = Vec::new();
        for file in about(sources.inject) {
            let outcome = load_injections(specification, &file);
            self.found(outcome.problems);
            self.sound &= outcome.injections.is_some();
            injections.extend(outcome.injections.unwrap_or_default());
        }
        Application {
            specification: specification.clone(),
            rules: outcome.rules.unwrap_or_default(),
            models: Vec::new(),
            plans: Vec::new(),
            injections,
            task: None,
        }
    }

    /// Applications are told apart by their names.
    fn check_names(&mut self, all: &[ApplicationSpecification]) {
        for (index, one) in all.iter().enumerate() {
            if let Some(first) = all[..index].iter().find(|other| other.name == one.name) {
                let document = Document::open(&one.file);
                document.report_root(
                    format!(
                        "another application of this run is called `{}`, too: {}",
                        one.name,
                        first.file.display()
                    ),
                    "name each application once, and give each a <name> of its own",
                );
                self.sound = false;
                self.found(document.problems());
            }
        }
    }

    /// Takes problems down, those of a file that several applications refer to once.
    fn found(&mut self, problems: Vec<Problem>) {
        for problem in problems {
            let says_the_same =
                |known: &Problem| known.place == problem.place && known.message == problem.message;
            if !self.problems.iter().any(says_the_same) {
                self.problems.push(problem);
            }
        }
    }
}

/// Whether a file of rules or injections goes to an application: if it names that, or none at all,
/// as a system file. One that names no application of the run goes to the first, whose reader
/// refuses it.
fn is_about(
    file: &Path,
    application: &ApplicationSpecification,
    all: &[ApplicationSpecification],
) -> bool {
    let document = Document::open(file);
    let name = document
        .tree()
        .and_then(|root| root.attribute("application"));
    match name {
        Some(name) if all.iter().any(|one| one.name == name) => application.name == name,
        Some(_) => all
            .first()
            .is_some_and(|first| first.name == application.name),
        None => true,
    }
}
