//! Rules: what they mean when they are sound, and what each mistake is called.

mod meaning;
mod mistakes;
mod project;
mod sources;
