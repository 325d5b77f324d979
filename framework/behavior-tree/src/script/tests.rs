use std::collections::HashMap;

use proptest::prelude::*;

use super::*;

/// A blackboard of one scope.
#[derive(Default)]
struct Board {
    slots: HashMap<String, usize>,
    values: Vec<Option<Value>>,
}

impl Board {
    fn resolve(&mut self, name: &str) -> Name {
        if name == "RED" {
            return Name::Constant(Value::Number(1.0));
        }
        let next = self.values.len();
        let slot = *self.slots.entry(name.to_owned()).or_insert(next);
        if slot == next {
            self.values.push(None);
        }
        Name::Entry(slot)
    }

    fn run(&mut self, text: &str) -> Result<Value, String> {
        let script = Script::parse(text, &mut |name| self.resolve(name));
        script.map_err(|error| error.to_string())?.evaluate(self)
    }
}

impl Environment for Board {
    fn get(&self, slot: usize) -> Option<&Value> {
        self.values[slot].as_ref()
    }
    fn is_declared(&self, slot: usize) -> bool {
        self.values[slot].is_some()
    }
    fn set(&mut self, slot: usize, value: Value) {
        self.values[slot] = Some(value);
    }
    fn name(&self, slot: usize) -> String {
        let found = self.slots.iter().find(|(_, number)| **number == slot);
        found.map(|(name, _)| name.clone()).unwrap_or_default()
    }
}

fn text(text: &str) -> Value {
    Value::Text(text.into())
}

#[test]
fn operators_bind_as_documented() {
    for (script, expected) in [
        ("1 + 2 * 3", Value::Number(7.0)),
        ("(1 + 2) * 3", Value::Number(9.0)),
        ("10 - 4 - 3", Value::Number(3.0)),
        ("2 - -3", Value::Number(5.0)),
        ("0x1F & 0xF0 | 1", Value::Number(17.0)),
        ("~0", Value::Number(-1.0)),
        ("6 ^ 3", Value::Number(5.0)),
        ("1 < 2 < 3", Value::Boolean(true)),
        ("1 < 3 < 2", Value::Boolean(false)),
        ("1 > 2 || 2 > 1 && true", Value::Boolean(true)),
        ("!true || false", Value::Boolean(false)),
        ("1 > 2 ? 'a' : 'b'", text("b")),
        ("'a' .. 1 + 1", text("a2")),
        ("'a' + 'b'", text("ab")),
        ("1.5e1 .. ''", text("15")),
        (".5 * 2", Value::Number(1.0)),
        ("x := 3; x *= 2; x + RED", Value::Number(7.0)),
        ("a := 1; a = 'now a text'; a", text("now a text")),
        ("A:=1.1; B:=(1.0+0.1); A==B", Value::Boolean(true)),
        ("'abc' < 'abd'", Value::Boolean(true)),
        ("true == 1", Value::Boolean(true)),
        ("@top := 1; ; @top", Value::Number(1.0)),
    ] {
        assert_eq!(Board::default().run(script), Ok(expected), "{script}");
    }
}

#[test]
fn mistakes_are_told_with_their_place() {
    for (script, told) in [
        ("", "an empty script"),
        ("1 +", "the end where a value was expected, at character 4"),
        ("(1", "the end where `)` was expected"),
        ("a b", "`b` where an operator or `;` was expected"),
        ("'open", "a text without its closing '"),
        ("1 # 2", "`#` means nothing here, at character 3"),
        ("0xZZ", "a number that cannot be read"),
        ("RED := 2", "`RED` is a constant"),
        ("1 ? 2", "the end where `:` was expected"),
        ("unknown", "entry `unknown` has no value"),
        ("unknown = 1", "no entry `unknown`; `:=` would make it"),
        ("1 / 0", "no finite number"),
        ("'a' * 2", "'a' is no number"),
        ("!'a'", "'a' is neither true nor false"),
        ("1.5 & 1", "no whole number"),
    ] {
        let message = Board::default().run(script).expect_err(script);
        assert!(message.contains(told), "{script}: {message}");
    }
}

#[test]
fn what_is_not_asked_for_is_not_evaluated() {
    assert_eq!(
        Board::default().run("false && unknown"),
        Ok(Value::Boolean(false))
    );
    assert_eq!(
        Board::default().run("true || unknown"),
        Ok(Value::Boolean(true))
    );
    assert_eq!(
        Board::default().run("true ? 1 : unknown"),
        Ok(Value::Number(1.0))
    );
}

#[test]
fn depth_is_bounded() {
    for script in [
        format!("{}1{}", "(".repeat(1000), ")".repeat(1000)),
        "-".repeat(1000) + "1",
        "1".to_owned() + &" + 1".repeat(1000),
        "1 ? ".repeat(1000),
    ] {
        let message = Board::default().run(&script).expect_err("too deep");
        assert!(message.contains("in each other"), "{message}");
    }
}

/// An arithmetic expression with its value, reckoned beside the script.
fn arithmetic() -> impl Strategy<Value = (String, f64)> {
    let leaf = (-100i32..100).prop_map(|number| (format!("({number})"), f64::from(number)));
    leaf.prop_recursive(4, 24, 2, |inner| {
        (inner.clone(), 0..3, inner).prop_map(|((left, x), operator, (right, y))| {
            let (sign, value) = match operator {
                0 => ("+", x + y),
                1 => ("-", x - y),
                _ => ("*", x * y),
            };
            (format!("({left} {sign} {right})"), value)
        })
    })
}

proptest! {
    #[test]
    fn arithmetic_is_that_of_numbers((script, expected) in arithmetic()) {
        prop_assert_eq!(Board::default().run(&script), Ok(Value::Number(expected)));
    }

    #[test]
    fn no_text_is_too_odd(script in "[ a-c0-9.'()<>=!&|?:;+*/~^@_-]{0,60}") {
        // Whatever comes of it, it comes without a panic and within the stack.
        let _any = Board::default().run(&script);
    }

    #[test]
    fn a_comparison_and_its_negation_differ(left in -5i32..5, right in -5i32..5) {
        for (one, other) in [("<", ">="), (">", "<="), ("==", "!=")] {
            let yes = Board::default().run(&format!("{left} {one} {right}"));
            let no = Board::default().run(&format!("!({left} {other} {right})"));
            prop_assert_eq!(yes, no);
        }
    }
}
