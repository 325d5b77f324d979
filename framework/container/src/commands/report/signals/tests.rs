use serde_json::json;

use super::*;
use crate::commands::report::model::Verdict;

const MS: u64 = 1_000_000;

fn run_with(evidence: Value) -> Run {
    let verdict = Verdict {
        component: "sonar".to_owned(),
        evidence,
        first_symptom_ns: 3_000 * MS,
        confirmed_ns: 3_100 * MS,
        ..Verdict::default()
    };
    let fault = Fault {
        verdict,
        ..Fault::default()
    };
    let number = FaultNumber {
        container: 1,
        id: 1,
    };
    Run {
        faults: [(number, fault)].into(),
        ..Run::default()
    }
}

fn signal(run: &Run) -> &Signal {
    let fault = run.faults.values().next().expect("a fault");
    fault.signal.as_ref().expect("a signal")
}

#[test]
fn a_value_is_kept_around_its_fault() {
    let mut run = run_with(json!({"value": {"port": "range", "field": "echo[1].distance"}}));
    let mut collector = Collector::new(&run, "");
    assert!(collector.wants("/sonar/range") && !collector.wants("/sonar/image"));
    for (t_ms, distance) in [
        (1_900, json!(9)),
        (2_000, json!(1.5)),
        (3_000, json!("NaN")),
        (4_100, json!(null)),
        (4_101, json!(9)),
    ] {
        let datum = json!({"echo": [{}, {"distance": distance}]});
        collector.take("/sonar/range", t_ms * MS, &datum);
    }
    collector.finish(&mut run);
    let signal = signal(&run);
    assert_eq!(signal.name, "sonar/range: echo[1].distance");
    let times: Vec<u64> = signal.samples.iter().map(|(t_ns, _)| t_ns / MS).collect();
    assert_eq!(times, [2_000, 3_000, 4_100]);
    assert!(signal.samples[1].1.is_nan() && signal.samples[2].1.is_nan());
}

#[test]
fn an_age_is_a_sawtooth() {
    let mut run = run_with(json!({"age": {"port": "range"}}));
    let mut collector = Collector::new(&run, "");
    for t_ms in [1_950, 2_050, 2_150] {
        collector.take("/sonar/range", t_ms * MS, &json!({}));
    }
    collector.finish(&mut run);
    let samples: Vec<(u64, f64)> = (signal(&run).samples.iter())
        .map(|(t_ns, age)| (t_ns / MS, *age))
        .collect();
    let expected = [
        (2_050, 100.0),
        (2_050, 0.0),
        (2_150, 100.0),
        (2_150, 0.0),
        (4_100, 1950.0),
    ];
    assert_eq!(samples, expected);
}

#[test]
fn nothing_grows_without_bound() {
    let mut run = run_with(json!({"value": {"port": "range", "field": "d"}}));
    let mut collector = Collector::new(&run, "/wheels/odometry");
    for number in 0..3 * MOST_SAMPLES as u64 {
        collector.take("/sonar/range", 3_000 * MS + number, &json!({"d": 1}));
        collector.take("/wheels/odometry", number, &json!({"x": number, "y": 0}));
    }
    collector.finish(&mut run);
    assert_eq!(signal(&run).samples.len(), MOST_SAMPLES);
    assert_eq!(signal(&run).left_out, 2 * MOST_SAMPLES as u64);
    assert!(run.path.len() < MOST_POSES && run.path.len() > MOST_POSES / 4);
    assert!(run.path.last().expect("a pose").0 > 3 * MOST_SAMPLES as u64 - 32);
}

#[test]
fn a_pose_is_two_finite_numbers() {
    for (datum, expected) in [
        (json!({"x": 1.5, "y": 2, "heading": 0}), Some([1.5, 2.0])),
        (json!({"x": 1.5}), None),
        (json!({"x": "NaN", "y": 2}), None),
        (json!(7), None),
    ] {
        assert_eq!(pose(&datum), expected, "{datum}");
    }
}
