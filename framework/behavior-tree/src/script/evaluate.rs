//! The value of a script, without allocation except where texts are joined.

use super::{Assignment, Binary, Comparison, Expression, Script, Unary};
use crate::value::Value;

/// Where a script finds and leaves its entries.
pub(crate) trait Environment {
    /// The value of a slot, if it has one.
    fn get(&self, slot: usize) -> Option<&Value>;
    /// Whether a file mentions the entry or somebody has made it.
    fn is_declared(&self, slot: usize) -> bool;
    /// Gives a slot a value.
    fn set(&mut self, slot: usize, value: Value);
    /// What the slot is called in messages.
    fn name(&self, slot: usize) -> String;
}

impl Script {
    /// Runs all statements; the value is that of the last one.
    pub(crate) fn evaluate(&self, environment: &mut impl Environment) -> Result<Value, String> {
        let mut last = Value::Boolean(false);
        for statement in &self.statements {
            last = value(statement, environment)?;
        }
        Ok(last)
    }

    /// As [`Script::evaluate`], where the value must be true or false.
    pub(crate) fn holds(&self, environment: &mut impl Environment) -> Result<bool, String> {
        truth(&self.evaluate(environment)?)
    }
}

fn value(expression: &Expression, environment: &mut impl Environment) -> Result<Value, String> {
    match expression {
        Expression::Literal(literal) => Ok(literal.clone()),
        Expression::Entry(slot) => match environment.get(*slot) {
            Some(value) => Ok(value.clone()),
            None => Err(not_set(*slot, environment)),
        },
        Expression::Unary(operator, operand) => unary(*operator, &value(operand, environment)?),
        Expression::Binary(operator, left, right) => {
            let left = value(left, environment)?;
            binary(*operator, &left, &value(right, environment)?)
        }
        Expression::Chain(first, others) => {
            let mut left = value(first, environment)?;
            for (comparison, right) in others {
                let right = value(right, environment)?;
                if !compare(*comparison, &left, &right)? {
                    return Ok(Value::Boolean(false));
                }
                left = right;
            }
            Ok(Value::Boolean(true))
        }
        Expression::And(left, right) => {
            let both = truth(&value(left, environment)?)? && truth(&value(right, environment)?)?;
            Ok(Value::Boolean(both))
        }
        Expression::Or(left, right) => {
            let either = truth(&value(left, environment)?)? || truth(&value(right, environment)?)?;
            Ok(Value::Boolean(either))
        }
        Expression::Choice(parts) => {
            let [condition, yes, no] = parts.as_ref();
            match truth(&value(condition, environment)?)? {
                true => value(yes, environment),
                false => value(no, environment),
            }
        }
        Expression::Assign(slot, assignment, right) => {
            let right = value(right, environment)?;
            assign(*slot, *assignment, right, environment)
        }
    }
}

fn assign(
    slot: usize,
    assignment: Assignment,
    right: Value,
    environment: &mut impl Environment,
) -> Result<Value, String> {
    let new = match assignment {
        Assignment::Make => right,
        Assignment::Change if environment.is_declared(slot) => right,
        Assignment::Change => {
            let name = environment.name(slot);
            return Err(format!(
                "the blackboard has no entry `{name}`; `:=` would make it"
            ));
        }
        Assignment::Update(operator) => match environment.get(slot) {
            Some(old) => binary(operator, old, &right)?,
            None => return Err(not_set(slot, environment)),
        },
    };
    environment.set(slot, new.clone());
    Ok(new)
}

fn not_set(slot: usize, environment: &impl Environment) -> String {
    format!(
        "the blackboard's entry `{}` has no value",
        environment.name(slot)
    )
}

fn truth(value: &Value) -> Result<bool, String> {
    value
        .as_boolean()
        .ok_or_else(|| format!("'{value}' is neither true nor false"))
}

fn number(value: &Value) -> Result<f64, String> {
    value
        .as_number()
        .ok_or_else(|| format!("'{value}' is no number"))
}

/// Bits are those of a whole number of 64 bits, as in BehaviorTree.CPP.
fn bits(value: &Value) -> Result<i64, String> {
    let number = number(value)?;
    // Bounds of i64, the upper one as the nearest number below it that f64 can hold.
    let fits = number.fract() == 0.0 && (-9.2e18..=9.2e18).contains(&number);
    match fits {
        true => Ok(number as i64),
        false => Err(format!("{number} is no whole number, and has no bits")),
    }
}

fn unary(operator: Unary, operand: &Value) -> Result<Value, String> {
    Ok(match operator {
        Unary::Not => Value::Boolean(!truth(operand)?),
        Unary::Minus => Value::Number(-number(operand)?),
        Unary::Complement => Value::Number(!bits(operand)? as f64),
    })
}

fn binary(operator: Binary, left: &Value, right: &Value) -> Result<Value, String> {
    let result = match operator {
        Binary::Join => return Ok(Value::Text(format!("{left}{right}").into())),
        Binary::Plus => match (left, right) {
            (Value::Text(left), Value::Text(right)) => {
                return Ok(Value::Text(format!("{left}{right}").into()));
            }
            _ => number(left)? + number(right)?,
        },
        Binary::Minus => number(left)? - number(right)?,
        Binary::Times => number(left)? * number(right)?,
        Binary::Over => number(left)? / number(right)?,
        Binary::BitAnd => (bits(left)? & bits(right)?) as f64,
        Binary::BitOr => (bits(left)? | bits(right)?) as f64,
        Binary::BitXor => (bits(left)? ^ bits(right)?) as f64,
    };
    match result.is_finite() {
        true => Ok(Value::Number(result)),
        false => Err(format!("{left} and {right} give no finite number")),
    }
}

fn compare(comparison: Comparison, left: &Value, right: &Value) -> Result<bool, String> {
    let order = |left: &Value, right: &Value| match (left, right) {
        (Value::Text(left), Value::Text(right)) => Ok(left.as_ref().cmp(right.as_ref())),
        _ => number(left)?
            .partial_cmp(&number(right)?)
            .ok_or_else(|| format!("{left} and {right} cannot be compared")),
    };
    Ok(match comparison {
        Comparison::Equal => left.equals(right),
        Comparison::Unequal => !left.equals(right),
        Comparison::Less => order(left, right)?.is_lt(),
        Comparison::LessOrEqual => order(left, right)?.is_le() || left.equals(right),
        Comparison::Greater => order(left, right)?.is_gt(),
        Comparison::GreaterOrEqual => order(left, right)?.is_ge() || left.equals(right),
    })
}
