//! The answer to one question, as text and as JSON.

use std::fmt::Write as _;

use fault_manager::what_if::{Answer, Supposition};
use fault_manager::{Cause, Scope, Verdict};
use serde_json::{Value, json};

/// `front_sonar.range drop`; with the application's name in front where there are several.
pub fn words(scopes: &[Scope], question: &Supposition) -> String {
    format!("{} {}", subject(scopes, question), question.fault.name())
}

/// The component or the port that a question is about.
pub fn subject(scopes: &[Scope], question: &Supposition) -> String {
    let component = name(scopes, question.application, question.component);
    match &question.port {
        Some(port) => format!("{component}.{port}"),
        None => component,
    }
}

/// A component's name; with the application's in front where there are several.
pub fn name(scopes: &[Scope], application: usize, component: usize) -> String {
    let specification = &scopes[application].specification;
    let own = &specification.components[component].name;
    match scopes.len() {
        1 => own.clone(),
        _ => format!("{}/{own}", specification.name),
    }
}

/// What comes of it, in one word or two, the worst first.
pub fn outcome(answer: &Answer) -> &'static str {
    let stopped = answer.applications.iter().any(|it| it.state == "STOPPED");
    let lost = answer.components.iter().any(|it| it.lost);
    let did = |what: &str| {
        answer
            .actions()
            .iter()
            .any(|action| action.starts_with(what))
    };
    match answer {
        _ if answer.emergency_stop => "emergency stop",
        _ if stopped => "application stopped",
        _ if lost => "goes on without some",
        _ if did("replace") => "replaced",
        _ if did("reset") => "reset",
        _ if answer.is_seen() => "recorded only",
        _ => "not seen",
    }
}

/// For people.
pub fn text(scopes: &[Scope], question: &Supposition, answer: &Answer) -> String {
    let mut text = format!("What if {}?\n\n", words(scopes, question));
    if !answer.is_seen() {
        text += "No rule and no default sees it, so nothing is done.\n";
    }
    for verdict in &answer.verdicts {
        tell(&mut text, verdict);
    }
    if !answer.reaches.is_empty() {
        let readers = answer.reaches.join(", ");
        // Writing to memory does not fail.
        let _infallible = writeln!(
            text,
            "Wrong data come to {readers}, unseen by any rule; what is made of them depends on the \
             component (--passes-on)."
        );
    }
    text += "\nIn the end: ";
    text += outcome(answer);
    text += ".\n";
    for application in &answer.applications {
        let _infallible = writeln!(
            text,
            "  application {}: {}",
            application.application, application.state
        );
    }
    for component in answer
        .components
        .iter()
        .filter(|it| it.state != "ACTIVE" || it.incarnation > 1)
    {
        let _infallible = writeln!(
            text,
            "  {}: {}, incarnation {}",
            component.component, component.state, component.incarnation
        );
    }
    text
}

fn tell(text: &mut String, verdict: &Verdict) {
    let cause = match verdict.cause {
        Cause::Root => String::new(),
        Cause::ConsequenceOf(id) => format!(", a consequence of fault {}", id.0),
    };
    let rule = match &verdict.rule {
        Some(rule) => format!("by {rule}"),
        None => "by default".to_owned(),
    };
    let _infallible = writeln!(
        text,
        "Fault {}: {} of {} after {} ms, {rule}{cause}",
        verdict.id.0,
        verdict.kind,
        verdict.component,
        since(verdict)
    );
    for action in &verdict.actions {
        let _infallible = writeln!(text, "  {}: {}", action.action, action.outcome);
    }
    for sentence in verdict.plan.iter().filter(|_| verdict.actions.is_empty()) {
        let _infallible = writeln!(text, "  {sentence}");
    }
}

/// From the beginning of what is supposed to the fault, in milliseconds.
fn since(verdict: &Verdict) -> u64 {
    let begin = u64::try_from(fault_manager::what_if::BEGIN.as_nanos()).unwrap_or(u64::MAX);
    verdict.confirmed_ns.saturating_sub(begin) / 1_000_000
}

/// For programs.
pub fn json(scopes: &[Scope], question: &Supposition, answer: &Answer) -> Value {
    json!({
        "component": name(scopes, question.application, question.component),
        "port": question.port,
        "fault": question.fault.name(),
        "outcome": outcome(answer),
        "seen": answer.is_seen(),
        "stops_robot": answer.stops_robot(),
        "actions": answer.actions(),
        "answer": answer,
    })
}
