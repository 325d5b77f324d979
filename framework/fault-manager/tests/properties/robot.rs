//! Robots to which anything may happen that can happen to robots.

use std::time::Duration;

use fault_manager::{Condition, Scope};
use proptest::prelude::*;

use crate::generators::{Step, config, robots, steps};
use crate::oracle::Level;
use crate::shell::Shell;

/// Nothing waits for ever: what is in ERROR is down, lost by rule, or was recovered.
fn assert_at_rest(shell: &Shell) -> Result<(), TestCaseError> {
    for (component, fact) in shell.facts.iter().enumerate() {
        let condition = shell.manager.condition(component);
        let down = matches!(
            condition,
            Some(Condition::Stopped | Condition::Destroyed | Condition::Lost)
        );
        prop_assert!(
            down || condition == Some(Condition::Working) && !fact.in_error,
            "component {component} is {condition:?}, {fact:?}"
        );
        prop_assert_eq!(
            matches!(condition, Some(Condition::Stopped | Condition::Destroyed)),
            fact.down > Level::Up
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(config(1_000))]

    /// The shell checks every effect of every observation: an emergency reaches the emergency stop,
    /// what lacks what it needs does not run, nothing else is stopped, budgets hold, consequences
    /// start nothing, every fault has a plan or a cause, one action at a time. Afterwards everything
    /// comes to rest, and after an operator's clear nothing is left in ERROR.
    #[test]
    fn whatever_happens(scopes in robots(), steps in steps(60)) {
        let mut shell = Shell::new(scopes);
        for step in &steps {
            shell.step(step);
        }
        shell.come_to_rest();
        for _ in 0..shell.facts.len() + 1 {
            if shell.manager.is_emergency() {
                shell.step(&Step::ClearAll);
                shell.come_to_rest();
            }
        }
        let hopeless = (0..shell.facts.len()).any(|component| shell.is_hopeless(component));
        prop_assert_eq!(shell.manager.is_emergency(), hopeless);
        if !hopeless {
            assert_at_rest(&shell)?;
        }
    }

    #[test]
    fn the_same_sequence_has_the_same_effects(scopes in robots(), steps in steps(40)) {
        let run = |scopes: Vec<Scope>| {
            let mut shell = Shell::new(scopes);
            for step in &steps {
                shell.step(step);
            }
            shell.log
        };
        prop_assert_eq!(run(scopes.clone()), run(scopes));
    }

    /// Whatever recovery comes to, a component that fails again at once ends down or in an
    /// emergency stop, after no more attempts than its rules have.
    #[test]
    fn a_component_that_always_fails_comes_to_an_end(scopes in robots(), which in 0..6_usize) {
        let mut shell = Shell::new(scopes);
        let component = which % shell.facts.len();
        for _ in 0..20 {
            shell.crash(component);
            let ended = shell.manager.is_emergency()
                || !matches!(
                    shell.manager.condition(component),
                    Some(Condition::Working | Condition::Recovering | Condition::Waiting)
                );
            if ended {
                return Ok(());
            }
            while let Some(action) = shell.open.pop() {
                shell.finish(&action);
            }
        }
        prop_assert!(false, "it is recovered for ever");
    }

    /// Without any answer every deadline passes and everything ends by itself.
    #[test]
    fn without_answers_everything_ends_too(scopes in robots(), steps in steps(20)) {
        let mut shell = Shell::new(scopes);
        for step in &steps {
            shell.step(step);
        }
        shell.open.clear();
        shell.wait(Duration::from_secs(3_600));
        for component in 0..shell.facts.len() {
            let condition = shell.manager.condition(component);
            prop_assert_ne!(condition, Some(Condition::Recovering));
            if !shell.manager.is_emergency() {
                prop_assert_ne!(condition, Some(Condition::Waiting));
            }
        }
    }
}
