use proptest::prelude::*;
use serde_json::json;

use super::*;

fn field(path: &str, offset: usize, scalar: Scalar, count: usize) -> Field {
    Field {
        path: path.to_owned(),
        unit: String::new(),
        offset,
        scalar,
        count,
    }
}

fn data_type(size: usize, fields: Vec<Field>) -> DataType {
    DataType {
        name: "Sample".to_owned(),
        size,
        layout_hash: 0,
        fields,
    }
}

fn encoded(layout: &Layout, datum: &[u8]) -> Value {
    let mut text = Vec::new();
    layout.encode(datum, &mut text);
    serde_json::from_slice(&text).unwrap_or_else(|error| {
        panic!("{error}: {}", String::from_utf8_lossy(&text));
    })
}

fn nested() -> DataType {
    let mut fields = vec![
        field("time", 0, Scalar::U64, 1),
        field("pose.x", 8, Scalar::F64, 1),
        field("pose.heading", 16, Scalar::F32, 1),
        field("echoes[0].near", 20, Scalar::I16, 2),
        field("echoes[1].near", 24, Scalar::I16, 2),
        field("pixels", 28, Scalar::U8, 4),
    ];
    fields[1].unit = "m".to_owned();
    data_type(32, fields)
}

#[test]
fn structures_arrays_and_bytes_have_their_forms() {
    let layout = Layout::new(&nested());
    let mut datum = vec![0; 32];
    let written = json!({
        "time": u64::MAX, "pose": {"x": -0.1, "heading": 0.1},
        "echoes": [{"near": [1, -2]}, {"near": [3, 4]}], "pixels": "AP8BAg==",
    });
    layout.decode(&written, &mut datum).unwrap();
    assert_eq!(datum[28..], [0, 255, 1, 2]);
    assert_eq!(
        encoded(&layout, &datum),
        json!({
            "time": u64::MAX, "pose": {"x": -0.1, "heading": 0.1},
            "echoes": [{"near": [1, -2]}, {"near": [3, 4]}], "pixels": "AP8BAg==",
        })
    );
    assert_eq!(
        layout.schema(),
        &json!({
            "title": "Sample", "type": "object", "properties": {
                "time": {"type": "integer"},
                "pose": {"type": "object", "properties": {
                    "x": {"type": "number", "description": "in m"}, "heading": {"type": "number"},
                }},
                "echoes": {"type": "array", "items": {"type": "object", "properties": {
                    "near": {"type": "array", "items": {"type": "integer"}},
                }}},
                "pixels": {"type": "string", "contentEncoding": "base64"},
            },
        })
    );
}

#[test]
fn numbers_that_json_lacks_are_words() {
    let layout = Layout::new(&data_type(8, vec![field("value", 0, Scalar::F64, 1)]));
    for (number, expected) in [
        (f64::NAN, json!("NaN")),
        (f64::INFINITY, json!("Infinity")),
        (f64::NEG_INFINITY, json!("-Infinity")),
        (1e300, json!(1e300)),
    ] {
        let json = encoded(&layout, &number.to_ne_bytes());
        assert_eq!(json["value"], expected);
        let mut datum = [0; 8];
        layout.decode(&json, &mut datum).unwrap();
        assert_eq!(f64::from_ne_bytes(datum).to_string(), number.to_string());
    }
}

#[test]
fn names_that_contradict_each_other_or_json_are_kept() {
    let names = ["a", "a.b", "a", "qu\"ote/s~", "list[1].x"];
    let at = |(index, name): (usize, &&str)| field(name, index, Scalar::I8, 1);
    let layout = Layout::new(&data_type(5, names.iter().enumerate().map(at).collect()));
    let json = encoded(&layout, &[1, 2, 3, 4, 5]);
    assert_eq!(json.as_object().unwrap().len(), 5, "{json}");
    let mut datum = [0; 5];
    layout.decode(&json, &mut datum).unwrap();
    assert_eq!(datum, [1, 2, 3, 4, 5]);
}

#[test]
fn what_is_no_datum_of_the_type_is_refused() {
    let layout = Layout::new(&nested());
    let good = encoded(&layout, &[0; 32]);
    for (pointer, value, expected) in [
        ("/time", json!(-1), "field 'time' cannot be -1"),
        ("/pose/x", json!("far"), "field 'pose.x' cannot be \"far\""),
        ("/pose", json!({"x": 1}), "it has no field 'pose.heading'"),
        (
            "/echoes/1/near",
            json!([1]),
            "field 'echoes[1].near' cannot be [1]",
        ),
        (
            "/pixels",
            json!("AA=="),
            "field 'pixels' cannot be \"AA==\"",
        ),
    ] {
        let mut message = good.clone();
        *message.pointer_mut(pointer).unwrap() = value;
        let refused = layout.decode(&message, &mut [0; 32]).unwrap_err();
        assert_eq!(refused.to_string(), expected);
    }
    let refused = layout.decode(&good, &mut [0; 31]).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "a datum of 'Sample' has 32 bytes, not 31"
    );
}

proptest! {
    /// Every bit pattern of a datum survives, but for which NaN it was.
    #[test]
    fn written_and_read_is_the_same(bytes in proptest::collection::vec(any::<u8>(), 32)) {
        let layout = Layout::new(&nested());
        let json = encoded(&layout, &bytes);
        let mut datum = vec![0; 32];
        layout.decode(&json, &mut datum).unwrap();
        prop_assert_eq!(encoded(&layout, &datum), json);
    }
}
