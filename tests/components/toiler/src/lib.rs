//! Works over memory of its own, so that others find their caches cold, and sends increasing
//! numbers, which it keeps in 4 KiB of registered memory.
//!
//! Property: `walks_kib`, how much memory it walks over in each cycle (default 0).
#![forbid(unsafe_code)]

use component_sdk::prelude::*;
use test_parts::Sample;

/// Bytes that share a line of a cache.
const LINE_BYTES: usize = 64;

#[derive(PortData, Clone, Copy)]
#[repr(C)]
struct State {
    numbers: [u64; 512],
}

#[derive(Ports)]
struct Ports {
    output: Output<Sample>,
}

struct Toiler {
    ports: Ports,
    ground: Vec<u8>,
    state: Option<&'static mut State>,
}

impl Component for Toiler {
    type Ports = Ports;

    fn new(ports: Ports) -> Self {
        Self {
            ports,
            ground: Vec::new(),
            state: None,
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        let walks_kib: usize = context.property_or("walks_kib", 0)?;
        self.ground.resize(walks_kib * 1024, 0);
        if self.state.is_none() {
            let numbers = [0; 512];
            self.state = Some(context.critical(State { numbers })?);
        }
        Ok(())
    }

    fn on_execute(&mut self, _context: &Context) -> Outcome {
        for line in self.ground.chunks_mut(LINE_BYTES) {
            line[0] = line[0].wrapping_add(1);
        }
        let Some(state) = &mut self.state else {
            return Ok(());
        };
        state.numbers[0] += 1;
        let number = state.numbers[0];
        self.ports.output.write(&Sample { number, value: 0.0 });
        Ok(())
    }
}

export_component!(Toiler);
