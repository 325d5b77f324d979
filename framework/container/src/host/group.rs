//! Which host an instance runs in: one of its own, or that of its group.

use std::collections::HashMap;
use std::io;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError, Weak};

use super::process::{HostProcess, Starter};

/// The hosts of a container.
#[derive(Debug)]
pub struct Hosts {
    /// Or why there is none.
    starter: Result<Starter, String>,
    groups: Mutex<HashMap<String, Group>>,
}

/// The hosts of one group.
#[derive(Debug, Default)]
struct Group {
    /// Where its components run.
    present: Weak<HostProcess>,
    /// Where those are that stand by for them: what ends the one must not end the other.
    standby: Weak<HostProcess>,
}

impl Hosts {
    /// No host yet; they will be started by this executable, if there is one, and with policy and
    /// priority of the calling thread.
    pub fn new(executable: Option<&Path>) -> Arc<Self> {
        let starter = match executable {
            None => Err("there is no executable `steadfast` to run it in".to_owned()),
            Some(executable) => Starter::new(executable).map_err(|error| error.to_string()),
        };
        Arc::new(Self {
            starter,
            groups: Mutex::default(),
        })
    }

    /// The host for an instance of a component of this group, or of none. An instance that stands
    /// by never shares the host of those that run.
    ///
    /// # Errors
    /// If the system refuses the process.
    pub(super) fn host(
        &self,
        group: Option<&str>,
        stands_by: bool,
    ) -> io::Result<Arc<HostProcess>> {
        let Some(group) = group else {
            return self.start();
        };
        let mut groups = self.groups.lock().unwrap_or_else(PoisonError::into_inner);
        let group = groups.entry(group.to_owned()).or_default();
        if living(&group.present).is_none() {
            // Who stood by runs there now.
            group.present = std::mem::take(&mut group.standby);
        }
        let place = if stands_by {
            &mut group.standby
        } else {
            &mut group.present
        };
        if let Some(host) = living(place) {
            return Ok(host);
        }
        let host = self.start()?;
        *place = Arc::downgrade(&host);
        Ok(host)
    }
}

impl Hosts {
    fn start(&self) -> io::Result<Arc<HostProcess>> {
        let starter = self.starter.as_ref();
        let starter = starter.map_err(|reason| io::Error::other(reason.clone()))?;
        HostProcess::start(starter).map(Arc::new)
    }
}

fn living(host: &Weak<HostProcess>) -> Option<Arc<HostProcess>> {
    host.upgrade()
        .filter(|host| !host.is_dead() && !host.was_killed())
}
