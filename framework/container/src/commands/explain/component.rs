//! What the rules make of a component: what is watched, what is done step by step, whom it concerns.

use std::fmt::Write as _;
use std::time::Duration;

use fault_manager::what_if::{
    Answer, Assumptions, Recoveries, SupposedFault, Supposition, answer, dependents,
};
use fault_manager::{FaultManager, Scope};
use serde::Serialize;
use system_model::injection::Misbehaviour;
use system_model::rules::{
    ApplicationSeverity, ComponentRules, DependencySeverity, Entity, IsolationTier, Preload,
    StopCategory,
};
use system_model::specification::ExecutionKind;

use super::watched::{Subject, Watched, time};
use super::what_if::{name, outcome};

/// Everything that is to be said of a component.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Explanation {
    /// Instance name.
    pub component: String,
    /// How and where it runs.
    pub runs: String,
    /// What is watched of it.
    pub watched: Vec<Watched>,
    /// The ladder: what is done when a fault is to be recovered, step by step.
    pub ladder: Vec<String>,
    /// How long a step of it may take, in seconds; none if the rules do not say.
    pub recovery_deadline_s: Option<f64>,
    /// What it needs.
    pub needs: Vec<String>,
    /// Who needs it, and what becomes of them.
    pub needed_by: Vec<String>,
    /// What its loss comes to.
    pub loss: &'static str,
}

/// Explains a component.
pub fn explain(
    scopes: &[Scope],
    manager: &FaultManager,
    application: usize,
    component: usize,
) -> Explanation {
    let scope = &scopes[application];
    let before = scopes[..application].iter();
    let first: usize = before.map(|it| it.specification.components.len()).sum();
    let detectors = manager.detectors().iter();
    let own = detectors.filter(|detector| detector.component == first + component);
    let subject = Subject { scope, component };
    let rules = &scope.rules.components[component];
    Explanation {
        component: name(scopes, application, component),
        runs: runs(scope, component),
        watched: own.flat_map(|detector| subject.watched(detector)).collect(),
        ladder: ladder(scope, rules),
        recovery_deadline_s: (rules.recovery.as_ref())
            .map(|rule| rule.value.deadline.as_secs_f64()),
        needs: needs(scope, component),
        needed_by: needed_by(scopes, application, component),
        loss: loss(scopes, application, component),
    }
}

fn runs(scope: &Scope, component: usize) -> String {
    let specification = &scope.specification.components[component];
    let rules = &scope.rules.components[component];
    let execution = &specification.execution;
    let rhythm = match execution.kind {
        ExecutionKind::Passive => "when it is asked".to_owned(),
        ExecutionKind::Aperiodic => "when a datum or an event arrives".to_owned(),
        ExecutionKind::Periodic => format!("every {}", time(execution.period)),
        ExecutionKind::PeriodicShared => {
            format!(
                "every {}, on a thread shared with others",
                time(execution.period)
            )
        }
    };
    let place = match rules.isolation.as_ref().map(|rule| &rule.value) {
        Some(isolation) if isolation.tier == IsolationTier::Process => match &isolation.group {
            Some(group) => format!("in the process of the group {group}"),
            None => "in a process of its own".to_owned(),
        },
        _ => "guarded, in the container's process".to_owned(),
    };
    let actuator = rules
        .actuator
        .as_ref()
        .map(|rule| match rule.value.stop_category {
            StopCategory::PowerOff => "; an actuator: in an emergency its power is taken at once",
            StopCategory::ControlledThenOff => {
                "; an actuator: in an emergency it stops under control, then its power is taken"
            }
            StopCategory::Controlled => "; an actuator: in an emergency it stops under control",
        });
    format!("runs {rhythm}, {place}{}", actuator.unwrap_or_default())
}

fn ladder(scope: &Scope, rules: &ComponentRules) -> Vec<String> {
    let inherited = rules.fault.as_ref().or(scope.rules.fault.as_ref());
    let fault = inherited.map(|rule| rule.value).unwrap_or_default();
    let resurrect = rules.resurrect.as_ref().map(|rule| rule.value);
    let mut steps = Vec::new();
    if fault.retry_max > 0 && resurrect.is_none_or(|rule| rule.reset) {
        let pause = match fault.backoff.is_zero() {
            true => String::new(),
            false => format!(", {} after the one before", time(fault.backoff)),
        };
        let memory = resurrect.and_then(|rule| rule.backup).map(|period| {
            let period = time(period);
            format!("; its memory is restored from the copy that is made every {period}")
        });
        let standby = match rules.standby.as_ref().map(|rule| rule.value) {
            Some(Preload::Warm) => "; a warm standby takes over if it cannot be called any more",
            Some(Preload::Loaded) => {
                "; a loaded standby takes over if it cannot be called any more"
            }
            Some(Preload::Cold) | None => "",
        };
        steps.push(format!(
            "It is reset, at most {} within {}{pause}{}{standby}.",
            match fault.retry_max {
                1 => "once".to_owned(),
                times => format!("{times} times"),
            },
            time(fault.window),
            memory.unwrap_or_default()
        ));
    }
    steps.extend(rules.secondaries.iter().map(|secondary| {
        let prepared = match secondary.preload {
            Preload::Cold => "loaded only then",
            Preload::Loaded => "which is loaded already",
            Preload::Warm => "which is initialised already",
        };
        format!(
            "{} takes its place, {prepared}.",
            secondary.specification.type_name
        )
    }));
    steps.extend(rules.adapt.as_ref().map(|rule| {
        let task = &rule.value.task;
        format!("The task {task} is done without it, if there is another way.")
    }));
    steps.push(match fault.severity {
        ApplicationSeverity::Ignore => {
            "It is stopped, and what needs it; the application goes on without.".to_owned()
        }
        ApplicationSeverity::Local => {
            format!("The application {} is stopped.", scope.specification.name)
        }
        ApplicationSeverity::Global => "Emergency stop of all applications.".to_owned(),
    });
    steps
}

fn needs(scope: &Scope, component: usize) -> Vec<String> {
    let rules = scope.rules.dependencies.iter();
    let own = rules.filter(|rule| rule.value.dependent.entity == Entity::Component(component));
    let sentences = own.map(|rule| {
        let rule = &rule.value;
        let names: Vec<&str> = rule.providers.iter().map(|one| one.name.as_str()).collect();
        let (need, all) = (rule.need, names.len());
        let names = names.join(", ");
        let otherwise = match rule.severity {
            DependencySeverity::Ignore => "goes on otherwise",
            DependencySeverity::Stop => "is stopped otherwise",
            DependencySeverity::Destroy => "is destroyed otherwise",
        };
        match need < all {
            true => format!("It needs {need} of {names}, and {otherwise}."),
            false => format!("It needs {names}, and {otherwise}."),
        }
    });
    sentences.collect()
}

fn needed_by(scopes: &[Scope], application: usize, component: usize) -> Vec<String> {
    let down = dependents(scopes, application, component).into_iter();
    down.map(|(application, component, destroyed)| {
        let who = name(scopes, application, component);
        let what = if destroyed { "destroyed" } else { "stopped" };
        format!("{who} is {what} when it is.")
    })
    .collect()
}

/// What comes of a crash of which no recovery succeeds.
fn loss(scopes: &[Scope], application: usize, component: usize) -> &'static str {
    let supposition = Supposition {
        application,
        component,
        port: None,
        fault: SupposedFault::Callback(Misbehaviour::Segfault),
    };
    let assumptions = Assumptions {
        recoveries: Recoveries::Fail,
        ..Assumptions::default()
    };
    let answered = answer(scopes, &supposition, &assumptions);
    answered
        .as_ref()
        .map_or("it is never executed", |answer: &Answer| outcome(answer))
}

/// For people.
pub fn text(explanation: &Explanation) -> String {
    let mut text = format!("{}: {}\n", explanation.component, explanation.runs);
    text += "  What is watched\n";
    for watched in &explanation.watched {
        let confirmation = match watched.confirmation.as_str() {
            "" => String::new(),
            conditions => format!(" ({conditions})"),
        };
        let rule = watched.rule.as_deref().unwrap_or("default");
        // Writing to memory does not fail.
        let _infallible = writeln!(
            text,
            "    - {}{confirmation}: {}. [{rule}]",
            watched.symptom, watched.then
        );
    }
    text += "  The ladder\n";
    for (index, step) in explanation.ladder.iter().enumerate() {
        let _infallible = writeln!(text, "    {}. {step}", index + 1);
    }
    if let Some(deadline_s) = explanation.recovery_deadline_s {
        let deadline = time(Duration::from_secs_f64(deadline_s));
        let _infallible = writeln!(
            text,
            "    A recovery that fails, or takes longer than {deadline}, is followed by the next step."
        );
    }
    for (heading, sentences, none) in [
        (
            "What it needs",
            &explanation.needs,
            "No rule says that it needs anything.",
        ),
        (
            "Who needs it",
            &explanation.needed_by,
            "No rule says that anybody does.",
        ),
    ] {
        let _infallible = writeln!(text, "  {heading}");
        for sentence in sentences {
            let _infallible = writeln!(text, "    - {sentence}");
        }
        if sentences.is_empty() {
            let _infallible = writeln!(text, "    - {none}");
        }
    }
    let _infallible = writeln!(text, "  If it cannot be brought back: {}", explanation.loss);
    text
}
