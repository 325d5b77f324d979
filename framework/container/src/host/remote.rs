//! In a host: what a component asks for is asked of the container, except for what came with the
//! call, what is written, and the time.

use std::fs::File;
use std::os::fd::{AsFd as _, IntoRawFd as _, OwnedFd};
use std::sync::atomic::Ordering;

use component_abi::Status;
use rustix::time::{ClockId, clock_gettime};

use super::channel::Channel;
use super::critical::CriticalMemory;
use super::input::Offer;
use super::layout::{Area, Layout, PortArea};
use super::message::{Asked, Question, ToContainer, ToHost};
use super::socket;
use crate::guard::{ForeignBytes, ForeignBytesMut, ForeignText, HostServices, Request};

/// Every entry in what was written begins with port and size.
pub(super) const ENTRY_HEAD: usize = 16;

/// The services of one instance in a host.
pub(super) struct Remote {
    channel: &'static Channel,
    layout: Layout,
    critical: CriticalMemory,
    devices: OwnedFd,
    /// See `Setup`.
    clock_began_ns: Option<u64>,
    /// The container's clock where it stands still.
    pub(super) now_ns: u64,
    /// How much was written in this callback, in bytes.
    written: usize,
}

impl Remote {
    pub(super) fn new(
        channel: &'static Channel,
        layout: Layout,
        devices: OwnedFd,
        clock_began_ns: Option<u64>,
    ) -> Self {
        Self {
            channel,
            critical: CriticalMemory::new(layout.critical),
            layout,
            devices,
            clock_began_ns,
            now_ns: 0,
            written: 0,
        }
    }

    /// How much was written and not handed over yet; it is from now on.
    pub(super) fn take_written(&mut self) -> usize {
        std::mem::take(&mut self.written)
    }

    /// Asks the container.
    fn ask(&mut self, asked: Asked, bad: bool) -> u64 {
        let question = ToContainer::Asked(Question { asked, bad });
        let written = self.take_written();
        self.channel.say(&question.words(written));
        self.channel.hand_to_container();
        self.channel.wait_for_container();
        match ToHost::from_words(&self.channel.hear()) {
            Some(ToHost::Answer(answer)) => answer,
            // The container gives the instance up; what is answered now changes nothing.
            _ => u64::from(Status::UNAUTHORIZED.0),
        }
    }

    fn read(&mut self, port: u32, data: ForeignBytesMut) -> u64 {
        let PortArea::Input(place) = self.layout.port(port) else {
            return self.ask(Asked::Read(port, data.size()), false);
        };
        if data.size() != place.size {
            return self.ask(Asked::Read(port, data.size()), false);
        }
        let offer = self.channel.offer(&self.layout, port);
        let offered = offer.map(|offer| Offer::from_word(offer.load(Ordering::Relaxed)));
        if let Some(offer) = offer
            && matches!(offered, Some(Offer::Datum | Offer::NoDatum))
        {
            offer.store(Offer::Taken.word(), Ordering::Relaxed);
        }
        match offered {
            Some(Offer::NoDatum) => return u64::from(Status::NOTHING.0),
            Some(Offer::Datum) => {}
            _ => {
                let answer = self.ask(Asked::Read(port, data.size()), false);
                if answer != u64::from(Status::SUCCESS.0) {
                    return answer;
                }
            }
        }
        if self.give(place, data) {
            u64::from(Status::SUCCESS.0)
        } else {
            self.ask(Asked::Read(port, data.size()), true)
        }
    }

    fn write(&mut self, port: u32, data: ForeignBytes) -> u64 {
        if self.layout.port(port) != PortArea::Output(data.size()) {
            return self.ask(Asked::Write(port, data.size()), false);
        }
        let room = ENTRY_HEAD + data.size().next_multiple_of(8);
        if self.layout.written.part(self.written, room).is_none() {
            self.ask(Asked::HandOver, false);
        }
        let Some(entry) = self.layout.written.part(self.written, room) else {
            return u64::from(Status::OUT_OF_RESOURCES.0);
        };
        let mut head = [0; ENTRY_HEAD];
        head[..8].copy_from_slice(&u64::from(port).to_ne_bytes());
        head[8..].copy_from_slice(&(data.size() as u64).to_ne_bytes());
        let content = Area {
            offset: entry.offset + ENTRY_HEAD,
            size: data.size(),
        };
        if !self.put(entry, &head) || !self.take(data, content) {
            return self.ask(Asked::Write(port, data.size()), true);
        }
        self.written += room;
        u64::from(Status::SUCCESS.0)
    }

    /// A question with a content of the component's.
    fn ask_with(&mut self, asked: Asked, content: ForeignBytes) -> u64 {
        let part = self.layout.to_container.part(0, content.size());
        // One that is larger than any can be is refused by its size.
        let readable = part.is_none_or(|part| self.take(content, part));
        self.ask(asked, !readable)
    }

    /// A question with a text.
    fn ask_text(&mut self, text: ForeignText, asked: impl FnOnce(usize) -> Asked) -> u64 {
        let Some(text) = text.read() else {
            return self.ask(asked(0), true);
        };
        self.put(self.layout.to_container, text.as_bytes());
        self.ask(asked(text.len()), false)
    }

    fn call(
        &mut self,
        (port, method): (u32, u32),
        request: ForeignBytes,
        reply: ForeignBytesMut,
        deadline_ns: u64,
    ) -> u64 {
        let asked = Asked::Call(port, method, request.size(), reply.size(), deadline_ns);
        let answer = self.ask_with(asked, request);
        if answer != u64::from(Status::SUCCESS.0) {
            return answer;
        }
        let place = self.layout.to_host.part(0, reply.size());
        if place.is_some_and(|place| self.give(place, reply)) {
            answer
        } else {
            self.ask(asked, true)
        }
    }

    fn property(
        &mut self,
        name: ForeignText,
        value: ForeignBytesMut,
        length: ForeignBytesMut,
    ) -> u64 {
        const LENGTH_BYTES: usize = size_of::<usize>();
        let room = value.size().min(self.layout.to_host.size - LENGTH_BYTES);
        let answer = self.ask_text(name, |size| Asked::Property(size, room));
        let mut found = [0; LENGTH_BYTES];
        let told = [Status::SUCCESS, Status::OUT_OF_RESOURCES].map(|status| u64::from(status.0));
        if !told.contains(&answer) || !self.get(self.layout.to_host, &mut found) {
            return answer;
        }
        let mut fits = length.copy_from(&found);
        if answer == u64::from(Status::SUCCESS.0) {
            let size = usize::from_ne_bytes(found).min(room);
            let place = self.layout.to_host.part(LENGTH_BYTES, size);
            fits &= place.is_some_and(|place| self.give(place, value));
        }
        if fits {
            answer
        } else {
            self.ask(Asked::Property(0, 0), true)
        }
    }

    fn critical(&mut self, address: *mut u8, size: usize) -> u64 {
        if size == 0 {
            return self.ask(Asked::Critical(0, 0), false);
        }
        let shared = self
            .critical
            .share(self.channel, address.expose_provenance(), size);
        match shared {
            Ok(place) => self.ask(Asked::Critical(place, size), false),
            Err(error) if error.raw_os_error() == Some(libc::EFAULT) => {
                self.ask(Asked::Critical(0, size), true)
            }
            Err(_no_room) => u64::from(Status::OUT_OF_RESOURCES.0),
        }
    }

    fn failed(&mut self, message: ForeignText, file: ForeignText, line: u32, column: u32) -> u64 {
        let (Some(message), Some(file)) = (message.read(), file.read()) else {
            return self.ask(Asked::Failed(0, 0, line, column), true);
        };
        let both = [message.as_bytes(), file.as_bytes()].concat();
        self.put(self.layout.to_container, &both);
        self.ask(
            Asked::Failed(message.len(), file.len(), line, column),
            false,
        )
    }

    fn open_device(&mut self, name: ForeignText, descriptor: ForeignBytesMut) -> u64 {
        let answer = self.ask_text(name, Asked::OpenDevice);
        if answer != u64::from(Status::SUCCESS.0) {
            return answer;
        }
        let Ok(Some((_, files))) = socket::receive(self.devices.as_fd()) else {
            return u64::from(Status::CALLEE_ERROR.0);
        };
        let Some(device) = files.into_iter().next() else {
            return u64::from(Status::CALLEE_ERROR.0);
        };
        let device = File::from(device);
        let number = std::os::fd::AsRawFd::as_raw_fd(&device);
        if !descriptor.copy_from(&number.to_ne_bytes()) {
            return self.ask(Asked::OpenDevice(0), true);
        }
        let _the_components_now = device.into_raw_fd();
        answer
    }

    /// From a part of the shared memory to the component's.
    fn give(&self, from: Area, to: ForeignBytesMut) -> bool {
        self.channel.bytes(from).for_reading().copy_into(to)
    }

    /// From the component's memory to a part of the shared one.
    fn take(&self, from: ForeignBytes, to: Area) -> bool {
        from.copy_into(self.channel.bytes(to))
    }

    fn put(&self, area: Area, bytes: &[u8]) -> bool {
        self.channel.bytes(area).copy_from(bytes)
    }

    fn get(&self, area: Area, bytes: &mut [u8]) -> bool {
        area.part(0, bytes.len())
            .is_some_and(|part| self.channel.bytes(part).for_reading().copy_to(bytes))
    }

    fn time(&self) -> u64 {
        let Some(began_ns) = self.clock_began_ns else {
            return self.now_ns;
        };
        monotonic_ns().saturating_sub(began_ns)
    }
}

/// The machine's monotonic clock, in nanoseconds.
pub(super) fn monotonic_ns() -> u64 {
    let now = clock_gettime(ClockId::Monotonic);
    let seconds = u64::try_from(now.tv_sec).unwrap_or_default();
    let nanoseconds = u64::try_from(now.tv_nsec).unwrap_or_default();
    seconds * 1_000_000_000 + nanoseconds
}

impl HostServices for Remote {
    fn answer(&mut self, request: &Request) -> u64 {
        match *request {
            Request::Read(port, data) => self.read(port, data),
            Request::Write(port, data) => self.write(port, data),
            Request::Now => self.time(),
            Request::Raise(port, data) => self.ask_with(Asked::Raise(port, data.size()), data),
            Request::Call(port, method, request, reply, deadline_ns) => {
                self.call((port, method), request, reply, deadline_ns)
            }
            Request::Property(name, value, length) => self.property(name, value, length),
            Request::Log(level, message) => self.ask_text(message, |size| Asked::Log(level, size)),
            Request::Critical(address, size) => self.critical(address, size),
            Request::ReportFault(code, message) => {
                self.ask_text(message, |size| Asked::ReportFault(code.0, size))
            }
            Request::Failed(message, file, line, column) => {
                self.failed(message, file, line, column)
            }
            Request::OpenDevice(name, descriptor) => self.open_device(name, descriptor),
        }
    }
}
