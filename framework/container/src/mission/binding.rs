//! Trees are bound to the components of an assembled application: every leaf gets its ends of ports.

use std::cell::RefCell;
use std::collections::HashMap;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use behavior_tree::component_nodes::{ComponentNodeKind, component_node};
use behavior_tree::{Leaf, NodeId, Plan, Tree, Value};
use fault_manager::OperatorOrder;
use fault_manager::detection::NumberReader;
use system_model::data_type::DataType;
use system_model::mission::DeclaredTree;
use system_model::rules::{ComponentRules, SafeValue};
use system_model::specification::{ExecutionKind, QueuePolicy};

use super::leaves::control::{Ordered, Wish};
use super::leaves::data::{Outlet, ReadPort, WaitForData, Watched, WritePort};
use super::leaves::evaluation::{Age, Deviation};
use super::leaves::faults::{Await, Clear, Fault, Present, Raise};
use super::leaves::messages::{RaiseEvent, WaitForEvent};
use super::leaves::running::Running;
use super::leaves::states::{Estimate, State};
use super::{Reach, Runner, Setting, TreeStatus};
use crate::assembly::{Assembly, AssemblyProblem, EVENT_QUEUE, wake_of};
use crate::component::{Inbox, PortEnd, SafeDatum};
use crate::lane::SETUP_TOKEN;
use crate::library::PortDescription;
use crate::port::{Receiver, Sender, connection, mailbox};
use crate::supervision::Orders;
use crate::wake::Wake;

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
}

/// The ways to input ports that trees send to, by component and port.
#[derive(Default)]
pub struct Outlets(RefCell<HashMap<(usize, usize), Arc<Mutex<Outlet>>>>);

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
            Kind::CallService | Kind::RaiseFault => {
                return Err(self.unknown("node", id));
            }
        })
    }

    /// What the file says at a port whose content is fixed.
    fn word(&self, port: &str) -> Option<String> {
        let value = self.plan.initial(self.node, port);
        value.map(Value::to_string)
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

    /// A connection of its own to an output port; `reads`: the field that the node names.
    fn watched(&self, component: usize, reads: bool) -> Result<Watched, Misfit> {
        let (index, port) = self.port(component)?;
        let data_type = self.data_type(port)?;
        let field = self.word("field");
        let reader = match (reads, &field) {
            (true, Some(field)) => Some(
                NumberReader::compile(data_type, Some(field), 0)
                    .map_err(|error| self.no_field(&error.to_string()))?,
            ),
            _ => None,
        };
        let (sender, receiver): (Sender, Receiver) =
            connection(QueuePolicy::Last, 1, data_type.size);
        self.with_end(component, index, |end| match end {
            PortEnd::DataOutput(output) => {
                output.connections.push((sender, None));
                Some(())
            }
            _ => None,
        })?;
        Ok(Watched::new(receiver, reader))
    }

    fn written(&self, component: usize) -> Result<WritePort, Misfit> {
        let (index, port) = self.port(component)?;
        let data_type = self.data_type(port)?;
        let safe = SafeValue {
            field: self.word("field"),
            value: 0.0,
        };
        let datum = SafeDatum::new(data_type, [&safe])
            .map_err(|field| self.no_field(&format!("no field `{field}`")))?;
        Ok(WritePort {
            reach: Arc::clone(&self.ground.reach),
            outlet: self.outlet(component, index, data_type.size)?,
            datum,
        })
    }

    /// The way to an input port; all nodes that write there share it.
    fn outlet(
        &self,
        component: usize,
        port: usize,
        size: usize,
    ) -> Result<Arc<Mutex<Outlet>>, Misfit> {
        let mut outlets = self.ground.outlets.0.borrow_mut();
        if let Some(outlet) = outlets.get(&(component, port)) {
            return Ok(Arc::clone(outlet));
        }
        let (sender, receiver) = connection(QueuePolicy::Last, 1, size);
        self.with_end(component, port, |end| match end {
            PortEnd::DataInput(input) if input.source.is_none() => {
                input.source = Some(receiver);
                Some(())
            }
            _ => None,
        })?;
        let (wake, kind) = self.wake(component);
        let wake = (kind == ExecutionKind::Aperiodic).then_some(wake);
        let outlet = Arc::new(Mutex::new(Outlet::new(sender, size, wake)));
        outlets.insert((component, port), Arc::clone(&outlet));
        Ok(outlet)
    }

    fn awaited_event(&self, component: usize) -> Result<WaitForEvent, Misfit> {
        let (index, port) = self.port(component)?;
        let size = port.data_type.as_ref().map_or(0, |it| it.size);
        let (sender, messages) = mailbox(EVENT_QUEUE, size);
        self.with_end(component, index, |end| match end {
            PortEnd::EventOutput(output) => {
                output.connections.push((sender, Arc::default()));
                Some(())
            }
            _ => None,
        })?;
        Ok(WaitForEvent::new(messages))
    }

    fn raised_event(&self, component: usize) -> Result<RaiseEvent, Misfit> {
        let (index, port) = self.port(component)?;
        let size = port.data_type.as_ref().map_or(0, |it| it.size);
        let (sender, messages) = mailbox(EVENT_QUEUE, size);
        let cell = self.ground.assembly.components.get(component);
        if let Some(mut component) = cell.and_then(|it| it.enter(SETUP_TOKEN, Duration::ZERO)) {
            component.services_mut().add_inbox(Inbox {
                port: u32::try_from(index).unwrap_or(u32::MAX),
                method: None,
                messages,
                in_work: None,
                deaths: 0,
            });
        }
        let (wake, _) = self.wake(component);
        Ok(RaiseEvent {
            reach: Arc::clone(&self.ground.reach),
            sender,
            wake,
        })
    }

    /// What wakes a component's executor.
    fn wake(&self, component: usize) -> (Arc<Wake>, ExecutionKind) {
        let found = wake_of(&self.ground.assembly.executors, component);
        // Every component is in an executor.
        found.unwrap_or_else(|| (Arc::default(), ExecutionKind::Passive))
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
