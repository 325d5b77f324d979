//! An instance in a host, as the container has it: with the methods of one behind the guard.

use std::io;
use std::os::fd::{AsFd as _, OwnedFd};
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};
use std::thread::ThreadId;
use std::time::{Duration, Instant};

use system_model::rules::ProcessLimits;

use super::answer;
use super::channel::{Channel, Waited};
use super::ending::HostEnding;
use super::group::Hosts;
use super::input::{Input, inputs};
use super::layout::Layout;
use super::message::{Call, CallbackWords, ToContainer, ToHost};
use super::patience::Patience;
use super::process::HostProcess;
use super::remains::RemoteScene;
use super::remote::monotonic_ns;
use super::scheduling::Scheduling;
use super::setup::Setup;
use super::socket;
use crate::clock::Clock;
use crate::guard::loss::Loss;
use crate::guard::{
    CallLimit, Callback, Ending, ForeignBytes, ForeignBytesMut, Guarded, HostServices,
    Misbehaviour, Registers, Trap,
};
use crate::library::{PortDescription, sealed};
use crate::wake::Wake;

/// Loading a library takes milliseconds, starting a process a few; a host that takes longer hangs.
const START_LIMIT: Duration = Duration::from_secs(10);

/// One component instance in a host.
pub struct Hosted {
    channel: Arc<Channel>,
    layout: Arc<Layout>,
    /// None once the instance cannot be called any more.
    process: Option<Arc<HostProcess>>,
    /// What is left of it then.
    remains: Option<Arc<HostProcess>>,
    /// Woken when the host dies while nobody calls the instance.
    executor: Arc<OnceLock<Arc<Wake>>>,
    /// Where devices are handed to the host.
    devices: OwnedFd,
    /// The host's thread that runs the instance.
    thread: i32,
    inputs: Vec<Input>,
    /// Of the last call.
    number: u32,
    injection: Option<Misbehaviour>,
    forgets_allocations: bool,
    allocated_bytes: u64,
    misbehaved: Option<Instant>,
    stray: Option<Trap>,
    /// Whose policy and priority the host's thread has.
    followed: Option<ThreadId>,
    scheduling: Scheduling,
}

/// What is to be run in a host.
pub struct HostedComponent<'factory> {
    /// Instance name.
    pub name: &'factory str,
    /// The component's number in the application.
    pub number: u32,
    /// The library's file.
    pub library: PathBuf,
    /// Its ports.
    pub ports: &'factory [PortDescription],
    /// Components of one group share a host.
    pub group: Option<&'factory str>,
    /// Whether it only stands by for one that runs.
    pub stands_by: bool,
    /// Whether a rule asks how much memory it uses.
    pub counts_allocations: bool,
    /// Bounds of the process.
    pub limits: ProcessLimits,
}

impl Hosted {
    /// Makes an instance; nothing of the component has run then but what its library does when it
    /// is loaded.
    ///
    /// # Errors
    /// If the host does not start, or refuses the library; in words.
    pub fn new(
        hosts: &Hosts,
        component: HostedComponent<'_>,
        clock: &Clock,
    ) -> Result<Self, String> {
        // What a host passes is copied as if a component passed it.
        Guarded::prepare_process();
        let layout = Arc::new(Layout::of(component.ports));
        let in_words = |error: io::Error| format!("its host process does not start: {error}");
        let channel = Arc::new(Channel::create(layout.total, layout.front()).map_err(in_words)?);
        let (devices, far) = socket::pair().map_err(in_words)?;
        let library = sealed(&component.library)
            .map_err(|error| format!("{}: {error}", component.library.display()))?;
        let process = hosts
            .host(component.group, component.stands_by)
            .map_err(in_words)?;
        let setup = Setup {
            component: component.name.to_owned(),
            number: component.number,
            library: component.library,
            layout: (*layout).clone(),
            clock_began_ns: (!clock.is_simulated())
                .then(|| monotonic_ns().saturating_sub(clock.now_ns())),
            counts_allocations: component.counts_allocations,
            limits: component.limits,
        };
        let executor = Arc::default();
        process
            .run(&setup, &channel, far.as_fd(), library.as_fd(), &executor)
            .map_err(in_words)?;
        drop(far);
        let thread = wait_until_loaded(&channel, &layout, &process)?;
        Ok(Self {
            channel,
            inputs: inputs(&layout),
            layout,
            process: Some(process),
            remains: None,
            executor,
            devices,
            thread,
            number: 0,
            injection: None,
            forgets_allocations: false,
            allocated_bytes: 0,
            misbehaved: None,
            stray: None,
            followed: None,
            scheduling: Scheduling::NORMAL,
        })
    }

    /// Whether the instance can still be called.
    pub fn is_alive(&self) -> bool {
        self.process.is_some()
    }

    /// Whose thread calls it from now on: it is woken when the host dies while nobody does.
    pub fn run_by(&self, executor: &Arc<Wake>) {
        let _first = self.executor.set(Arc::clone(executor));
        if self.has_lost_host() {
            executor.wake();
        }
    }

    /// Whether its host has died by itself while it should live.
    #[inline]
    pub fn has_lost_host(&self) -> bool {
        self.process.is_some() && self.channel.is_dead()
    }

    /// Runs a callback to its end; what the component asks for is answered by `services`. After
    /// `limit` the host breaks it off; a host that does not manage that is killed.
    pub fn call<Services: HostServices>(
        &mut self,
        callback: Callback,
        limit: CallLimit,
        loss: &Loss,
        services: &mut Services,
    ) -> Ending {
        if self.process.is_none() {
            return Ending::Gone;
        }
        self.follow_scheduling();
        if !self.put_content(&callback) {
            return Ending::Gone;
        }
        let is_cycle = matches!(callback, Callback::Execute);
        if is_cycle {
            answer::offer(&self.channel, &self.layout, &mut self.inputs, services);
        }
        self.number = self.number.wrapping_add(1).max(1);
        let call = ToHost::Call(Call {
            callback: CallbackWords::of(&callback),
            injection: self.injection.take(),
            forgets_allocations: std::mem::take(&mut self.forgets_allocations),
            now_ns: services.answer(&crate::guard::Request::Now),
            limit_ns: crate::clock::nanoseconds(limit.duration()),
            number: self.number,
        });
        self.channel.say(&call.words());
        let watched = loss.watch().enter(CallLimit::NONE);
        self.channel.hand_to_host();
        let ending = self.attend(&callback, limit, loss, services);
        loss.watch().leave(watched);
        if is_cycle {
            answer::look_back(&self.channel, &self.layout, &mut self.inputs);
        }
        if !matches!(ending, Ending::Returned(_)) {
            self.quarantine();
        }
        ending
    }

    /// Lets the component misbehave when its next callback is due.
    pub fn inject(&mut self, misbehaviour: Option<Misbehaviour>) {
        self.injection = misbehaviour;
    }

    /// When it misbehaved last as it was made to.
    pub fn misbehaved(&self) -> Option<Instant> {
        self.misbehaved
    }

    /// Bytes that callbacks have allocated and not freed.
    pub fn allocated_bytes(&self) -> u64 {
        self.allocated_bytes
    }

    /// What was allocated so far does not count any more.
    pub fn forget_allocations(&mut self) {
        self.forgets_allocations = true;
    }

    /// The fault that a thread of the component's own has met, once.
    pub fn take_stray_fault(&mut self) -> Option<Trap> {
        let trap = self.stray.take()?;
        self.quarantine();
        Some(trap)
    }

    /// Never call this instance again. Its host ends when nobody else needs it.
    pub fn quarantine(&mut self) {
        if let Some(process) = self.process.take() {
            self.remains = Some(process);
        }
    }

    /// Where this instance was when it ended, for a thread that has time.
    pub fn scene(&mut self) -> Option<RemoteScene> {
        let process = self.remains.take()?;
        Some(RemoteScene::new(
            Arc::clone(&self.channel),
            &self.layout,
            process,
        ))
    }

    /// How its host ended, in words; waits for that at most `limit`.
    pub fn end_of_host(&self, limit: Duration) -> Option<String> {
        let process = self.process.as_ref().or(self.remains.as_ref())?;
        process.wait_for_end(limit)
    }

    /// Waits for the end of the callback that was just handed over.
    fn attend<Services: HostServices>(
        &mut self,
        callback: &Callback,
        limit: CallLimit,
        loss: &Loss,
        services: &mut Services,
    ) -> Ending {
        let mut patience = Patience::new(limit.duration(), self.thread);
        loop {
            let hurry = loss.watch().hurry_limit().duration();
            match self.channel.wait_for_host(patience.next_look(hurry)) {
                Waited::Dead => return Ending::HostEnded,
                Waited::Turn => match ToContainer::from_words(&self.channel.hear()) {
                    Some((ToContainer::Ended(ended), written)) => {
                        return self.end(ended, written, callback, services);
                    }
                    Some((ToContainer::Asked(question), written)) => {
                        patience.pause();
                        answer::take_written(&self.channel, &self.layout, written, services);
                        let devices = self.devices.as_fd();
                        let inputs = &mut self.inputs;
                        let memory = (&*self.channel, &*self.layout);
                        let status = answer::answer(memory, question, inputs, devices, services);
                        patience.resume();
                        self.channel.say(&ToHost::Answer(status).words());
                        self.channel.hand_to_host();
                        if !patience.is_used_up(hurry) {
                            continue;
                        }
                    }
                    // Whoever speaks so has lost its mind; it has lost its life as well.
                    Some((ToContainer::Loaded(_) | ToContainer::Refused(_), _)) | None => {
                        self.kill();
                        return Ending::HostEnded;
                    }
                },
                Waited::Late => {}
            }
            if patience.has_given_up() {
                self.kill();
                return Ending::Trapped(hang(limit.duration()));
            }
            if patience.exceeded(hurry) {
                self.channel.condemn(self.number);
                patience.give_grace();
            }
        }
    }

    /// The callback has ended by itself.
    fn end<Services: HostServices>(
        &mut self,
        ended: HostEnding,
        written: usize,
        callback: &Callback,
        services: &mut Services,
    ) -> Ending {
        self.allocated_bytes = ended.allocated_bytes;
        if ended.misbehaved_ns > 0 {
            let ago = monotonic_ns().saturating_sub(ended.misbehaved_ns);
            self.misbehaved = Instant::now().checked_sub(Duration::from_nanos(ago));
        }
        self.stray = self.stray.or(ended.stray);
        if let Ending::Returned(status) = ended.ending {
            if status != component_abi::Status::PANICKED {
                answer::take_written(&self.channel, &self.layout, written, services);
            }
            if let Callback::Call(call) = callback
                && call.reply_size > 0
                && let Some(part) = self.layout.to_container.part(0, call.reply_size)
            {
                let reply = ForeignBytesMut::at(call.reply.expose_provenance(), call.reply_size);
                let _readable = self.channel.bytes(part).for_reading().copy_into(reply);
            }
        }
        ended.ending
    }

    /// Puts what goes with a callback where the host finds it.
    fn put_content(&self, callback: &Callback) -> bool {
        let (data, size) = match callback {
            Callback::Event(_, data, size) => (*data, *size),
            Callback::Call(call) => (call.request, call.request_size),
            _ => return true,
        };
        size == 0
            || self.layout.to_host.part(0, size).is_some_and(|part| {
                let content = ForeignBytes::at(data.expose_provenance(), size);
                content.copy_into(self.channel.bytes(part))
            })
    }

    /// The host's thread gets policy and priority of the thread that calls.
    fn follow_scheduling(&mut self) {
        let caller = std::thread::current().id();
        if self.followed == Some(caller) {
            return;
        }
        self.followed = Some(caller);
        let scheduling = Scheduling::of_this_thread();
        if scheduling != self.scheduling {
            self.scheduling = scheduling;
            scheduling.give_to(self.thread);
        }
    }

    fn kill(&self) {
        if let Some(process) = &self.process {
            process.kill();
        }
    }
}

impl Drop for Hosted {
    fn drop(&mut self) {
        if self.process.is_some() && !self.channel.is_dead() {
            self.channel.say(&ToHost::End.words());
            self.channel.hand_to_host();
        }
    }
}

/// Waits until the host has loaded the library; the thread that runs the instance.
fn wait_until_loaded(
    channel: &Channel,
    layout: &Layout,
    process: &HostProcess,
) -> Result<i32, String> {
    match channel.wait_for_host(START_LIMIT) {
        Waited::Turn => match ToContainer::from_words(&channel.hear()) {
            Some((ToContainer::Loaded(thread), _)) if process.has_thread(thread) => Ok(thread),
            Some((ToContainer::Refused(size), _)) => Err(channel.text(layout.to_container, size)),
            _ => Err("its host process makes no sense".to_owned()),
        },
        Waited::Dead => Err("its host process ended while it loaded the library".to_owned()),
        Waited::Late => Err(format!(
            "its host process did not load the library within {} s",
            START_LIMIT.as_secs()
        )),
    }
}

fn hang(limit: Duration) -> Trap {
    Trap {
        signal: libc::SIGKILL,
        code: 0,
        address: 0,
        registers: Registers::default(),
        stack_overflow: false,
        hang: Some(limit),
    }
}
