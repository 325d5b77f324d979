//! The page: runs to HTML that needs nothing else, neither network nor scripts.

use super::amounts::{at, count};
use super::faults::{self, Heading};
use super::figures::{self, tier};
use super::markup::Markup;
use super::model::Run;
use super::paragraph::{name, paragraph};
use super::{map, timeline};

/// What a browser may do with the page: show it. Whatever text gets into it cannot load or run
/// anything.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; img-src data:";

/// The page of some runs.
pub(super) fn page(runs: &[Run]) -> String {
    let title = match runs {
        [run] => format!("{}: what happened", name(run)),
        _ => format!("{}: what happened", count(runs.len(), "run")),
    };
    let mut markup = Markup::default();
    markup.element("html", &[("lang", &"en")], |html| {
        html.element("head", &[], |head| {
            head.void("meta", &[("charset", &"utf-8")]);
            head.void(
                "meta",
                &[
                    ("http-equiv", &"Content-Security-Policy"),
                    ("content", &POLICY),
                ],
            );
            let width = "width=device-width, initial-scale=1";
            head.void("meta", &[("name", &"viewport"), ("content", &width)]);
            head.leaf("title", &[], &title);
            head.style(include_str!("report.css"));
        });
        html.element("body", &[], |body| {
            body.leaf("h1", &[], &title);
            if runs.len() > 1 {
                contents(body, runs);
            }
            for (run, number) in runs.iter().zip(1..) {
                if runs.len() > 1 {
                    body.leaf("h2", &[], name(run));
                }
                write_run(body, run, &format!("run-{number}"));
            }
            if runs.len() > 1 {
                body.leaf("h2", &[], "Times of all runs");
                figures::draw(body, &runs.iter().collect::<Vec<_>>());
            }
            let made = concat!("Made by steadfast ", env!("CARGO_PKG_VERSION"), ".");
            body.leaf("footer", &[], made);
        });
    });
    format!("<!DOCTYPE html>\n{}", markup.into_text())
}

fn contents(body: &mut Markup, runs: &[Run]) {
    body.element("ol", &[("class", &"contents")], |list| {
        for (run, number) in runs.iter().zip(1..) {
            list.element("li", &[], |item| {
                let target = format!("#run-{number}");
                item.leaf("a", &[("href", &target)], name(run));
                let faults = count(run.faults.len(), "fault");
                item.text(format_args!(" ({}; {faults})", run.sources.join(", ")));
            });
        }
    });
}

fn write_run(body: &mut Markup, run: &Run, anchor: &str) {
    body.element("section", &[("id", &anchor)], |section| {
        section.leaf(
            "p",
            &[("class", &"note")],
            format_args!("From {}.", run.sources.join(", ")),
        );
        section.leaf("p", &[("class", &"story")], paragraph(run));
        section.leaf("h3", &[], "States over time");
        legend(section);
        timeline::draw(section, run, anchor);
        write_drive(section, run, anchor);
        if !run.faults.is_empty() {
            section.leaf("h3", &[], "Faults");
            write_faults(section, run, anchor);
            section.leaf("h3", &[], "Times");
            figures::draw(section, &[run]);
        }
        write_components(section, run);
        write_incidents(section, run);
    });
}

fn legend(section: &mut Markup) {
    section.element("p", &[("class", &"legend")], |legend| {
        for (class, what) in [
            ("ACTIVE", "active"),
            ("READY", "ready"),
            ("INACTIVE", "inactive"),
            ("ERROR", "in error"),
            ("fault-mark", "▼ fault confirmed"),
            ("recovered", "▲ handled or healed"),
            ("injected", "| made on purpose"),
            ("restarted", "| container restarted"),
        ] {
            legend.leaf("span", &[("class", &format_args!("key {class}"))], what);
        }
    });
}

fn write_drive(section: &mut Markup, run: &Run, anchor: &str) {
    if run.picture.is_none() && run.path.is_empty() {
        return;
    }
    section.leaf("h3", &[], "The drive");
    section.element("div", &[("class", &"drive")], |drive| {
        if let Some(picture) = &run.picture {
            drive.element("figure", &[], |figure| {
                let text = "the drive from above";
                // The page is there before the picture is painted.
                let decoding = ("decoding", &"async" as &dyn std::fmt::Display);
                figure.void("img", &[("alt", &text), decoding, ("src", picture)]);
                figure.leaf("figcaption", &[], "The drive as the world saw it.");
            });
        }
        if !run.path.is_empty() {
            drive.element("figure", &[], |figure| {
                map::draw(figure, run, anchor);
                let text = format!(
                    "The way that {} tells of (green: start and end; red: faults).",
                    run.path_topic.trim_start_matches('/')
                );
                figure.leaf("figcaption", &[], text);
            });
        }
    });
}

fn write_faults(section: &mut Markup, run: &Run, anchor: &str) {
    for (number, fault) in &run.faults {
        let heading = Heading {
            number: *number,
            anchor,
            tier: &tier(run, &fault.verdict.component),
        };
        faults::draw(section, heading, fault);
    }
    if !run.recorded {
        let note = "With a recording of the run (steadfast run --record or --black-box) the signals \
                    around each fault are plotted here.";
        section.leaf("p", &[("class", &"note")], note);
    }
}

fn write_components(section: &mut Markup, run: &Run) {
    let Some(summary) = &run.summary else { return };
    section.leaf("h3", &[], "Components in the end");
    section.element("table", &[], |table| {
        table.element("thead", &[], |head| {
            head.element("tr", &[], |row| {
                for name in [
                    "component",
                    "state",
                    "tier",
                    "incarnation",
                    "cycles",
                    "overruns",
                ] {
                    row.leaf("th", &[], name);
                }
            });
        });
        table.element("tbody", &[], |body| {
            for (name, component) in &summary.components {
                body.element("tr", &[], |row| {
                    for text in [name, &component.state, &component.tier] {
                        row.leaf("td", &[], text);
                    }
                    let incarnation = u64::from(component.incarnation);
                    for number in [incarnation, component.cycles, component.overruns] {
                        row.leaf("td", &[("class", &"number")], number);
                    }
                });
            }
        });
    });
}

fn write_incidents(section: &mut Markup, run: &Run) {
    if !run.incidents.is_empty() {
        section.leaf("h3", &[], "What else happened");
        section.element("table", &[], |table| {
            table.element("tbody", &[], |body| {
                for incident in &run.incidents {
                    body.element("tr", &[], |row| {
                        row.leaf("td", &[("class", &"number")], at(incident.t_ns));
                        row.leaf("td", &[], incident.kind.replace('_', " "));
                        row.leaf("td", &[], &incident.text);
                    });
                }
            });
        });
    }
    let overruns: u64 = run.overruns.values().sum();
    if overruns > 0 {
        let by = run.overruns.iter();
        let by: Vec<String> = by.map(|(name, times)| format!("{name} {times}")).collect();
        let text = format!("Cycles that took too long: {}.", by.join(", "));
        section.leaf("p", &[("class", &"note")], text);
    }
}

#[cfg(test)]
mod tests;
