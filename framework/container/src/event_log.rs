//! The event log: everything that happened, one JSON object a line, written by a thread of its own.

mod unfinished;

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crossbeam::channel::{Receiver, RecvTimeoutError, Sender, TryRecvError, TrySendError, bounded};
use fault_manager::Verdict;
use serde::Serialize;
use system_model::fault::Fault;
use unfinished::open_at_end;

use crate::adaptation::AdaptationRecord;
use crate::outer_supervision::ContainerRestart;

/// Events that may wait for the writer: more than a robot of a hundred components makes in a
/// second when all of them fail.
const QUEUE: usize = 8192;

/// Written lines reach the file at least this often, so that a person can watch it grow.
const FLUSH_PERIOD: Duration = Duration::from_millis(200);

/// How often the writer looks for events where nobody waits for it. It does not sleep on the queue:
/// whoever records an event would have to wake it, and may be a component's executor in the middle
/// of a recovery. A hundredth of what the queue holds comes in this time.
const LOOK_PERIOD: Duration = Duration::from_millis(10);

/// Something that happened.
#[derive(Debug, Clone, Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub enum Event {
    /// The application is assembled and about to run.
    RunStarted {
        /// Its name.
        application: String,
        /// `real` or `simulated`.
        clock: &'static str,
        /// Seed of the simulated world.
        seed: u64,
        /// Number of component instances.
        components: usize,
    },
    /// A component went from one life-cycle state to another.
    State {
        /// Instance name.
        component: String,
        /// Old state.
        from: &'static str,
        /// New state.
        to: &'static str,
        /// Incarnation.
        incarnation: u32,
    },
    /// A component failed.
    Fault {
        /// Instance name.
        component: String,
        /// Incarnation.
        incarnation: u32,
        /// Kind of fault.
        kind: &'static str,
        /// Callback that failed, as OPRoS names it.
        callback: &'static str,
        /// What was seen.
        message: String,
        /// `file:line:column` in the component's source, where it is known.
        #[serde(skip_serializing_if = "Option::is_none")]
        place: Option<String>,
        /// Whether its thread was lost with it.
        thread_lost: bool,
    },
    /// A fault was made on purpose, or is over.
    Injection {
        /// Its KIND.
        fault: &'static str,
        /// Instance name; none for a fault of the world.
        #[serde(skip_serializing_if = "Option::is_none")]
        component: Option<String>,
        /// `begins` or `ends`.
        change: &'static str,
    },
    /// A datum or message with which two incarnations died in work is not given to a third.
    DatumSetAside {
        /// Instance name of the receiver.
        component: String,
        /// The port that it had arrived at.
        port: String,
        /// When it was written, in nanoseconds of the container's clock.
        stamp_ns: u64,
    },
    /// A component goes on from what a run that died has left on the disk.
    CheckpointRestored {
        /// Instance name.
        component: String,
        /// Incarnation that goes on.
        incarnation: u32,
        /// Number of the checkpoint.
        sequence: u64,
        /// How old it is, in milliseconds by the machine's clock.
        age_ms: u64,
    },
    /// A decision of self-adaptation has ended.
    Adaptation(Box<AdaptationRecord>),
    /// What the fault manager made of a fault; the last one of an `id` counts.
    Verdict(Box<Verdict>),
    /// An executor did not finish its cycle within its period.
    Overrun {
        /// Executor name.
        executor: String,
        /// Cycle number.
        cycle: u64,
        /// How much too late, in nanoseconds.
        late_ns: u64,
    },
    /// A component logged something.
    Log {
        /// Instance name.
        component: String,
        /// `error`, `warning`, `information` or `debug`.
        level: &'static str,
        /// What it said.
        message: String,
    },
    /// The container has something to say that is no fault of a component.
    Notice {
        /// What it is.
        message: String,
    },
    /// The container has died and was restarted by its parent; recorded once it runs again.
    ContainerRestarted(Box<ContainerRestart>),
    /// The container has died once too often: its parent will not restart it.
    ContainerGivenUp {
        /// How many restarts there have been in this run.
        restarts: u32,
        /// What was seen last.
        seen: String,
        /// Why it was judged so.
        judged: String,
    },
    /// A behaviour tree has begun, ended, failed or was halted.
    TreeState {
        /// Its name.
        tree: String,
        /// What it did before: `waiting`, `running`, `success`, `failure`, `failed` or `stopped`.
        from: &'static str,
        /// What it does now.
        to: &'static str,
    },
    /// Nodes of a behaviour tree have other states after a tick than they had before.
    TreeNodes {
        /// The tree's name.
        tree: String,
        /// Path and state of each.
        nodes: Vec<(String, &'static str)>,
        /// Further ones that are left out, so that a tree does not fill the record.
        left_out: u64,
    },
    /// The robot has reached its target.
    TargetReached {
        /// Of several in worlds of their own: the first application in its world.
        #[serde(skip_serializing_if = "Option::is_none")]
        application: Option<String>,
        /// Robot time in seconds.
        time_s: f64,
    },
    /// Something about a robot of the network.
    Robot {
        /// Its name.
        robot: String,
        /// `appeared`, `died`, `decides`, `refused` (data of it), `fault` (of one of its components),
        /// `namesake`, `unintelligible`.
        change: &'static str,
        /// What is to be known of it.
        message: String,
    },
    /// The application has stopped.
    RunStopped {
        /// Why.
        reason: &'static str,
        /// Events that were lost because the writer did not keep up.
        events_lost: u64,
    },
}

impl Event {
    /// The event for a fault.
    pub fn fault(component: &str, incarnation: u32, fault: &Fault) -> Self {
        Self::Fault {
            component: component.to_owned(),
            incarnation,
            kind: fault.kind.name(),
            callback: fault.callback,
            message: fault.message.clone(),
            place: fault
                .place
                .as_ref()
                .map(|(file, line, column)| format!("{file}:{line}:{column}")),
            thread_lost: fault.thread_lost,
        }
    }
}

/// One line of the file.
#[derive(Debug, Serialize)]
pub(crate) struct Line {
    pub(crate) t_ns: u64,
    #[serde(flatten)]
    pub(crate) event: Event,
}

/// Where events go. Cheap to call from any thread; never waits unless time is simulated.
#[derive(Debug)]
pub struct EventLog {
    sender: Sender<Option<Line>>,
    waits: bool,
    lost: AtomicU64,
    /// Who gets every event, too.
    recording: Option<Sender<(u64, Event)>>,
    /// Who gets every verdict, too, if there is room.
    listener: Option<Sender<(u64, Event)>>,
}

/// The thread that writes; to be closed when all has been said.
#[derive(Debug)]
pub struct EventWriter {
    thread: JoinHandle<io::Result<()>>,
}

impl EventLog {
    /// Opens the log; without a file events are only counted and echoed. `waits`: whether a full
    /// queue makes the caller wait (simulated time, where nothing may be lost and nothing is late).
    ///
    /// # Errors
    /// If the file cannot be created.
    pub fn open(
        path: Option<&Path>,
        waits: bool,
        echo: Option<Sender<(u64, Event)>>,
    ) -> io::Result<(Self, EventWriter)> {
        Self::write_to(path.map(File::create).transpose()?, waits, echo)
    }

    /// As [`EventLog::open`], but goes on in the file where a container that died has ended. The half
    /// line that such a one may leave is taken out.
    ///
    /// # Errors
    /// If the file cannot be opened.
    pub fn resume(
        path: Option<&Path>,
        waits: bool,
        echo: Option<Sender<(u64, Event)>>,
    ) -> io::Result<(Self, EventWriter)> {
        Self::write_to(path.map(open_at_end).transpose()?, waits, echo)
    }

    fn write_to(
        file: Option<File>,
        waits: bool,
        echo: Option<Sender<(u64, Event)>>,
    ) -> io::Result<(Self, EventWriter)> {
        let (sender, receiver) = bounded(QUEUE);
        let thread = std::thread::Builder::new()
            .name("event-log".to_owned())
            .spawn(move || {
                let target = Target {
                    output: file.map(BufWriter::new),
                    echo,
                };
                write_all(&receiver, target, waits)
            })?;
        let log = Self {
            sender,
            waits,
            lost: AtomicU64::new(0),
            recording: None,
            listener: None,
        };
        Ok((log, EventWriter { thread }))
    }

    /// A log that nobody writes: events are lost.
    pub fn nowhere() -> Self {
        Self {
            sender: bounded(0).0,
            waits: false,
            lost: AtomicU64::new(0),
            recording: None,
            listener: None,
        }
    }

    /// A recording gets every event, too; what it does not keep up with counts as lost.
    #[must_use]
    pub fn recorded_by(self, recording: Option<Sender<(u64, Event)>>) -> Self {
        Self { recording, ..self }
    }

    /// Somebody gets every verdict, too, as far as there is room.
    #[must_use]
    pub fn heard_by(self, listener: Option<Sender<(u64, Event)>>) -> Self {
        Self { listener, ..self }
    }

    /// Records an event at a time of the application's clock.
    pub fn record(&self, t_ns: u64, event: Event) {
        if let Some(recording) = &self.recording {
            self.pass_on(recording, (t_ns, event.clone()));
        }
        if let (Some(listener), Event::Verdict(_)) = (&self.listener, &event) {
            // Full: the verdict is on record here.
            let _unheard = listener.try_send((t_ns, event.clone()));
        }
        self.pass_on(&self.sender, Some(Line { t_ns, event }));
    }

    fn pass_on<Message>(&self, receiver: &Sender<Message>, message: Message) {
        if self.waits {
            // Fails only when the receiver has ended, after which nobody reads.
            let _ended = receiver.send(message);
        } else if let Err(TrySendError::Full(_)) = receiver.try_send(message) {
            self.lost.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Says that nothing more will come: the writer ends. Abandoned threads may hold the log for
    /// ever, so its end cannot be that everyone has let go of it.
    pub fn finish(&self) {
        // Fails only when the writer has ended already.
        let _ended = self.sender.send(None);
    }

    /// Events lost so far.
    pub fn lost(&self) -> u64 {
        self.lost.load(Ordering::Relaxed)
    }
}

impl EventWriter {
    /// Waits until everything is written, after [`EventLog::finish`].
    ///
    /// # Errors
    /// If the file could not be written.
    pub fn close(self) -> io::Result<()> {
        self.thread
            .join()
            .unwrap_or_else(|_panic| Err(io::Error::other("the event writer panicked")))
    }
}

/// Where the writer puts events.
struct Target {
    output: Option<BufWriter<File>>,
    echo: Option<Sender<(u64, Event)>>,
}

impl Target {
    fn write(&mut self, line: Line) -> io::Result<()> {
        if let Some(output) = &mut self.output {
            serde_json::to_writer(&mut *output, &line)?;
            output.write_all(b"\n")?;
        }
        if let Some(echo) = &self.echo {
            // The person's view may lag; the file is the record.
            let _lagging = echo.try_send((line.t_ns, line.event));
        }
        Ok(())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.output.as_mut().map_or(Ok(()), Write::flush)
    }
}

/// Writes until the end is said. Who records waits for room where `waits`, and is waited for.
fn write_all(receiver: &Receiver<Option<Line>>, mut target: Target, waits: bool) -> io::Result<()> {
    let mut flushed = Instant::now();
    loop {
        let received = if waits {
            receiver
                .recv_timeout(FLUSH_PERIOD)
                .map_err(|error| match error {
                    RecvTimeoutError::Timeout => TryRecvError::Empty,
                    RecvTimeoutError::Disconnected => TryRecvError::Disconnected,
                })
        } else {
            receiver.try_recv()
        };
        match received {
            Ok(Some(line)) => target.write(line)?,
            Err(TryRecvError::Empty) => {
                if flushed.elapsed() >= FLUSH_PERIOD {
                    target.flush()?;
                    flushed = Instant::now();
                }
                if !waits {
                    std::thread::sleep(LOOK_PERIOD);
                }
            }
            Ok(None) | Err(TryRecvError::Disconnected) => return target.flush(),
        }
    }
}
