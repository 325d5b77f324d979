//! Writes past the ends of its own blocks of the heap, where the C library keeps its books, and goes
//! on allocating.
#![allow(unsafe_code)] // the misbehaviour itself

use std::hint::black_box;

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

/// Sizes of several of the allocator's classes.
const SIZES: [usize; 6] = [24, 104, 520, 1_400, 9_000, 40_000];

/// How far it writes: the head of what lies behind, and a bit of its content.
const TOO_FAR: usize = 48;

/// Allocations that follow; far fewer show the damage.
const ALLOCATIONS: usize = 100_000;

struct CorruptsHeap;

impl Misbehaviour for CorruptsHeap {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        for size in SIZES {
            // SAFETY: any size may be asked for.
            let block = unsafe { libc::malloc(size) }.cast::<u8>();
            if block.is_null() {
                return Err(Failure::internal("there is no memory"));
            }
            for offset in size..size + TOO_FAR {
                // SAFETY: none; this is behind the block.
                unsafe { black_box(block.wrapping_add(offset)).write_volatile(0xA5) };
            }
        }
        let mut kept = Vec::new();
        for round in 0..ALLOCATIONS {
            kept.push(vec![1_u8; SIZES[round % SIZES.len()]]);
            if kept.len() > 64 {
                drop(black_box(kept.swap_remove(round % 64)));
            }
        }
        Ok(())
    }
}

export_component!(Faulty<CorruptsHeap>);
