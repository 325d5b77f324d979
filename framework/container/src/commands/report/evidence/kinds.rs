//! The kinds of evidence: a sentence of each, and what can be drawn of it.

use serde_json::Value;

use super::{Drawing, Evidence, Level, Wanted, WantedKind};
use crate::commands::report::amounts::{number, read};

/// The fields of one kind of evidence.
pub(super) struct Fields<'value>(pub(super) &'value Value);

impl Fields<'_> {
    pub(super) fn text(&self, name: &str) -> String {
        let found = self.0.get(name).and_then(Value::as_str);
        found.unwrap_or_default().to_owned()
    }

    fn number(&self, name: &str) -> Option<f64> {
        self.0.get(name).and_then(read)
    }

    fn shown(&self, name: &str) -> String {
        self.number(name).map_or_else(|| "?".to_owned(), number)
    }

    fn lines(&self, name: &str) -> Vec<String> {
        let lines = self.0.get(name).and_then(Value::as_array);
        let lines = lines.into_iter().flatten().filter_map(Value::as_str);
        lines.map(str::to_owned).collect()
    }

    /// `field` of port `port`, or the port alone.
    fn place(&self) -> String {
        match self.text("field") {
            field if field.is_empty() => self.text("port"),
            field => format!("{field} of {}", self.text("port")),
        }
    }

    fn wanted(&self, component: &str, kind: WantedKind) -> Option<Wanted> {
        Some(Wanted {
            topic: format!("/{component}/{}", self.text("port")),
            field: self.text("field"),
            kind,
        })
    }

    fn level(&self, quantity: &str, value: &str, maximum: &str) -> Option<Drawing> {
        Some(Drawing::Level(Level {
            quantity: quantity.to_owned(),
            value: self.number(value)?,
            minimum: None,
            maximum: Some(self.number(maximum)?),
        }))
    }
}

pub(super) fn exception(fields: &Fields<'_>) -> Evidence {
    let mut notes = Vec::new();
    let place = fields.text("place");
    if !place.is_empty() {
        notes.push(format!("at {place}"));
    }
    notes.extend(fields.lines("backtrace"));
    let damage = fields.text("damage");
    if !damage.is_empty() {
        notes.push(damage);
    }
    if fields.0.get("thread_lost") == Some(&Value::Bool(true)) {
        notes.push("its thread was set aside with it".to_owned());
    }
    Evidence {
        seen: format!("{} in {}", fields.text("message"), fields.text("callback")),
        notes,
        ..Evidence::default()
    }
}

pub(super) fn of_port(kind: &str, fields: &Fields<'_>, component: &str) -> Evidence {
    let place = fields.place();
    let value = fields.shown("value");
    let (seen, drawing) = match kind {
        "value" => (
            format!("{place} was {value}{}", bounds(fields)),
            range(fields, &place),
        ),
        "jump" => (
            format!(
                "{place} jumped to {value}, by {} per second where {} are allowed",
                fields.shown("rate"),
                fields.shown("maximum_per_second")
            ),
            fields.level("change per second", "rate", "maximum_per_second"),
        ),
        "frozen" => (
            format!("{place} was the same {} times", fields.shown("count")),
            None,
        ),
        "size" => (
            format!(
                "a datum of {place} had {} bytes instead of {}",
                fields.shown("size"),
                fields.shown("expected")
            ),
            None,
        ),
        _ => (
            format!(
                "nothing new came to {place} for {} ms, {} ms are allowed",
                fields.shown("age_ms"),
                fields.shown("maximum_ms")
            ),
            fields.level("age in ms", "age_ms", "maximum_ms"),
        ),
    };
    let wanted = match kind {
        "size" => None,
        "age" => fields.wanted(component, WantedKind::Age),
        _ if fields.text("field").is_empty() => None,
        _ => fields.wanted(component, WantedKind::Value),
    };
    Evidence {
        seen,
        drawing,
        wanted,
        ..Evidence::default()
    }
}

fn bounds(fields: &Fields<'_>) -> String {
    let (minimum, maximum) = (fields.number("minimum"), fields.number("maximum"));
    match (minimum, maximum) {
        (Some(least), Some(most)) => {
            format!(", {} to {} are allowed", number(least), number(most))
        }
        (Some(least), None) => format!(", at least {} is allowed", number(least)),
        (None, Some(most)) => format!(", at most {} is allowed", number(most)),
        (None, None) => ", which is no number that can be used".to_owned(),
    }
}

fn range(fields: &Fields<'_>, place: &str) -> Option<Drawing> {
    Some(Drawing::Level(Level {
        quantity: place.to_owned(),
        value: fields.number("value")?,
        minimum: fields.number("minimum"),
        maximum: fields.number("maximum"),
    }))
}

pub(super) fn residual(fields: &Fields<'_>, component: &str) -> Evidence {
    let statistic = fields.number("statistic");
    Evidence {
        seen: format!(
            "monitor {}: what was measured was off by {} from what the model says; {} made {} of \
             that, the threshold is {}",
            fields.text("monitor"),
            fields.shown("residual"),
            fields.text("method"),
            statistic.map_or_else(|| "?".to_owned(), number),
            fields.shown("threshold")
        ),
        drawing: fields.level("decision statistic", "statistic", "threshold"),
        wanted: Some(Wanted {
            topic: format!("/{component}/{}:residual", fields.text("monitor")),
            field: "statistic".to_owned(),
            kind: WantedKind::Value,
        }),
        ..Evidence::default()
    }
}

pub(super) fn votes(fields: &Fields<'_>) -> Evidence {
    let votes = fields.0.get("votes").and_then(Value::as_array);
    let votes: Vec<Option<f64>> = votes.into_iter().flatten().map(read).collect();
    let numbers = [
        fields.number("value"),
        fields.number("voted"),
        fields.number("tolerance"),
    ];
    let drawing = match numbers {
        [Some(dissent), Some(voted), Some(tolerance)] => Some(Drawing::Votes {
            votes,
            dissent,
            voted,
            tolerance,
        }),
        _ => None,
    };
    Evidence {
        seen: format!(
            "voter {}: it said {}, {} was voted, and {} of difference is allowed",
            fields.text("voter"),
            fields.shown("value"),
            fields.shown("voted"),
            fields.shown("tolerance")
        ),
        drawing,
        ..Evidence::default()
    }
}

pub(super) fn of_work(kind: &str, fields: &Fields<'_>) -> Evidence {
    let (seen, drawing) = match kind {
        "overruns" => (
            format!(
                "{} cycles took too long within {} ms, {} are tolerated",
                fields.shown("count"),
                fields.shown("within_ms"),
                fields.shown("tolerated")
            ),
            fields.level("cycles that took too long", "count", "tolerated"),
        ),
        "heartbeat" => (
            format!(
                "no work was completed in {} periods of {} ms",
                fields.shown("missed"),
                fields.shown("period_ms")
            ),
            None,
        ),
        _ => (
            format!(
                "{} kB were allocated and not freed, {} kB are allowed",
                fields.shown("used_kb"),
                fields.shown("limit_kb")
            ),
            fields.level("allocated kB", "used_kb", "limit_kb"),
        ),
    };
    Evidence {
        seen,
        drawing,
        ..Evidence::default()
    }
}
