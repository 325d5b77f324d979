//! Connections of data ports, made and undone while components run: between two callbacks of the
//! component whose port it is.

use std::sync::Arc;

use system_model::task::{Placement, RobotIndex};

use super::linking::LinkEnd;
use super::local::LocalRobot;
use super::wiring::{Hop, PortKey};
use crate::component::PortEnd;
use crate::event_log::Event;
use crate::lane::Lane;
use crate::network::Entrance;
use crate::port::{ConnectionId, Newest, Receiver, Sender, connection};
use crate::wake::Wake;

impl LocalRobot {
    /// Makes this system's part of a connection: where the output is here it sends, where the input is
    /// here that input and what it will receive are returned. The newest datum is sent at once, so
    /// that who reads need not wait for the next one. Nobody reads it yet.
    pub(super) fn connect(
        &mut self,
        hop: &Hop,
        lane: &Lane,
    ) -> Result<Option<(PortKey, Receiver)>, String> {
        let own = |(key, end): (&PortKey, &LinkEnd)| (key.clone(), end.clone());
        let output = self.binding.output(hop).map(own);
        let input = self.binding.input(hop).map(own);
        match (output, input) {
            (Some((output, end)), Some((input, _))) => {
                let (policy, length) = self.binding.queue(&input);
                let (mut sender, receiver) = connection(policy, length, end.data_type.size);
                if let Some(watched) = self.watched(&input, lane)? {
                    sender.watch_by(watched);
                }
                let wake = self.executions[input.component].1.clone();
                self.send_by(&output, sender, wake, lane)?;
                Ok(Some((input, receiver)))
            }
            (Some((output, end)), None) => {
                let Some(passage) = &mut self.passage else {
                    return Err(self.unconnected(hop.to.robot));
                };
                let (sender, wake) = passage.send_out(hop, &end.data_type)?;
                self.send_by(&output, sender, Some(wake), lane)?;
                Ok(None)
            }
            (None, Some((input, end))) => {
                let (policy, length) = self.binding.queue(&input);
                let entrance = Entrance {
                    name: format!("{}.{}", self.statuses[input.component].name, input.port),
                    data_type: end.data_type,
                    policy,
                    length,
                    wake: self.executions[input.component].1.clone(),
                    watched: self.watched(&input, lane)?,
                };
                let Some(passage) = &mut self.passage else {
                    return Err(self.unconnected(hop.from.robot));
                };
                let receiver = passage.let_in(hop, entrance);
                Ok(Some((input, receiver)))
            }
            (None, None) => Ok(None),
        }
    }

    /// Makes the connections from robot to robot of what runs at the beginning: no application has
    /// them.
    pub(super) fn connect_robots(&mut self, running: &[Placement], lane: &Lane) {
        for hop in self.hops(running) {
            if hop.from.robot == hop.to.robot {
                continue;
            }
            let made = self.connect(&hop, lane).and_then(|end| match end {
                Some((input, receiver)) => self.plug_in(&input, Some(receiver), lane).map(drop),
                None => Ok(()),
            });
            if let Err(how) = made {
                self.notice(&how);
            }
        }
    }

    /// An output sends by one more connection.
    fn send_by(
        &self,
        output: &PortKey,
        mut sender: Sender,
        wake: Option<Arc<Wake>>,
        lane: &Lane,
    ) -> Result<(), String> {
        if let Some(newest) = self.outlet(output).and_then(|outlet| outlet.newest()) {
            sender.send(newest.stamp_ns, newest.incarnation, |bytes| {
                bytes.copy_from_slice(&newest.bytes);
                true
            });
            if let Some(wake) = &wake {
                wake.wake();
            }
        }
        let done = self.with_port(output, lane.token(), |end| {
            if let PortEnd::DataOutput(output) = end {
                output.connections.push((sender, wake));
            }
        });
        done.ok_or_else(|| self.unreachable(output))
    }

    /// Where the age of the data is left that an input gets now: whoever asks goes on asking at the
    /// same place.
    fn watched(&self, input: &PortKey, lane: &Lane) -> Result<Option<Arc<Newest>>, String> {
        let old = self.with_port(input, lane.token(), |end| match end {
            PortEnd::DataInput(input) => {
                let old = input.source.as_ref().map(Receiver::id);
                Some((old, input.newest_from_afar.clone()))
            }
            _ => None,
        });
        let Some(Some((old, from_afar))) = old else {
            return Err(self.unreachable(input));
        };
        if from_afar.is_some() {
            return Ok(from_afar);
        }
        let passage = self.passage.as_ref();
        Ok(old.and_then(|old| {
            let from_far = passage.and_then(|passage| passage.watched(&old));
            from_far.or_else(|| self.watched_here(old, lane))
        }))
    }

    fn watched_here(&self, connection: ConnectionId, lane: &Lane) -> Option<Arc<Newest>> {
        let mut sources = self.binding.ends.iter().filter_map(|it| it.output.as_ref());
        sources.find_map(|source| {
            let newest = self.with_port(source, lane.token(), |end| match end {
                PortEnd::DataOutput(output) => {
                    let mut connections = output.connections.iter();
                    let fed = connections.find(|(sender, _)| sender.id() == connection);
                    fed.and_then(|(sender, _)| sender.watched())
                }
                _ => None,
            });
            newest.flatten()
        })
    }

    /// Gives an input another source; the one that it had.
    pub(super) fn plug_in(
        &self,
        input: &PortKey,
        source: Option<Receiver>,
        lane: &Lane,
    ) -> Result<Option<Receiver>, String> {
        let old = self.with_port(input, lane.token(), |end| match end {
            PortEnd::DataInput(input) => std::mem::replace(&mut input.source, source),
            _ => None,
        });
        old.ok_or_else(|| self.unreachable(input))
    }

    /// Gives up what an input does not get its data from any more.
    pub(super) fn release(&mut self, hop: &Hop, receiver: &Receiver, lane: &Lane) {
        match self.binding.output(hop).map(|(key, _)| key.clone()) {
            Some(output) => self.unplug(&output, receiver.id(), lane),
            None => {
                if let Some(passage) = &mut self.passage {
                    passage.close(hop);
                }
            }
        }
    }

    /// Nothing is sent by a connection any more.
    fn unplug(&self, output: &PortKey, connection: ConnectionId, lane: &Lane) {
        let done = self.with_port(output, lane.token(), |end| {
            if let PortEnd::DataOutput(output) = end {
                let connections = &mut output.connections;
                connections.retain(|(sender, _)| sender.id() != connection);
            }
        });
        if done.is_none() {
            self.notice(&self.unreachable(output));
        }
    }

    /// Undoes this system's part of a connection.
    pub(super) fn disconnect(&mut self, hop: &Hop, lane: &Lane) {
        match self.binding.input(hop).map(|(key, _)| key.clone()) {
            Some(input) => match self.plug_in(&input, None, lane) {
                Ok(Some(old)) => self.release(hop, &old, lane),
                Ok(None) => {}
                Err(how) => self.notice(&how),
            },
            None => {
                let output = self.binding.output(hop).map(|(key, _)| key.clone());
                if let (Some(output), Some(passage)) = (output, &mut self.passage)
                    && let Some(connection) = passage.close(hop)
                {
                    self.unplug(&output, connection, lane);
                }
            }
        }
    }

    fn unconnected(&self, robot: RobotIndex) -> String {
        format!("{} is not connected", self.binding.task.robots[robot].name)
    }

    fn unreachable(&self, key: &PortKey) -> String {
        format!(
            "port '{}' of '{}' cannot be reached: its component was in a callback for too long",
            key.port, self.statuses[key.component].name
        )
    }

    pub(super) fn notice(&self, message: &str) {
        let message = message.to_owned();
        let now_ns = self.now_ns();
        self.environment
            .events
            .record(now_ns, Event::Notice { message });
    }
}
