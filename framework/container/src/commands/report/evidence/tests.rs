use serde_json::{Value, json};

use super::*;

fn of(evidence: Value) -> Evidence {
    super::evidence(&Verdict {
        component: "sonar".to_owned(),
        kind: "fault_event".to_owned(),
        evidence,
        ..Verdict::default()
    })
}

#[test]
fn every_kind_is_a_sentence() {
    for (evidence, expected) in [
        (
            json!({"exception": {"callback": "onExecute", "message": "SIGSEGV", "thread_lost": false}}),
            "SIGSEGV in onExecute",
        ),
        (
            json!({"value": {"port": "range", "field": "distance", "value": 0.0, "minimum": 0.03,
                             "maximum": 3.0}}),
            "distance of range was 0, 0.03 to 3 are allowed",
        ),
        (
            json!({"value": {"port": "range", "field": "distance", "value": "NaN"}}),
            "distance of range was NaN, which is no number that can be used",
        ),
        (
            json!({"jump": {"port": "p", "field": "f", "value": 2.0, "rate": 9.0,
                            "maximum_per_second": 4.0}}),
            "f of p jumped to 2, by 9 per second where 4 are allowed",
        ),
        (
            json!({"frozen": {"port": "p", "field": "", "count": 20}}),
            "p was the same 20 times",
        ),
        (
            json!({"size": {"port": "p", "size": 4, "expected": 8}}),
            "a datum of p had 4 bytes instead of 8",
        ),
        (
            json!({"age": {"port": "p", "age_ms": 210.0, "maximum_ms": 200.0}}),
            "nothing new came to p for 210 ms, 200 ms are allowed",
        ),
        (
            json!({"overruns": {"count": 4, "tolerated": 3, "within_ms": 1000.0}}),
            "4 cycles took too long within 1000 ms, 3 are tolerated",
        ),
        (
            json!({"heartbeat": {"missed": 2, "period_ms": 80.0}}),
            "no work was completed in 2 periods of 80 ms",
        ),
        (
            json!({"memory": {"used_kb": 70, "limit_kb": 64}}),
            "70 kB were allocated and not freed, 64 kB are allowed",
        ),
        (
            json!({"residual": {"monitor": "drive", "method": "cusum", "residual": -0.08,
                                "statistic": 0.05, "threshold": 0.04}}),
            "monitor drive: what was measured was off by -0.08 from what the model says; cusum made \
             0.05 of that, the threshold is 0.04",
        ),
        (
            json!({"votes": {"voter": "front", "value": 2.2, "voted": 1.7, "tolerance": 0.1,
                             "votes": [1.7, 2.2, null]}}),
            "voter front: it said 2.2, 1.7 was voted, and 0.1 of difference is allowed",
        ),
        (
            json!({"smell": {"of": "smoke"}}),
            "smell: {\"of\":\"smoke\"}",
        ),
        (json!(null), "fault event was reported"),
    ] {
        assert_eq!(of(evidence.clone()).seen, expected, "{evidence}");
    }
}

#[test]
fn an_exception_has_notes() {
    let notes = of(json!({"exception": {
        "callback": "onStart", "message": "panicked", "place": "src/lib.rs:7:5",
        "backtrace": ["planner::plan", "planner::step"], "thread_lost": true, "damage": "heap",
    }}));
    assert_eq!(
        notes.notes,
        [
            "at src/lib.rs:7:5",
            "planner::plan",
            "planner::step",
            "heap",
            "its thread was set aside with it"
        ]
    );
}

#[test]
fn what_is_drawn_and_what_is_looked_for() {
    let value = of(
        json!({"value": {"port": "range", "field": "distances[2]", "value": "NaN",
                                    "maximum": 3.0}}),
    );
    let wanted = value.wanted.expect("a signal");
    assert_eq!(
        (wanted.topic.as_str(), wanted.field.as_str()),
        ("/sonar/range", "distances[2]")
    );
    assert_eq!(wanted.kind, WantedKind::Value);
    let Some(Drawing::Level(level)) = value.drawing else {
        panic!("a level");
    };
    assert!(level.value.is_nan() && level.minimum.is_none() && level.maximum == Some(3.0));

    let age = of(json!({"age": {"port": "p", "age_ms": 210.0, "maximum_ms": 200.0}}));
    assert_eq!(age.wanted.expect("a signal").kind, WantedKind::Age);
    let residual = of(json!({"residual": {"monitor": "drive", "statistic": 1, "threshold": 2}}));
    let wanted = residual.wanted.expect("a signal");
    assert_eq!(wanted.topic, "/sonar/drive:residual");
    assert_eq!(wanted.field, "statistic");
    let size = of(json!({"size": {"port": "p", "size": 4, "expected": 8}}));
    assert_eq!((size.wanted, size.drawing), (None, None));
    let votes = of(
        json!({"votes": {"value": 2.2, "voted": 1.7, "tolerance": 0.1,
                                    "votes": [1.7, "NaN", null]}}),
    );
    let Some(Drawing::Votes { votes, .. }) = votes.drawing else {
        panic!("votes");
    };
    assert_eq!(votes.len(), 3);
    assert!(votes[1].is_some_and(f64::is_nan) && votes[2].is_none());
}
