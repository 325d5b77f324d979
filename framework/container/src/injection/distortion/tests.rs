//! Distortions of a datum with a number of every type.

use system_model::data_type::{Field, Scalar};

use super::*;

/// Type, number of elements.
const LAYOUT: [(&str, Scalar, usize); 12] = [
    ("time", Scalar::U64, 1),
    ("pose.time", Scalar::U64, 1),
    ("u8", Scalar::U8, 8),
    ("u16", Scalar::U16, 4),
    ("u32", Scalar::U32, 2),
    ("u64", Scalar::U64, 1),
    ("i8", Scalar::I8, 8),
    ("i16", Scalar::I16, 4),
    ("i32", Scalar::I32, 2),
    ("i64", Scalar::I64, 1),
    ("f32", Scalar::F32, 2),
    ("f64", Scalar::F64, 1),
];

fn data_type() -> DataType {
    let fields = LAYOUT.iter().enumerate();
    let fields = fields.map(|(index, (path, scalar, count))| Field {
        path: (*path).to_owned(),
        unit: String::new(),
        offset: 8 * index,
        scalar: *scalar,
        count: *count,
    });
    DataType {
        name: "Everything".into(),
        size: 8 * LAYOUT.len(),
        layout_hash: 0,
        fields: fields.collect(),
    }
}

/// A datum whose numbers are all `value`.
fn datum(value: u8) -> Datum {
    let mut datum = Datum::empty(8 * LAYOUT.len());
    for (index, (_, scalar, count)) in LAYOUT.iter().enumerate() {
        for element in 0..*count {
            let start = 8 * index + element * scalar.size();
            let bytes = &mut datum.bytes_mut()[start..start + scalar.size()];
            match scalar {
                Scalar::F32 => bytes.copy_from_slice(&f32::from(value).to_ne_bytes()),
                Scalar::F64 => bytes.copy_from_slice(&f64::from(value).to_ne_bytes()),
                _ => {
                    let number = u64::from(value).to_ne_bytes();
                    match cfg!(target_endian = "little") {
                        true => bytes.copy_from_slice(&number[..scalar.size()]),
                        false => bytes.copy_from_slice(&number[8 - scalar.size()..]),
                    }
                }
            }
        }
    }
    datum
}

/// The elements of a field.
fn read(datum: &Datum, path: &str) -> Vec<f64> {
    let index = LAYOUT.iter().position(|(name, ..)| *name == path).unwrap();
    let (_, scalar, count) = LAYOUT[index];
    let start = 8 * index;
    let bytes = &datum.bytes()[start..start + scalar.size() * count];
    macro_rules! numbers {
        ($type:ty) => {
            bytes
                .chunks_exact(scalar.size())
                .map(|bytes| <$type>::from_ne_bytes(bytes.try_into().unwrap()) as f64)
                .collect()
        };
    }
    match scalar {
        Scalar::U8 => numbers!(u8),
        Scalar::U16 => numbers!(u16),
        Scalar::U32 => numbers!(u32),
        Scalar::U64 => numbers!(u64),
        Scalar::I8 => numbers!(i8),
        Scalar::I16 => numbers!(i16),
        Scalar::I32 => numbers!(i32),
        Scalar::I64 => numbers!(i64),
        Scalar::F32 => numbers!(f32),
        Scalar::F64 => numbers!(f64),
    }
}

fn distort(field: Option<&str>, distortion: Distortion) -> PortDistortion {
    PortDistortion::new(&data_type(), field, distortion, 7, 0).unwrap()
}

fn after(field: Option<&str>, distortion: Distortion) -> Datum {
    let mut distorted = datum(100);
    let passage = distort(field, distortion).apply(&mut distorted, Duration::ZERO);
    assert_eq!(passage, Passage::Deliver);
    distorted
}

#[test]
fn numbers_of_every_type_are_changed_and_integers_saturate() {
    use Distortion::{Offset, OutOfRange};
    let table: [(&str, Distortion, f64); 18] = [
        ("u8", OutOfRange(-1.0), 0.0),
        ("u8", OutOfRange(1e9), 255.0),
        ("u8", Offset(200.0), 255.0),
        ("u8", Offset(-200.0), 0.0),
        ("u16", Offset(0.6), 101.0),
        ("u32", Offset(-1e30), 0.0),
        ("u64", OutOfRange(1e30), u64::MAX as f64),
        ("i8", Offset(100.0), 127.0),
        ("i8", OutOfRange(-1000.0), -128.0),
        ("i16", OutOfRange(-1000.4), -1000.0),
        ("i32", Offset(-200.0), -100.0),
        ("i32", Offset(1e30), f64::from(i32::MAX)),
        ("i64", Offset(-1e30), i64::MIN as f64),
        ("i64", Offset(f64::MAX), i64::MAX as f64),
        ("f32", OutOfRange(0.5), 0.5),
        ("f32", Offset(-0.5), 99.5),
        ("f64", Offset(0.25), 100.25),
        ("time", Offset(5.0), 105.0),
    ];
    for (path, distortion, expected) in table {
        let distorted = after(Some(path), distortion);
        for (other, _, count) in LAYOUT {
            let wanted = if other == path { expected } else { 100.0 };
            let found = read(&distorted, other);
            assert_eq!(
                found,
                vec![wanted; count],
                "{distortion:?} of {path}: {other}"
            );
        }
    }
}

#[test]
fn whole_numbers_of_64_bits_are_kept_exactly() {
    let mut large = datum(0);
    let number = (1u64 << 53) + 1;
    large.bytes_mut()[40..48].copy_from_slice(&number.to_ne_bytes());
    distort(Some("u64"), Distortion::Offset(2.0)).apply(&mut large, Duration::ZERO);
    assert_eq!(large.bytes()[40..48], (number + 2).to_ne_bytes());
}

#[test]
fn without_a_field_all_is_changed_but_the_time() {
    let distorted = after(None, Distortion::OutOfRange(3.0));
    for (path, _, count) in LAYOUT {
        let wanted = if path.ends_with("time") { 100.0 } else { 3.0 };
        assert_eq!(read(&distorted, path), vec![wanted; count], "{path}");
    }
    let distorted = after(None, Distortion::NotANumber);
    for (path, scalar, _) in LAYOUT {
        let float = matches!(scalar, Scalar::F32 | Scalar::F64);
        let all = read(&distorted, path);
        assert!(all.iter().all(|number| number.is_nan() == float), "{path}");
    }
}

#[test]
fn what_cannot_be_changed_is_refused() {
    let refusal = |data_type: &DataType, field, distortion| {
        let distortion = PortDistortion::new(data_type, field, distortion, 7, 0);
        distortion.map(|_| ()).unwrap_err().to_string()
    };
    let everything = data_type();
    let unknown = refusal(&everything, Some("f65"), Distortion::Stuck);
    assert!(unknown.starts_with("Everything has no field 'f65'; it has: time, "));
    let integers = refusal(&everything, Some("i32"), Distortion::NotANumber);
    assert!(integers.contains("whole numbers"), "{integers}");
    let mut opaque = everything;
    opaque.fields.clear();
    for field in [None, Some("f64")] {
        let nothing = refusal(&opaque, field, Distortion::Offset(1.0));
        assert_eq!(nothing, "Everything has no fields that could be changed");
    }
    assert!(PortDistortion::new(&opaque, None, Distortion::Drop, 7, 0).is_ok());
}

#[test]
fn a_stuck_value_is_the_first_one_and_its_time_goes_on() {
    let mut stuck = distort(None, Distortion::Stuck);
    let values = |value, stuck: &mut PortDistortion| {
        let mut datum = datum(value);
        stuck.apply(&mut datum, Duration::ZERO);
        (read(&datum, "time")[0], read(&datum, "f64")[0])
    };
    assert_eq!(values(5, &mut stuck), (5.0, 5.0));
    assert_eq!(values(6, &mut stuck), (6.0, 5.0));
    stuck.restart();
    assert_eq!(values(7, &mut stuck), (7.0, 7.0));
}

#[test]
fn a_drift_grows_from_where_it_began() {
    let mut drift = distort(Some("f64"), Distortion::Drift(-0.5));
    let value = |second, drift: &mut PortDistortion| {
        let mut datum = datum(100);
        drift.apply(&mut datum, Duration::from_secs(second));
        read(&datum, "f64")[0]
    };
    assert_eq!(value(10, &mut drift), 100.0);
    assert_eq!(value(14, &mut drift), 98.0);
    drift.restart();
    assert_eq!(value(20, &mut drift), 100.0);
}

#[test]
fn noise_has_its_deviation_and_its_seed() {
    let draw = |seed| {
        let data_type = data_type();
        let mut noise =
            PortDistortion::new(&data_type, Some("f64"), Distortion::Noise(0.5), seed, 0).unwrap();
        let values = (0..4000).map(|_| {
            let mut datum = datum(100);
            noise.apply(&mut datum, Duration::ZERO);
            read(&datum, "f64")[0] - 100.0
        });
        values.collect::<Vec<f64>>()
    };
    let values = draw(1);
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|value| value * value).sum::<f64>() / count;
    // Six standard errors.
    assert!(mean.abs() < 0.05, "{mean}");
    assert!((variance.sqrt() - 0.5).abs() < 0.04, "{variance}");
    assert_eq!(draw(1), values);
    assert_ne!(draw(2), values);
}

#[test]
fn data_are_lost_doubled_or_late() {
    let mut original = datum(1);
    original.set_origin(77, 3);
    let now = Duration::ZERO;
    let mut passage = |distortion| distort(None, distortion).apply(&mut original, now);
    assert_eq!(passage(Distortion::Drop), Passage::Withhold);
    assert_eq!(passage(Distortion::Duplicate), Passage::DeliverTwice);

    let ms = Duration::from_millis;
    let mut late = distort(None, Distortion::Delay(ms(50)));
    for time in [0, 20, 40] {
        original.set_origin(time, 3);
        assert_eq!(late.apply(&mut original, ms(time)), Passage::Withhold);
    }
    late.restart();
    let stamps = |late: &mut PortDistortion, now| {
        let mut stamps = Vec::new();
        while let Some(datum) = late.due(ms(now)) {
            assert_eq!((datum.incarnation(), read(&datum, "f64")[0]), (3, 1.0));
            stamps.push(datum.stamp_ns());
        }
        stamps
    };
    assert_eq!(stamps(&mut late, 49), [0; 0]);
    assert_eq!(stamps(&mut late, 50), [0]);
    assert_eq!(stamps(&mut late, 100), [20, 40]);
}

#[test]
fn what_waits_is_bounded() {
    let mut late = distort(None, Distortion::Delay(Duration::from_secs(1)));
    for _ in 0..MAX_DELAYED + 3 {
        late.apply(&mut datum(1), Duration::ZERO);
    }
    assert_eq!((late.delayed.len(), late.lost()), (MAX_DELAYED, 3));

    let mut large = data_type();
    large.size = MAX_DELAYED_BYTES / 2 + 1;
    let delay = Distortion::Delay(Duration::from_secs(1));
    let mut late = PortDistortion::new(&large, None, delay, 7, 0).unwrap();
    for _ in 0..2 {
        late.apply(&mut Datum::empty(large.size), Duration::ZERO);
    }
    assert_eq!((late.delayed.len(), late.lost()), (1, 1));
}

#[test]
fn a_datum_of_another_size_is_left_alone() {
    let mut short = Datum::empty(8);
    let passage = distort(None, Distortion::Drop).apply(&mut short, Duration::ZERO);
    assert_eq!(passage, Passage::Deliver);
}
