//! What is checked of every effect.

use fault_manager::{
    Action, ActionId, Cause, Condition, Effect, FaultId, FaultState, PlannedAction, Severity,
    Verdict,
};
use system_model::rules::{ApplicationSeverity, ComponentRules, FaultRule};
use system_model::specification::ExecutionKind;

use crate::fact::Fact;
use crate::oracle::{self, Level};
use crate::shell::Shell;

impl Shell {
    pub fn keep(&mut self, verdict: &Verdict) {
        assert_ne!(verdict.state, FaultState::Prefailed, "not a fault yet");
        assert!(
            verdict.cause != Cause::Root || !verdict.plan.is_empty(),
            "neither a plan nor a cause: {verdict:?}"
        );
        if verdict.cause != Cause::Root {
            self.consequences.insert(verdict.id);
        }
        self.verdicts.insert(verdict.id, verdict.clone());
    }

    /// What a consequence names as its cause is a root cause.
    pub fn check_causes(&self, effects: &[Effect]) {
        for effect in effects {
            if let Effect::Record(verdict) = effect
                && let Cause::ConsequenceOf(root) = verdict.cause
            {
                assert_eq!(self.verdicts[&root].cause, Cause::Root, "{verdict:?}");
            }
        }
    }

    pub fn act(&mut self, act: &PlannedAction, latched: bool) {
        self.open.push(act.clone());
        if act.action == Action::EmergencyStop {
            self.stop_asked = true;
        }
        let Some(component) = act.action.component() else {
            return;
        };
        let open = self.facts[component].open.replace(act.id);
        assert_eq!(open, None, "one action at a time: {act:?}");
        match act.action {
            Action::Reset { .. } | Action::Replace { .. } => {
                assert!(!latched, "no recovery begins in an emergency stop: {act:?}");
                assert!(
                    !self.consequences.contains(&act.fault),
                    "a consequence starts no recovery: {act:?}"
                );
                assert_eq!(self.facts[component].down, Level::Up);
                self.count(component, act);
            }
            Action::Adapt { .. } => {
                assert!(!latched, "no recovery begins in an emergency stop: {act:?}");
            }
            Action::Stop { .. } => {
                self.facts[component].down = self.facts[component].down.max(Level::Stopped);
            }
            Action::Destroy { .. } => self.facts[component].down = Level::Destroyed,
            Action::Handle { .. } | Action::EmergencyStop => {}
        }
        self.facts[component].awaits_first_cycle = false;
    }

    /// No more resets within the window than the rule allows, with their pauses.
    fn count(&mut self, component: usize, act: &PlannedAction) {
        let rule = self.fault_rule(component);
        let used = self.used(component, &rule);
        let last = self.facts[component].resets.last().copied();
        let fact = &mut self.facts[component];
        if matches!(act.action, Action::Replace { .. }) {
            fact.replacing = true;
            fact.replacements += 1;
            return;
        }
        assert!(
            !fact.replacing,
            "nothing that a reset could bring back: {act:?}"
        );
        assert!(used < rule.retry_max, "the budget is used up: {act:?}");
        if used > 0 {
            let earliest = last.expect("there was one") + rule.backoff;
            assert!(act.not_before >= earliest, "too early: {act:?}");
        }
        fact.resets.push(act.not_before);
        fact.in_vain += 1;
    }

    fn used(&self, component: usize, rule: &FaultRule) -> u32 {
        let resets = self.facts[component].resets.iter();
        let within = resets.filter(|reset| **reset + rule.window > self.now);
        let within = u32::try_from(within.count()).expect("few");
        within.max(self.facts[component].in_vain)
    }

    pub fn abandon(&mut self, id: ActionId) {
        self.open.retain(|action| action.id != id);
        for fact in &mut self.facts {
            if fact.open == Some(id) {
                fact.open = None;
                fact.in_error = true;
            }
        }
    }

    /// How far every component is down in fact.
    pub fn levels(&self) -> Vec<Level> {
        let level = |(component, fact): (usize, &Fact)| {
            let lost = self.manager.condition(component) == Some(Condition::Lost);
            fact.down.max(if lost { Level::Stopped } else { Level::Up })
        };
        self.facts.iter().enumerate().map(level).collect()
    }

    /// Nothing that needs what is down runs; nothing is stopped without reason; dependents first.
    pub fn check_stops(&self, effects: &[Effect]) {
        let demanded = oracle::demanded(&self.scopes, &self.levels());
        for (component, fact) in self.facts.iter().enumerate() {
            let level = self.levels()[component];
            assert!(
                level >= demanded[component],
                "component {component} is {level:?}, {fact:?}, but lacks what it needs"
            );
        }
        let mut stopped: Vec<(FaultId, usize)> = Vec::new();
        for effect in effects {
            let Effect::Act(act) = effect else { continue };
            let (Action::Stop { component } | Action::Destroy { component }) = act.action else {
                continue;
            };
            let again = self.manager.verdicts().any(|one| {
                let fails = one.actions.iter().any(|action| {
                    let name = self.name(component);
                    action.action == format!("stop {name}")
                        && matches!(action.outcome, "failed" | "overdue")
                });
                one.id == act.fault && fails
            });
            assert!(
                again
                    || demanded[component] > Level::Up
                    || self.has_own_reason(component, act.fault),
                "component {component} is stopped without a reason: {:?}",
                self.verdicts.get(&act.fault)
            );
            for (fault, earlier) in &stopped {
                assert!(
                    *fault != act.fault || !oracle::needs(&self.scopes, component, *earlier),
                    "{earlier} was stopped before {component}, which needs it"
                );
            }
            stopped.push((act.fault, component));
        }
    }

    /// Whether the fault itself asks for the stop of the component: by its severity, or because its
    /// ladder has ended.
    fn has_own_reason(&self, component: usize, id: FaultId) -> bool {
        let verdict = &self.verdicts[&id];
        let of = (0..self.facts.len())
            .find(|one| self.name(*one) == verdict.component)
            .expect("a fault of a component");
        assert!(
            !self.consequences.contains(&id),
            "a consequence stops nothing"
        );
        if verdict.severity == Severity::Stop {
            return of == component;
        }
        let rule = self.fault_rule(of);
        let rules = self.rules(of);
        let resets = rules.resurrect.as_ref().is_none_or(|rule| rule.value.reset);
        let resets = resets && !self.facts[of].replacing;
        let exhausted = (!resets || self.used(of, &rule) >= rule.retry_max)
            && self.facts[of].replacements == rules.secondaries.len();
        exhausted
            && match rule.severity {
                ApplicationSeverity::Ignore => of == component,
                ApplicationSeverity::Local => self.place(of).0 == self.place(component).0,
                ApplicationSeverity::Global => false,
            }
    }

    /// Whether nothing can bring the component back, and that is an emergency.
    pub fn is_hopeless(&self, component: usize) -> bool {
        let (rule, rules) = (self.fault_rule(component), self.rules(component));
        let resets = rules.resurrect.as_ref().is_none_or(|rule| rule.value.reset);
        let fact = &self.facts[component];
        fact.in_error
            && self.manager.condition(component) == Some(Condition::Waiting)
            && (!resets || fact.replacing || rule.retry_max == 0)
            && fact.replacements == rules.secondaries.len()
            && rule.severity == ApplicationSeverity::Global
    }

    /// A clear renews the budgets of those that it is about.
    pub fn renew_budgets(&mut self, about: impl Fn(&str) -> bool) {
        for component in 0..self.facts.len() {
            if about(self.name(component)) {
                self.facts[component].resets.clear();
                self.facts[component].in_vain = 0;
                self.facts[component].replacing = false;
            }
        }
    }

    pub fn is_periodic(&self, component: usize) -> bool {
        let (application, index) = self.place(component);
        let component = &self.scopes[application].specification.components[index];
        matches!(
            component.execution.kind,
            ExecutionKind::Periodic | ExecutionKind::PeriodicShared
        )
    }

    pub fn name(&self, component: usize) -> &str {
        let (application, index) = self.place(component);
        &self.scopes[application].specification.components[index].name
    }

    pub fn rules(&self, component: usize) -> &ComponentRules {
        let (application, index) = self.place(component);
        &self.scopes[application].rules.components[index]
    }

    pub fn fault_rule(&self, component: usize) -> FaultRule {
        let own = self.rules(component).fault.as_ref();
        own.map(|rule| rule.value).unwrap_or_default()
    }

    /// Application, and index in it.
    pub fn place(&self, component: usize) -> (usize, usize) {
        let starts = (0..self.scopes.len()).map(|one| oracle::first(&self.scopes, one));
        let (application, start) = starts
            .enumerate()
            .take_while(|(_, start)| *start <= component)
            .last()
            .expect("the first one starts at 0");
        (application, component - start)
    }
}
