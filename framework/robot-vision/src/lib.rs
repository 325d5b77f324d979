//! Algorithms on pictures that several vision components share.
//!
//! [`Dehazer`] clears a picture of haze. Nothing here knows ports, clocks or devices; the same
//! pixels give the same result on any number of cores.

#![forbid(unsafe_code)]

mod bands;
mod dehazing;
mod plane;

pub use dehazing::Dehazer;
