//! Crashes while the loader runs its constructors.
#![allow(unsafe_code)] // the misbehaviour itself

use std::hint::black_box;

use component_sdk::prelude::*;

struct NeverMade;

impl Component for NeverMade {
    type Ports = ();
    fn new((): ()) -> Self {
        Self
    }
}

extern "C" fn crash() {
    let field: *mut u8 = black_box(std::ptr::without_provenance_mut(8));
    // SAFETY: none; the first page is never mapped, so this traps.
    unsafe { field.write_volatile(1) };
}

#[used]
#[unsafe(link_section = ".init_array")]
static CONSTRUCTOR: extern "C" fn() = crash;

export_component!(NeverMade);
