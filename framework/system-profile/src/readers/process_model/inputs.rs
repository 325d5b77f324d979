//! `inputs`: how the inputs of a model are got from the fields of a datum.

use system_model::process_model::{InputCase, InputCondition, InputTerm, ModelInput};

use crate::node::Node;

/// All inputs; an error if they are not so many as the model has.
pub(super) fn read(node: &Node<'_>, count: Option<usize>) -> Option<Vec<ModelInput>> {
    let nodes = node.children("input");
    if count.is_some_and(|count| count != nodes.len()) {
        node.error(
            format!(
                "the inputs are {}, the columns of <b> {}",
                nodes.len(),
                count.unwrap_or_default()
            ),
            Some("write one <input name=\"…\"> for each column, in the same order".into()),
        );
    }
    let inputs: Vec<Option<ModelInput>> = nodes.iter().map(input).collect();
    node.finish();
    inputs.into_iter().collect()
}

fn input(node: &Node<'_>) -> Option<ModelInput> {
    let name = node.required_attribute("name");
    let cases = node.children("case");
    if cases.is_empty() {
        node.error(
            "an input made of nothing",
            Some("write <case><term field=\"…\"/></case> in it".into()),
        );
    }
    let mut unconditional = None;
    for case in &cases {
        if let Some(place) = &unconditional {
            case.warning(
                "this case never counts",
                Some(format!("the case at {place} always holds; write it last")),
            );
        } else if case.attribute("when").is_none() {
            unconditional = Some(case.place());
        }
    }
    let cases: Vec<Option<InputCase>> = cases.iter().map(case).collect();
    node.finish();
    Some(ModelInput {
        name: name?.as_str().to_owned(),
        cases: cases.into_iter().collect::<Option<_>>()?,
    })
}

fn case(node: &Node<'_>) -> Option<InputCase> {
    let field = node.attribute("when");
    let equals = match field {
        Some(_) => node.required_attribute("equals"),
        None => None,
    };
    let condition = field.map(|field| {
        Some(InputCondition {
            field: field.as_str().to_owned(),
            equals: equals?.number()?,
        })
    });
    let offset = node.attribute("offset").map(|value| value.number());
    let terms = node.children("term");
    let terms: Vec<Option<InputTerm>> = terms.iter().map(term).collect();
    node.finish();
    Some(InputCase {
        condition: match condition {
            Some(condition) => Some(condition?),
            None => None,
        },
        terms: terms.into_iter().collect::<Option<_>>()?,
        offset: offset.unwrap_or(Some(0.0))?,
    })
}

fn term(node: &Node<'_>) -> Option<InputTerm> {
    let field = node.required_attribute("field");
    let scale = node.attribute("scale").map(|value| value.number());
    node.finish();
    Some(InputTerm {
        field: field?.as_str().to_owned(),
        scale: scale.unwrap_or(Some(1.0))?,
    })
}
