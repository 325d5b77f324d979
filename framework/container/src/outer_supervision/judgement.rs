//! What the end of a container means. Decides, does nothing.

use std::fmt;
use std::time::Duration;

use signal_hook::low_level::signal_name;

/// The highest exit code of a container whose start was refused.
const LAST_REFUSAL: i32 = 6;

/// What shells add to a signal to make an exit code of it.
const SIGNAL_CODE: i32 = 128;

/// How a container ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    /// With an exit code.
    Code(i32),
    /// By a signal.
    Signal(i32),
    /// It was killed because it was silent for so long.
    Silence(Duration),
}

/// In what circumstances.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Circumstances {
    /// It is not the first one.
    pub(super) is_restart: bool,
    /// Its application has run.
    pub(super) has_run: bool,
    /// It was asked to stop, or said that it does.
    pub(super) stopping: bool,
}

/// What the end means.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Judgement {
    /// The run is over, with this exit code.
    Over(u8),
    /// The container has failed; why it is judged so.
    Failed(String),
}

/// Judges an end.
pub(super) fn judge(end: End, circumstances: Circumstances) -> Judgement {
    let Circumstances {
        is_restart,
        has_run,
        stopping,
    } = circumstances;
    let refusal = matches!(end, End::Code(0..=LAST_REFUSAL)) && !has_run;
    if stopping || (refusal && !is_restart) {
        return Judgement::Over(exit_code(end));
    }
    Judgement::Failed(match end {
        End::Silence(_) if has_run => {
            "a hang: the fault manager of a container that lives is heard every 150 ms".to_owned()
        }
        End::Silence(_) => "a hang: bringing up has limits, and these are past".to_owned(),
        End::Code(_) if refusal => {
            "a start that failed: the one before succeeded, so what it needs may come back"
                .to_owned()
        }
        End::Code(_) | End::Signal(_) => {
            "a crash: nobody had asked it to stop, and it had not said that it does".to_owned()
        }
    })
}

/// The exit code that passes an end on.
fn exit_code(end: End) -> u8 {
    let code = match end {
        End::Code(code) => code,
        End::Signal(signal) => SIGNAL_CODE + signal,
        End::Silence(_) => SIGNAL_CODE + signal_hook::consts::SIGKILL,
    };
    u8::try_from(code).unwrap_or(u8::MAX)
}

impl fmt::Display for End {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Code(code) => write!(formatter, "it ended with exit code {code}"),
            Self::Signal(signal) => {
                let name = signal_name(*signal).unwrap_or("unnamed");
                write!(formatter, "it was ended by signal {signal} ({name})")
            }
            Self::Silence(silence) => write!(
                formatter,
                "it gave no sign of life for {:.2} s and was killed",
                silence.as_secs_f64()
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_failures_are_followed_by_a_restart() {
        let silence = End::Silence(Duration::from_secs(1));
        // Restart, has run, stopping.
        for (end, [is_restart, has_run, stopping], expected) in [
            (End::Code(0), [false, true, true], Some(0)),
            (End::Code(2), [true, true, true], Some(2)),
            (End::Code(5), [false, false, false], Some(5)),
            (End::Code(0), [false, false, false], Some(0)),
            (End::Code(5), [true, false, false], None),
            (End::Code(101), [false, false, false], None),
            (End::Code(0), [false, true, false], None),
            (End::Signal(11), [false, true, false], None),
            (End::Signal(11), [false, false, false], None),
            (End::Signal(2), [false, false, true], Some(130)),
            (End::Signal(9), [true, true, true], Some(137)),
            (End::Code(130), [false, true, true], Some(130)),
            (silence, [false, true, false], None),
            (silence, [false, false, false], None),
            (silence, [false, true, true], Some(137)),
            (End::Code(-1), [false, true, true], Some(255)),
        ] {
            let circumstances = Circumstances {
                is_restart,
                has_run,
                stopping,
            };
            let code = match judge(end, circumstances) {
                Judgement::Over(code) => Some(code),
                Judgement::Failed(_) => None,
            };
            assert_eq!(code, expected, "{end:?} {circumstances:?}");
        }
    }

    #[test]
    fn an_end_is_said_in_words() {
        for (end, words) in [
            (End::Code(101), "it ended with exit code 101"),
            (End::Signal(9), "it was ended by signal 9 (SIGKILL)"),
            (
                End::Silence(Duration::from_millis(1003)),
                "it gave no sign of life for 1.00 s and was killed",
            ),
        ] {
            assert_eq!(end.to_string(), words);
        }
    }
}
