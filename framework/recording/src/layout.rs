//! From a port's descriptor to a JSON schema, and its data to JSON and back.
//!
//! Structures are objects, arrays are lists, byte arrays are text in base64 (`contentEncoding`,
//! which Foxglove reads as bytes). JSON has no NaN and no infinities: they are the texts `"NaN"`,
//! `"Infinity"` and `"-Infinity"`, as in the JSON form of Protocol Buffers.

mod scalar;
mod tree;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use serde_json::{Value, json};
use system_model::data_type::{DataType, Field, Scalar};

use scalar::{read_number, write_number};
use tree::Node;

/// How data of one type are written and read.
#[derive(Debug, Clone)]
pub struct Layout {
    data_type: DataType,
    schema: Value,
    steps: Vec<Step>,
    /// Where each field is in the JSON, as a JSON pointer (RFC 6901).
    pointers: Vec<String>,
}

/// One piece of the JSON.
#[derive(Debug, Clone)]
enum Step {
    /// As it is.
    Text(Vec<u8>),
    /// The value of a field, by its index.
    Field(usize),
}

/// A message that is no datum of the type.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Misfit {
    /// A field is not there.
    #[error("it has no field '{path}'")]
    Missing {
        /// Path of the field.
        path: String,
    },
    /// A field's value cannot be that of the field.
    #[error("field '{path}' cannot be {value}")]
    Value {
        /// Path of the field.
        path: String,
        /// What the message has there, shortened.
        value: String,
    },
    /// The buffer is not as long as a datum.
    #[error("a datum of '{name}' has {expected} bytes, not {size}")]
    Size {
        /// Name of the type.
        name: String,
        /// Its size in bytes.
        expected: usize,
        /// The buffer's.
        size: usize,
    },
}

impl Layout {
    /// Of a type. Fields whose paths contradict each other stand at the top under their whole paths.
    pub fn new(data_type: &DataType) -> Self {
        let (root, pointers) = tree::of(data_type);
        let mut steps = Vec::new();
        append(&root, &mut steps);
        Self {
            schema: titled(schema_of(&root, data_type), &data_type.name),
            data_type: data_type.clone(),
            steps,
            pointers,
        }
    }

    /// The type.
    pub fn data_type(&self) -> &DataType {
        &self.data_type
    }

    /// The JSON schema of its messages.
    pub fn schema(&self) -> &Value {
        &self.schema
    }

    /// Appends a datum as JSON. What is behind the end of `datum` reads as nothing.
    pub fn encode(&self, datum: &[u8], json: &mut Vec<u8>) {
        for step in &self.steps {
            match step {
                Step::Text(text) => json.extend_from_slice(text),
                Step::Field(index) => encode_field(&self.data_type.fields[*index], datum, json),
            }
        }
    }

    /// Writes a message into `datum`; bytes of no field are set to zero.
    ///
    /// # Errors
    /// If the message is no datum of this type, or `datum` has another size.
    pub fn decode(&self, message: &Value, datum: &mut [u8]) -> Result<(), Misfit> {
        if datum.len() != self.data_type.size {
            return Err(Misfit::Size {
                name: self.data_type.name.clone(),
                expected: self.data_type.size,
                size: datum.len(),
            });
        }
        datum.fill(0);
        for (field, pointer) in self.data_type.fields.iter().zip(&self.pointers) {
            let value = message.pointer(pointer).ok_or_else(|| Misfit::Missing {
                path: field.path.clone(),
            })?;
            decode_field(field, value, datum).ok_or_else(|| Misfit::Value {
                path: field.path.clone(),
                value: shortened(value),
            })?;
        }
        Ok(())
    }
}

/// Bytes are text, not lists of numbers: a picture would be four times as long.
fn is_binary(field: &Field) -> bool {
    field.scalar == Scalar::U8 && field.count > 1
}

fn bytes_of<'datum>(field: &Field, index: usize, datum: &'datum [u8]) -> &'datum [u8] {
    let start = field.offset + index * field.scalar.size();
    datum
        .get(start..start + field.scalar.size())
        .unwrap_or_default()
}

fn encode_field(field: &Field, datum: &[u8], json: &mut Vec<u8>) {
    if is_binary(field) {
        let bytes = datum.get(field.offset..field.offset + field.count);
        encode_base64(bytes.unwrap_or_default(), json);
    } else if field.count == 1 {
        write_number(field.scalar, bytes_of(field, 0, datum), json);
    } else {
        json.push(b'[');
        for index in 0..field.count {
            if index > 0 {
                json.push(b',');
            }
            write_number(field.scalar, bytes_of(field, index, datum), json);
        }
        json.push(b']');
    }
}

fn encode_base64(bytes: &[u8], json: &mut Vec<u8>) {
    json.push(b'"');
    let start = json.len();
    // Four characters for every three bytes that have begun.
    json.resize(start + bytes.len().div_ceil(3) * 4, 0);
    let written = BASE64.encode_slice(bytes, &mut json[start..]);
    // It fits; nothing is written if it did not.
    json.truncate(start + written.unwrap_or(0));
    json.push(b'"');
}

fn decode_field(field: &Field, value: &Value, datum: &mut [u8]) -> Option<()> {
    let size = field.scalar.size();
    let place = datum.get_mut(field.offset..field.offset + field.count * size)?;
    if is_binary(field) {
        let written = BASE64.decode(value.as_str()?).ok()?;
        (written.len() == place.len()).then(|| place.copy_from_slice(&written))
    } else if field.count == 1 {
        read_number(field.scalar, value, place)
    } else {
        let values = value.as_array().filter(|it| it.len() == field.count)?;
        let mut places = place.chunks_exact_mut(size).zip(values);
        places.try_for_each(|(place, value)| read_number(field.scalar, value, place))
    }
}

fn shortened(value: &Value) -> String {
    /// Enough to recognise it by.
    const CHARACTERS: usize = 40;
    let text = value.to_string();
    match text.char_indices().nth(CHARACTERS) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text,
    }
}

/// The pieces of a node's JSON.
fn append(node: &Node, steps: &mut Vec<Step>) {
    match node {
        Node::Field(index) => steps.push(Step::Field(*index)),
        Node::Object(members) => {
            for (number, (name, member)) in members.iter().enumerate() {
                let before = if number == 0 { "{" } else { "," };
                text(&format!("{before}{}:", Value::from(name.as_str())), steps);
                append(member, steps);
            }
            text(if members.is_empty() { "{}" } else { "}" }, steps);
        }
        Node::List(elements) => {
            for (number, element) in elements.iter().enumerate() {
                text(if number == 0 { "[" } else { "," }, steps);
                append(element, steps);
            }
            text("]", steps);
        }
    }
}

/// Adds text to the last piece if that is text.
fn text(more: &str, steps: &mut Vec<Step>) {
    match steps.last_mut() {
        Some(Step::Text(text)) => text.extend_from_slice(more.as_bytes()),
        _ => steps.push(Step::Text(more.as_bytes().to_vec())),
    }
}

fn schema_of(node: &Node, data_type: &DataType) -> Value {
    match node {
        Node::Field(index) => schema_of_field(&data_type.fields[*index]),
        Node::Object(members) => {
            let named = members.iter();
            let named = named.map(|(name, member)| (name.clone(), schema_of(member, data_type)));
            let properties: serde_json::Map<String, Value> = named.collect();
            json!({"type": "object", "properties": properties})
        }
        // Elements of one array are of one type.
        Node::List(elements) => match elements.first() {
            Some(first) => json!({"type": "array", "items": schema_of(first, data_type)}),
            None => json!({"type": "array", "items": {"type": "number"}}),
        },
    }
}

fn schema_of_field(field: &Field) -> Value {
    let kind = match field.scalar {
        Scalar::F32 | Scalar::F64 => "number",
        _ => "integer",
    };
    let mut schema = if is_binary(field) {
        json!({"type": "string", "contentEncoding": "base64"})
    } else if field.count == 1 {
        json!({"type": kind})
    } else {
        json!({"type": "array", "items": {"type": kind}})
    };
    if !field.unit.is_empty() {
        schema["description"] = Value::from(format!("in {}", field.unit));
    }
    schema
}

fn titled(mut schema: Value, title: &str) -> Value {
    schema["title"] = Value::from(title);
    schema
}

#[cfg(test)]
mod tests;
