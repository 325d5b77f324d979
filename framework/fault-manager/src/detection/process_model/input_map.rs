//! Inputs of a model from the data of a port.

use system_model::data_type::DataType;
use system_model::process_model::{InputCase, ModelInput};

use crate::detection::number::{NumberReader, UnknownField};

/// Reckons the inputs of a model from each datum, as the model's `inputs` say.
#[derive(Debug, Clone)]
pub struct InputMap {
    inputs: Vec<Vec<Case>>,
}

#[derive(Debug, Clone)]
struct Case {
    condition: Option<(NumberReader, f64)>,
    terms: Vec<(NumberReader, f64)>,
    offset: f64,
}

impl InputMap {
    /// Prepares the inputs of a model whose port has data of this type.
    ///
    /// # Errors
    /// Every field that the type does not have; the index is that of the input.
    pub fn compile(inputs: &[ModelInput], data_type: &DataType) -> Result<Self, Vec<UnknownField>> {
        let mut errors = Vec::new();
        let mut maps = Vec::with_capacity(inputs.len());
        for (index, input) in inputs.iter().enumerate() {
            let mut reader = |field: &str| {
                let reader = NumberReader::compile(data_type, Some(field), index);
                reader.map_err(|error| errors.push(error)).ok()
            };
            let cases = input.cases.iter().map(|case| Case::new(case, &mut reader));
            maps.push(cases.collect::<Vec<_>>());
        }
        let inputs = maps
            .into_iter()
            .map(|cases| cases.into_iter().collect::<Option<Vec<_>>>());
        match inputs.collect() {
            Some(inputs) => Ok(Self { inputs }),
            None => Err(errors),
        }
    }

    /// Number of inputs.
    pub fn inputs(&self) -> usize {
        self.inputs.len()
    }

    /// Writes the inputs that a datum stands for, as many as there is room for; NaN where it has the
    /// wrong size.
    pub fn read(&self, bytes: &[u8], inputs: &mut [f64]) {
        for (input, cases) in inputs.iter_mut().zip(&self.inputs) {
            let case = cases.iter().find(|case| case.holds(bytes));
            *input = case.map_or(0.0, |case| case.value(bytes));
        }
    }
}

impl Case {
    /// None if a field is unknown; all are asked for.
    fn new(
        case: &InputCase,
        reader: &mut impl FnMut(&str) -> Option<NumberReader>,
    ) -> Option<Self> {
        let condition = case
            .condition
            .as_ref()
            .map(|condition| Some((reader(&condition.field)?, condition.equals)));
        let terms = case.terms.iter();
        let terms: Vec<_> = terms
            .map(|term| Some((reader(&term.field)?, term.scale)))
            .collect();
        Some(Self {
            condition: match condition {
                Some(condition) => Some(condition?),
                None => None,
            },
            terms: terms.into_iter().collect::<Option<_>>()?,
            offset: case.offset,
        })
    }

    /// A datum that cannot be read meets every condition, so that it becomes no number, not zero.
    fn holds(&self, bytes: &[u8]) -> bool {
        self.condition.as_ref().is_none_or(|(reader, equals)| {
            let value = reader.read(bytes);
            value.is_nan() || value == *equals
        })
    }

    fn value(&self, bytes: &[u8]) -> f64 {
        let terms = self.terms.iter();
        let terms = terms.map(|(reader, scale)| scale * reader.read(bytes));
        let condition = self.condition.iter();
        // Not a number if the condition cannot be read, whatever the terms are.
        let unreadable = condition.map(|(reader, _)| reader.read(bytes) * 0.0);
        self.offset + terms.sum::<f64>() + unreadable.sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use system_model::process_model::{InputCondition, InputTerm};

    use super::*;
    use crate::detection::number::tests::{range_type, ranges};

    fn case(condition: Option<(&str, f64)>, terms: &[(&str, f64)], offset: f64) -> InputCase {
        InputCase {
            condition: condition.map(|(field, equals)| InputCondition {
                field: field.into(),
                equals,
            }),
            terms: terms
                .iter()
                .map(|(field, scale)| InputTerm {
                    field: (*field).into(),
                    scale: *scale,
                })
                .collect(),
            offset,
        }
    }

    fn inputs(cases: Vec<InputCase>) -> Vec<ModelInput> {
        vec![ModelInput {
            name: "speed".into(),
            cases,
        }]
    }

    #[test]
    fn the_first_case_that_holds_counts() {
        let cases = vec![
            case(
                Some(("kind", 1.0)),
                &[("ranges[0]", 2.0), ("ranges[1]", -1.0)],
                0.5,
            ),
            case(Some(("kind", 2.0)), &[("ranges[0]", -2.0)], 0.0),
        ];
        let map = InputMap::compile(&inputs(cases), &range_type()).expect("known fields");
        for (kind, expected) in [(1, 4.0 * 2.0 - 3.0 + 0.5), (2, -8.0), (3, 0.0)] {
            let mut found = [f64::NAN; 2];
            map.read(&ranges(4.0, 3.0, kind), &mut found);
            assert_eq!(found[0], expected, "{kind}");
            assert!(found[1].is_nan());
        }
        let mut found = [0.0];
        map.read(&[0; 3], &mut found);
        assert!(found[0].is_nan());
    }

    #[test]
    fn every_unknown_field_is_named() {
        let cases = vec![
            case(
                Some(("sort", 1.0)),
                &[("ranges[0]", 2.0), ("range", 1.0)],
                0.0,
            ),
            case(None, &[("ranges", 1.0)], 0.0),
        ];
        let errors = InputMap::compile(&inputs(cases), &range_type()).expect_err("unknown fields");
        let fields: Vec<_> = errors.iter().map(|error| &error.field[..]).collect();
        assert_eq!(fields, ["sort", "range", "ranges"]);
    }
}
