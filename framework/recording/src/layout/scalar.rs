//! Single numbers, between memory and JSON.

use serde_json::Value;
use system_model::data_type::Scalar;

/// Calls `$with` with the type that a scalar stands for.
macro_rules! by_type {
    ($scalar:expr, $with:ident ! ($($argument:expr),*)) => {
        match $scalar {
            Scalar::U8 => $with!(u8, $($argument),*),
            Scalar::U16 => $with!(u16, $($argument),*),
            Scalar::U32 => $with!(u32, $($argument),*),
            Scalar::U64 => $with!(u64, $($argument),*),
            Scalar::I8 => $with!(i8, $($argument),*),
            Scalar::I16 => $with!(i16, $($argument),*),
            Scalar::I32 => $with!(i32, $($argument),*),
            Scalar::I64 => $with!(i64, $($argument),*),
            Scalar::F32 => $with!(f32, $($argument),*),
            Scalar::F64 => $with!(f64, $($argument),*),
        }
    };
}

/// Appends the number that lies in `bytes`; `null` if they are not as many as it has.
pub(super) fn write_number(scalar: Scalar, bytes: &[u8], json: &mut Vec<u8>) {
    macro_rules! write {
        ($kind:ty, $bytes:expr) => {
            match $bytes.try_into() {
                Ok(bytes) => <$kind>::from_ne_bytes(bytes).append(json),
                Err(_other_size) => json.extend_from_slice(b"null"),
            }
        };
    }
    by_type!(scalar, write!(bytes));
}

/// Puts a number into `place`, if it is one of this kind and size.
pub(super) fn read_number(scalar: Scalar, value: &Value, place: &mut [u8]) -> Option<()> {
    macro_rules! read {
        ($kind:ty, $value:expr) => {
            <$kind>::from_json($value)?.to_ne_bytes().to_vec()
        };
    }
    let bytes = by_type!(scalar, read!(value));
    (bytes.len() == place.len()).then(|| place.copy_from_slice(&bytes))
}

/// A number that JSON can say, or nearly so.
trait Number: Sized {
    fn append(self, json: &mut Vec<u8>);
    fn from_json(value: &Value) -> Option<Self>;
}

macro_rules! whole_number {
    ($($kind:ty: $get:ident),*) => {
        $(impl Number for $kind {
            fn append(self, json: &mut Vec<u8>) {
                append_plain(self, json);
            }

            fn from_json(value: &Value) -> Option<Self> {
                Self::try_from(value.$get()?).ok()
            }
        })*
    };
}

whole_number!(
    u8: as_u64, u16: as_u64, u32: as_u64, u64: as_u64,
    i8: as_i64, i16: as_i64, i32: as_i64, i64: as_i64
);

macro_rules! real_number {
    ($($kind:ident),*) => {
        $(impl Number for $kind {
            fn append(self, json: &mut Vec<u8>) {
                match self {
                    it if it.is_finite() => append_plain(it, json),
                    it if it.is_nan() => json.extend_from_slice(b"\"NaN\""),
                    it if it > 0.0 => json.extend_from_slice(b"\"Infinity\""),
                    _ => json.extend_from_slice(b"\"-Infinity\""),
                }
            }

            fn from_json(value: &Value) -> Option<Self> {
                match value.as_str() {
                    // A single is written with its own shortest digits, and a double keeps them.
                    None => value.as_f64().map(|number| number as $kind),
                    Some("NaN") => Some(Self::NAN),
                    Some("Infinity") => Some(Self::INFINITY),
                    Some("-Infinity") => Some(Self::NEG_INFINITY),
                    Some(_) => None,
                }
            }
        })*
    };
}

real_number!(f32, f64);

/// As serde_json writes it: the shortest digits that read back as the same number.
fn append_plain(number: impl serde::Serialize, json: &mut Vec<u8>) {
    let before = json.len();
    if serde_json::to_writer(&mut *json, &number).is_err() {
        // Memory does not refuse; whatever a writer may have left would not be JSON.
        json.truncate(before);
        json.extend_from_slice(b"null");
    }
}
