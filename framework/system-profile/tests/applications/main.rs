//! References between files: what becomes of a sound application, and what each mistake is called.

mod connections;
mod project;
mod references;
mod trees;
