//! What the components of the tests share: their port data, and when a faulty one strikes.
#![forbid(unsafe_code)]

mod faulty;

use component_sdk::prelude::*;

pub use faulty::{Faulty, FaultyPorts, Misbehaviour};

/// The datum that all test components exchange.
#[derive(PortData, Debug, Clone, Copy, PartialEq, Default)]
#[repr(C)]
pub struct Sample {
    /// Counts from 1 at its source.
    pub number: u64,
    /// Something that a filter may change.
    #[unit("m")]
    pub value: f64,
}

/// The time, in a datum of 64 bytes.
#[derive(PortData, Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct SmallStamp {
    /// When it was sent, in nanoseconds since 1970.
    pub sent_ns: u64,
    /// All else.
    pub rest: [u64; 7],
}

/// The time, in a datum as large as a picture of 160 x 120 pixels: 57,600 bytes.
#[derive(PortData, Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct LargeStamp {
    /// When it was sent, in nanoseconds since 1970.
    pub sent_ns: u64,
    /// All else.
    pub rest: [u8; 57_592],
}

service_type! {
    /// A service with both kinds of method.
    pub Arithmetic {
        blocking double(f64) -> f64;
        nonblocking note(u64);
    }
}
