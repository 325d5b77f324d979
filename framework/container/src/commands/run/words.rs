//! Events in words, for a person who watches.

use container::event_log::Event;
use container::outer_supervision::ContainerRestart;
use fault_manager::{Cause, Evidence, Verdict};

/// The event in words; `None` for those that would only be noise.
pub(super) fn describe(event: &Event) -> Option<String> {
    Some(match event {
        Event::RunStarted {
            application,
            clock,
            seed,
            components,
        } => format!("{application}: {components} components, {clock} time, seed {seed}"),
        Event::State {
            component,
            from,
            to,
            ..
        } => format!("{component}: {from} -> {to}"),
        Event::Fault {
            component,
            kind,
            callback,
            message,
            place,
            ..
        } => {
            let place = place.as_ref().map(|at| format!(" at {at}"));
            format!(
                "FAULT {component}: {kind} in {callback}: {message}{}",
                place.unwrap_or_default()
            )
        }
        Event::Verdict(verdict) => judged(verdict),
        Event::Adaptation(record) => format!("ADAPTATION: {}", record.text),
        Event::Injection {
            fault,
            component,
            change,
        } => {
            let place = component.as_ref().map(|name| format!(" in {name}"));
            let place = place.unwrap_or_default();
            format!("injected fault {fault} {change}{place}")
        }
        Event::DatumSetAside {
            component, port, ..
        } => format!(
            "{component}: a datum of '{port}' is set aside, two incarnations died with it in work"
        ),
        Event::TreeState { tree, from, to } => format!("tree {tree}: {from} -> {to}"),
        Event::CheckpointRestored {
            component,
            sequence,
            age_ms,
            ..
        } => format!("{component}: goes on from checkpoint {sequence}, {age_ms} ms old"),
        Event::Overrun {
            executor, late_ns, ..
        } => {
            let late = std::time::Duration::from_nanos(*late_ns);
            format!("{executor}: overrun, {late:.1?} late")
        }
        Event::Log {
            component,
            level,
            message,
        } if *level != "debug" => format!("{component}: {level}: {message}"),
        Event::Log { .. } | Event::TreeNodes { .. } | Event::RunStopped { .. } => return None,
        Event::Notice { message } => format!("notice: {message}"),
        Event::ContainerRestarted(restart) => restarted(restart),
        Event::ContainerGivenUp { seen, .. } => format!("the container is given up: {seen}"),
        Event::Robot { .. } => of_robot(event),
        Event::TargetReached { .. } => reached(event),
    })
}

/// A robot is where it was to go.
fn reached(event: &Event) -> String {
    match event {
        Event::TargetReached {
            application,
            time_s,
        } => {
            let whose = application.iter().map(|it| format!(" of {it}"));
            let whose: String = whose.collect();
            format!("the robot{whose} has reached its target ({time_s:.2} s)")
        }
        _ => String::new(),
    }
}

/// What has changed among robots.
fn of_robot(event: &Event) -> String {
    match event {
        Event::Robot {
            robot,
            change,
            message,
        } => format!("robot {robot}: {change}: {message}"),
        _ => String::new(),
    }
}

/// What became of the container before this one.
fn restarted(restart: &ContainerRestart) -> String {
    let without = std::time::Duration::from_micros(restart.without_container_us);
    format!(
        "RESTART {} of the container: {}: {}; {:.3} s without one",
        restart.restart,
        restart.seen,
        restart.done,
        without.as_secs_f64()
    )
}

/// A verdict in one line: who, what, why so, and what is being done.
fn judged(verdict: &Verdict) -> String {
    let cause = match verdict.cause {
        Cause::Root => String::new(),
        Cause::ConsequenceOf(root) => format!(", a consequence of fault {}", root.0),
    };
    let done = match verdict.actions.last() {
        Some(action) if action.note.is_empty() => {
            format!(": {} {}", action.action, action.outcome.replace('_', " "))
        }
        Some(action) => format!(
            ": {} {} ({})",
            action.action,
            action.outcome.replace('_', " "),
            action.note
        ),
        None => String::new(),
    };
    let damage = match &verdict.evidence {
        Evidence::Exception {
            damage: Some(damage),
            ..
        } if verdict.actions.is_empty() => format!("; {damage}"),
        _ => String::new(),
    };
    format!(
        "VERDICT {} {}: {}{cause}, {}{done}{damage}",
        verdict.id.0,
        verdict.component,
        verdict.kind,
        state(verdict)
    )
}

fn state(verdict: &Verdict) -> &'static str {
    use fault_manager::FaultState::{Cleared, Confirmed, Healed, Prefailed};
    match verdict.state {
        Prefailed => "suspected",
        Confirmed => "confirmed",
        Healed => "healed",
        Cleared => "cleared",
    }
}
