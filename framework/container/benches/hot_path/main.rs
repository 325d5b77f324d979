//! What the container costs on the path that runs every cycle, beside a floor measured in the same
//! run: guard, allocations, ports, executor
//! cycle. Ends with a table of ratios.
#![allow(missing_docs, unsafe_code)] // benchmark: calls the raw tables to have a floor

mod allocation;
mod chain;
mod guard;
mod monitored;
mod ports;
mod ratios;

use std::time::{Duration, SystemTime};

use criterion::Criterion;

fn main() {
    let start = SystemTime::now();
    let mut criterion = Criterion::default()
        .configure_from_args()
        .sample_size(50)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(800));
    guard::bench(&mut criterion);
    allocation::bench(&mut criterion);
    ports::bench(&mut criterion);
    chain::bench(&mut criterion);
    criterion.final_summary();
    ratios::print(start);
}
