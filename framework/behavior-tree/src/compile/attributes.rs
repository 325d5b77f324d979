//! What stands in a node's attributes: ports, conditions, flags.

use system_model::profile::Located;

use super::build::Builder;
use super::scope::{ScopeId, key_of};
use crate::catalogue::{BuiltIn, Content, Port, port_name};
use crate::definition::{Format, NodeAttribute, NodeDefinition, NodeModel};
use crate::finding::Finding;
use crate::plan::{Conditions, Kind, Source};
use crate::script::{Name, Script};
use crate::status::Status;
use crate::value::Value;

/// What begins with `_` and has a meaning.
pub(super) const CONDITIONS: [&str; 8] = [
    "_failureIf",
    "_successIf",
    "_skipIf",
    "_while",
    "_onSuccess",
    "_onFailure",
    "_onHalted",
    "_post",
];

/// Also known, but not to be executed.
const FLAGS: [&str; 4] = ["_autoremap", "_description", "_fullpath", "_uid"];

/// A node's ports: where they lead, and how they are described.
#[derive(Default)]
pub(super) struct Ports {
    pub(super) sources: Vec<Source>,
    pub(super) described: Vec<(String, Option<String>)>,
    pub(super) script: Option<Box<Script>>,
}

impl Ports {
    fn push(&mut self, name: &str, written: Option<&str>, source: Source) {
        self.sources.push(source);
        let written = written.map(str::to_owned);
        self.described.push((name.to_owned(), written));
    }
}

impl Builder<'_, '_> {
    /// The pre- and post-conditions of a node.
    pub(super) fn conditions(
        &mut self,
        node: &NodeDefinition,
        scope: ScopeId,
    ) -> Option<Box<Conditions>> {
        let mut conditions = Conditions::default();
        let mut any = false;
        for attribute in &node.attributes {
            let place = match attribute.name.value.as_str() {
                "_failureIf" => &mut conditions.failure_if,
                "_successIf" => &mut conditions.success_if,
                "_skipIf" => &mut conditions.skip_if,
                "_while" => &mut conditions.while_true,
                "_onSuccess" => &mut conditions.on_success,
                "_onFailure" => &mut conditions.on_failure,
                "_onHalted" => &mut conditions.on_halted,
                "_post" => &mut conditions.post,
                name if name.starts_with('_') && !FLAGS.contains(&name) => {
                    let what = format!("the attribute {name} has no meaning");
                    self.findings.push(
                        Finding::warning(&attribute.name, what, "remove it")
                            .among(CONDITIONS.into_iter().chain(FLAGS)),
                    );
                    continue;
                }
                _ => continue,
            };
            any = true;
            *place = self.script(&attribute.value, scope);
        }
        any.then(|| Box::new(conditions))
    }

    /// The ports of a node that is built in, in the order of its declaration.
    pub(super) fn built_in_ports(
        &mut self,
        built_in: &'static BuiltIn,
        node: &NodeDefinition,
        scope: ScopeId,
        format: Format,
    ) -> Ports {
        let mut ports = Ports::default();
        let named = |attribute: &&NodeAttribute, port: &Port| {
            port_name(format, built_in, &attribute.name.value) == port.name
        };
        for port in built_in.ports {
            let attribute = port_attributes(node).find(|it| named(it, port));
            let written = attribute.map(|it| it.value.value.as_str()).or(port.default);
            let source = match attribute {
                Some(attribute) => self.source(port, attribute, scope, &mut ports),
                None => port.default.map_or(Source::Nothing, |it| literal(port, it)),
            };
            if port.is_required && attribute.is_none() {
                self.findings.push(Finding::error(
                    &node.id,
                    format!("{} has no {}", node.id.value, port.name),
                    format!("write {}=\"…\"", port.name),
                ));
            }
            ports.push(port.name, written, source);
        }
        self.old_threshold(built_in, node, format, &mut ports);
        for attribute in port_attributes(node) {
            if port_name(format, built_in, &attribute.name.value).is_empty() {
                let known = built_in.ports.iter().map(|port| port.name);
                self.no_such_port(node, attribute, known);
            }
        }
        ports
    }

    /// The ports of somebody else's node: as its model says, else as the file does.
    pub(super) fn custom_ports(
        &mut self,
        model: Option<&NodeModel>,
        node: &NodeDefinition,
        scope: ScopeId,
    ) -> Ports {
        let mut ports = Ports::default();
        for attribute in port_attributes(node) {
            let (name, value) = (&attribute.name.value, &attribute.value.value);
            let source = match key_of(name, value) {
                Some(key) => Source::Entry(self.scopes.mention(scope, key)),
                None => Source::Literal(Value::Text(value.as_str().into())),
            };
            ports.push(name, Some(value), source);
            if let Some(model) = model
                && !model.ports.iter().any(|port| port.name.value == *name)
            {
                let known = model.ports.iter().map(|port| port.name.value.as_str());
                self.no_such_port(node, attribute, known);
            }
        }
        for port in model.iter().flat_map(|model| &model.ports) {
            let name = &port.name.value;
            if ports.described.iter().any(|(said, _)| said == name) {
                continue;
            }
            let source = match &port.default {
                None => Source::Nothing,
                Some(default) => match key_of(name, default) {
                    Some(key) => Source::Entry(self.scopes.mention(scope, key)),
                    None => Source::Literal(Value::Text(default.as_str().into())),
                },
            };
            ports.push(name, port.default.as_deref(), source);
        }
        ports
    }

    /// A script of an attribute; what is wrong with it is reported.
    pub(super) fn script(&mut self, text: &Located<String>, scope: ScopeId) -> Option<Script> {
        let (scopes, constants) = (&mut self.scopes, &self.options.constants);
        let mut resolve = |name: &str| match constants.get(name) {
            Some(value) => Name::Constant(value.clone()),
            None => Name::Entry(scopes.slot(scope, name)),
        };
        match Script::parse(&text.value, &mut resolve) {
            Ok(script) => Some(script),
            Err(error) => {
                let what = format!("this is no script: {error}");
                let help = "statements are separated by `;`, texts stand in 'single quotes'";
                self.findings.push(Finding::error(text, what, help));
                None
            }
        }
    }

    fn source(
        &mut self,
        port: &Port,
        attribute: &NodeAttribute,
        scope: ScopeId,
        ports: &mut Ports,
    ) -> Source {
        let value = attribute.value.value.as_str();
        if port.content == Content::Script {
            ports.script = self.script(&attribute.value, scope).map(Box::new);
            return Source::Nothing;
        }
        if let Some(key) = key_of(port.name, value) {
            return Source::Entry(self.scopes.mention(scope, key));
        }
        let fits = match port.content {
            Content::Entry => return Source::Entry(self.scopes.mention(scope, value.trim())),
            Content::Number => Value::of_literal(value).as_number().is_some(),
            Content::Boolean => Value::of_literal(value).as_boolean().is_some(),
            Content::Status => Status::named(value.trim()).is_some(),
            Content::Any | Content::Script => true,
        };
        if !fits {
            let expected = match port.content {
                Content::Number => "a number",
                Content::Boolean => "true or false",
                _ => "SUCCESS, FAILURE, SKIPPED or RUNNING",
            };
            self.findings.push(Finding::error(
                &attribute.value,
                format!("`{value}` at port {} is not understood", port.name),
                format!("write {expected}, or {{key}} for an entry of the blackboard"),
            ));
        }
        if port.content == Content::Any
            && let Some(constant) = self.options.constants.get(value.trim())
        {
            return Source::Literal(constant.clone());
        }
        literal(port, value)
    }

    /// `threshold` of BehaviorTree.CPP 2: a parallel fails when so many successes are out of reach.
    fn old_threshold(
        &mut self,
        built_in: &BuiltIn,
        node: &NodeDefinition,
        format: Format,
        ports: &mut Ports,
    ) {
        let is_old = |attribute: &NodeAttribute| attribute.name.value == "threshold";
        let is_here = node.attributes.iter().any(is_old);
        if format == Format::V3
            && built_in.kind == Kind::Parallel
            && is_here
            && let Source::Literal(Value::Number(needed)) = ports.sources[0]
        {
            let failures = node.children.len() as f64 - needed + 1.0;
            ports.sources[1] = Source::Literal(Value::Number(failures));
        }
    }

    fn no_such_port<'n>(
        &mut self,
        node: &NodeDefinition,
        attribute: &NodeAttribute,
        known: impl Iterator<Item = &'n str>,
    ) {
        let known: Vec<&str> = known.collect();
        let help = match known.is_empty() {
            true => "it has none: remove the attribute",
            false => "remove the attribute, or correct its name",
        };
        let message = format!("{} has no port {}", node.id.value, attribute.name.value);
        self.findings
            .push(Finding::error(&attribute.name, message, help).among(known));
    }
}

/// Attributes that are ports.
pub(super) fn port_attributes(node: &NodeDefinition) -> impl Iterator<Item = &NodeAttribute> {
    let attributes = node.attributes.iter();
    attributes.filter(|attribute| !attribute.name.value.starts_with('_'))
}

fn literal(port: &Port, text: &str) -> Source {
    Source::Literal(match port.content {
        Content::Number | Content::Boolean => Value::of_literal(text),
        Content::Status => Value::Text(text.trim().into()),
        _ => Value::Text(text.into()),
    })
}
