//! Where the topics of a recording belong in an application.

use std::collections::BTreeMap;
use std::sync::Arc;

use recording::{Channel, Layout, Topic};
use system_model::data_type::DataType;
use system_model::specification::{
    ApplicationSpecification, Place, PortDirection, PortKind, QueuePolicy,
};

use crate::assembly::{Assembly, AssemblyProblem};
use crate::component::PortEnd;
use crate::lane::SETUP_TOKEN;
use crate::library::PortDescription;
use crate::port::{Sender, connection};
use crate::wake::Wake;

/// What may wait at an input whose data are recorded themselves: they are read as they come.
const INPUT_QUEUE: usize = 64;

/// Where the messages of a topic go.
pub(super) enum Route {
    /// A component writes them.
    Written {
        component: usize,
        port: u32,
        kind: PortKind,
        layout: Layout,
    },
    /// They arrive at an input.
    Arriving {
        component: usize,
        layout: Layout,
        sender: Sender,
        wake: Option<Arc<Wake>>,
    },
}

/// Where everything of a recording belongs, and what it lacks.
#[derive(Default)]
pub(super) struct Routes {
    /// By topic.
    pub(super) by_topic: BTreeMap<String, Route>,
    /// Topics of ports that the application does not have.
    pub(super) strangers: Vec<String>,
    /// Outputs of components that are played of which the recording has nothing.
    pub(super) missing: Vec<String>,
}

/// Finds the way for every topic.
///
/// # Errors
/// Data of another layout, or too little for the component that is to be replayed.
pub(super) fn find(
    place: &Place,
    channels: &[Arc<Channel>],
    specification: &ApplicationSpecification,
    assembly: &Assembly,
    only: Option<&str>,
) -> Result<Routes, Vec<AssemblyProblem>> {
    let search = Search {
        place,
        specification,
        assembly,
        only,
    };
    let (mut routes, mut problems) = (Routes::default(), Vec::new());
    let is_port = |channel: &&Arc<Channel>| {
        let is_topic = Topic::ALL.iter().any(|it| it.name() == channel.topic);
        // What monitors made of the data is made once more.
        let direction = channel.metadata.get("direction").map(String::as_str);
        !is_topic && direction != Some("monitor")
    };
    for channel in channels.iter().filter(is_port) {
        match search.route(channel) {
            Ok(Some(route)) => {
                routes.by_topic.insert(channel.topic.clone(), route);
            }
            Ok(None) => {}
            Err(Refusal::Stranger) => routes.strangers.push(channel.topic.clone()),
            Err(Refusal::Problem(problem)) => problems.push(problem),
        }
    }
    routes.missing = search.missing(&routes);
    problems.extend(search.too_little(&routes));
    if problems.is_empty() {
        Ok(routes)
    } else {
        Err(problems)
    }
}

enum Refusal {
    /// The application has no such port.
    Stranger,
    /// It has another one.
    Problem(AssemblyProblem),
}

struct Search<'start> {
    place: &'start Place,
    specification: &'start ApplicationSpecification,
    assembly: &'start Assembly,
    only: Option<&'start str>,
}

impl Search<'_> {
    fn route(&self, channel: &Channel) -> Result<Option<Route>, Refusal> {
        let (component, number, port) = self.port(channel).ok_or(Refusal::Stranger)?;
        let nothing = DataType {
            name: String::new(),
            size: 0,
            layout_hash: 0,
            fields: Vec::new(),
        };
        let layout = Layout::new(port.data_type.as_ref().unwrap_or(&nothing));
        let hash = format!("{:#x}", layout.data_type().layout_hash);
        if channel.metadata.get("layout_hash") != Some(&hash) {
            return Err(Refusal::Problem(self.problem(
                format!(
                    "topic '{}' was recorded of another layout of '{}' than the library has now",
                    channel.topic, channel.schema
                ),
                "replay it with the libraries of that time, or record anew".to_owned(),
            )));
        }
        let replayed = self.only == Some(self.name(component));
        let port_number = u32::try_from(number).unwrap_or(u32::MAX);
        Ok(match port.direction {
            // It writes them itself.
            PortDirection::Output if replayed => None,
            PortDirection::Output => Some(Route::Written {
                component,
                port: port_number,
                kind: port.kind,
                layout,
            }),
            PortDirection::Input => self.arriving(component, number, layout),
        })
    }

    /// Data that came to an input where rules or injections stood: they come again as they did, in
    /// place of what is sent. In front of a voter they do not: it votes again.
    fn arriving(&self, component: usize, number: usize, layout: Layout) -> Option<Route> {
        let size = layout.data_type().size;
        let (sender, receiver) = connection(QueuePolicy::Fifo, INPUT_QUEUE, size);
        let cell = &self.assembly.components[component];
        let mut entered = cell.enter(SETUP_TOKEN, std::time::Duration::ZERO)?;
        let Some(PortEnd::DataInput(input)) = entered.services_mut().port_mut(number) else {
            return None;
        };
        if input.tap.as_ref().is_some_and(|tap| tap.voter.is_some()) {
            return None;
        }
        input.source = Some(receiver);
        let runs =
            |member: &crate::executor::Member| usize::try_from(member.number) == Ok(component);
        let executors = self.assembly.executors.iter();
        let mut executors = executors.filter(|it| it.members.iter().any(runs));
        Some(Route::Arriving {
            component,
            layout,
            sender,
            wake: executors.next().map(|it| Arc::clone(&it.wake)),
        })
    }

    /// The port that a channel is of, with the numbers of its component and of itself. Where there
    /// were several applications their components bore the application's name, too.
    fn port(&self, channel: &Channel) -> Option<(usize, usize, &PortDescription)> {
        let (of, port) = (
            channel.metadata.get("component")?,
            channel.metadata.get("port")?,
        );
        let own = of
            .strip_prefix(&self.specification.name)
            .and_then(|rest| rest.strip_prefix('/'));
        let components = &self.specification.components;
        let component = components
            .iter()
            .position(|it| it.name == *of || Some(it.name.as_str()) == own)?;
        let ports = self.assembly.interfaces[component].iter().enumerate();
        let mut named = ports.filter(|(_, it)| it.name == *port);
        named.next().map(|(number, it)| (component, number, it))
    }

    fn missing(&self, routes: &Routes) -> Vec<String> {
        let mut missing = Vec::new();
        for (component, ports) in self.assembly.interfaces.iter().enumerate() {
            if self.only == Some(self.name(component)) {
                continue;
            }
            for (number, port) in ports.iter().enumerate() {
                let sends =
                    port.kind != PortKind::Service && port.direction == PortDirection::Output;
                let is_routed = routes.by_topic.values().any(|route| {
                    matches!(route, Route::Written { component: other, port, .. }
                        if *other == component && usize::try_from(*port) == Ok(number))
                });
                if sends && !is_routed {
                    missing.push(format!("{}.{}", self.name(component), port.name));
                }
            }
        }
        missing
    }

    /// What a component that is replayed cannot do without.
    fn too_little(&self, routes: &Routes) -> Vec<AssemblyProblem> {
        if routes.by_topic.is_empty() {
            return vec![self.problem(
                format!(
                    "it holds no data of any port of application '{}'",
                    self.specification.name
                ),
                "name the recording and the application that belong together".to_owned(),
            )];
        }
        let connections = self.specification.connections.iter();
        let wanted = connections.filter(|it| self.only == Some(self.name(it.target.component)));
        let lacking = wanted.filter_map(|connection| {
            let source = &connection.source;
            let name = format!("{}.{}", self.name(source.component), source.port);
            let port = &connection.target.port;
            routes.missing.contains(&name).then(|| {
                self.problem(
                    format!("it holds no data of '{name}', which goes to input '{port}'"),
                    "record that port, too: see --record-max-bytes-per-datum".to_owned(),
                )
            })
        });
        let connections = self.specification.connections.iter();
        let calls = connections.filter(|it| self.only == Some(self.name(it.source.component)));
        let calls = calls.filter(|it| {
            let ports = &self.assembly.interfaces[it.source.component];
            let port = ports.iter().find(|port| port.name == it.source.port);
            port.is_some_and(|port| port.kind == PortKind::Service)
        });
        let answers = calls.map(|connection| {
            self.problem(
                format!(
                    "'{}' calls a service at its port '{}', and recordings do not hold what services \
                     answer",
                    self.name(connection.source.component),
                    connection.source.port
                ),
                "replay another component".to_owned(),
            )
        });
        lacking.chain(answers).collect()
    }

    fn name(&self, component: usize) -> &str {
        &self.specification.components[component].name
    }

    fn problem(&self, message: String, help: String) -> AssemblyProblem {
        AssemblyProblem::Connection {
            place: self.place.clone(),
            message,
            help,
        }
    }
}
