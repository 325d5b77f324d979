//! The OPRoS component life cycle (component specification, sheet A4): states, operations, and
//! which operation is allowed from which state.

use std::fmt;

/// Where a component instance stands in its life.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum LifeCycleState {
    /// The instance exists, nothing of it has run but its constructor.
    Created,
    /// `onInitialize` succeeded.
    Ready,
    /// `onStart` succeeded; the executor runs the component.
    Active,
    /// `onStop` succeeded and the port queues were cleared.
    Inactive,
    /// A callback failed, panicked or trapped; nothing of it runs until it is recovered.
    Error,
    /// `onDestroy` has run, or the instance was abandoned.
    Destroyed,
}

/// A life-cycle operation that the container asks of an instance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Operation {
    /// CREATED -> READY.
    Initialize,
    /// READY or INACTIVE -> ACTIVE.
    Start,
    /// ACTIVE -> INACTIVE.
    Stop,
    /// ACTIVE -> ERROR.
    StopOnError,
    /// ERROR -> READY.
    Recover,
    /// Any living state -> ACTIVE, by onReset, onInitialize, onStart.
    Reset,
    /// READY, ACTIVE, INACTIVE, ERROR -> DESTROYED.
    Destroy,
}

/// What an operation means in a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transition {
    /// The callbacks run; if all succeed the instance enters this state.
    Run(LifeCycleState),
    /// The operation was already done: success without a callback.
    AlreadyThere,
    /// Not allowed here: the answer is 405 PRECONDITION_NOT_MET, the state unchanged.
    Refused,
}

/// What `operation` does in `state` (facts sheet A4, without the quirks of the old engines:
/// reset is refused on a destroyed instance).
pub fn transition(state: LifeCycleState, operation: Operation) -> Transition {
    use LifeCycleState::{Active, Created, Destroyed, Error, Inactive, Ready};
    use Transition::{AlreadyThere, Refused, Run};
    match (operation, state) {
        (Operation::Initialize, Created) => Run(Ready),
        (Operation::Start, Ready | Inactive) => Run(Active),
        (Operation::Stop, Active) => Run(Inactive),
        (Operation::StopOnError, Active) => Run(Error),
        (Operation::Recover, Error) => Run(Ready),
        (Operation::Destroy, Ready | Active | Inactive | Error) => Run(Destroyed),
        (Operation::Reset, Created | Ready | Active | Inactive | Error) => Run(Active),
        (Operation::Initialize, Ready)
        | (Operation::Start, Active)
        | (Operation::Stop, Inactive)
        | (Operation::StopOnError, Error)
        | (Operation::Destroy, Destroyed) => AlreadyThere,
        _ => Refused,
    }
}

impl LifeCycleState {
    /// The state's name as OPRoS writes it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Created => "CREATED",
            Self::Ready => "READY",
            Self::Active => "ACTIVE",
            Self::Inactive => "INACTIVE",
            Self::Error => "ERROR",
            Self::Destroyed => "DESTROYED",
        }
    }
}

impl fmt::Display for LifeCycleState {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use LifeCycleState::{Active, Created, Destroyed, Error, Inactive, Ready};
    use Transition::{AlreadyThere as Again, Refused as No, Run};

    const STATES: [LifeCycleState; 6] = [Created, Ready, Active, Inactive, Error, Destroyed];

    #[test]
    fn every_operation_in_every_state() {
        let table: [(Operation, [Transition; 6]); 7] = [
            (Operation::Initialize, [Run(Ready), Again, No, No, No, No]),
            (
                Operation::Start,
                [No, Run(Active), Again, Run(Active), No, No],
            ),
            (Operation::Stop, [No, No, Run(Inactive), Again, No, No]),
            (Operation::StopOnError, [No, No, Run(Error), No, Again, No]),
            (Operation::Recover, [No, No, No, No, Run(Ready), No]),
            (
                Operation::Reset,
                [
                    Run(Active),
                    Run(Active),
                    Run(Active),
                    Run(Active),
                    Run(Active),
                    No,
                ],
            ),
            (
                Operation::Destroy,
                [
                    No,
                    Run(Destroyed),
                    Run(Destroyed),
                    Run(Destroyed),
                    Run(Destroyed),
                    Again,
                ],
            ),
        ];
        for (operation, expected) in table {
            for (state, expected) in STATES.into_iter().zip(expected) {
                assert_eq!(
                    transition(state, operation),
                    expected,
                    "{operation:?} in {state}"
                );
            }
        }
    }
}
