//! What container and host say to each other, as words: a call and its end, a question and its
//! answer. Contents travel beside them. What a host says may be anything; what makes no sense is no
//! message.

use crate::guard::{Callback, Misbehaviour};

use super::channel::WORD_COUNT;
use super::ending::{self, HostEnding};

/// A message.
pub(super) type Words = [u64; WORD_COUNT];

/// Where a message says how many bytes of written data go with it.
const WRITTEN: usize = WORD_COUNT - 1;

/// From the container.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ToHost {
    /// Run a callback.
    Call(Call),
    /// The status that answers what was asked.
    Answer(u64),
    /// The instance is not wanted any more.
    End,
}

/// A callback to be run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Call {
    /// Which.
    pub(super) callback: CallbackWords,
    /// What is to go wrong in it.
    pub(super) injection: Option<Misbehaviour>,
    /// What was allocated so far counts no more.
    pub(super) forgets_allocations: bool,
    /// The container's clock, in nanoseconds, for as long as it stands still.
    pub(super) now_ns: u64,
    /// How long it may take, in nanoseconds; 0 if there is no limit.
    pub(super) limit_ns: u64,
    /// The how many-th of the instance it is, by which it can be condemned; not 0.
    pub(super) number: u32,
}

/// A callback without the addresses of its contents, which are another process's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CallbackWords {
    /// One without arguments, by its place in [`PLAIN`].
    Plain(usize),
    /// `onPeriodChanged`, in nanoseconds.
    PeriodChanged(u64),
    /// `onEvent`: port, size of the content.
    Event(u32, usize),
    /// A service method: port, method, sizes of request and reply.
    Call(u32, u32, usize, usize),
}

/// Callbacks without arguments.
pub(super) const PLAIN: [Callback; 11] = [
    Callback::Create,
    Callback::Initialize,
    Callback::Start,
    Callback::Stop,
    Callback::Reset,
    Callback::Error,
    Callback::Recover,
    Callback::Destroy,
    Callback::Execute,
    Callback::Updated,
    Callback::DestroyInstance,
];

/// From the host.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ToContainer {
    /// The library is loaded, and this thread will run the instance.
    Loaded(i32),
    /// It is not; the reason has so many bytes.
    Refused(usize),
    /// The component asks for something.
    Asked(Question),
    /// The callback is over.
    Ended(HostEnding),
}

/// What a component asks for. A text or content that it passed and that is not readable, or not
/// writable, is `bad`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Question {
    /// What.
    pub(super) asked: Asked,
    /// Whether it passed memory that is not accessible.
    pub(super) bad: bool,
}

/// The kinds of questions; sizes are in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Asked {
    /// Port, size.
    Read(u32, usize),
    /// Port, size.
    Write(u32, usize),
    /// Port, size.
    Raise(u32, usize),
    /// Port, method, size of request, size of reply, deadline in nanoseconds.
    Call(u32, u32, usize, usize, u64),
    /// Size of the name, room for the value.
    Property(usize, usize),
    /// Level, size of the message.
    Log(u32, usize),
    /// Place in the critical part, size.
    Critical(usize, usize),
    /// Status code, size of the message.
    ReportFault(u32, usize),
    /// Sizes of message and file, line, column.
    Failed(usize, usize, u32, u32),
    /// Size of the name.
    OpenDevice(usize),
    /// Nothing: there is no more room for what was written.
    HandOver,
}

impl ToHost {
    /// As words.
    pub(super) fn words(self) -> Words {
        match self {
            Self::Call(call) => {
                let [kind, a, b, c, d] = call.callback.words();
                let [misbehaviour, argument] = ending::misbehaviour_words(call.injection);
                words(&[
                    1,
                    kind,
                    a,
                    b,
                    c,
                    d,
                    misbehaviour,
                    argument,
                    u64::from(call.forgets_allocations),
                    call.now_ns,
                    call.limit_ns,
                    call.number.into(),
                ])
            }
            Self::Answer(status) => words(&[2, status]),
            Self::End => words(&[3]),
        }
    }

    /// From words.
    pub(super) fn from_words(words: &Words) -> Option<Self> {
        Some(match words[0] {
            1 => Self::Call(Call {
                callback: CallbackWords::from_words(words[1..6].try_into().ok()?)?,
                injection: ending::misbehaviour([words[6], words[7]])?,
                forgets_allocations: words[8] != 0,
                now_ns: words[9],
                limit_ns: words[10],
                number: number(words[11])?,
            }),
            2 => Self::Answer(words[1]),
            3 => Self::End,
            _ => return None,
        })
    }
}

impl CallbackWords {
    /// Of a callback.
    pub(super) fn of(callback: &Callback) -> Self {
        match callback {
            Callback::PeriodChanged(period_ns) => Self::PeriodChanged(*period_ns),
            Callback::Event(port, _, size) => Self::Event(*port, *size),
            Callback::Call(call) => {
                Self::Call(call.port, call.method, call.request_size, call.reply_size)
            }
            plain => {
                let kind = std::mem::discriminant(plain);
                let of = |other: &Callback| std::mem::discriminant(other) == kind;
                Self::Plain(PLAIN.iter().position(of).unwrap_or(PLAIN.len()))
            }
        }
    }

    fn words(self) -> [u64; 5] {
        match self {
            Self::Plain(index) => [1, index as u64, 0, 0, 0],
            Self::PeriodChanged(period_ns) => [2, period_ns, 0, 0, 0],
            Self::Event(port, size) => [3, port.into(), size as u64, 0, 0],
            Self::Call(port, method, request, reply) => {
                [4, port.into(), method.into(), request as u64, reply as u64]
            }
        }
    }

    fn from_words([kind, a, b, c, d]: [u64; 5]) -> Option<Self> {
        Some(match kind {
            1 if size(a)? < PLAIN.len() => Self::Plain(size(a)?),
            2 => Self::PeriodChanged(a),
            3 => Self::Event(number(a)?, size(b)?),
            4 => Self::Call(number(a)?, number(b)?, size(c)?, size(d)?),
            _ => return None,
        })
    }
}

impl ToContainer {
    /// As words; `written` bytes of data go with them.
    pub(super) fn words(self, written: usize) -> Words {
        let mut words = match self {
            Self::Loaded(thread) => words(&[1, u64::from(thread.cast_unsigned())]),
            Self::Refused(size) => words(&[2, size as u64]),
            Self::Asked(question) => {
                let [kind, a, b, c, d, e] = question.asked.words();
                words(&[3, kind, a, b, c, d, e, u64::from(question.bad)])
            }
            Self::Ended(ending) => {
                let mut words = words(&[4]);
                words[1..WRITTEN].copy_from_slice(&ending.words());
                words
            }
        };
        words[WRITTEN] = written as u64;
        words
    }

    /// From words, with the number of bytes that were written.
    pub(super) fn from_words(words: &Words) -> Option<(Self, usize)> {
        let message = match words[0] {
            1 => Self::Loaded(number(words[1])?.cast_signed()),
            2 => Self::Refused(size(words[1])?),
            3 => Self::Asked(Question {
                asked: Asked::from_words(words[1..7].try_into().ok()?)?,
                bad: words[7] != 0,
            }),
            4 => Self::Ended(HostEnding::from_words(words[1..WRITTEN].try_into().ok()?)?),
            _ => return None,
        };
        Some((message, size(words[WRITTEN])?))
    }
}

impl Asked {
    fn words(self) -> [u64; 6] {
        match self {
            Self::Read(port, size) => [1, port.into(), size as u64, 0, 0, 0],
            Self::Write(port, size) => [2, port.into(), size as u64, 0, 0, 0],
            Self::Raise(port, size) => [3, port.into(), size as u64, 0, 0, 0],
            Self::Call(port, method, request, reply, deadline_ns) => [
                4,
                port.into(),
                method.into(),
                request as u64,
                reply as u64,
                deadline_ns,
            ],
            Self::Property(name, value) => [5, name as u64, value as u64, 0, 0, 0],
            Self::Log(level, size) => [6, level.into(), size as u64, 0, 0, 0],
            Self::Critical(offset, size) => [7, offset as u64, size as u64, 0, 0, 0],
            Self::ReportFault(code, size) => [8, code.into(), size as u64, 0, 0, 0],
            Self::Failed(message, file, line, column) => [
                9,
                message as u64,
                file as u64,
                line.into(),
                column.into(),
                0,
            ],
            Self::OpenDevice(size) => [10, size as u64, 0, 0, 0, 0],
            Self::HandOver => [11, 0, 0, 0, 0, 0],
        }
    }

    fn from_words([kind, a, b, c, d, e]: [u64; 6]) -> Option<Self> {
        Some(match kind {
            1 => Self::Read(number(a)?, size(b)?),
            2 => Self::Write(number(a)?, size(b)?),
            3 => Self::Raise(number(a)?, size(b)?),
            4 => Self::Call(number(a)?, number(b)?, size(c)?, size(d)?, e),
            5 => Self::Property(size(a)?, size(b)?),
            6 => Self::Log(number(a)?, size(b)?),
            7 => Self::Critical(size(a)?, size(b)?),
            8 => Self::ReportFault(number(a)?, size(b)?),
            9 => Self::Failed(size(a)?, size(b)?, number(c)?, number(d)?),
            10 => Self::OpenDevice(size(a)?),
            11 => Self::HandOver,
            _ => return None,
        })
    }
}

fn words(first: &[u64]) -> Words {
    let mut words = [0; WORD_COUNT];
    words[..first.len()].copy_from_slice(first);
    words
}

pub(super) fn number(word: u64) -> Option<u32> {
    u32::try_from(word).ok()
}

pub(super) fn size(word: u64) -> Option<usize> {
    usize::try_from(word).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_said_is_understood() {
        for callback in [
            CallbackWords::Plain(0),
            CallbackWords::Plain(10),
            CallbackWords::PeriodChanged(u64::MAX),
            CallbackWords::Event(3, 1 << 20),
            CallbackWords::Call(1, 2, 3, 4),
        ] {
            let said = ToHost::Call(Call {
                callback,
                injection: Some(Misbehaviour::Leak(9)),
                forgets_allocations: true,
                now_ns: 17,
                limit_ns: 18,
                number: 19,
            });
            assert_eq!(ToHost::from_words(&said.words()), Some(said));
        }
        for said in [ToHost::Answer(5), ToHost::End] {
            assert_eq!(ToHost::from_words(&said.words()), Some(said));
        }
        for asked in [
            Asked::Read(1, 2),
            Asked::Write(1, 2),
            Asked::Raise(1, 2),
            Asked::Call(1, 2, 3, 4, 5),
            Asked::Property(1, 2),
            Asked::Log(1, 2),
            Asked::Critical(1, 2),
            Asked::ReportFault(1, 2),
            Asked::Failed(1, 2, 3, 4),
            Asked::OpenDevice(1),
            Asked::HandOver,
        ] {
            let said = ToContainer::Asked(Question { asked, bad: true });
            assert_eq!(
                ToContainer::from_words(&said.words(99)),
                Some((said, 99)),
                "{asked:?}"
            );
        }
        for said in [ToContainer::Loaded(7), ToContainer::Refused(3)] {
            assert_eq!(ToContainer::from_words(&said.words(0)), Some((said, 0)));
        }
    }

    #[test]
    fn nonsense_is_no_message() {
        let mut nonsense = [u64::MAX; WORD_COUNT];
        assert_eq!(ToHost::from_words(&nonsense), None);
        assert_eq!(ToContainer::from_words(&nonsense), None);
        for kind in 1..=4 {
            nonsense[0] = kind;
            let understood = ToContainer::from_words(&nonsense);
            assert!(
                matches!(understood, None | Some((ToContainer::Refused(_), _))),
                "{understood:?}"
            );
        }
        assert_eq!(
            ToHost::from_words(&words(&[1, 1, 11])),
            None,
            "no such callback"
        );
    }

    #[test]
    fn every_callback_without_arguments_has_its_place() {
        for (index, callback) in PLAIN.iter().enumerate() {
            assert_eq!(CallbackWords::of(callback), CallbackWords::Plain(index));
        }
    }
}
