//! An order is given, and what becomes of it waited for.

use std::io::{self, Write as _};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use container::control::client::{Client, ClientError};
use container::control::{Answer, Request};
use indicatif::ProgressBar;
use serde_json::{Value, json};

use crate::commands::exit_code::{DONE, FAILED, NOT_OVER, REFUSED};
use crate::commands::operator::{Format, Target, unanswered};
use crate::commands::words::word;

/// A reset takes milliseconds, a person does not see less than this.
const LOOK_PERIOD: Duration = Duration::from_millis(20);

/// What takes longer is a wait for a person, who is told so.
const WITHOUT_WORDS: Duration = Duration::from_secs(2);

/// How an order ended.
#[derive(Debug, Clone, PartialEq)]
enum End {
    Refused(String),
    /// With the verdict on it.
    Done(Value),
    Failed(Value),
    NotOver(Value),
}

/// Gives an order and says how it ended.
pub(super) fn carry_out(
    target: &Target,
    order: &Request,
    timeout: Duration,
    format: Format,
) -> ExitCode {
    let ended = target
        .connect()
        .and_then(|mut client| wait(&mut client, order, timeout));
    let end = match ended {
        Ok(end) => end,
        Err(error) => return unanswered(&error),
    };
    // If nobody reads the text the exit code still tells.
    let _unread = match (format, &end) {
        (Format::Json, end) => writeln!(io::stdout(), "{:#}", as_json(end)),
        (Format::Text, End::Done(verdict)) => writeln!(io::stdout(), "{}", words(verdict)),
        (Format::Text, End::Refused(reason)) => writeln!(io::stderr(), "{reason}"),
        (Format::Text, End::Failed(verdict) | End::NotOver(verdict)) => {
            let id = word(&verdict["id"]);
            writeln!(
                io::stderr(),
                "{}\n  help: 'steadfast fault show {id}' has all of it",
                words(verdict)
            )
        }
    };
    ExitCode::from(match end {
        End::Done(_) => DONE,
        End::Refused(_) => REFUSED,
        End::Failed(_) => FAILED,
        End::NotOver(_) => NOT_OVER,
    })
}

/// Gives the order and looks at its verdict until that tells the end.
fn wait(client: &mut Client, order: &Request, timeout: Duration) -> Result<End, ClientError> {
    let deadline = Instant::now() + timeout;
    let id = match client.ask(order)? {
        Answer::Refused(reason) => return Ok(End::Refused(reason)),
        Answer::Done(content) => content.get("ordered").and_then(Value::as_u64),
    };
    let Some(id) = id else {
        return Ok(End::Refused("the answer names no verdict".to_owned()));
    };
    let patience = Instant::now() + WITHOUT_WORDS;
    let mut progress = None;
    loop {
        let verdict = match client.ask(&Request::FaultShow { id })? {
            Answer::Refused(reason) => return Ok(End::Refused(reason)),
            Answer::Done(mut content) => content.remove("fault").unwrap_or_default(),
        };
        if let Some(end) = end_of(&verdict) {
            return Ok(end);
        }
        if Instant::now() >= deadline {
            return Ok(End::NotOver(verdict));
        }
        if Instant::now() >= patience {
            // Drawn on a terminal only.
            progress
                .get_or_insert_with(|| {
                    ProgressBar::new_spinner().with_message("waiting until it is carried out")
                })
                .tick();
        }
        std::thread::sleep(LOOK_PERIOD);
    }
}

/// The end of an order, from its verdict; none while it is under way. What was ordered is the first
/// action; the rules may have asked for others after it.
fn end_of(verdict: &Value) -> Option<End> {
    let is_over = verdict["handling_us"].is_u64();
    match verdict["actions"][0]["outcome"].as_str() {
        _ if !is_over => None,
        Some("done") if verdict["actions"].as_array()?.iter().all(is_done) => {
            Some(End::Done(verdict.clone()))
        }
        _ => Some(End::Failed(verdict.clone())),
    }
}

fn is_done(action: &Value) -> bool {
    action["outcome"] == "done"
}

/// `reset camera: done (by a warm standby); stop planner: done`.
fn words(verdict: &Value) -> String {
    let actions = verdict["actions"].as_array().into_iter().flatten();
    let words = actions.map(|action| {
        let note = word(&action["note"]);
        let note = match note.is_empty() {
            true => String::new(),
            false => format!(" ({note})"),
        };
        let outcome = word(&action["outcome"]).replace('_', " ");
        format!("{}: {outcome}{note}", word(&action["action"]))
    });
    words.collect::<Vec<_>>().join("; ")
}

fn as_json(end: &End) -> Value {
    match end {
        End::Refused(reason) => json!({"ok": false, "error": reason}),
        End::Done(verdict) => json!({"ok": true, "outcome": "done", "fault": verdict}),
        End::Failed(verdict) => json!({"ok": false, "outcome": "failed", "fault": verdict}),
        End::NotOver(verdict) => json!({"ok": false, "outcome": "under_way", "fault": verdict}),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_of_an_order_is_in_its_verdict() {
        let verdict = |outcomes: &[&str], over: bool| {
            let action = |outcome: &&str| json!({"action": "reset a", "outcome": outcome});
            let actions: Vec<Value> = outcomes.iter().map(action).collect();
            match over {
                true => json!({"actions": actions, "handling_us": 7}),
                false => json!({"actions": actions}),
            }
        };
        for (outcomes, over, code) in [
            (&["under_way"][..], false, None),
            (&["done"], false, None),
            (&["done"], true, Some("done")),
            (&["done", "done"], true, Some("done")),
            (&["done", "failed"], true, Some("failed")),
            (&["failed", "done"], true, Some("failed")),
            (&["failed", "under_way"], false, None),
            (&[], true, Some("failed")),
        ] {
            let end = end_of(&verdict(outcomes, over));
            let found = end.map(|end| as_json(&end)["outcome"].clone());
            assert_eq!(found.as_ref().and_then(Value::as_str), code, "{outcomes:?}");
        }
    }

    #[test]
    fn what_was_done_in_words() {
        let verdict = json!({"actions": [
            {"action": "reset camera", "outcome": "failed", "note": "segfault in onStart\u{7}"},
            {"action": "replace camera by spare", "outcome": "done", "note": ""},
        ]});
        assert_eq!(
            words(&verdict),
            "reset camera: failed (segfault in onStart\u{FFFD}); replace camera by spare: done"
        );
    }
}
