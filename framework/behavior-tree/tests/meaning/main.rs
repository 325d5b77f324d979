//! What nodes mean: tables of trees and of what they answer, tick by tick.

mod adaptive;
mod allocation;
mod compiling;
mod conditions;
mod grids;
mod harness;
mod over_time;
