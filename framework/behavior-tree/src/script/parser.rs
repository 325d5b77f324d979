//! Words to expressions, by descent from the loosest operator to the tightest.

use thiserror::Error;

use super::lexer::{Word, words};
use super::{Assignment, Binary, Comparison, Expression, Name, Script, Unary};
use crate::value::Value;

/// So deep may parentheses and operators be nested; what is deeper is damaged or hostile.
pub const MAX_SCRIPT_DEPTH: usize = 64;

/// Why a text is no script.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{message}, at character {} of the script", position + 1)]
pub struct ScriptError {
    /// The byte of the text at which the trouble begins.
    pub position: usize,
    /// What is wrong.
    pub message: String,
}

impl ScriptError {
    pub(super) fn new(position: usize, message: impl Into<String>) -> Self {
        Self {
            position,
            message: message.into(),
        }
    }
}

pub(super) fn parse(
    text: &str,
    resolve: &mut dyn FnMut(&str) -> Name,
) -> Result<Script, ScriptError> {
    let mut parser = Parser {
        words: words(text)?,
        next: 0,
        end: text.len(),
        depth: 0,
        resolve,
    };
    let mut statements = Vec::new();
    while parser.next < parser.words.len() {
        if parser.take(";") {
            continue;
        }
        statements.push(parser.statement()?);
        if parser.next < parser.words.len() && !parser.take(";") {
            return Err(parser.unexpected("an operator or `;`"));
        }
    }
    if statements.is_empty() {
        return Err(ScriptError::new(0, "an empty script"));
    }
    Ok(Script {
        statements: statements.into(),
    })
}

struct Parser<'a> {
    words: Vec<(usize, Word)>,
    next: usize,
    end: usize,
    depth: usize,
    resolve: &'a mut dyn FnMut(&str) -> Name,
}

type Parsed = Result<Expression, ScriptError>;

impl Parser<'_> {
    fn statement(&mut self) -> Parsed {
        let (Some((at, Word::Name(name))), Some((_, Word::Sign(sign)))) =
            (self.words.get(self.next), self.words.get(self.next + 1))
        else {
            return self.choice();
        };
        let assignment = match *sign {
            ":=" => Assignment::Make,
            "=" => Assignment::Change,
            "+=" => Assignment::Update(Binary::Plus),
            "-=" => Assignment::Update(Binary::Minus),
            "*=" => Assignment::Update(Binary::Times),
            "/=" => Assignment::Update(Binary::Over),
            _ => return self.choice(),
        };
        let (at, name) = (*at, name.clone());
        self.next += 2;
        let Name::Entry(slot) = (self.resolve)(&name) else {
            let message = format!("`{name}` is a constant and cannot be changed");
            return Err(ScriptError::new(at, message));
        };
        let value = self.choice()?;
        Ok(Expression::Assign(slot, assignment, value.into()))
    }

    fn choice(&mut self) -> Parsed {
        let condition = self.or()?;
        if !self.take("?") {
            return Ok(condition);
        }
        let yes = self.deeper(Self::choice)?;
        if !self.take(":") {
            return Err(self.unexpected("`:`"));
        }
        let no = self.deeper(Self::choice)?;
        Ok(Expression::Choice(Box::new([condition, yes, no])))
    }

    fn or(&mut self) -> Parsed {
        let mut left = self.and()?;
        let mut taken = 0;
        while self.take("||") {
            self.bounded(&mut taken)?;
            left = Expression::Or(left.into(), self.and()?.into());
        }
        Ok(left)
    }

    fn and(&mut self) -> Parsed {
        let mut left = self.comparison()?;
        let mut taken = 0;
        while self.take("&&") {
            self.bounded(&mut taken)?;
            left = Expression::And(left.into(), self.comparison()?.into());
        }
        Ok(left)
    }

    fn comparison(&mut self) -> Parsed {
        const SIGNS: [(&str, Comparison); 6] = [
            ("==", Comparison::Equal),
            ("!=", Comparison::Unequal),
            ("<=", Comparison::LessOrEqual),
            ("<", Comparison::Less),
            (">=", Comparison::GreaterOrEqual),
            (">", Comparison::Greater),
        ];
        let first = self.binary(0)?;
        let mut others = Vec::new();
        while let Some(comparison) = self.take_any(&SIGNS) {
            others.push((comparison, self.binary(0)?));
        }
        Ok(match others.is_empty() {
            true => first,
            false => Expression::Chain(first.into(), others.into()),
        })
    }

    /// Operators of one value from two, by how tight they bind.
    fn binary(&mut self, level: usize) -> Parsed {
        const LEVELS: [&[(&str, Binary)]; 6] = [
            &[("|", Binary::BitOr)],
            &[("^", Binary::BitXor)],
            &[("&", Binary::BitAnd)],
            &[("..", Binary::Join)],
            &[("+", Binary::Plus), ("-", Binary::Minus)],
            &[("*", Binary::Times), ("/", Binary::Over)],
        ];
        let Some(signs) = LEVELS.get(level) else {
            return self.unary();
        };
        let mut left = self.binary(level + 1)?;
        let mut taken = 0;
        while let Some(operator) = self.take_any(signs) {
            self.bounded(&mut taken)?;
            left = Expression::Binary(operator, left.into(), self.binary(level + 1)?.into());
        }
        Ok(left)
    }

    fn unary(&mut self) -> Parsed {
        const SIGNS: [(&str, Unary); 3] = [
            ("!", Unary::Not),
            ("-", Unary::Minus),
            ("~", Unary::Complement),
        ];
        match self.take_any(&SIGNS) {
            Some(operator) => {
                let operand = self.deeper(Self::unary)?;
                Ok(Expression::Unary(operator, operand.into()))
            }
            None => self.operand(),
        }
    }

    fn operand(&mut self) -> Parsed {
        if self.take("(") {
            let inner = self.deeper(Self::choice)?;
            return match self.take(")") {
                true => Ok(inner),
                false => Err(self.unexpected("`)`")),
            };
        }
        let expression = match self.words.get(self.next) {
            Some((_, Word::Number(number))) => Expression::Literal(Value::Number(*number)),
            Some((_, Word::Text(text))) => Expression::Literal(Value::Text(text.as_str().into())),
            Some((_, Word::Name(name))) => match name.as_str() {
                "true" => Expression::Literal(Value::Boolean(true)),
                "false" => Expression::Literal(Value::Boolean(false)),
                name => match (self.resolve)(name) {
                    Name::Entry(slot) => Expression::Entry(slot),
                    Name::Constant(value) => Expression::Literal(value),
                },
            },
            _ => return Err(self.unexpected("a value")),
        };
        self.next += 1;
        Ok(expression)
    }

    fn take(&mut self, sign: &str) -> bool {
        let found = matches!(self.words.get(self.next), Some((_, Word::Sign(it))) if *it == sign);
        self.next += usize::from(found);
        found
    }

    fn take_any<T: Copy>(&mut self, signs: &[(&str, T)]) -> Option<T> {
        let found = signs.iter().find(|(sign, _)| self.take(sign));
        found.map(|(_, meaning)| *meaning)
    }

    fn deeper(&mut self, parse: fn(&mut Self) -> Parsed) -> Parsed {
        self.depth += 1;
        if self.depth > MAX_SCRIPT_DEPTH {
            return Err(self.too_deep());
        }
        let parsed = parse(self);
        self.depth -= 1;
        parsed
    }

    /// A chain of operators nests to the left: it counts as deep as it is long.
    fn bounded(&self, taken: &mut usize) -> Result<(), ScriptError> {
        *taken += 1;
        match *taken > MAX_SCRIPT_DEPTH {
            true => Err(self.too_deep()),
            false => Ok(()),
        }
    }

    fn too_deep(&self) -> ScriptError {
        let message = format!("more than {MAX_SCRIPT_DEPTH} operators in each other");
        ScriptError::new(self.position(), message)
    }

    fn unexpected(&self, expected: &str) -> ScriptError {
        let found = match self.words.get(self.next) {
            Some((_, Word::Sign(sign))) => format!("`{sign}`"),
            Some((_, Word::Name(name))) => format!("`{name}`"),
            Some((_, Word::Number(number))) => format!("`{number}`"),
            Some((_, Word::Text(text))) => format!("'{text}'"),
            None => "the end".to_owned(),
        };
        ScriptError::new(
            self.position(),
            format!("{found} where {expected} was expected"),
        )
    }

    fn position(&self) -> usize {
        self.words.get(self.next).map_or(self.end, |(at, _)| *at)
    }
}
