//! Injections as they are written to those of an application: every name resolved, and everything
//! that could never happen refused.

use std::path::Path;
use std::rc::Rc;

use system_model::injection::Injection;
use system_model::specification::ApplicationSpecification;

use super::rules::applications::with_application;
use super::{Assembly, LoadedFile};
use crate::document::Document;
use crate::problem::{Problem, Severity};
use crate::readers::injection::{self as reader, DeclaredInjections, INJECTION, INJECTIONS_ROOT};
use crate::suggest::quoted;

mod injection;

/// What came of loading injections.
#[derive(Debug)]
pub struct InjectionsOutcome {
    /// The injections in the order they are written, if nothing about them is an error.
    pub injections: Option<Vec<Injection>>,
    /// All problems, sorted by place.
    pub problems: Vec<Problem>,
}

/// Loads an injection file of an application. Whether a data type has the field that an injection
/// names is known only to the library, and not checked here.
///
/// ```no_run
/// use system_profile::{LoadOptions, load_application, load_injections};
///
/// let loaded = load_application("applications/patrol.xml".as_ref(), &LoadOptions::default());
/// if let Some(application) = &loaded.specification {
///     let outcome = load_injections(application, "injections.xml".as_ref());
///     for problem in &outcome.problems {
///         eprintln!("{}: {problem}", problem.place);
///     }
/// }
/// ```
pub fn load_injections(application: &ApplicationSpecification, path: &Path) -> InjectionsOutcome {
    let document = Document::open(path);
    let declared = document
        .root(&[INJECTIONS_ROOT])
        .and_then(|root| reader::read(&root));
    let injections = declared.map(|declared| resolve(&document, application, &declared));
    outcome(&document, injections)
}

/// Reads one injection from the text of its element; `name` is what the text is called in problems.
///
/// It is what an operator asks of a running system: `<inject component="camera" fault="hang"/>`.
pub fn read_injection(
    application: &ApplicationSpecification,
    name: &str,
    text: &str,
) -> InjectionsOutcome {
    let document = Document::from_bytes(name, text.as_bytes());
    let declared = document
        .root(&[INJECTION])
        .and_then(|node| reader::injection(&node));
    let injection =
        declared.and_then(|declared| injection::resolve(&document, application, &declared));
    outcome(&document, injection.map(|injection| vec![injection]))
}

fn outcome(document: &Document, injections: Option<Vec<Injection>>) -> InjectionsOutcome {
    InjectionsOutcome {
        injections: injections.filter(|_| !document.has_errors()),
        problems: document.problems(),
    }
}

/// Reports everything about an injection file that can be known: with its application, if that is
/// found.
pub(crate) fn check_file(assembly: &mut Assembly<'_>, file: &Rc<LoadedFile>) {
    let Some(root) = file.document.root(&[INJECTIONS_ROOT]) else {
        return;
    };
    let Some(declared) = reader::read(&root) else {
        return;
    };
    if declared.application.value.is_empty() {
        return;
    }
    with_application(assembly, file, &declared.application, |_, application| {
        let _only_problems_matter = resolve(&file.document, application, &declared);
    });
}

fn resolve(
    document: &Document,
    application: &ApplicationSpecification,
    declared: &DeclaredInjections,
) -> Vec<Injection> {
    let (wanted, own) = (&declared.application, &application.name);
    if wanted.value != *own && !wanted.value.is_empty() {
        document.report(
            Severity::Error,
            wanted,
            format!(
                "these are injections into `{}`, not into `{}`",
                quoted(&wanted.value),
                quoted(own)
            ),
            Some(format!("write application=\"{}\"", quoted(own))),
        );
        return Vec::new();
    }
    declared
        .injections
        .iter()
        .filter_map(|injection| injection::resolve(document, application, injection))
        .collect()
}
