//! Connections of data ports, made and undone while components run: between two callbacks of the
//! component whose port it is.

use super::local::LocalRobot;
use super::wiring::{Hop, PortKey};
use crate::component::PortEnd;
use crate::event_log::Event;
use crate::lane::Lane;
use crate::port::{Receiver, connection};

impl LocalRobot {
    /// Makes a connection and gives it the newest datum of its output, so that who reads need not wait
    /// for the next one. Nobody reads it yet.
    pub(super) fn connect(&self, hop: &Hop, lane: &Lane) -> Result<Receiver, String> {
        let size = self.with_port(&hop.to, lane.token(), |end| match end {
            PortEnd::DataInput(input) => {
                Some((input.size, input.source.as_ref().map(Receiver::id)))
            }
            _ => None,
        });
        let Some(Some((size, old))) = size else {
            return Err(self.unreachable(&hop.to));
        };
        let (policy, length) = self.binding.queue(&hop.to);
        let (mut sender, receiver) = connection(policy, length, size);
        if let Some(newest) = self.outlet(&hop.from).and_then(|outlet| outlet.newest()) {
            sender.send(newest.stamp_ns, newest.incarnation, |bytes| {
                bytes.copy_from_slice(&newest.bytes);
                true
            });
        }
        // Whoever asks how old the data of the input are goes on asking at the same place.
        let watched = old.and_then(|old| {
            let mut sources = self.binding.routes.iter().flat_map(|route| {
                let stages = route.through.iter().map(|stage| &stage.output);
                stages.chain([&route.from])
            });
            sources.find_map(|source| {
                let newest = self.with_port(source, lane.token(), |end| match end {
                    PortEnd::DataOutput(output) => {
                        let mut connections = output.connections.iter();
                        let fed = connections.find(|(sender, _)| sender.id() == old);
                        fed.and_then(|(sender, _)| sender.watched())
                    }
                    _ => None,
                });
                newest.flatten()
            })
        });
        if let Some(watched) = watched {
            sender.watch_by(watched);
        }
        let wake = self.executions[hop.to.component].1.clone();
        let done = self.with_port(&hop.from, lane.token(), |end| {
            if let PortEnd::DataOutput(output) = end {
                output.connections.push((sender, wake));
            }
        });
        done.map(|()| receiver)
            .ok_or_else(|| self.unreachable(&hop.from))
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

    /// Nothing is sent to a receiver any more.
    pub(super) fn unplug(&self, output: &PortKey, receiver: &Receiver, lane: &Lane) {
        let id = receiver.id();
        let done = self.with_port(output, lane.token(), |end| {
            if let PortEnd::DataOutput(output) = end {
                output.connections.retain(|(sender, _)| sender.id() != id);
            }
        });
        if done.is_none() {
            self.notice(&self.unreachable(output));
        }
    }

    /// Undoes the connection that an input has.
    pub(super) fn disconnect(&self, hop: &Hop, lane: &Lane) {
        match self.plug_in(&hop.to, None, lane) {
            Ok(Some(old)) => self.unplug(&hop.from, &old, lane),
            Ok(None) => {}
            Err(how) => self.notice(&how),
        }
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
