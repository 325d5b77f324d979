//! Numbers in the bytes of a datum.

use std::ops::Range;

use system_model::data_type::{DataType, Field, Scalar};

/// A rule names a field that the data type does not have.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{data_type} has no field `{field}`; it has {}", known.join(", "))]
pub struct UnknownField {
    /// Which of the rules or ports it is; the caller's numbering says of what.
    pub index: usize,
    /// What the rule says.
    pub field: String,
    /// Name of the data type.
    pub data_type: String,
    /// Paths of all fields that there are.
    pub known: Vec<String>,
}

/// Elements of one field, at their place in the datum.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Elements {
    /// Index of the field in its data type.
    pub(crate) field: usize,
    /// Index of the first element in the field.
    pub(crate) first: usize,
    pub(crate) scalar: Scalar,
    /// Where they lie, in bytes.
    pub(crate) bytes: Range<usize>,
}

impl Elements {
    /// What a rule means by a field: `distances` is all of an array, `distances[2]` its third
    /// element, no name every number of the datum but the time stamp.
    pub(crate) fn resolve(data_type: &DataType, path: Option<&str>) -> Option<Vec<Self>> {
        let fields = || data_type.fields.iter().enumerate();
        let Some(path) = path else {
            let measured = fields().filter(|(_, field)| !is_time_stamp(field));
            return Some(
                measured
                    .map(|(index, field)| Self::all(index, field))
                    .collect(),
            );
        };
        if let Some((index, field)) = fields().find(|(_, field)| field.path == path) {
            return Some(vec![Self::all(index, field)]);
        }
        let (array, rest) = path.strip_suffix(']')?.rsplit_once('[')?;
        let element: usize = rest.parse().ok()?;
        let (index, field) = fields().find(|(_, field)| field.path == array)?;
        let all = Self::all(index, field);
        (element < field.count).then(|| {
            let start = all.bytes.start + element * field.scalar.size();
            vec![Self {
                first: element,
                bytes: start..start + field.scalar.size(),
                ..all
            }]
        })
    }

    fn all(index: usize, field: &Field) -> Self {
        Self {
            field: index,
            first: 0,
            scalar: field.scalar,
            bytes: field.offset..field.offset + field.count * field.scalar.size(),
        }
    }

    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.bytes.len() / self.scalar.size()
    }

    /// Whether an element can be no number.
    pub(crate) fn is_floating(&self) -> bool {
        matches!(self.scalar, Scalar::F32 | Scalar::F64)
    }

    /// One element, `position` counts from the first of these and is less than their number; `None`
    /// past the end of the data.
    #[inline]
    pub(crate) fn value(&self, bytes: &[u8], position: usize) -> Option<f64> {
        let size = self.scalar.size();
        let start = self.bytes.start + position * size;
        let bytes = bytes.get(start..start + size)?;
        Some(read(self.scalar, bytes))
    }

    /// Position of the first element that is not acceptable.
    #[inline]
    pub(crate) fn find(&self, bytes: &[u8], unacceptable: impl Fn(f64) -> bool) -> Option<usize> {
        let bytes = bytes.get(self.bytes.clone())?;
        // One loop for each scalar, so that the kind of number is not asked for each element.
        macro_rules! find {
            ($($name:ident $number:ty),*) => {
                match self.scalar {
                    $(Scalar::$name => chunks::<{ size_of::<$number>() }>(bytes)
                        .position(|chunk| unacceptable(<$number>::from_ne_bytes(*chunk) as f64)),)*
                }
            };
        }
        find!(U8 u8, U16 u16, U32 u32, U64 u64, I8 i8, I16 i16, I32 i32, I64 i64, F32 f32, F64 f64)
    }
}

fn chunks<const SIZE: usize>(bytes: &[u8]) -> impl Iterator<Item = &[u8; SIZE]> {
    bytes.as_chunks().0.iter()
}

#[inline]
fn read(scalar: Scalar, bytes: &[u8]) -> f64 {
    macro_rules! read {
        ($($name:ident $number:ty),*) => {
            match scalar {
                $(Scalar::$name => bytes
                    .first_chunk()
                    .map_or(f64::NAN, |chunk| <$number>::from_ne_bytes(*chunk) as f64),)*
            }
        };
    }
    read!(U8 u8, U16 u16, U32 u32, U64 u64, I8 i8, I16 i16, I32 i32, I64 i64, F32 f32, F64 f64)
}

/// A time in nanoseconds says when the datum was made: it is none of the values that an interval, a
/// rate or a standstill without a field name is about, and would make each of them useless.
fn is_time_stamp(field: &Field) -> bool {
    field.unit == "ns" && field.scalar == Scalar::U64
}

/// The names for a message about a field that is not there.
pub(crate) fn unknown(data_type: &DataType, index: usize, field: &str) -> UnknownField {
    let paths = data_type.fields.iter().map(|field| field.path.clone());
    UnknownField {
        index,
        field: field.to_owned(),
        data_type: data_type.name.clone(),
        known: paths.collect(),
    }
}

/// Reads one number of every datum of a port, for monitors and voters.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NumberReader {
    elements: Elements,
    size: usize,
}

impl NumberReader {
    /// A reader of `path`, `distance` or `distances[2]`. Without a path the datum must hold exactly
    /// one number besides its time stamp. `index` is handed on to the error.
    ///
    /// # Errors
    /// When there is no such number, or several.
    pub fn compile(
        data_type: &DataType,
        path: Option<&str>,
        index: usize,
    ) -> Result<Self, UnknownField> {
        let mut found = Elements::resolve(data_type, path).unwrap_or_default();
        match (found.pop(), found.is_empty()) {
            (Some(elements), true) if elements.count() == 1 => Ok(Self {
                elements,
                size: data_type.size,
            }),
            _ => Err(unknown(data_type, index, path.unwrap_or_default())),
        }
    }

    /// The number; NaN for a datum of the wrong size.
    pub fn read(&self, bytes: &[u8]) -> f64 {
        if bytes.len() != self.size {
            return f64::NAN;
        }
        self.elements.value(bytes, 0).unwrap_or(f64::NAN)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// `{time: u64 ns, ranges: [f64; 2] m, kind: i8}`, 32 bytes.
    pub(crate) fn range_type() -> DataType {
        let field = |path: &str, unit: &str, offset, scalar, count| Field {
            path: path.into(),
            unit: unit.into(),
            offset,
            scalar,
            count,
        };
        DataType {
            name: "Ranges".into(),
            size: 32,
            layout_hash: 0,
            fields: vec![
                field("time", "ns", 0, Scalar::U64, 1),
                field("ranges", "m", 8, Scalar::F64, 2),
                field("kind", "", 24, Scalar::I8, 1),
            ],
        }
    }

    pub(crate) fn ranges(left: f64, right: f64, kind: i8) -> Vec<u8> {
        let mut bytes = 77_u64.to_ne_bytes().to_vec();
        bytes.extend(left.to_ne_bytes());
        bytes.extend(right.to_ne_bytes());
        bytes.extend(kind.to_ne_bytes());
        bytes.resize(32, 0xAA);
        bytes
    }

    #[test]
    fn a_number_is_named_by_path_and_element() {
        let data = ranges(1.5, -2.5, -3);
        let cases = [
            (Some("ranges[0]"), Some(1.5)),
            (Some("ranges[1]"), Some(-2.5)),
            (Some("kind"), Some(-3.0)),
            (Some("kind[0]"), Some(-3.0)),
            (Some("time"), Some(77.0)),
            (Some("ranges"), None),
            (Some("ranges[2]"), None),
            (Some("ranges[-1]"), None),
            (Some("range"), None),
            (None, None),
        ];
        for (path, expected) in cases {
            let reader = NumberReader::compile(&range_type(), path, 4);
            match expected {
                Some(value) => assert_eq!(reader.expect("a number").read(&data), value, "{path:?}"),
                None => {
                    let error = reader.expect_err("no number");
                    assert_eq!((error.index, error.known.len()), (4, 3));
                }
            }
        }
        let reader = NumberReader::compile(&range_type(), Some("kind"), 0).expect("a number");
        assert!(reader.read(&data[1..]).is_nan());
    }

    #[test]
    fn every_scalar_is_read() {
        for (scalar, bytes, expected) in [
            (Scalar::U8, 200_u8.to_ne_bytes().to_vec(), 200.0),
            (Scalar::U16, 60_000_u16.to_ne_bytes().to_vec(), 60_000.0),
            (
                Scalar::U32,
                u32::MAX.to_ne_bytes().to_vec(),
                4_294_967_295.0,
            ),
            (
                Scalar::U64,
                (1_u64 << 60).to_ne_bytes().to_vec(),
                (1_u64 << 60) as f64,
            ),
            (Scalar::I8, (-5_i8).to_ne_bytes().to_vec(), -5.0),
            (Scalar::I16, (-500_i16).to_ne_bytes().to_vec(), -500.0),
            (
                Scalar::I32,
                i32::MIN.to_ne_bytes().to_vec(),
                -2_147_483_648.0,
            ),
            (Scalar::I64, (-7_i64).to_ne_bytes().to_vec(), -7.0),
            (Scalar::F32, 0.5_f32.to_ne_bytes().to_vec(), 0.5),
            (Scalar::F64, 0.1_f64.to_ne_bytes().to_vec(), 0.1),
        ] {
            let elements = Elements {
                field: 0,
                first: 0,
                scalar,
                bytes: 0..scalar.size(),
            };
            assert_eq!(elements.value(&bytes, 0), Some(expected), "{scalar:?}");
            assert_eq!(elements.find(&bytes, |value| value == expected), Some(0));
            assert_eq!(elements.find(&bytes, |value| value != expected), None);
        }
    }
}
