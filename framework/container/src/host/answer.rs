//! In the container: what an instance in a host asks for, answered by the services that answer one
//! behind the guard as well. Nothing that the host says is trusted: what is outside its part of the
//! shared memory is treated as memory that is not there.

use std::os::fd::BorrowedFd;
use std::sync::atomic::Ordering;

use component_abi::Status;

use super::channel::Channel;
use super::input::{Input, Offer};
use super::layout::{Area, Layout, PortArea};
use super::message::{Asked, Question, size};
use super::remote::ENTRY_HEAD;
use super::socket;
use crate::guard::{ForeignBytesMut, ForeignText, HostServices, Request};

/// Puts what the component will probably read where it finds it.
pub(super) fn offer<Services: HostServices>(
    channel: &Channel,
    layout: &Layout,
    inputs: &mut [Input],
    services: &mut Services,
) {
    for input in inputs {
        let offer = if input.is_read && !services.has_queue(input.port) {
            match read(channel, layout, input, services) {
                Status::SUCCESS => Offer::Datum,
                Status::NOTHING => Offer::NoDatum,
                _ => Offer::Nothing,
            }
        } else {
            Offer::Nothing
        };
        input.is_kept |= offer == Offer::Datum;
        if let Some(word) = channel.offer(layout, input.port) {
            word.store(offer.word(), Ordering::Relaxed);
        }
    }
}

/// The cycle is over: what was offered and not taken waits for the next.
pub(super) fn look_back(channel: &Channel, layout: &Layout, inputs: &mut [Input]) {
    for input in inputs {
        if let Some(word) = channel.offer(layout, input.port) {
            let offer = word.swap(Offer::Nothing.word(), Ordering::Relaxed);
            input.look_back(Offer::from_word(offer));
        }
    }
}

/// Sends what the component has written.
pub(super) fn take_written<Services: HostServices>(
    channel: &Channel,
    layout: &Layout,
    written: usize,
    services: &mut Services,
) {
    let mut offset = 0;
    while offset < written {
        let mut head = [0; ENTRY_HEAD];
        let Some(place) = layout.written.part(offset, ENTRY_HEAD) else {
            return;
        };
        if !channel.bytes(place).for_reading().copy_to(&mut head) {
            return;
        }
        let word = |index: usize| {
            let bytes = head[8 * index..][..8].try_into().unwrap_or_default();
            u64::from_ne_bytes(bytes)
        };
        let (Ok(port), Some(bytes)) = (u32::try_from(word(0)), size(word(1))) else {
            return;
        };
        let Some(content) = layout.written.part(offset + ENTRY_HEAD, bytes) else {
            return;
        };
        // A refusal is on record already, or the port has no such size: the host had looked.
        services.answer(&Request::Write(port, channel.bytes(content).for_reading()));
        offset += ENTRY_HEAD + bytes.next_multiple_of(8);
    }
}

/// Answers a question.
pub(super) fn answer<Services: HostServices>(
    (channel, layout): (&Channel, &Layout),
    question: Question,
    inputs: &mut [Input],
    devices: BorrowedFd<'_>,
    services: &mut Services,
) -> u64 {
    let from_host = |offset: usize, bytes: usize| {
        let part = layout.to_container.part(offset, bytes);
        place(channel, part.filter(|_| !question.bad), bytes)
    };
    let to_host = |offset: usize, bytes: usize| {
        let part = layout.to_host.part(offset, bytes);
        place(channel, part.filter(|_| !question.bad), bytes)
    };
    let content = |bytes| from_host(0, bytes).for_reading();
    let text = |offset, bytes| ForeignText::of(from_host(offset, bytes).for_reading());
    let request = match question.asked {
        Asked::Read(port, bytes) => {
            let input = inputs.iter_mut().find(|input| input.port == port);
            let Some(input) = input.filter(|_| !question.bad) else {
                let nowhere = ForeignBytesMut::at(0, bytes);
                return services.answer(&Request::Read(port, nowhere));
            };
            if layout.port(port) != PortArea::Input(area_of(layout, port, bytes)) {
                return services.answer(&Request::Read(port, ForeignBytesMut::at(0, bytes)));
            }
            input.is_read = true;
            let offer = channel.offer(layout, port);
            let taken =
                offer.is_some_and(|offer| offer.load(Ordering::Relaxed) == Offer::Taken.word());
            input.is_kept &= !taken;
            let status = read(channel, layout, input, services);
            input.is_kept = false;
            return u64::from(status.0);
        }
        Asked::Write(port, bytes) => {
            Request::Write(port, ForeignBytesMut::at(0, bytes).for_reading())
        }
        Asked::Raise(port, bytes) => Request::Raise(port, content(bytes)),
        Asked::Call(port, method, request, reply, deadline_ns) => Request::Call(
            port,
            method,
            content(request),
            to_host(0, reply),
            deadline_ns,
        ),
        Asked::Property(name, value) => {
            let length = size_of::<usize>();
            Request::Property(text(0, name), to_host(length, value), to_host(0, length))
        }
        Asked::Log(level, bytes) => Request::Log(level, text(0, bytes)),
        Asked::Critical(offset, bytes) => {
            let part = layout.critical.part(offset, bytes);
            let memory = place(channel, part.filter(|_| !question.bad), bytes);
            Request::Critical(memory.address(), memory.size())
        }
        Asked::ReportFault(code, bytes) => Request::ReportFault(Status(code), text(0, bytes)),
        Asked::Failed(message, file, line, column) => {
            Request::Failed(text(0, message), text(message, file), line, column)
        }
        Asked::OpenDevice(name) => {
            return open_device(text(0, name), question.bad, devices, services);
        }
        Asked::HandOver => return u64::from(Status::SUCCESS.0),
    };
    services.answer(&request)
}

/// The newest datum of an input, put in its place.
fn read<Services: HostServices>(
    channel: &Channel,
    layout: &Layout,
    input: &Input,
    services: &mut Services,
) -> Status {
    let PortArea::Input(area) = layout.port(input.port) else {
        return Status::BAD_INPUT_PARAMETER;
    };
    let request = Request::Read(input.port, channel.bytes(area));
    let status = Status(u32::try_from(services.answer(&request)).unwrap_or(u32::MAX));
    if status == Status::NOTHING && input.is_kept {
        return Status::SUCCESS;
    }
    status
}

/// The place of an input, if it has this size.
fn area_of(layout: &Layout, port: u32, bytes: usize) -> Area {
    match layout.port(port) {
        PortArea::Input(area) if area.size == bytes => area,
        _ => Area { offset: 0, size: 0 },
    }
}

/// Memory of the host, or memory of this size that is not there.
fn place(channel: &Channel, part: Option<Area>, bytes: usize) -> ForeignBytesMut {
    part.map_or(ForeignBytesMut::at(0, bytes), |part| channel.bytes(part))
}

/// Opens a device here and hands it to the host.
fn open_device<Services: HostServices>(
    name: ForeignText,
    bad: bool,
    devices: BorrowedFd<'_>,
    services: &mut Services,
) -> u64 {
    let mut number = [0; size_of::<i32>()];
    // Not in the shared memory: nobody else may say which file is meant.
    let answered = if bad {
        ForeignBytesMut::at(0, number.len())
    } else {
        ForeignBytesMut::of(&mut number)
    };
    let answer = services.answer(&Request::OpenDevice(name, answered));
    if answer == u64::from(Status::SUCCESS.0) {
        let device = crate::device::taken_back(i32::from_ne_bytes(number));
        if socket::send(devices, b"device", &[std::os::fd::AsFd::as_fd(&device)]).is_err() {
            return u64::from(Status::CALLEE_ERROR.0);
        }
    }
    answer
}
