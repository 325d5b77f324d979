//! What an actuator's hardware is told while no container runs.

use std::path::Path;

use system_model::rules::{MAX_SAFE_STATE_BYTES, SafeStateRule};

use super::measure::{positive_duration, required};
use crate::node::Node;
use crate::suggest::quoted;
use crate::value::Value;

/// `safe_state`.
pub(super) fn safe_state(node: &Node<'_>) -> Option<SafeStateRule> {
    let device = required(node, "device").and_then(|value| device(&value));
    let bytes = required(node, "bytes").and_then(|value| bytes(&value));
    let period = required(node, "period").and_then(|value| positive_duration(&value));
    node.finish();
    Some(SafeStateRule {
        device: device?,
        bytes: bytes?,
        period: period?,
    })
}

/// Nobody is there to look for a device, or to simulate one.
fn device(value: &Value<'_>) -> Option<String> {
    let device = value.as_str();
    if Path::new(device).is_absolute() {
        return Some(device.to_owned());
    }
    value.error(
        format!("`{}` is no path of a device", quoted(device)),
        Some("write where the machine has it, such as /dev/ttyUSB0".into()),
    );
    None
}

fn bytes(value: &Value<'_>) -> Option<Vec<u8>> {
    let byte = |text: &str| match text.len() {
        // A sign would be read, too.
        2 if text.bytes().all(|digit| digit.is_ascii_hexdigit()) => {
            u8::from_str_radix(text, 16).ok()
        }
        _ => None,
    };
    let bytes: Option<Vec<u8>> = value.as_str().split_whitespace().map(byte).collect();
    let bytes = bytes.filter(|bytes| bytes.len() <= MAX_SAFE_STATE_BYTES);
    if bytes.is_none() {
        value.error(
            format!("`{}` are no bytes", quoted(value.as_str())),
            Some(format!(
                "write 1 to {MAX_SAFE_STATE_BYTES} bytes of two hexadecimal digits each: 02 10 ff"
            )),
        );
    }
    bytes
}
