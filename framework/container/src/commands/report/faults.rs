//! The section of one fault: what was seen, why it was judged so, what was done, how long it took,
//! and its evidence as a drawing.

use serde_json::Value;

use super::amounts::{at, count, took};
use super::evidence::{Drawing, Evidence, evidence};
use super::levels;
use super::markup::Markup;
use super::model::{Fault, FaultNumber, Verdict};
use super::plot::{self, Moment, Plot};
use super::signals::window_ns;

/// Where a fault stands on the page.
#[derive(Debug, Clone, Copy)]
pub(super) struct Heading<'page> {
    pub(super) number: FaultNumber,
    /// What references to faults of the run begin with.
    pub(super) anchor: &'page str,
    /// Where the component ran.
    pub(super) tier: &'page str,
}

/// Writes it.
pub(super) fn draw(markup: &mut Markup, heading: Heading<'_>, fault: &Fault) {
    let Heading { number, anchor, .. } = heading;
    let verdict = &fault.verdict;
    let id = format!("{anchor}-fault-{number}");
    let class = format!("fault {}", severity(verdict));
    let attributes: [(&str, &dyn std::fmt::Display); 3] =
        [("id", &id), ("class", &class), ("data-verdict", &number)];
    markup.element("article", &attributes, |article| {
        article.element("h4", &[], |title| {
            title.text(format_args!(
                "{number}. {} of {} ",
                capital(&verdict.kind.replace('_', " ")),
                verdict.component
            ));
            let state = verdict.state.to_lowercase();
            title.leaf("span", &[("class", &"badge")], state);
        });
        let evidence = evidence(verdict);
        article.element("dl", &[], |list| facts(list, heading, verdict, &evidence));
        show(article, fault, &evidence);
        for note in &evidence.notes {
            article.leaf("p", &[("class", &"trace")], note);
        }
    });
}

fn facts(list: &mut Markup, heading: Heading<'_>, verdict: &Verdict, evidence: &Evidence) {
    let mut fact = |name: &str, content: &dyn Fn(&mut Markup)| {
        list.leaf("dt", &[], name);
        list.element("dd", &[], |inside| content(inside));
    };
    fact("seen", &|inside| {
        let place = match heading.tier {
            "–" => String::new(),
            tier => format!(", tier {tier}"),
        };
        inside.text(format_args!(
            "{} (first at {}, incarnation {}{place})",
            evidence.seen,
            at(verdict.first_symptom_ns),
            verdict.incarnation
        ));
    });
    fact("judged", &|inside| judged(inside, heading.anchor, verdict));
    fact("done", &|inside| done(inside, verdict));
    fact("times", &|inside| {
        let recovery = verdict.handling_us.map_or_else(
            || "there is no recovery on record".to_owned(),
            |time| format!("recovery {}", took(time)),
        );
        inside.text(format_args!(
            "detection {}, decision {}, {recovery}",
            took(verdict.detection_us),
            took(verdict.decision_us)
        ));
    });
}

fn judged(inside: &mut Markup, anchor: &str, verdict: &Verdict) {
    let symptoms = usize::try_from(verdict.symptoms).unwrap_or(usize::MAX);
    match &verdict.rule {
        Some(rule) => {
            inside.text("confirmed by the rule at ");
            inside.leaf("code", &[], rule);
        }
        None => inside.text("confirmed as it is without a rule for it"),
    }
    inside.text(format_args!(
        " at {}, after {}; severity {}; ",
        at(verdict.confirmed_ns),
        count(symptoms, "symptom"),
        severity(verdict)
    ));
    match verdict.cause.get("consequence_of").and_then(Value::as_u64) {
        Some(root) => {
            let target = format!("#{anchor}-fault-{root}");
            inside.text("a consequence of ");
            inside.leaf("a", &[("href", &target)], format_args!("fault {root}"));
        }
        None => inside.text("a cause of its own"),
    }
}

fn done(inside: &mut Markup, verdict: &Verdict) {
    if verdict.actions.is_empty() {
        inside.text(match verdict.plan.is_empty() {
            true => "nothing".to_owned(),
            false => format!("nothing yet; the plan is: {}", verdict.plan.join(", then ")),
        });
        return;
    }
    inside.element("ol", &[], |list| {
        for action in &verdict.actions {
            list.element("li", &[], |item| {
                item.text(format_args!("{}: ", action.action));
                let outcome = action.outcome.replace('_', " ");
                let is_done = action.outcome == "done";
                let class = if is_done { "done" } else { "undone" };
                item.leaf("span", &[("class", &class)], outcome);
                if !action.note.is_empty() {
                    item.text(format_args!(" ({})", action.note));
                }
            });
        }
    });
}

/// The evidence as a drawing: what was recorded, or what the verdict alone has.
fn show(article: &mut Markup, fault: &Fault, evidence: &Evidence) {
    let level = match &evidence.drawing {
        Some(Drawing::Level(level)) => Some(level),
        _ => None,
    };
    match (&fault.signal, &evidence.drawing) {
        (Some(signal), _) => article.element("figure", &[], |figure| {
            let verdict = &fault.verdict;
            let moment = |t_ns, class, what| Moment { t_ns, class, what };
            let mut moments = vec![
                moment(verdict.first_symptom_ns, "symptom", "first symptom"),
                moment(verdict.confirmed_ns, "confirmed", "confirmed"),
            ];
            let end = fault.end_ns();
            moments.extend(end.map(|end_ns| moment(end_ns, "over", fault.end_word())));
            let plot = Plot {
                signal,
                window_ns: window_ns(fault),
                minimum: level.and_then(|it| it.minimum),
                maximum: level.and_then(|it| it.maximum),
                moments,
            };
            plot::draw(figure, &plot);
            let more = match signal.left_out {
                0 => String::new(),
                left_out => format!(" ({left_out} data at the end are not shown)"),
            };
            figure.leaf(
                "figcaption",
                &[],
                format_args!(
                    "{}, as recorded{more}. Dotted: first symptom; red: confirmed; green: handled or healed; \
                     dashed: limit.",
                    signal.name
                ),
            );
        }),
        (None, Some(drawing)) => article.element("figure", &[], |it| levels::draw(it, drawing)),
        (None, None) => {}
    }
}

/// The severity as a class and a word: one of those that there are.
fn severity(verdict: &Verdict) -> &'static str {
    let known = ["ignore", "reset", "stop", "emergency"];
    let found = known.into_iter().find(|it| *it == verdict.severity);
    found.unwrap_or("unknown")
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().into_iter().flat_map(char::to_uppercase);
    first.chain(letters).collect()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::commands::report::model::Signal;

    fn drawn(verdict: Value, signal: Option<Signal>) -> String {
        let fault = Fault {
            verdict: serde_json::from_value(verdict).expect("a verdict"),
            healed_ns: None,
            signal,
        };
        let heading = Heading {
            number: FaultNumber {
                container: 1,
                id: 3,
            },
            anchor: "run-1",
            tier: "guarded",
        };
        let mut markup = Markup::default();
        draw(&mut markup, heading, &fault);
        markup.into_text()
    }

    #[test]
    fn a_fault_is_told_whole() {
        let text = drawn(
            json!({"id": 3, "kind": "out_of_range", "component": "sonar", "severity": "reset",
                   "state": "HEALED", "symptoms": 2, "rule": "rules.xml:4:5",
                   "first_symptom_ns": 3_000_000_000u64, "confirmed_ns": 3_020_000_000u64,
                   "cause": {"consequence_of": 1},
                   "evidence": {"value": {"port": "range", "field": "distance", "value": 0.0,
                                          "minimum": 0.03, "maximum": 3.0}},
                   "actions": [{"action": "reset sonar", "outcome": "done", "note": "fresh"}],
                   "detection_us": 20_000, "decision_us": 0, "handling_us": 300}),
            None,
        );
        for part in [
            "id=\"run-1-fault-3\"",
            "data-verdict=\"3\"",
            "3. Out of range of sonar",
            "distance of range was 0, 0.03 to 3 are allowed (first at 3.000 s",
            "<code>rules.xml:4:5</code> at 3.020 s, after 2 symptoms; severity reset",
            "<a href=\"#run-1-fault-1\">fault 1</a>",
            "reset sonar: <span class=\"done\">done</span> (fresh)",
            "detection 20 ms, decision 0 µs, recovery 300 µs",
            "class=\"plot level\"",
        ] {
            assert!(text.contains(part), "{part} is not in {text}");
        }
    }

    #[test]
    fn what_was_recorded_is_plotted_instead() {
        let signal = Signal {
            name: "sonar/range: distance".to_owned(),
            samples: vec![(0, 1.0), (1_000_000_000, 0.0)],
            left_out: 7,
        };
        let text = drawn(
            json!({"evidence": {"value": {"value": 0.0, "minimum": 0.5}}}),
            Some(signal),
        );
        assert!(
            text.contains("class=\"plot\"") && !text.contains("plot level"),
            "{text}"
        );
        assert!(
            text.contains("class=\"limit\"") && text.contains("7 data at the end"),
            "{text}"
        );
    }

    #[test]
    fn what_was_not_done_is_said() {
        for (verdict, expected) in [
            (json!({}), "nothing<"),
            (
                json!({"plan": ["reset a", "stop a"]}),
                "the plan is: reset a, then stop a",
            ),
            (
                json!({"actions": [{"action": "reset a", "outcome": "under_way"}]}),
                "<span class=\"undone\">under way</span>",
            ),
        ] {
            let text = drawn(verdict, None);
            assert!(text.contains(expected), "{text}");
            assert!(text.contains("no recovery on record"), "{text}");
        }
    }
}
