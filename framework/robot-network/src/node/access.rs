//! Who may say what, where certificates prove names: everything that is not allowed is refused, on
//! the way in and on the way out.

use std::collections::BTreeSet;

use serde_json::{Value, json};

/// What a robot says under its own name.
const TO_SAY: [&str; 5] = [
    "put",
    "delete",
    "reply",
    "declare_queryable",
    "liveliness_token",
];

/// What a robot wants to hear.
const TO_HEAR: [&str; 4] = [
    "query",
    "declare_subscriber",
    "declare_liveliness_subscriber",
    "liveliness_query",
];

/// The rules of `robot`, which speaks with those who are allowed: whoever speaks does so in his own
/// name, and all may listen and ask.
pub(super) fn control(robot: &str, allowed: &[String]) -> Value {
    let allowed: BTreeSet<&str> = allowed.iter().map(String::as_str).collect();
    let rule = |id: &str, messages: &[&str], flows: &[&str], key: String| {
        json!({
            "id": id,
            "permission": "allow",
            "messages": messages,
            "flows": flows,
            "key_exprs": [key],
        })
    };
    let said_by = |robot: &str| format!("steadfast/*/{robot}/**");
    let mut rules = vec![
        rule("say", &TO_SAY, &["egress"], said_by(robot)),
        rule(
            "hear",
            &TO_HEAR,
            &["egress", "ingress"],
            "steadfast/**".to_owned(),
        ),
    ];
    let mut subjects = Vec::new();
    let mut policies = Vec::new();
    for other in allowed {
        // Rules have names among themselves: no robot's rule may be taken for those above.
        let from = format!("from {other}");
        rules.push(rule(&from, &TO_SAY, &["ingress"], said_by(other)));
        subjects.push(json!({"id": other, "cert_common_names": [other]}));
        policies.push(json!({"rules": ["say", "hear", from], "subjects": [other]}));
    }
    json!({
        "enabled": true,
        "default_permission": "deny",
        "rules": rules,
        "subjects": subjects,
        "policies": policies,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_of_those_who_are_allowed_speaks_under_his_own_name() {
        let names = ["R2", "say", "R2"].map(str::to_owned);
        let control = control("R1", &names);
        let keys = |id: &str| {
            let mut rules = control["rules"].as_array().expect("rules").iter();
            let rule = rules.find(|rule| rule["id"] == id).expect("a rule");
            (rule["key_exprs"][0].clone(), rule["flows"].clone())
        };
        let expected = |key: &str, flow: &str| (json!(key), json!([flow]));
        assert_eq!(keys("say"), expected("steadfast/*/R1/**", "egress"));
        assert_eq!(keys("from R2"), expected("steadfast/*/R2/**", "ingress"));
        assert_eq!(keys("from say"), expected("steadfast/*/say/**", "ingress"));
        let policies = control["policies"].as_array().expect("policies");
        assert_eq!(policies.len(), 2);
        assert_eq!(policies[0]["subjects"], json!(["R2"]));
        let mut config = zenoh::Config::default();
        let taken = config.insert_json5("access_control", &control.to_string());
        assert!(taken.is_ok(), "{taken:?}");
    }
}
