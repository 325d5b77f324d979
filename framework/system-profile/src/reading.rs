//! The facts of a file as one JSON object, texts as they are written: what an independent reader of
//! the same file would find. Straight from the tree, so that it shows what the typed readers were
//! given, not what they made of it.

use serde_json::{Map, Value, json};

use crate::document::Document;
use crate::tree::Element;

/// The facts of one file.
///
/// Elements that are missing are `null`, empty ones `""`; in lists of ports, subcomponents and
/// exports both are `""`. For a file that is not well-formed the `error` names line and column as
/// event-based parsers count them: lines from 1, columns from 0. (Problems count both from 1.)
pub fn reading(document: &Document) -> Value {
    let mut facts = Map::new();
    facts.insert("path".into(), json!(document.path().to_string_lossy()));
    facts.insert("root".into(), json!(document.root_name()));
    facts.insert("wellformed".into(), json!(document.tree().is_some()));
    match document.tree() {
        Some(root) => match root.name.as_str() {
            "component_profile" => component(root, &mut facts),
            "package_profile" | "application_profile" | "composite_component_profile" => {
                group(root, &mut facts);
            }
            "service_port_type_profile" => {
                let types = root.children_named("service_port_type").map(service_type);
                facts.insert("types".into(), types.collect());
            }
            "data_type" => {
                facts.insert(
                    "structs".into(),
                    root.children_named("struct").map(structure).collect(),
                );
            }
            "fault_rules" => {
                facts.insert("application".into(), json!(root.attribute("application")));
                let components = root.children_named("component");
                let names = components.map(|component| json!(component.attribute("name")));
                facts.insert("components".into(), names.collect());
            }
            "fault_injections" => {
                facts.insert("application".into(), json!(root.attribute("application")));
                let kinds = root.children_named("inject");
                let kinds = kinds.map(|inject| json!(inject.attribute("fault")));
                facts.insert("injections".into(), kinds.collect());
            }
            _ => {}
        },
        None => {
            facts.insert("error".into(), json!(error(document)));
        }
    }
    Value::Object(facts)
}

fn error(document: &Document) -> String {
    match document.malformed() {
        Some(problem) => format!(
            "not well-formed (invalid token): line {}, column {}",
            problem.place.line,
            problem.place.column.saturating_sub(1)
        ),
        None => document
            .problems()
            .first()
            .map_or_else(String::new, |problem| problem.message.clone()),
    }
}

fn component(root: &Element, facts: &mut Map<String, Value>) {
    for name in ["id", "name", "version"] {
        facts.insert(name.into(), json!(root.child_text(name)));
    }
    let environment = root.child("execution_environment");
    let names = [
        "compiler",
        "cpu",
        "impl_language",
        "library_name",
        "library_type",
    ];
    facts.insert("env".into(), texts(environment, &names));
    let systems = children(environment, "os")
        .map(|os| json!({"name": os.attribute("name"), "version": os.attribute("version")}));
    facts.insert("os".into(), systems.collect());
    let names = [
        "creation_type",
        "instance_creation",
        "lifecycle_type",
        "period",
        "priority",
        "type",
    ];
    facts.insert(
        "exec".into(),
        texts(root.child("execution_semantics"), &names),
    );
    for (key, list) in [("properties", "properties"), ("exports", "exports")] {
        let found = children(root.child(list), "property").map(property);
        facts.insert(key.into(), found.collect());
    }
    for (key, list, item) in [
        (
            "service_type_files",
            "defined_service_types",
            "defined_service_type",
        ),
        ("data_type_files", "defined_data_types", "defined_data_type"),
    ] {
        let found = children(root.child(list), item).map(|file| json!(file.text));
        facts.insert(key.into(), found.collect());
    }
    let ports = root.child("ports").map(|ports| &ports.children[..]);
    let ports = ports.unwrap_or_default().iter().filter_map(port);
    facts.insert("ports".into(), ports.collect());
}

fn port(port: &Element) -> Option<Value> {
    let kind = port.name.strip_suffix("_port")?;
    let first = |names: &[&str]| {
        let mut texts = names.iter().filter_map(|name| port.child_text(name));
        texts.next().unwrap_or_default().to_owned()
    };
    Some(json!([
        kind,
        first(&["name"]),
        first(&["usage"]),
        first(&["data_type", "type"]),
        first(&["reference"]),
        first(&["queueing_policy", "queuing_policy", "policy"]),
        first(&["queue_size", "policy_param"]),
    ]))
}

fn property(property: &Element) -> Value {
    json!([
        property.attribute("name"),
        property.attribute("type"),
        property.text
    ])
}

fn group(root: &Element, facts: &mut Map<String, Value>) {
    facts.insert("name".into(), json!(root.child_text("name")));
    let members = children(root.child("subcomponents"), "subcomponent").map(|member| {
        let mut texts = Map::new();
        for name in ["name", "node_id", "reference", "type"] {
            texts.insert(
                name.into(),
                json!(member.child_text(name).unwrap_or_default()),
            );
        }
        Value::Object(texts)
    });
    facts.insert("subcomponents".into(), members.collect());
    let connections = children(root.child("port_connections"), "port_connection").map(connection);
    facts.insert("connections".into(), connections.collect());
    let exports = children(root.child("export_ports"), "export_port").map(|export| {
        let names = [
            "component_name",
            "port_name",
            "port_type",
            "port_dir",
            "export_port_name",
        ];
        json!(names.map(|name| export.child_text(name).unwrap_or_default()))
    });
    facts.insert("exports".into(), exports.collect());
}

fn connection(connection: &Element) -> Value {
    let end = |end: &str, attribute: &str| connection.child(end)?.attribute(attribute);
    json!([
        connection.attribute("port_type"),
        end("source", "component_name"),
        end("source", "port_name"),
        end("target", "component_name"),
        end("target", "port_name"),
    ])
}

fn service_type(service: &Element) -> Value {
    let methods: Value = service
        .children_named("method")
        .map(|method| {
            let parameters: Value = method
                .children_named("param")
                .map(|parameter| {
                    json!([
                        parameter.attribute("index"),
                        parameter.child_text("name"),
                        parameter.child_text("type"),
                    ])
                })
                .collect();
            json!([
                method.attribute("name"),
                method.attribute("return_type"),
                method.attribute("call_type"),
                parameters,
            ])
        })
        .collect();
    json!({"name": service.child_text("type_name"), "methods": methods})
}

fn structure(structure: &Element) -> Value {
    let items = structure.children_named("item");
    let items: Value = items
        .map(|item| json!([item.attribute("type"), item.text]))
        .collect();
    json!([structure.attribute("name"), items])
}

fn texts(element: Option<&Element>, names: &[&str]) -> Value {
    let texts = names.iter().map(|name| {
        let text = element.and_then(|element| element.child_text(name));
        ((*name).to_owned(), json!(text))
    });
    Value::Object(texts.collect())
}

fn children<'a>(parent: Option<&'a Element>, name: &'a str) -> impl Iterator<Item = &'a Element> {
    parent
        .into_iter()
        .flat_map(move |parent| parent.children_named(name))
}
