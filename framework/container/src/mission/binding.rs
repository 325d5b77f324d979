//! Trees are bound to the components of an assembled application: every leaf gets its ends of ports.

mod ports;

use std::cell::RefCell;
use std::collections::HashMap;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use behavior_tree::component_nodes::{ComponentNodeKind, component_node};
use behavior_tree::{Leaf, NodeId, Plan, Tree, Value};
use fault_manager::OperatorOrder;
use system_model::data_type::DataType;
use system_model::mission::DeclaredTree;
use system_model::rules::ComponentRules;

use super::calls::Calls;
use super::leaves::control::{Ordered, Wish};
use super::leaves::data::{Outlet, ReadPort, WaitForData};
use super::leaves::evaluation::{Age, Deviation};
use super::leaves::faults::{Await, Clear, Fault, Present, Raise};
use super::leaves::running::Running;
use super::leaves::states::{Estimate, State};
use super::{Reach, Runner, Setting, TreeStatus};
use crate::assembly::{Assembly, AssemblyProblem};
use crate::component::PortEnd;
use crate::lane::SETUP_TOKEN;
use crate::library::PortDescription;
use crate::supervision::Orders;

/// What a tree is bound to.
pub struct Ground<'a> {
    /// All applications, assembled.
    pub assembly: &'a Assembly,
    /// The names of the application's components as trees use them, and the number of each.
    pub components: &'a [(String, usize)],
    /// The rules of all components, by number.
    pub rules: &'a [ComponentRules],
    /// The way to components.
    pub reach: Arc<Reach>,
    /// The ways to input ports that trees send to.
    pub outlets: &'a Outlets,
    /// Who calls services.
    pub calls: &'a Arc<Calls>,
}

/// The ways to input ports that trees send to, by component and port.
#[derive(Default)]
pub struct Outlets(RefCell<HashMap<(usize, usize), Shared>>);

/// The way to one of them.
type Shared = Arc<Mutex<Outlet>>;

/// A tree with its leaves.
///
/// # Errors
/// What does not fit the libraries.
pub fn bind(
    declared: &DeclaredTree,
    plan: Arc<Plan>,
    orders: Arc<Orders>,
    ground: &Ground<'_>,
) -> Result<Runner, Vec<AssemblyProblem>> {
    let mut problems = Vec::new();
    let mut make = |plan: &Plan, node: NodeId| {
        let seat = Seat { plan, node, ground };
        seat.leaf().map_err(|(message, help)| {
            problems.push(AssemblyProblem::Connection {
                place: plan.describe(node).place.clone(),
                message: message.clone(),
                help,
            });
            message
        })
    };
    let tree = Tree::new(Arc::clone(&plan), &mut make);
    let Ok(tree) = tree else {
        return Err(problems);
    };
    let status = Arc::new(TreeStatus::new(declared.name.clone(), plan));
    Ok(Runner::new(Setting {
        declared: declared.clone(),
        tree,
        reach: Arc::clone(&ground.reach),
        orders,
        status,
    }))
}

/// What is wrong, and what to do about it.
type Misfit = (String, String);

/// A node that is to get its leaf.
struct Seat<'a> {
    plan: &'a Plan,
    node: NodeId,
    ground: &'a Ground<'a>,
}

impl Seat<'_> {
    fn leaf(&self) -> Result<Box<dyn Leaf>, Misfit> {
        use ComponentNodeKind as Kind;
        let id = &self.plan.describe(self.node).id;
        let known = component_node(id).ok_or_else(|| self.unknown("node", id))?;
        let reach = Arc::clone(&self.ground.reach);
        if known.kind == Kind::RaiseFault {
            let subject = match self.word("component") {
                Some(_) => self.component()?,
                None => reach.tree(),
            };
            return Ok(Box::new(Raise { reach, subject }));
        }
        let component = self.component()?;
        let ordered = |wish| Box::new(Ordered::new(Arc::clone(&reach), component, wish));
        let fault = || Fault {
            reach: Arc::clone(&reach),
            component,
            kind: self.word("kind"),
        };
        Ok(match known.kind {
            Kind::Start => ordered(Wish::Works),
            Kind::Stop => ordered(Wish::Stopped),
            Kind::Reset => ordered(Wish::Renewed(OperatorOrder::Reset)),
            Kind::Replace => ordered(Wish::Renewed(self.replacement(component)?)),
            Kind::Run => Box::new(Running::new(reach, component)),
            Kind::WaitForData => Box::new(WaitForData::new(self.watched(component, false)?)),
            Kind::ReadPort => Box::new(ReadPort(self.watched(component, true)?)),
            Kind::WritePort => Box::new(self.written(component)?),
            Kind::WaitForEvent => Box::new(self.awaited_event(component)?),
            Kind::RaiseEvent => Box::new(self.raised_event(component)?),
            Kind::AwaitFault => Box::new(Await::new(fault())),
            Kind::ClearFault => Box::new(Clear(fault())),
            Kind::FaultPresent => Box::new(Present(fault())),
            Kind::Works | Kind::InState => Box::new(State {
                wanted: self.word("state"),
                reach,
                component,
            }),
            Kind::EvaluateAge => {
                let reads = self.word("field").is_some();
                Box::new(Age::new(self.watched(component, reads)?))
            }
            Kind::EvaluateDeviation => Box::new(Deviation(self.watched(component, true)?)),
            Kind::Estimate => Box::new(Estimate { reach, component }),
            Kind::CallService => Box::new(self.called(component)?),
            Kind::RaiseFault => return Err(self.unknown("node", id)),
        })
    }

    /// What the file says at a port whose content is fixed.
    fn word(&self, port: &str) -> Option<String> {
        let value = self.plan.initial(self.node, port);
        value.map(Value::to_string)
    }

    /// Whether the file says anything at a port.
    fn says(&self, port: &str) -> bool {
        self.plan.initial(self.node, port).is_some() || self.plan.is_entry(self.node, port)
    }

    fn unknown(&self, what: &str, name: &str) -> Misfit {
        let path = &self.plan.describe(self.node).path;
        (
            format!("{path}: there is no {what} `{name}`"),
            "'steadfast check' of the application says more".to_owned(),
        )
    }

    fn component(&self) -> Result<usize, Misfit> {
        let name = self.word("component").unwrap_or_default();
        let found = self.ground.components.iter().find(|(own, _)| *own == name);
        found
            .map(|(_, number)| *number)
            .ok_or_else(|| self.unknown("component", &name))
    }

    fn replacement(&self, component: usize) -> Result<OperatorOrder, Misfit> {
        let Some(name) = self.word("secondary") else {
            return Ok(OperatorOrder::Replace { secondary: None });
        };
        let rules = self.ground.rules.get(component);
        let secondaries = rules.map_or(&[][..], |rules| &rules.secondaries);
        let mut types = secondaries.iter().map(|one| &one.specification.type_name);
        match types.position(|own| *own == name) {
            Some(index) => Ok(OperatorOrder::Replace {
                secondary: Some(index),
            }),
            None => Err((
                format!(
                    "{}: the rules name no secondary `{name}` for it",
                    self.path()
                ),
                "name it by <fault><secondary> in the rules of the component".to_owned(),
            )),
        }
    }

    fn path(&self) -> &str {
        &self.plan.describe(self.node).path
    }

    /// The port of the component that the node names, with its index.
    fn port(&self, component: usize) -> Result<(usize, &PortDescription), Misfit> {
        let name = self.word("port").unwrap_or_default();
        let ports = self.ground.assembly.interfaces.get(component);
        let mut ports = ports.into_iter().flatten().enumerate();
        ports
            .find(|(_, port)| port.name == name)
            .ok_or_else(|| self.unknown("port", &name))
    }

    /// An end of a port that the container holds.
    fn with_end<T>(
        &self,
        component: usize,
        port: usize,
        change: impl FnOnce(&mut PortEnd) -> Option<T>,
    ) -> Result<T, Misfit> {
        let cell = self.ground.assembly.components.get(component);
        let entered = cell.and_then(|cell| cell.enter(SETUP_TOKEN, Duration::ZERO));
        let changed = entered.and_then(|mut component| {
            let end = component.services_mut().port_mut(port)?;
            change(end)
        });
        changed.ok_or_else(|| {
            (
                format!("{}: nothing can be connected to this port", self.path()),
                "WritePort needs an input that nothing else is connected to".to_owned(),
            )
        })
    }

    fn data_type<'port>(&self, port: &'port PortDescription) -> Result<&'port DataType, Misfit> {
        let data_type = port.data_type.as_ref();
        data_type.ok_or_else(|| self.no_field("the port carries no data"))
    }

    fn no_field(&self, reason: &str) -> Misfit {
        (
            format!("{}: {reason}", self.path()),
            "name a field of the port's data type".to_owned(),
        )
    }
}
