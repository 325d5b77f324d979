//! The XML schemas and the readers agree: what one takes the other takes, what one refuses the
//! other refuses, and where XSD 1.0 cannot say what a reader asks for, that is listed.
//!
//! Schemas are validated against by `xmllint` (Debian: libxml2-utils). Where there is none these
//! tests say so and pass, unless REQUIRE_XMLLINT is set, as it is by `.ci/run`.

mod mistakes;
mod names;
mod samples;
mod xmllint;
