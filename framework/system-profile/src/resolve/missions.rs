//! Behaviour trees of an application: their files read, and every name in them that means something of
//! the application looked up.

use std::path::PathBuf;
use std::rc::Rc;

use behavior_tree::component_nodes::{ComponentPort, PortMeaning, component_node};
use behavior_tree::{Finding, NodeId, Plan, Value};
use system_model::mission::DeclaredTree;
use system_model::profile::{Located, TreeReference};
use system_model::specification::{
    ComponentSpecification, PortDirection, PortKind, PortSpecification,
};

use super::{Assembly, LoadedFile, Sibling};
use crate::check::FileReport;
use crate::problem::Severity;
use crate::suggest::quoted;
use crate::trees::{TreeOptions, load_trees_for};

impl Assembly<'_> {
    /// Reads the trees of an application whose components are known; those without a problem. Their
    /// plans go to `plans`, in the same order.
    pub(super) fn trees(
        &mut self,
        file: &Rc<LoadedFile>,
        references: &[TreeReference],
    ) -> Vec<DeclaredTree> {
        let mut declared: Vec<DeclaredTree> = Vec::new();
        for reference in references {
            self.check_name(file, reference, &declared);
            let Some(path) = self.find(file, &reference.file, Sibling::Trees) else {
                continue;
            };
            if let Some(plan) = self.plan(file, reference, path) {
                self.plans.push(plan);
                declared.push(reference.declared.clone());
            }
        }
        declared
    }

    /// Records tell trees and components apart by their names alone.
    fn check_name(&self, file: &LoadedFile, reference: &TreeReference, others: &[DeclaredTree]) {
        let DeclaredTree { name, place, .. } = &reference.declared;
        let what = match name {
            name if self.components.iter().any(|it| it.name == *name) => "a component",
            name if others.iter().any(|it| it.name == *name) => "another tree",
            _ => return,
        };
        let at = Located {
            value: "tree".to_owned(),
            place: place.clone(),
        };
        file.document.report(
            Severity::Error,
            &at,
            format!("{what} has the name {} already", quoted(name)),
            Some("records tell them apart by their names: choose another one".into()),
        );
    }

    fn plan(
        &mut self,
        file: &LoadedFile,
        reference: &TreeReference,
        path: PathBuf,
    ) -> Option<Plan> {
        let options = TreeOptions {
            main: reference.main.as_ref().map(|main| main.value.clone()),
            ..TreeOptions::default()
        };
        let components = &self.components;
        let outcome = load_trees_for(&path, &options, &|plan| names(plan, components));
        if let Some(reason) = outcome.undecided {
            let at = reference.main.as_ref().unwrap_or(&reference.file);
            let help = "name the tree to be ticked by main=\"…\"";
            file.document
                .report(Severity::Error, at, reason, Some(help.into()));
        }
        let is_error = |report: &FileReport| {
            let mut problems = report.problems.iter();
            !report.readable || problems.any(|problem| problem.severity == Severity::Error)
        };
        if outcome.files.iter().any(is_error) {
            self.dangling = true;
        }
        for report in outcome.files {
            let is_known = |other: &FileReport| other.path == report.path;
            if !self.tree_files.iter().any(is_known) {
                self.tree_files.push(report);
            }
        }
        outcome.plan
    }
}

/// What is wrong with the names that nodes over components give.
fn names(plan: &Plan, components: &[ComponentSpecification]) -> Vec<Finding> {
    let leaves = plan.leaves().iter();
    let looks = leaves.flat_map(|node| match component_node(&plan.describe(*node).id) {
        Some(known) => {
            let look = Look {
                plan,
                node: *node,
                components,
            };
            look.at_ports(known.ports)
        }
        None => vec![nobodys(plan, *node)],
    });
    looks.collect()
}

/// A leaf that is described somewhere, but that nobody here can do.
fn nobodys(plan: &Plan, node: NodeId) -> Finding {
    let description = plan.describe(node);
    Finding {
        is_error: true,
        at: Located {
            value: description.id.clone(),
            place: description.place.clone(),
        },
        message: format!("no component does the work of {}", description.id),
        help: "an application's tree is made of built-in nodes and of those over components: \
               use CallService, WritePort or RaiseEvent"
            .to_owned(),
        candidates: Vec::new(),
    }
}

/// One node being looked at.
struct Look<'a> {
    plan: &'a Plan,
    node: NodeId,
    components: &'a [ComponentSpecification],
}

impl Look<'_> {
    fn at_ports(&self, ports: &[ComponentPort]) -> Vec<Finding> {
        let mut findings = Vec::new();
        for port in ports {
            if let Err(finding) = self.at_port(port) {
                findings.push(*finding);
            }
        }
        findings
    }

    fn at_port(&self, port: &ComponentPort) -> Result<(), Box<Finding>> {
        let is_entry = self.plan.is_entry(self.node, port.name);
        let value = self.plan.initial(self.node, port.name);
        if port.meaning == PortMeaning::Entry {
            return match value.is_some() && !is_entry {
                true => Err(self.error(
                    port,
                    format!("{} must be an entry of the blackboard", port.name),
                    format!("write {}=\"{{key}}\"", port.name),
                    Vec::new(),
                )),
                false => self.is_there(port, value.is_some() || is_entry),
            };
        }
        self.is_there(port, value.is_some() || is_entry)?;
        match value {
            None if is_entry && port.meaning.is_fixed() => Err(self.error(
                port,
                format!("{} must be known before the first tick", port.name),
                "write the name itself, or give it by an attribute of <SubTree>".to_owned(),
                Vec::new(),
            )),
            None => Ok(()),
            Some(value) => self.means(port, value),
        }
    }

    fn is_there(&self, port: &ComponentPort, is_there: bool) -> Result<(), Box<Finding>> {
        if is_there || !port.is_required {
            return Ok(());
        }
        Err(self.error(
            port,
            format!("{} has no {}", self.plan.describe(self.node).id, port.name),
            format!("write {}=\"…\"", port.name),
            Vec::new(),
        ))
    }

    /// Whether a value means something of the application.
    fn means(&self, port: &ComponentPort, value: &Value) -> Result<(), Box<Finding>> {
        let text = value.to_string();
        let wanted = match port.meaning {
            PortMeaning::Component => {
                let names = self.components.iter().map(|it| it.name.clone());
                return self.among(port, &text, "component", names.collect());
            }
            PortMeaning::DataOutput => (PortKind::Data, PortDirection::Output),
            PortMeaning::DataInput => (PortKind::Data, PortDirection::Input),
            PortMeaning::EventOutput => (PortKind::Event, PortDirection::Output),
            PortMeaning::EventInput => (PortKind::Event, PortDirection::Input),
            PortMeaning::Service => (PortKind::Service, PortDirection::Input),
            PortMeaning::Choice(words) => {
                let words = words.iter().map(|word| (*word).to_owned());
                return self.among(port, &text, "word", words.collect());
            }
            PortMeaning::Number if value.as_number().is_none_or(|number| number < 0.0) => {
                return Err(self.error(
                    port,
                    format!(
                        "`{}` at port {} is no such number",
                        quoted(&text),
                        port.name
                    ),
                    "write a number that is not negative, or {key} for an entry".to_owned(),
                    Vec::new(),
                ));
            }
            _ => return Ok(()),
        };
        let ports = self.ports_of_component();
        let fits = ports.iter().filter(|it| (it.kind, it.direction) == wanted);
        let fits: Vec<String> = fits.map(|it| it.name.clone()).collect();
        self.among(port, &text, what(wanted), fits)
    }

    /// The ports of the node's component; none where that is not known, which has been told.
    fn ports_of_component(&self) -> &[PortSpecification] {
        let name = self.plan.initial(self.node, "component");
        let name = name.map(Value::to_string).unwrap_or_default();
        let mut components = self.components.iter();
        let component = components.find(|component| component.name == name);
        component.map_or(&[], |component| &component.ports)
    }

    fn among(
        &self,
        port: &ComponentPort,
        name: &str,
        what: &str,
        names: Vec<String>,
    ) -> Result<(), Box<Finding>> {
        if names.iter().any(|known| known == name) {
            return Ok(());
        }
        let help = match names.is_empty() {
            true => "there is none".to_owned(),
            false => format!("write one of {}", names.join(", ")),
        };
        let message = format!("there is no {what} `{}`", quoted(name));
        Err(self.error(port, message, help, names))
    }

    fn error(
        &self,
        port: &ComponentPort,
        message: String,
        help: String,
        candidates: Vec<String>,
    ) -> Box<Finding> {
        let description = self.plan.describe(self.node);
        let mut places = description.port_places.iter();
        let place = places.find(|(name, _)| name == port.name);
        let written = self.plan.initial(self.node, port.name);
        let at = match (place, written) {
            (Some((_, place)), Some(value)) => Located {
                value: value.to_string(),
                place: place.clone(),
            },
            _ => Located {
                value: description.id.clone(),
                place: description.place.clone(),
            },
        };
        Box::new(Finding {
            is_error: true,
            at,
            message,
            help,
            candidates,
        })
    }
}

fn what(wanted: (PortKind, PortDirection)) -> &'static str {
    match wanted {
        (PortKind::Data, PortDirection::Output) => "output data port",
        (PortKind::Data, PortDirection::Input) => "input data port",
        (PortKind::Event, PortDirection::Output) => "output event port",
        (PortKind::Event, PortDirection::Input) => "input event port",
        (PortKind::Service, _) => "provided service port",
    }
}
