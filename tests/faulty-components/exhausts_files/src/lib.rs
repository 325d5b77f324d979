//! Opens file after file, until it is refused or has enough.
#![forbid(unsafe_code)]

use std::fs::File;

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

/// So many are enough; what processes usually may have is more.
const FILES: usize = 500;

struct ExhaustsFiles;

impl Misbehaviour for ExhaustsFiles {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        let mut open = Vec::new();
        for number in 0..FILES {
            match File::open("/dev/null") {
                Ok(file) => open.push(file),
                Err(error) => {
                    let text = format!("{error} after {number} files");
                    return Err(Failure::internal(text));
                }
            }
        }
        Ok(())
    }
}

export_component!(Faulty<ExhaustsFiles>);
