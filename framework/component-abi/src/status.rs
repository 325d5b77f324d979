//! Return codes: the OPRoS families (facts sheet A4) plus what containment adds.

use core::fmt;

/// The answer of every call that crosses the boundary.
#[repr(transparent)]
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Status(pub u32);

impl Status {
    /// Done.
    pub const SUCCESS: Self = Self(200);
    /// Done, and synchronously so.
    pub const SUCCESS_SYNC: Self = Self(202);
    /// Nothing there: the input holds no new datum, the property is not set.
    pub const NOTHING: Self = Self(204);
    /// The caller did something wrong.
    pub const CALLER_ERROR: Self = Self(400);
    /// A parameter is wrong: pointer, size, index or type.
    pub const BAD_INPUT_PARAMETER: Self = Self(401);
    /// A parameter lies outside its range.
    pub const INPUT_OUT_OF_RANGE: Self = Self(402);
    /// A parameter is null.
    pub const INPUT_NULL: Self = Self(403);
    /// The caller may not do this: a host service called from a thread of the component's own.
    pub const UNAUTHORIZED: Self = Self(404);
    /// Not allowed in this life-cycle state, or not connected.
    pub const PRECONDITION_NOT_MET: Self = Self(405);
    /// A queue, a table or the memory is full.
    pub const OUT_OF_RESOURCES: Self = Self(408);
    /// The callee failed.
    pub const CALLEE_ERROR: Self = Self(500);
    /// The callee does not offer this.
    pub const UNSUPPORTED_METHOD: Self = Self(501);
    /// The callee failed for a reason of its own.
    pub const INTERNAL_FAULT: Self = Self(502);
    /// The callee did not answer in time.
    pub const TIMED_OUT: Self = Self(504);
    /// The two sides were built for different versions.
    pub const VERSION_MISMATCH: Self = Self(505);
    /// Family of failures that a component declares unrecoverable.
    pub const UNRECOVERABLE: Self = Self(0x1000_0000);
    /// The callback panicked; the text has been handed to the host. No recovery of this instance.
    pub const PANICKED: Self = Self(0x1000_0200);
    /// Family of failures that a component declares recoverable.
    pub const RECOVERABLE: Self = Self(0x2000_0000);

    /// Whether the call succeeded.
    pub const fn is_success(self) -> bool {
        matches!(self.0, 200 | 202)
    }

    /// The code's family and name as a person reads it; unknown codes by family.
    pub const fn name(self) -> &'static str {
        match self.0 {
            200 => "SUCCESS",
            202 => "SUCCESS_SYNC",
            204 => "NOTHING",
            400 => "CALLER_ERROR",
            401 => "BAD_INPUT_PARAMETER",
            402 => "INPUT_OUT_OF_RANGE",
            403 => "INPUT_NULL",
            404 => "UNAUTHORIZED",
            405 => "PRECONDITION_NOT_MET",
            408 => "OUT_OF_RESOURCES",
            500 => "CALLEE_ERROR",
            501 => "UNSUPPORTED_METHOD",
            502 => "INTERNAL_FAULT",
            504 => "TIMED_OUT",
            505 => "VERSION_MISMATCH",
            0x1000_0200 => "PANICKED",
            code => match code >> 28 {
                1 => "UNRECOVERABLE",
                2 => "RECOVERABLE",
                _ => "UNKNOWN",
            },
        }
    }
}

impl fmt::Display for Status {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0 >= 0x1000_0000 {
            write!(formatter, "{:#x} {}", self.0, self.name())
        } else {
            write!(formatter, "{} {}", self.0, self.name())
        }
    }
}

impl fmt::Debug for Status {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, formatter)
    }
}
