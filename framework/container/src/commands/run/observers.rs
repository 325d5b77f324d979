//! Who else may look at a run: its operator, Prometheus, Foxglove.

use std::net::{SocketAddr, TcpListener};
use std::sync::{Arc, Mutex};

use clap::Args;
use container::control::Server;
use container::metrics::{EventSender, Metrics, MetricsServer, Tally, count_events, parse_address};
use container::recording::RecordingOptions;
use container::system::System;

use super::failure::{Failed, exit_code};
use super::live::Watcher;

/// Who is served.
#[derive(Debug, Args)]
pub(super) struct ObserverArguments {
    /// Serve figures for Prometheus at http://ADDRESS/metrics; a port alone means this machine only
    #[arg(long, value_name = "ADDRESS", value_parser = parse_address)]
    metrics: Option<SocketAddr>,
    /// Show port data, events and diagnostics to Foxglove over a WebSocket, at 127.0.0.1:8765 unless
    /// said otherwise; only if steadfast was built with the feature `foxglove`
    #[arg(
        long,
        value_name = "ADDRESS",
        value_parser = parse_address,
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "127.0.0.1:8765"
    )]
    foxglove: Option<SocketAddr>,
}

/// Those that will be served once the run has begun.
pub(super) struct Prepared {
    metrics: Option<(TcpListener, Arc<Mutex<Tally>>)>,
}

/// Those that are served, until this is dropped.
pub(super) struct Observers {
    _metrics: Option<MetricsServer>,
}

impl ObserverArguments {
    /// What is recorded, and shown to who looks on.
    pub(super) fn shown(&self, options: RecordingOptions) -> RecordingOptions {
        RecordingOptions {
            foxglove: self.foxglove,
            ..options
        }
    }

    /// Takes the addresses, before anything runs; events for `echo` go by the sender returned.
    pub(super) fn prepare(&self, echo: EventSender) -> Result<(Prepared, EventSender), Failed> {
        let Some(address) = self.metrics else {
            return Ok((Prepared { metrics: None }, echo));
        };
        let listener = TcpListener::bind(address).map_err(|error| {
            refused(&format!(
                "--metrics: {address} cannot be listened at: {error}\n  help: another process may \
                 use it; choose another port, or 0 for any"
            ))
        })?;
        let (echo, tally) = count_events(echo)
            .map_err(|error| refused(&format!("--metrics: no thread for it: {error}")))?;
        let metrics = Some((listener, tally));
        Ok((Prepared { metrics }, echo))
    }
}

impl Prepared {
    /// Serves them. The robot runs without that, too.
    pub(super) fn start(self, system: &System, watcher: &Watcher) -> Observers {
        let metrics = self.metrics.and_then(|(listener, tally)| {
            let metrics = Metrics::new(system.control(), tally);
            match MetricsServer::start(listener, metrics) {
                Ok(server) => {
                    let address = server.address();
                    watcher.say(&format!("notice: figures at http://{address}/metrics"));
                    Some(server)
                }
                Err(error) => {
                    watcher.say(&format!("notice: no figures are served: {error}"));
                    None
                }
            }
        });
        Observers { _metrics: metrics }
    }
}

/// Lets an operator ask and command by `steadfast fault`. The robot runs without that, too.
pub(super) fn listen(system: &System, watcher: &Watcher) -> Option<Server> {
    match Server::start(system.name(), Arc::new(system.control())) {
        Ok(server) => {
            let path = server.path().display();
            watcher.say(&format!(
                "notice: 'steadfast status', 'top', 'component' and 'fault' find this run at {path}"
            ));
            Some(server)
        }
        Err(error) => {
            watcher.say(&format!(
                "notice: 'steadfast status' and its like cannot reach this run: {error}"
            ));
            None
        }
    }
}

fn refused(text: &str) -> Failed {
    Failed {
        code: exit_code::SYSTEM,
        text: text.to_owned(),
    }
}
