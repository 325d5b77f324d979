//! A world that is a process of its own, moved by the machine's clock: it outlives the container.

use std::io::{self, Write as _};
use std::os::fd::{AsFd as _, OwnedFd};
use std::os::unix::net::UnixStream;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use robot_simulation::{Simulation, Transport, draw_drive};
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use super::protocol::{ANSWER_LIMIT, Answer, Request};
use crate::descriptor_line::DescriptorLine;

/// What a world says to its parent when it stands.
pub const STANDS: u8 = b'W';

/// Moves a world and answers containers until its parent closes `parent`. The parent sends each
/// container's line over it as the descriptor of an empty message.
///
/// # Errors
/// If the system refuses.
pub fn serve(simulation: Simulation, parent: UnixStream) -> io::Result<()> {
    let simulation = &Mutex::new(simulation);
    let (stop, stopped) = channel();
    std::thread::scope(|scope| {
        std::thread::Builder::new()
            .name("world".to_owned())
            .spawn_scoped(scope, move || move_along(simulation, &stopped))?;
        let served = answer_containers(simulation, parent);
        drop(stop);
        served
    })
}

/// Moves the world until `stopped` is closed.
fn move_along(simulation: &Mutex<Simulation>, stopped: &Receiver<()>) {
    let start = Instant::now();
    let period = lock(simulation).step_period();
    while stopped.recv_timeout(period) == Err(RecvTimeoutError::Timeout) {
        lock(simulation).advance_to(start.elapsed());
    }
}

fn answer_containers(simulation: &Mutex<Simulation>, mut parent: UnixStream) -> io::Result<()> {
    parent.write_all(&[STANDS])?;
    let mut parent = DescriptorLine::new(parent, ANSWER_LIMIT)?;
    let mut container: Option<DescriptorLine> = None;
    loop {
        let (from_parent, from_container) = wait(&parent, container.as_ref())?;
        if from_container && !answer(simulation, container.as_mut()) {
            container = None;
        }
        if from_parent {
            let Some(((), Some(line))) = parent.receive::<()>()? else {
                return Ok(());
            };
            // The one before is dead; its faults on purpose went with it.
            lock(simulation).clear_faults();
            container = Some(DescriptorLine::new(line.into(), ANSWER_LIMIT)?);
        }
    }
}

/// Waits until parent or container have something to say.
fn wait(parent: &DescriptorLine, container: Option<&DescriptorLine>) -> io::Result<(bool, bool)> {
    let descriptors = std::iter::once(parent).chain(container);
    let mut descriptors: Vec<PollFd<'_>> = descriptors
        .map(|line| PollFd::from_borrowed_fd(line.as_fd(), PollFlags::IN))
        .collect();
    // Nothing is due but what these say; an end of the parent is something that it says.
    let forever: Option<&Timespec> = None;
    match poll(&mut descriptors, forever) {
        Ok(_) | Err(rustix::io::Errno::INTR) => {}
        Err(error) => return Err(error.into()),
    }
    let is_ready = |descriptor: Option<&PollFd<'_>>| {
        descriptor.is_some_and(|descriptor| !descriptor.revents().is_empty())
    };
    Ok((is_ready(descriptors.first()), is_ready(descriptors.get(1))))
}

/// Answers one request; whether the container is still there and keeps to the protocol.
fn answer(simulation: &Mutex<Simulation>, container: Option<&mut DescriptorLine>) -> bool {
    let Some(container) = container else {
        return false;
    };
    let Ok(Some((request, _))) = container.receive() else {
        return false;
    };
    let (answer, descriptor) = carry_out(simulation, request);
    let descriptor = descriptor.as_ref().map(|descriptor| descriptor.as_fd());
    container.send(&answer, descriptor).is_ok()
}

fn carry_out(simulation: &Mutex<Simulation>, request: Request) -> (Answer, Option<OwnedFd>) {
    let mut simulation = lock(simulation);
    let answer = match request {
        Request::Summary => Answer::Summary(simulation.summary()),
        Request::Picture => Answer::Picture(draw_drive(&simulation)),
        Request::Open(device) => match simulation.open(&device, Transport::PseudoTerminal) {
            Ok(line) => {
                let path = simulation.slave_path(&device).map(Into::into);
                return (Answer::Opened(path), Some(line));
            }
            Err(error) => Answer::Refused(error.to_string()),
        },
        Request::SetFault(fault) => {
            simulation.set_fault(fault);
            Answer::Done
        }
        Request::ClearFault(fault) => {
            simulation.clear_fault(fault);
            Answer::Done
        }
    };
    (answer, None)
}

fn lock(simulation: &Mutex<Simulation>) -> MutexGuard<'_, Simulation> {
    simulation.lock().unwrap_or_else(PoisonError::into_inner)
}
