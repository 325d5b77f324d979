//! Rules and injections: what they mean when they are sound, and what each mistake is called.

mod injection_mistakes;
mod injections;
mod meaning;
mod mistakes;
mod project;
mod safe_states;
mod sources;
