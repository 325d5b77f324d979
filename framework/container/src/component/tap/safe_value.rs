//! A command that is safe: the last one with safe values in it.

use system_model::data_type::{DataType, Field, Scalar};
use system_model::rules::SafeValue;

/// A datum with safe values.
pub struct SafeDatum {
    bytes: Box<[u8]>,
    values: Vec<(Field, f64)>,
    /// Time stamps, which are always fresh: a component must not think the safe command stale.
    stamps: Vec<Field>,
}

impl SafeDatum {
    /// A datum of a type, all zero but for the safe values. A value without a field is that of every
    /// number which is no time stamp.
    ///
    /// # Errors
    /// The name of a field that the type does not have.
    pub fn new<'rules>(
        data_type: &DataType,
        safe_values: impl IntoIterator<Item = &'rules SafeValue>,
    ) -> Result<Self, String> {
        let (stamps, numbers): (Vec<Field>, Vec<Field>) =
            data_type.fields.iter().cloned().partition(is_stamp);
        let mut values = Vec::new();
        for safe in safe_values {
            let Some(path) = &safe.field else {
                values.extend(numbers.iter().map(|field| (field.clone(), safe.value)));
                continue;
            };
            let field = data_type.fields.iter().find(|field| field.path == *path);
            values.push((field.ok_or_else(|| path.clone())?.clone(), safe.value));
        }
        Ok(Self {
            bytes: vec![0; data_type.size].into_boxed_slice(),
            values,
            stamps,
        })
    }

    /// The command that was delivered last; what has no safe value stays as it was.
    pub fn remember(&mut self, command: &[u8]) {
        if command.len() == self.bytes.len() {
            self.bytes.copy_from_slice(command);
        }
    }

    /// From now on the values are all this one.
    pub fn set(&mut self, value: f64) {
        for (_, own) in &mut self.values {
            *own = value;
        }
    }

    /// The safe command, of this time.
    pub fn at(&mut self, now_ns: u64) -> &[u8] {
        for (field, value) in &self.values {
            write_number(&mut self.bytes, field, *value);
        }
        for field in &self.stamps {
            write(&mut self.bytes, field, |_, place| {
                place.copy_from_slice(&now_ns.to_ne_bytes());
            });
        }
        &self.bytes
    }
}

/// Writes a number into all elements of a field.
pub(super) fn write_number(bytes: &mut [u8], field: &Field, value: f64) {
    write(bytes, field, |scalar, place| encode(scalar, value, place));
}

/// Whether a field is a time stamp of the container's clock, as those of the robot's data are.
fn is_stamp(field: &Field) -> bool {
    field.scalar == Scalar::U64 && field.unit == "ns"
}

fn write(bytes: &mut [u8], field: &Field, change: impl Fn(Scalar, &mut [u8])) {
    let size = field.scalar.size();
    for element in 0..field.count {
        let start = field.offset + element * size;
        if let Some(place) = bytes.get_mut(start..start + size) {
            change(field.scalar, place);
        }
    }
}

/// Writes a number as one of a type; integers are cut to their range.
#[allow(clippy::cast_possible_truncation)] // `as` saturates, which is what is wanted
fn encode(scalar: Scalar, value: f64, place: &mut [u8]) {
    match scalar {
        Scalar::U8 => place.copy_from_slice(&(value as u8).to_ne_bytes()),
        Scalar::U16 => place.copy_from_slice(&(value as u16).to_ne_bytes()),
        Scalar::U32 => place.copy_from_slice(&(value as u32).to_ne_bytes()),
        Scalar::U64 => place.copy_from_slice(&(value as u64).to_ne_bytes()),
        Scalar::I8 => place.copy_from_slice(&(value as i8).to_ne_bytes()),
        Scalar::I16 => place.copy_from_slice(&(value as i16).to_ne_bytes()),
        Scalar::I32 => place.copy_from_slice(&(value as i32).to_ne_bytes()),
        Scalar::I64 => place.copy_from_slice(&(value as i64).to_ne_bytes()),
        Scalar::F32 => place.copy_from_slice(&(value as f32).to_ne_bytes()),
        Scalar::F64 => place.copy_from_slice(&value.to_ne_bytes()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(path: &str, unit: &str, offset: usize, scalar: Scalar) -> Field {
        Field {
            path: path.to_owned(),
            unit: unit.to_owned(),
            offset,
            scalar,
            count: 1,
        }
    }

    fn command() -> DataType {
        DataType {
            name: "Command".to_owned(),
            size: 24,
            layout_hash: 0,
            fields: vec![
                field("time", "ns", 0, Scalar::U64),
                field("kind", "", 8, Scalar::U32),
                field("rpm", "rpm", 12, Scalar::I32),
                field("gain", "", 16, Scalar::F64),
            ],
        }
    }

    fn safe(field: Option<&str>, value: f64) -> SafeValue {
        SafeValue {
            field: field.map(str::to_owned),
            value,
        }
    }

    #[test]
    fn safe_values_are_written_into_the_last_command() {
        let mut last = [0u8; 24];
        last[8..12].copy_from_slice(&1u32.to_ne_bytes());
        last[12..16].copy_from_slice(&70i32.to_ne_bytes());
        last[16..24].copy_from_slice(&0.5f64.to_ne_bytes());
        let cases = [
            (vec![safe(None, 0.0)], 0u32, 0i32, 0.0),
            (vec![safe(Some("rpm"), -3.0)], 1, -3, 0.5),
            (vec![safe(None, 0.0), safe(Some("gain"), 2.0)], 0, 0, 2.0),
        ];
        for (values, kind, rpm, gain) in cases {
            let mut datum = SafeDatum::new(&command(), &values).expect("the fields are there");
            datum.remember(&last);
            let bytes = datum.at(99);
            assert_eq!(bytes[..8], 99u64.to_ne_bytes());
            assert_eq!(bytes[8..12], kind.to_ne_bytes(), "{values:?}");
            assert_eq!(bytes[12..16], rpm.to_ne_bytes(), "{values:?}");
            assert_eq!(bytes[16..24], f64::to_ne_bytes(gain), "{values:?}");
        }
        let unknown = SafeDatum::new(&command(), &[safe(Some("speed"), 0.0)]);
        assert_eq!(unknown.err().as_deref(), Some("speed"));
    }
}
