//! component-sdk
#![allow(unsafe_code)] // exporting a symbol

use component_abi::LibraryDescriptor;
use component_sdk::prelude::*;

struct NeverMade;

impl Component for NeverMade {
    type Ports = ();
    fn new((): ()) -> Self {
        Self
    }
}

/// Right in everything but its header.
#[allow(non_upper_case_globals)] // the symbol's name is part of the contract
#[unsafe(no_mangle)]
pub static steadfast_component: LibraryDescriptor = {
    let name = env!("CARGO_PKG_NAME");
    let mut descriptor = component_sdk::expansion::descriptor::<NeverMade>(name, "1.0");
    descriptor.header.layout_hash ^= 1;
    descriptor
};
