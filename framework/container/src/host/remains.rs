//! What is left of an instance in a host that is never called again: the functions that it was in,
//! and how its process ended.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::channel::Channel;
use super::layout::{Area, Layout};
use super::process::HostProcess;

/// A backtrace takes milliseconds of reading and parsing, and a dead host is reaped as soon; on a
/// machine whose processors are kept busy at real-time priority more than a second was seen. One
/// that is not done by then is not waited for.
const LONGEST_WAIT: Duration = Duration::from_secs(5);

/// How often is looked whether it is there.
const LOOK: Duration = Duration::from_millis(1);

/// Where an instance was when it ended. Keeps its host until it is dropped.
#[derive(Debug)]
pub struct RemoteScene {
    channel: Arc<Channel>,
    area: Area,
    process: Arc<HostProcess>,
}

impl RemoteScene {
    pub(super) fn new(channel: Arc<Channel>, layout: &Layout, process: Arc<HostProcess>) -> Self {
        Self {
            channel,
            area: layout.to_container,
            process,
        }
    }

    /// The functions of the component that were being called, innermost first, as the host has
    /// found them; of one that is dead how it ended. Waits for either.
    pub fn backtrace(&self) -> Vec<String> {
        let began = Instant::now();
        while began.elapsed() < LONGEST_WAIT {
            if let Some(size) = self.channel.text_size() {
                let text = self.channel.text(self.area, size);
                return text.lines().map(ToOwned::to_owned).collect();
            }
            if let Some(ending) = self.process.ending() {
                return vec![format!("the host process ended: {ending}")];
            }
            std::thread::sleep(LOOK);
        }
        Vec::new()
    }
}
