use serde_json::json;
use system_model::data_type::{DataType, Field, Scalar};

use super::*;
use crate::{Layout, RecordingWriter, Topic};

fn layout() -> Layout {
    Layout::new(&DataType {
        name: "Range".to_owned(),
        size: 8,
        layout_hash: 0xabc,
        fields: vec![Field {
            path: "distance".to_owned(),
            unit: "m".to_owned(),
            offset: 0,
            scalar: Scalar::F64,
            count: 1,
        }],
    })
}

/// A file of so many data, flushed after every hundredth.
fn written(path: &Path, count: u32) {
    let about = [("application", "robot".to_owned())];
    let mut recording = RecordingWriter::create(path, &about).unwrap();
    let layout = layout();
    let range = recording
        .add_port("front_sonar", "range", "output", &layout)
        .unwrap();
    let event = json!({"t_ns": 0, "event": "run_started"});
    recording.write_topic(Topic::Events, 0, &event).unwrap();
    for number in 0..count {
        let mut json = Vec::new();
        layout.encode(&f64::from(number).to_ne_bytes(), &mut json);
        let time_ns = u64::from(number) * 1000;
        recording.write(range, time_ns, time_ns, &json).unwrap();
        if number % 100 == 99 {
            recording.flush().unwrap();
        }
    }
    assert_eq!(recording.messages(), u64::from(count) + 1);
    recording.finish().unwrap();
}

#[test]
fn what_was_written_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.mcap");
    written(&path, 250);
    let mut reader = read(&path).unwrap();
    let first = reader.next().unwrap().unwrap();
    assert_eq!((first.topic(), first.t_ns), ("/events", 0));
    assert_eq!(reader.about()["application"], "robot");
    let second = reader.next().unwrap().unwrap();
    assert_eq!(second.topic(), "/front_sonar/range");
    assert_eq!(second.channel.schema, "Range");
    assert_eq!(second.channel.metadata["layout_hash"], "0xabc");
    let rest: Vec<Message> = reader.by_ref().collect::<Result<_, _>>().unwrap();
    assert_eq!(rest.len(), 249);
    assert_eq!(rest[248].value, json!({"distance": 249.0}));
    assert_eq!(rest[248].t_ns, 249_000);
    assert!(!reader.was_cut());
}

#[test]
fn only_what_is_wanted_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.mcap");
    written(&path, 250);
    for (wanted, expected) in [("/events", 1), ("/front_sonar/range", 250), ("/camera", 0)] {
        let mut reader = read(&path).unwrap();
        let mut count = 0;
        while let Some(message) = reader.next_of(|topic| topic == wanted) {
            assert_eq!(message.unwrap().topic(), wanted);
            count += 1;
        }
        assert_eq!(count, expected, "{wanted}");
    }
}

#[test]
fn a_file_that_is_cut_is_read_up_to_there() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.mcap");
    written(&path, 1000);
    let whole = std::fs::read(&path).unwrap();
    let mut last = 0;
    for percent in [30, 60, 75] {
        std::fs::write(&path, &whole[..whole.len() * percent / 100]).unwrap();
        let mut reader = read(&path).unwrap();
        let found = reader.by_ref().filter(|it| it.is_ok()).count();
        assert!(reader.was_cut());
        assert!(found > last && found < 1001, "{found} at {percent} %");
        last = found;
    }
}

#[test]
fn what_is_no_recording_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.mcap");
    assert!(matches!(read(&path), Err(ReadError::File { .. })));
    written(&path, 250);
    let mut damaged = std::fs::read(&path).unwrap();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 0xff;
    let text = b"<package_profile/> and more of it".to_vec();
    for (content, expected) in [(text, "no MCAP file"), (damaged, "damaged after")] {
        std::fs::write(&path, content).unwrap();
        let error = read(&path).unwrap().find_map(Result::err).unwrap();
        assert!(error.to_string().contains(expected), "{error}");
    }
}
