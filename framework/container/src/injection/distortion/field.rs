//! Numbers of a datum, of whatever type they are.

use std::ops::Range;

use system_model::data_type::{DataType, Field, Scalar};
use system_model::injection::Distortion;

use super::DistortionError;

/// One field of a datum, or an array of them.
#[derive(Debug)]
pub(super) struct Target {
    scalar: Scalar,
    bytes: Range<usize>,
}

/// The fields that a distortion changes; none if it concerns a datum as a whole.
pub(super) fn targets(
    data_type: &DataType,
    field: Option<&str>,
    distortion: Distortion,
) -> Result<Vec<Target>, DistortionError> {
    if matches!(
        distortion,
        Distortion::Drop | Distortion::Delay(_) | Distortion::Duplicate
    ) {
        return Ok(Vec::new());
    }
    let is_meant = |candidate: &&Field| match field {
        Some(path) => candidate.path == path,
        None => !is_time(&candidate.path),
    };
    let meant: Vec<&Field> = data_type.fields.iter().filter(is_meant).collect();
    if meant.is_empty() {
        return Err(nothing_meant(data_type, field));
    }
    let floats_only = distortion == Distortion::NotANumber;
    let targets = meant
        .into_iter()
        .filter(|field| !floats_only || matches!(field.scalar, Scalar::F32 | Scalar::F64))
        .filter_map(|field| Target::new(field, data_type.size));
    let targets: Vec<Target> = targets.collect();
    if targets.is_empty() {
        return Err(DistortionError::OnlyIntegers {
            data_type: data_type.name.clone(),
        });
    }
    Ok(targets)
}

/// Data say by `time` when they were measured; a sensor that lies does not lie about that.
fn is_time(path: &str) -> bool {
    path == "time" || path.ends_with(".time")
}

fn nothing_meant(data_type: &DataType, field: Option<&str>) -> DistortionError {
    let known: Vec<&str> = data_type
        .fields
        .iter()
        .map(|field| field.path.as_str())
        .collect();
    match field {
        Some(field) if !known.is_empty() => DistortionError::UnknownField {
            data_type: data_type.name.clone(),
            field: field.to_owned(),
            known: known.join(", "),
        },
        _ => DistortionError::NoFields {
            data_type: data_type.name.clone(),
        },
    }
}

/// Calls a macro with the Rust type of a scalar.
macro_rules! with_type {
    ($scalar:expr, $integer:ident, $float:ident) => {
        match $scalar {
            Scalar::U8 => $integer!(u8),
            Scalar::U16 => $integer!(u16),
            Scalar::U32 => $integer!(u32),
            Scalar::U64 => $integer!(u64),
            Scalar::I8 => $integer!(i8),
            Scalar::I16 => $integer!(i16),
            Scalar::I32 => $integer!(i32),
            Scalar::I64 => $integer!(i64),
            Scalar::F32 => $float!(f32),
            Scalar::F64 => $float!(f64),
        }
    };
}

impl Target {
    /// None for a field that does not lie within the datum.
    fn new(field: &Field, size: usize) -> Option<Self> {
        let length = field.scalar.size().checked_mul(field.count)?;
        let end = field.offset.checked_add(length)?;
        (end <= size).then_some(Self {
            scalar: field.scalar,
            bytes: field.offset..end,
        })
    }

    /// Sets every element; integers take the nearest value they can have.
    pub(super) fn set(&self, datum: &mut [u8], value: f64) {
        self.change(datum, |scalar, element| {
            // Conversions from f64 with `as` saturate.
            macro_rules! integer {
                ($type:ty) => {
                    element.copy_from_slice(&(value.round() as $type).to_ne_bytes())
                };
            }
            macro_rules! float {
                ($type:ty) => {
                    element.copy_from_slice(&(value as $type).to_ne_bytes())
                };
            }
            with_type!(scalar, integer, float);
        });
    }

    /// Adds to every element; integers are rounded and do not leave their range.
    pub(super) fn add(&self, datum: &mut [u8], mut increment: impl FnMut() -> f64) {
        self.change(datum, |scalar, element| {
            let increment = increment();
            // Sums are made in 128 bits, because f64 does not hold every number of 64.
            macro_rules! integer {
                ($type:ty) => {
                    if let Ok(bytes) = element.try_into() {
                        let sum = i128::from(<$type>::from_ne_bytes(bytes))
                            .saturating_add(increment.round() as i128)
                            .clamp(i128::from(<$type>::MIN), i128::from(<$type>::MAX));
                        element.copy_from_slice(&(sum as $type).to_ne_bytes());
                    }
                };
            }
            macro_rules! float {
                ($type:ty) => {
                    if let Ok(bytes) = element.try_into() {
                        let sum = f64::from(<$type>::from_ne_bytes(bytes)) + increment;
                        element.copy_from_slice(&(sum as $type).to_ne_bytes());
                    }
                };
            }
            with_type!(scalar, integer, float);
        });
    }

    /// Takes every element over from another datum of the same type.
    pub(super) fn copy(&self, datum: &mut [u8], from: &[u8]) {
        let range = self.bytes.clone();
        if let (Some(to), Some(from)) = (datum.get_mut(range.clone()), from.get(range)) {
            to.copy_from_slice(from);
        }
    }

    fn change(&self, datum: &mut [u8], mut change: impl FnMut(Scalar, &mut [u8])) {
        let Some(field) = datum.get_mut(self.bytes.clone()) else {
            return;
        };
        for element in field.chunks_exact_mut(self.scalar.size()) {
            change(self.scalar, element);
        }
    }
}
