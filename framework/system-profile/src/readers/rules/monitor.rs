//! `process_model` and `voting`: helpers that watch several ports at once.

use system_model::profile::Located;
use system_model::rules::{DecisionRule, ProcessModelRule, VotingMethod, VotingRule};

use super::declared::{DeclaredEnd, DeclaredMonitor, DeclaredSource, DeclaredVoting};
use super::detection::judgement;
use super::measure::{count, located, positive, positive_duration, required, setting, text};
use crate::node::Node;
use crate::suggest::quoted;
use crate::value::Value;

/// The process models in an element; `component` where their ports need not name it.
pub(super) fn process_models(
    node: &Node<'_>,
    name: &Located<String>,
    component: Option<&Located<String>>,
) -> Vec<DeclaredMonitor> {
    let models = node.children("process_model");
    models
        .iter()
        .filter_map(|node| process_model(node, name, component))
        .collect()
}

fn process_model(
    node: &Node<'_>,
    name: &Located<String>,
    component: Option<&Located<String>>,
) -> Option<DeclaredMonitor> {
    let model = required(node, "model");
    let window = required(node, "window").and_then(|value| positive_duration(&value));
    let threshold = required(node, "threshold").and_then(|value| positive(&value));
    let method = decision_rule(node);
    let inputs = ends(node, "input", component);
    let outputs = ends(node, "output", component);
    let parameters = parameters(node);
    let judgement = judgement(node);
    if outputs.is_empty() {
        node.error(
            "a process model without an output to compare with",
            Some("write <output component=\"…\" port=\"…\"/>".into()),
        );
    }
    node.finish();
    let rule = ProcessModelRule {
        model: model?.as_str().to_owned(),
        window: window?,
        threshold: threshold?,
        method: method?,
        parameters,
        judgement,
    };
    Some(DeclaredMonitor {
        name: name.clone(),
        rule: located(node, rule),
        inputs,
        outputs,
    })
}

/// The method; `drift` is known only where the method has one.
fn decision_rule(node: &Node<'_>) -> Option<DecisionRule> {
    let method = match setting(node, "method") {
        None => DecisionRule::default(),
        Some(method) => method.choice(&[
            ("window", DecisionRule::Window),
            ("cusum", DecisionRule::Cusum { drift: None }),
            ("chi_square", DecisionRule::ChiSquare),
        ])?,
    };
    match method {
        DecisionRule::Cusum { .. } => {
            let drift = setting(node, "drift").map(|value| positive(&value));
            Some(DecisionRule::Cusum {
                drift: match drift {
                    Some(drift) => Some(drift?),
                    None => None,
                },
            })
        }
        other => Some(other),
    }
}

fn parameters(node: &Node<'_>) -> Vec<(String, f64)> {
    let parameters = node.children("parameter").into_iter().filter_map(|node| {
        let name = node.required_attribute("name");
        let value = node.attribute("value").unwrap_or_else(|| node.text());
        let number = value.number();
        node.finish();
        Some((name?.as_str().to_owned(), number?))
    });
    parameters.collect()
}

fn ends(
    node: &Node<'_>,
    name: &'static str,
    component: Option<&Located<String>>,
) -> Vec<DeclaredEnd> {
    let ends = node.children(name).into_iter().filter_map(|node| {
        let end = end(&node, component);
        node.finish();
        end
    });
    ends.collect()
}

fn end(node: &Node<'_>, component: Option<&Located<String>>) -> Option<DeclaredEnd> {
    let port = node.required_attribute("port");
    let own = match component {
        Some(component) => {
            let other = node.attribute("component").map(|value| value.located());
            Some(other.unwrap_or_else(|| component.clone()))
        }
        None => node
            .required_attribute("component")
            .map(|value| value.located()),
    };
    Some(DeclaredEnd {
        field: text(node, "field"),
        component: own?,
        port: port?.located(),
    })
}

/// The voters in an element; `component` where their ports need not name it.
pub(super) fn votings(
    node: &Node<'_>,
    name: &Located<String>,
    component: Option<&Located<String>>,
) -> Vec<DeclaredVoting> {
    let votings = node.children("voting");
    votings
        .iter()
        .filter_map(|node| voting(node, name, component))
        .collect()
}

fn voting(
    node: &Node<'_>,
    name: &Located<String>,
    component: Option<&Located<String>>,
) -> Option<DeclaredVoting> {
    let of = required(node, "of").and_then(|value| count(&value, 1));
    let tolerance = required(node, "tolerance").and_then(|value| positive(&value));
    let method = setting(node, "method").map(|value| {
        value.choice(&[
            ("median", VotingMethod::Median),
            ("majority", VotingMethod::Majority),
            ("weighted", VotingMethod::Weighted),
        ])
    });
    let mut sources = sources(node, component);
    if let Some(weights) = setting(node, "weights") {
        distribute(&weights, &mut sources);
    }
    let output = node.child("output").and_then(|output| {
        let end = end(&output, component);
        output.finish();
        end
    });
    if output.is_none() {
        node.error(
            "a voter whose value nobody gets",
            Some("write <output component=\"…\" port=\"…\"/> with an input port".into()),
        );
    }
    let judgement = judgement(node);
    let own_name = node.attribute("name").map(|value| value.located());
    node.finish();
    let rule = VotingRule {
        of: usize::try_from(of?).unwrap_or(usize::MAX),
        method: method.unwrap_or(Some(VotingMethod::default()))?,
        tolerance: tolerance?,
        judgement,
    };
    Some(DeclaredVoting {
        name: own_name.unwrap_or_else(|| name.clone()),
        rule: located(node, rule),
        sources,
        output,
    })
}

fn sources(node: &Node<'_>, component: Option<&Located<String>>) -> Vec<DeclaredSource> {
    let sources = node.children("input").into_iter().filter_map(|node| {
        let weight = node.attribute("weight").map(|value| positive(&value));
        let end = end(&node, component);
        node.finish();
        Some(DeclaredSource {
            end: end?,
            weight: weight.flatten(),
        })
    });
    sources.collect()
}

/// `weights="1,2,1"`: one for each input, in document order.
fn distribute(weights: &Value<'_>, sources: &mut [DeclaredSource]) {
    let separated = |character: char| character == ',' || character.is_whitespace();
    let words = weights
        .as_str()
        .split(separated)
        .filter(|word| !word.is_empty());
    let numbers: Option<Vec<f64>> = words
        .map(|word| {
            let number = word.parse::<f64>().ok();
            number.filter(|number| number.is_finite() && *number > 0.0)
        })
        .collect();
    let Some(numbers) = numbers else {
        weights.error(
            format!("`{}` are no weights", quoted(weights.as_str())),
            Some("write numbers larger than 0 with commas between them: 1, 2, 1".into()),
        );
        return;
    };
    if numbers.len() != sources.len() {
        weights.error(
            format!(
                "the weights are {}, the inputs {}",
                numbers.len(),
                sources.len()
            ),
            Some("write one weight for each <input>, in the same order".into()),
        );
    }
    // Those without a number count once, so that they are not reported one by one.
    let numbers = numbers.into_iter().chain(std::iter::repeat(1.0));
    for (source, number) in sources.iter_mut().zip(numbers) {
        source.weight = Some(number);
    }
}
