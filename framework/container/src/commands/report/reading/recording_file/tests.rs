use recording::{Layout, RecordingWriter};
use serde_json::{Value, json};
use system_model::data_type::{DataType, Field, Scalar};

use super::*;

const SECOND: u64 = 1_000_000_000;

/// The events of a run in which a sonar reads too little.
fn events(application: &str) -> Vec<Value> {
    let evidence = json!({"value": {"port": "range", "field": "distance", "minimum": 0.5}});
    vec![
        json!({"t_ns": 0, "event": "run_started", "application": application}),
        json!({"t_ns": 3 * SECOND, "event": "verdict", "id": 1, "component": "sonar",
               "first_symptom_ns": 3 * SECOND, "confirmed_ns": 3 * SECOND, "evidence": evidence}),
    ]
}

fn layout(names: &[&str]) -> Layout {
    let fields = names.iter().zip(0..).map(|(name, number)| Field {
        path: (*name).to_owned(),
        unit: "m".to_owned(),
        offset: 8 * number,
        scalar: Scalar::F64,
        count: 1,
    });
    Layout::new(&DataType {
        name: names.concat(),
        size: 8 * names.len(),
        layout_hash: 1,
        fields: fields.collect(),
    })
}

/// A recording of a run of six seconds.
fn record(path: &Path, events: &[Value]) {
    let mut file = RecordingWriter::create(path, &[]).expect("a file");
    let (range, odometry) = (layout(&["distance"]), layout(&["x", "y"]));
    let mut add = |component, port, layout| {
        let channel = file.add_port(component, port, "output", layout);
        channel.expect("a port")
    };
    let sonar = add("sonar", "range", &range);
    let wheels = add("wheels", "odometry", &odometry);
    for event in events {
        let t_ns = event["t_ns"].as_u64().expect("a time");
        let written = file.write_topic(Topic::Events, t_ns, event);
        written.expect("an event");
    }
    for number in 0..60u32 {
        let t_ns = u64::from(number) * SECOND / 10;
        let (distance, y) = (f64::from(number).to_ne_bytes(), 0f64.to_ne_bytes());
        let mut json = Vec::new();
        range.encode(&distance, &mut json);
        file.write(sonar, t_ns, t_ns, &json).expect("a datum");
        json.clear();
        odometry.encode(&[distance, y].concat(), &mut json);
        file.write(wheels, t_ns, t_ns, &json).expect("a datum");
    }
    file.finish().expect("a file");
}

#[test]
fn a_recording_alone_tells_of_a_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.mcap");
    record(&path, &events("patrol"));
    let (gathering, recording) = read(&path).expect("a recording");
    let mut run = gathering.finish();
    collect(&recording, &mut run).expect("data");
    assert_eq!(run.application, "patrol");
    assert_eq!(run.path_topic, "/wheels/odometry");
    assert_eq!(run.path.len(), 60);
    let fault = run.faults.values().next().expect("a fault");
    let signal = fault.signal.as_ref().expect("a signal");
    let values: Vec<f64> = signal.samples.iter().map(|(_, value)| *value).collect();
    let ends = values.first().zip(values.last());
    assert_eq!(ends, Some((&20.0, &40.0)), "a second around");
}

#[test]
fn a_recording_belongs_to_the_run_that_told_of_its_events() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("box.mcap");
    let gathered = |events: &[Value]| {
        let mut gathering = Gathering::new("events.jsonl".to_owned());
        for event in events {
            gathering.learn(event).expect("an event");
        }
        gathering
    };
    let (patrol, other) = (gathered(&events("patrol")), gathered(&events("mapping")));
    for (recorded, known, expected) in [
        (events("patrol"), vec![&other, &patrol], Some(1)),
        // A black box has a part of a run only.
        (
            events("patrol").split_off(1),
            vec![&patrol, &other],
            Some(0),
        ),
        (events("cleaning"), vec![&other, &patrol], None),
        (Vec::new(), vec![&patrol], None),
        (events("patrol"), vec![], None),
    ] {
        record(&path, &recorded);
        let found = run_of(&path, &known).expect("a recording");
        assert_eq!(found.map(|(index, _)| index), expected);
    }
}

#[test]
fn a_recording_without_events_is_no_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.mcap");
    record(&path, &[]);
    let failed = read(&path).expect_err("no run");
    assert_eq!(failed.code, exit_code::REFUSED, "{}", failed.text);
}
