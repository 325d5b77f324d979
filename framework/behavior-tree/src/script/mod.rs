//! The scripts of pre- and post-conditions and of the node `Script`, a language of expressions.
//!
//! Statements are separated by `;`; the last one is the script's value. `name := value` makes an
//! entry of the blackboard or changes it, `=`, `+=`, `-=`, `*=` and `/=` change one that a file
//! mentions or a script has made. From the loosest to the tightest: `c ? a : b`, `||`, `&&`, comparisons,
//! which may be chained (`1 < x <= 3`), `|`, `^`, `&`, `..` (joins texts), `+` `-`, `*` `/`, and
//! `!` `-` `~` before an operand. Operands are numbers (also `0x1F`), `'texts'`, `true`, `false`,
//! names of the blackboard or of constants, `@name` of the outermost blackboard, and parentheses.

mod evaluate;
mod lexer;
mod parser;

pub(crate) use evaluate::Environment;
pub use parser::{MAX_SCRIPT_DEPTH, ScriptError};

use crate::value::Value;

/// A script whose names were resolved to slots of a blackboard.
#[derive(Debug, Clone, PartialEq)]
pub struct Script {
    pub(crate) statements: Box<[Expression]>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Expression {
    Literal(Value),
    Entry(usize),
    Unary(Unary, Box<Expression>),
    Binary(Binary, Box<Expression>, Box<Expression>),
    /// Each operator with the operand behind it.
    Chain(Box<Expression>, Box<[(Comparison, Expression)]>),
    And(Box<Expression>, Box<Expression>),
    Or(Box<Expression>, Box<Expression>),
    Choice(Box<[Expression; 3]>),
    Assign(usize, Assignment, Box<Expression>),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Unary {
    Not,
    Minus,
    Complement,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Binary {
    Plus,
    Minus,
    Times,
    Over,
    Join,
    BitAnd,
    BitOr,
    BitXor,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Comparison {
    Equal,
    Unequal,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Assignment {
    /// Makes the entry if there is none.
    Make,
    Change,
    /// Changes by an operation with the old value.
    Update(Binary),
}

/// What a name in a script stands for.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Name {
    Entry(usize),
    Constant(Value),
}

impl Script {
    /// Parses a text; `resolve` says what a name stands for.
    pub(crate) fn parse(
        text: &str,
        resolve: &mut dyn FnMut(&str) -> Name,
    ) -> Result<Self, ScriptError> {
        parser::parse(text, resolve)
    }
}

#[cfg(test)]
mod tests;
