//! What holds for every application, every set of rules and every sequence of observations.

#[path = "properties/applications.rs"]
mod applications;
#[path = "properties/checks.rs"]
mod checks;
#[path = "properties/fact.rs"]
mod fact;
#[path = "properties/generators.rs"]
mod generators;
#[path = "properties/nonsense.rs"]
mod nonsense;
#[path = "properties/oracle.rs"]
mod oracle;
#[path = "properties/robot.rs"]
mod robot;
#[path = "properties/shell.rs"]
mod shell;
