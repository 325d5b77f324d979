//! Events, one after the other, to what is known of a run. Files come from other programs and other
//! versions: an event that is not known is passed over, one that is no event is refused.

use std::collections::{BTreeSet, HashSet};
use std::hash::{DefaultHasher, Hash as _, Hasher as _};

use behavior_tree::catalogue::BUILT_IN;
use behavior_tree::component_nodes::component_node;
use serde_json::Value;

use super::model::{FaultNumber, Incident, Run, StateChange, Verdict};

/// Incidents that are kept of a run: more than a person reads. The first ones are kept, and how many
/// more there were is said.
const MOST_INCIDENTS: usize = 500;

/// Faults that are kept of a run: those of a campaign of one a second for an hour. That verdicts were
/// left out is said.
const MOST_FAULTS: usize = 4000;

/// Trees and nodes of trees that have a row beside those of components: what a mission is made of.
const MOST_TREE_ROWS: usize = 24;

/// A run that is being read.
#[derive(Debug, Default)]
pub(super) struct Gathering {
    pub(super) run: Run,
    /// Which container of the run is speaking, from 1.
    container: u32,
    /// The applications that it has started.
    started: BTreeSet<String>,
    /// What was told already, so that a recording of the same run is known.
    seen: HashSet<u64>,
    /// Incidents beyond [`MOST_INCIDENTS`].
    incidents_left_out: u64,
}

impl Gathering {
    /// A run that files of this name tell of.
    pub(super) fn new(source: String) -> Self {
        let mut gathering = Self::default();
        gathering.run.sources.push(source);
        gathering
    }

    /// Whether the run was told of this event already.
    pub(super) fn knows(&self, event: &Value) -> bool {
        self.seen.contains(&mark(event))
    }

    /// Takes note of an event.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    pub(super) fn learn(&mut self, event: &Value) -> Result<(), String> {
        let t_ns = event.get("t_ns").and_then(Value::as_u64);
        let kind = event.get("event").and_then(Value::as_str);
        let (Some(t_ns), Some(kind)) = (t_ns, kind) else {
            return Err("it has no `t_ns` and `event`".to_owned());
        };
        self.seen.insert(mark(event));
        let span = self.run.span_ns.get_or_insert((t_ns, t_ns));
        *span = (span.0.min(t_ns), span.1.max(t_ns));
        match kind {
            "run_started" => self.begin(event),
            "state" => self.change(t_ns, event),
            "tree_state" => {
                self.begin_tree(t_ns, event);
                self.happen(t_ns, kind, event);
            }
            "tree_nodes" => self.change_nodes(t_ns, event),
            "verdict" => self.judge(t_ns, event)?,
            "overrun" => {
                let executor = text(event, "executor");
                *self.run.overruns.entry(executor).or_default() += 1;
            }
            "run_stopped" => {
                self.run.ended_by = Some(text(event, "reason"));
                self.run.events_lost += number(event, "events_lost");
            }
            _ => self.happen(t_ns, kind, event),
        }
        Ok(())
    }

    /// What is known when all has been read.
    pub(super) fn finish(mut self) -> Run {
        if self.incidents_left_out > 0 {
            let last = self.run.incidents.last();
            let incident = Incident {
                t_ns: last.map_or(0, |it| it.t_ns),
                kind: "left out".to_owned(),
                text: format!(
                    "and {} more, which the event file has",
                    self.incidents_left_out
                ),
            };
            self.run.incidents.push(incident);
        }
        self.run
    }

    /// An application begins; if it has begun before, its container has died, and this is another.
    fn begin(&mut self, event: &Value) {
        let application = text(event, "application");
        if self.container == 0 || self.started.contains(&application) {
            self.container += 1;
            self.started.clear();
        }
        self.started.insert(application);
        let names: Vec<&str> = self.started.iter().map(String::as_str).collect();
        let run = &mut self.run;
        run.application = names.join(" + ");
        run.clock = text(event, "clock");
        run.seed = event.get("seed").and_then(Value::as_u64);
    }

    fn change(&mut self, t_ns: u64, event: &Value) {
        let change = StateChange {
            t_ns,
            from: text(event, "from"),
            to: text(event, "to"),
            incarnation: u32::try_from(number(event, "incarnation")).unwrap_or(u32::MAX),
        };
        let states = self.run.states.entry(text(event, "component"));
        states.or_default().push(change);
    }

    /// A tree has a row of its own among the components.
    fn begin_tree(&mut self, t_ns: u64, event: &Value) {
        let tree = text(event, "tree");
        self.change_tree(tree, t_ns, &text(event, "to").to_uppercase());
    }

    /// So have those of its nodes that have a name of their own.
    fn change_nodes(&mut self, t_ns: u64, event: &Value) {
        let tree = text(event, "tree");
        let nodes = event.get("nodes").and_then(Value::as_array);
        for node in nodes.into_iter().flatten() {
            let path = node.get(0).and_then(Value::as_str).unwrap_or_default();
            let status = node.get(1).and_then(Value::as_str).unwrap_or_default();
            if let Some(name) = own_name(path) {
                self.change_tree(format!("{tree}: {name}"), t_ns, status);
            }
        }
    }

    fn change_tree(&mut self, row: String, t_ns: u64, to: &str) {
        let is_known = self.run.states.contains_key(&row);
        if !is_known && self.run.tree_rows >= MOST_TREE_ROWS {
            return;
        }
        self.run.tree_rows += usize::from(!is_known);
        self.run.states.entry(row).or_default().push(StateChange {
            t_ns,
            from: String::new(),
            to: to.to_owned(),
            incarnation: 0,
        });
    }

    fn judge(&mut self, t_ns: u64, event: &Value) -> Result<(), String> {
        let verdict: Verdict = serde_json::from_value(event.clone())
            .map_err(|error| format!("it is no verdict: {error}"))?;
        let number = FaultNumber {
            container: self.container.max(1),
            id: verdict.id,
        };
        let faults = &mut self.run.faults;
        if faults.len() >= MOST_FAULTS && !faults.contains_key(&number) {
            self.run.verdicts_left_out += 1;
            return Ok(());
        }
        let fault = faults.entry(number).or_default();
        let is_over = matches!(verdict.state.as_str(), "HEALED" | "CLEARED");
        match is_over {
            true => _ = fault.healed_ns.get_or_insert(t_ns),
            false => fault.healed_ns = None,
        }
        fault.verdict = verdict;
        Ok(())
    }

    fn happen(&mut self, t_ns: u64, kind: &str, event: &Value) {
        let Some(text) = in_words(kind, event) else {
            return;
        };
        if self.run.incidents.len() >= MOST_INCIDENTS {
            self.incidents_left_out += 1;
            return;
        }
        let kind = kind.to_owned();
        self.run.incidents.push(Incident { t_ns, kind, text });
    }
}

/// An event as one number; two events are as good as never mistaken for each other.
fn mark(event: &Value) -> u64 {
    let mut hasher = DefaultHasher::new();
    event.to_string().hash(&mut hasher);
    hasher.finish()
}

/// The name that the author of a tree has given a node; none if it is only called what it is.
fn own_name(path: &str) -> Option<&str> {
    let name = path.rsplit('/').next()?;
    let kind = name.split("::").next()?;
    let is_kind = BUILT_IN.iter().any(|node| node.id == kind) || component_node(kind).is_some();
    (!is_kind && !name.is_empty()).then_some(name)
}

/// What happened; none for what is only noise. Faults stand in their verdicts.
fn in_words(kind: &str, event: &Value) -> Option<String> {
    let field = |name: &str| text(event, name);
    Some(match kind {
        "injection" => match event.get("component") {
            Some(_) => format!(
                "{} in {} {}",
                field("fault"),
                field("component"),
                field("change")
            ),
            None => format!("{} {}", field("fault"), field("change")),
        },
        "datum_set_aside" => format!(
            "{}: a datum of '{}' is set aside, two incarnations died with it in work",
            field("component"),
            field("port")
        ),
        "checkpoint_restored" => format!(
            "{} goes on from checkpoint {}, {} ms old",
            field("component"),
            number(event, "sequence"),
            number(event, "age_ms")
        ),
        "log" if matches!(field("level").as_str(), "error" | "warning") => {
            format!("{} says: {}", field("component"), field("message"))
        }
        "log" | "fault" => return None,
        "notice" => field("message"),
        "adaptation" => decided(event),
        "container_restarted" => format!(
            "{}; {}; {}; {:.3} s without a container",
            field("seen"),
            field("judged"),
            field("done"),
            // Far below 2^53.
            number(event, "without_container_us") as f64 / 1e6
        ),
        "container_given_up" => format!("{}; {}", field("seen"), field("judged")),
        "robot" => format!(
            "robot {}: {}: {}",
            field("robot"),
            field("change"),
            field("message")
        ),
        "tree_state" => format!(
            "tree {}: {} -> {}",
            field("tree"),
            field("from"),
            field("to")
        ),
        "target_reached" => "the robot has reached its target".to_owned(),
        _ => return None,
    })
}

/// A decision of self-adaptation: how it ended, how long it took, and what became of each candidate.
fn decided(event: &Value) -> String {
    let phases = &event["phases"];
    let microseconds: u64 = [
        "monitoring_us",
        "synthesis_us",
        "estimation_us",
        "reconfiguration_us",
    ]
    .iter()
    .map(|phase| number(phases, phase))
    .sum();
    let time_s = std::time::Duration::from_micros(microseconds).as_secs_f64();
    let candidates = event["candidates"].as_array();
    let candidates = candidates.into_iter().flatten().map(|candidate| {
        let components = candidate["components"].as_array();
        let components = components.into_iter().flatten();
        let components: Vec<&str> = components.filter_map(Value::as_str).collect();
        let quality = candidate["p_t"].as_f64();
        let quality = quality.map_or_else(String::new, |it| format!(", P_T {it:.4}"));
        let reason = match text(candidate, "rejected_because") {
            reason if reason.is_empty() => "taken".to_owned(),
            reason => format!("not taken: {reason}"),
        };
        format!(
            "; candidate {} ({}{quality}) {reason}",
            number(candidate, "number"),
            components.join(" | ")
        )
    });
    let candidates: String = candidates.collect();
    format!("{}, after {time_s:.3} s{candidates}", text(event, "text"))
}

fn text(event: &Value, field: &str) -> String {
    let found = event.get(field).and_then(Value::as_str);
    found.unwrap_or_default().to_owned()
}

fn number(event: &Value, field: &str) -> u64 {
    event.get(field).and_then(Value::as_u64).unwrap_or_default()
}

#[cfg(test)]
mod tests;
