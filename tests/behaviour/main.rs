//! What Steadfast promises, seen from outside.
#![forbid(unsafe_code)]

mod c_component;
mod faults;
