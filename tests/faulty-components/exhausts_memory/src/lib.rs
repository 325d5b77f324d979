//! Takes more and more memory and writes to all of it, until there is none or there is enough.
#![forbid(unsafe_code)]

use std::hint::black_box;

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

/// One piece.
const PIECE: usize = 1 << 20;

/// So many pieces are enough: a machine that lets it have all of them is not in need.
const PIECES: usize = 256;

struct ExhaustsMemory;

impl Misbehaviour for ExhaustsMemory {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        let pieces: Vec<Vec<u8>> = (0..PIECES).map(|_| vec![1; PIECE]).collect();
        drop(black_box(pieces));
        Ok(())
    }
}

export_component!(Faulty<ExhaustsMemory>);
