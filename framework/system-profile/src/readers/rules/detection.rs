//! The elements that say which data, exceptions and reports are a symptom.

use system_model::fault::FaultKind;
use system_model::profile::Located;
use system_model::rules::{
    Arming, Confirmation, ExceptionClass, ExceptionRule, FaultEventRule, FreshnessRule, Judgement,
    RateOfChangeRule, ReturnCodes, SafeValue, StuckRule, ValidityRule,
};

use super::diagnosis::COMPONENT_SEVERITIES;
use super::measure::{
    count, located, positive, positive_duration, required, setting, setting_of, text,
};
use crate::node::Node;
use crate::value::Value;

const SIGNALS: [(&str, FaultKind); 6] = [
    ("SIGSEGV", FaultKind::Segfault),
    ("SIGBUS", FaultKind::BusError),
    ("SIGFPE", FaultKind::DivideByZero),
    ("SIGILL", FaultKind::IllegalInstruction),
    ("SIGTRAP", FaultKind::IllegalInstruction),
    ("SIGABRT", FaultKind::Abort),
];

const KINDS: [FaultKind; 11] = [
    FaultKind::Panic,
    FaultKind::Segfault,
    FaultKind::BusError,
    FaultKind::DivideByZero,
    FaultKind::IllegalInstruction,
    FaultKind::Abort,
    FaultKind::StackOverflow,
    FaultKind::Exit,
    FaultKind::ErrorReturn,
    FaultKind::BadPointer,
    FaultKind::Reported,
];

const RETURN_CODES: [(&str, ReturnCodes); 4] = [
    ("caller", ReturnCodes::Caller),
    ("callee", ReturnCodes::Callee),
    ("unrecoverable", ReturnCodes::Unrecoverable),
    ("recoverable", ReturnCodes::Recoverable),
];

/// What every detecting rule may say.
pub(super) fn judgement(node: &Node<'_>) -> Judgement {
    let latched = node.attribute("latch").and_then(|value| value.boolean());
    let arming = node.attribute("armed").and_then(|value| {
        value.choice(&[("running", Arming::Running), ("always", Arming::Always)])
    });
    let severity = setting(node, "severity").and_then(|value| value.choice(&COMPONENT_SEVERITIES));
    Judgement {
        confirmation: confirmation_rule(node).map(|rule| rule.value),
        latched: latched.unwrap_or_default(),
        arming: arming.unwrap_or_default(),
        severity,
    }
}

/// `confirm`.
pub(super) fn confirmation_rule(node: &Node<'_>) -> Option<Located<Confirmation>> {
    let node = node.child("confirm")?;
    let symptoms = required(&node, "count").and_then(|value| count(&value, 1));
    let within = setting(&node, "within").map(|value| positive_duration(&value));
    node.finish();
    let confirmation = Confirmation {
        count: symptoms?,
        within: match within {
            Some(within) => Some(within?),
            None => None,
        },
    };
    Some(located(&node, confirmation))
}

/// `validity`, formerly `validation`.
pub(super) fn validity(node: &Node<'_>) -> Vec<Located<ValidityRule>> {
    let rules = node.children_of(&["validity", "validation"]);
    rules.iter().filter_map(interval).collect()
}

fn interval(node: &Node<'_>) -> Option<Located<ValidityRule>> {
    let bound = |names: [&'static str; 3]| {
        let value = setting_of(node, &names)?;
        Some(value.number::<f64>())
    };
    let minimum = bound(["min", "range_min", "rang_min"]);
    let maximum = bound(["max", "range_max", "rang_max"]);
    let field = text(node, "field");
    let judgement = judgement(node);
    node.finish();
    // A bound that is there and is no number is an error already.
    let (minimum, maximum) = match (minimum, maximum) {
        (Some(None), _) | (_, Some(None)) => return None,
        (minimum, maximum) => (minimum.flatten(), maximum.flatten()),
    };
    if let (Some(least), Some(largest)) = (minimum, maximum)
        && least > largest
    {
        node.error(
            "the minimum is larger than the maximum",
            Some(format!("no value is valid; exchange {least} and {largest}")),
        );
        return None;
    }
    let rule = ValidityRule {
        field,
        minimum,
        maximum,
        judgement,
    };
    Some(located(node, rule))
}

/// `freshness`, and the safe values in it.
pub(super) fn freshness(
    node: &Node<'_>,
) -> (Option<Located<FreshnessRule>>, Vec<Located<SafeValue>>) {
    let Some(node) = node.child("freshness") else {
        return (None, Vec::new());
    };
    let maximum_age = required(&node, "max_age").and_then(|value| positive_duration(&value));
    let safe_values = safe_values(&node);
    let judgement = judgement(&node);
    node.finish();
    let rule = maximum_age.map(|maximum_age| FreshnessRule {
        maximum_age,
        judgement,
    });
    (rule.map(|rule| located(&node, rule)), safe_values)
}

/// `safe_value`: an attribute for all fields, or children with a field each.
pub(super) fn safe_values(node: &Node<'_>) -> Vec<Located<SafeValue>> {
    let mut values = Vec::new();
    let mut take = |field: Option<String>, value: &Value<'_>| {
        values.extend(value.number::<f64>().map(|number| Located {
            value: SafeValue {
                field,
                value: number,
            },
            place: value.place(),
        }));
    };
    if let Some(value) = node.attribute("safe_value") {
        take(None, &value);
    }
    for child in node.children("safe_value") {
        let field = child.attribute("field");
        take(field.map(|field| field.as_str().to_owned()), &child.text());
        child.finish();
    }
    values
}

/// `rate_of_change`.
pub(super) fn rate_of_change(node: &Node<'_>) -> Vec<Located<RateOfChangeRule>> {
    let rules = node
        .children("rate_of_change")
        .into_iter()
        .filter_map(|node| {
            let maximum = required(&node, "max").and_then(|value| positive(&value));
            let rule = RateOfChangeRule {
                field: text(&node, "field"),
                maximum_per_second: maximum.unwrap_or_default(),
                judgement: judgement(&node),
            };
            node.finish();
            maximum.map(|_| located(&node, rule))
        });
    rules.collect()
}

/// `stuck`.
pub(super) fn stuck(node: &Node<'_>) -> Vec<Located<StuckRule>> {
    let rules = node.children("stuck").into_iter().filter_map(|node| {
        // One datum is always equal to itself.
        let equal = required(&node, "count").and_then(|value| count(&value, 2));
        let rule = StuckRule {
            field: text(&node, "field"),
            count: equal.unwrap_or_default(),
            judgement: judgement(&node),
        };
        node.finish();
        equal.map(|_| located(&node, rule))
    });
    rules.collect()
}

/// `exception`.
pub(super) fn exceptions(node: &Node<'_>) -> Vec<Located<ExceptionRule>> {
    let rules = node.children("exception").into_iter().filter_map(|node| {
        let class = exception_class(&node);
        let judgement = judgement(&node);
        node.finish();
        class.map(|class| located(&node, ExceptionRule { class, judgement }))
    });
    rules.collect()
}

fn exception_class(node: &Node<'_>) -> Option<ExceptionClass> {
    let signal = node.attribute("signal");
    let class = node.attribute("class");
    let return_code = node.attribute("return_code");
    match (signal, class, return_code) {
        (None, None, None) => Some(ExceptionClass::Any),
        (Some(signal), None, None) => signal.choice(&SIGNALS).map(ExceptionClass::Kind),
        (None, Some(class), None) => {
            let kinds = KINDS.map(|kind| (kind.name(), kind));
            class.choice(&kinds).map(ExceptionClass::Kind)
        }
        (None, None, Some(code)) => return_codes(&code).map(ExceptionClass::ReturnCodes),
        _ => {
            node.error(
                "an exception is named in two ways",
                Some(
                    "write one of signal, class and return_code, and one <exception> for each"
                        .into(),
                ),
            );
            None
        }
    }
}

/// A family, or one code, decimal or hexadecimal.
fn return_codes(value: &Value<'_>) -> Option<ReturnCodes> {
    let text = value.as_str();
    let code = match text.strip_prefix("0x") {
        Some(digits) => u32::from_str_radix(digits, 16).ok(),
        None => text.parse().ok(),
    };
    match code {
        Some(code) => Some(ReturnCodes::Code(code)),
        None => value.choice(&RETURN_CODES),
    }
}

/// `fault_event`.
pub(super) fn fault_events(node: &Node<'_>) -> Vec<Located<FaultEventRule>> {
    let rules = node.children("fault_event").into_iter().filter_map(|node| {
        let name = required(&node, "name");
        let rule = FaultEventRule {
            name: name.as_ref().map_or("", Value::as_str).to_owned(),
            port: text(&node, "port"),
            judgement: judgement(&node),
        };
        node.finish();
        name.map(|_| located(&node, rule))
    });
    rules.collect()
}
