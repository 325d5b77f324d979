//! The host process: runs instances of components behind the guard, each on a thread of its own, as
//! the container says.

use std::os::fd::{AsFd as _, OwnedFd};
use std::process::ExitCode;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use super::channel::Channel;
use super::ending::HostEnding;
use super::limits;
use super::message::{Call, CallbackWords, PLAIN, ToContainer, ToHost};
use super::remote::{Remote, monotonic_ns};
use super::robust::SignsOfLife;
use super::setup::Setup;
use super::socket;
use crate::clock::nanoseconds;
use crate::guard::loss::{Loss, losses, wait_for_loss};
use crate::guard::{CallLimit, Callback, Ending, Guarded, ServiceCall, Trap, interrupt};
use crate::library::{LoadedLibrary, hand_over};
use crate::scheduling::{be_ordinary, outrank_components};
use crate::watchdog::TICK;

/// How often lost threads are looked for if no word of one came.
const LOSS_PERIOD: Duration = Duration::from_millis(500);

/// One instance, as the rest of the host knows it.
struct Post {
    channel: &'static Channel,
    setup: Setup,
    loss: Loss,
    /// Number of the call that is under way; 0: none.
    call: AtomicU32,
}

type Posts = Arc<Mutex<Vec<Arc<Post>>>>;

/// What a host process does: what it is told on its standard input, until that is closed.
pub fn host_main() -> ExitCode {
    match serve() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // Its standard error is the container's; its end is seen in any case.
            let text = format!("steadfast host: {error}\n");
            let _unread = rustix::io::write(rustix::stdio::stderr(), text.as_bytes());
            ExitCode::FAILURE
        }
    }
}

fn serve() -> std::io::Result<()> {
    limits::tie_to_container()?;
    let control = rustix::io::dup(rustix::stdio::stdin())?;
    rustix::io::fcntl_setfd(&control, rustix::io::FdFlags::CLOEXEC)?;
    let nothing = std::fs::File::open("/dev/null")?;
    rustix::stdio::dup2_stdin(&nothing)?;
    let mut signs = SignsOfLife::new()?;
    let posts = Posts::default();
    let watched = Arc::clone(&posts);
    std::thread::Builder::new()
        .name("losses".to_owned())
        .spawn(move || watch_for_losses(&watched))?;
    // A death is told by the death of this thread, which sleeps all its life; it must not wait for
    // a processor then.
    outrank_components();
    let mut is_bounded = false;
    while let Some((message, files)) = socket::receive(control.as_fd())? {
        let setup: Setup = serde_json::from_slice(&message)?;
        let Ok([memory, devices, library]) = <[OwnedFd; 3]>::try_from(files) else {
            return Err(std::io::ErrorKind::InvalidData.into());
        };
        hand_over(&setup.library, library.into())?;
        if !is_bounded {
            limits::bound(&setup.limits)?;
            is_bounded = true;
        }
        // Never unmapped: the kernel may look at it when the process dies.
        let channel = Channel::open(memory, setup.layout.total, setup.layout.front())?;
        let channel = Box::leak(Box::new(channel));
        signs.show(channel);
        let post = Arc::new(Post {
            channel,
            setup,
            loss: Loss::default(),
            call: AtomicU32::new(0),
        });
        posts
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(Arc::clone(&post));
        std::thread::Builder::new()
            .name(post.setup.component.clone())
            .spawn(move || {
                // Not as the thread that made it, which outranks components.
                let _as_it_was = be_ordinary();
                run(&post, devices);
            })?;
    }
    Ok(())
}

/// The thread of one instance.
fn run(post: &Arc<Post>, devices: OwnedFd) {
    let channel = post.channel;
    channel.wait_for_container();
    let setup = &post.setup;
    let made = Guarded::prepare_thread()
        .map_err(|error| error.to_string())
        .and_then(|()| LoadedLibrary::load(&setup.library).map_err(|error| error.to_string()))
        .and_then(|library| {
            let callbacks = library.description.callbacks;
            Guarded::new(callbacks, library.code, setup.number).map_err(|error| error.to_string())
        });
    let mut guarded = match made {
        Ok(guarded) => guarded,
        Err(reason) => {
            let size = reason.len().min(setup.layout.to_container.size);
            let _fits = channel
                .bytes(setup.layout.to_container)
                .copy_from(&reason.as_bytes()[..size]);
            channel.say(&ToContainer::Refused(size).words(0));
            channel.hand_to_container();
            return;
        }
    };
    if setup.counts_allocations {
        guarded.count_allocations();
    }
    post.loss.watch().attach();
    let watched = Arc::clone(post);
    // Without that thread hangs are not broken off here; the container ends the process instead.
    let _ended_instead = std::thread::Builder::new()
        .name("watchdog".to_owned())
        .spawn(move || break_off_hangs(&watched));
    let mut remote = Remote::new(channel, setup.layout.clone(), devices, setup.clock_began_ns);
    let thread = rustix::thread::gettid().as_raw_nonzero().get();
    channel.say(&ToContainer::Loaded(thread).words(0));
    channel.hand_to_container();
    loop {
        channel.wait_for_container();
        let Some(ToHost::Call(call)) = ToHost::from_words(&channel.hear()) else {
            return;
        };
        let ending = call_back(post, &mut guarded, &mut remote, &call);
        let ended = HostEnding {
            ending,
            stray: guarded.look_for_stray_fault(),
            allocated_bytes: guarded.allocated_bytes(),
            misbehaved_ns: guarded.misbehaved().map_or(0, |acted| {
                monotonic_ns().saturating_sub(nanoseconds(acted.elapsed()))
            }),
        };
        channel.say(&ToContainer::Ended(ended).words(remote.take_written()));
        let scene = match ending {
            Ending::Trapped(trap) => guarded.scene(&trap),
            _ => None,
        };
        channel.hand_to_container();
        if let Some(scene) = scene {
            // It takes milliseconds, and the instance is never called again: the successor's
            // executor must not wait for it.
            let _as_it_was = be_ordinary();
            leave_backtrace(post, &scene.backtrace());
        }
    }
}

fn call_back(post: &Post, guarded: &mut Guarded, remote: &mut Remote, call: &Call) -> Ending {
    remote.now_ns = call.now_ns;
    post.call.store(call.number, Ordering::Release);
    let limit = CallLimit::from(Duration::from_nanos(call.limit_ns));
    guarded.inject(call.injection);
    if call.forgets_allocations {
        guarded.forget_allocations();
    }
    let layout = &post.setup.layout;
    let content = |size| layout.to_host.part(0, size);
    let mut request = Vec::new();
    let mut reply = Vec::new();
    let mut bring = |size: usize| {
        request.resize(size, 0);
        content(size).is_some_and(|part| {
            let bytes = post.channel.bytes(part).for_reading();
            bytes.copy_to(&mut request)
        })
    };
    let callback = match call.callback {
        CallbackWords::Plain(index) => PLAIN[index],
        CallbackWords::PeriodChanged(period_ns) => Callback::PeriodChanged(period_ns),
        CallbackWords::Event(port, size) => {
            if !bring(size) {
                return Ending::Gone;
            }
            Callback::Event(port, request.as_ptr(), size)
        }
        CallbackWords::Call(port, method, request_size, reply_size) => {
            if !bring(request_size) {
                return Ending::Gone;
            }
            reply.resize(reply_size.min(layout.to_container.size), 0);
            Callback::Call(ServiceCall {
                port,
                method,
                request: request.as_ptr(),
                request_size,
                reply: reply.as_mut_ptr(),
                reply_size: reply.len(),
            })
        }
    };
    let ending = guarded.call(callback, limit, &post.loss, remote);
    post.call.store(0, Ordering::Release);
    if !reply.is_empty() {
        let _fits = post.channel.bytes(layout.to_container).copy_from(&reply);
    }
    ending
}

/// Breaks off callbacks as the container says: what the watchdog does to a guarded component.
fn break_off_hangs(post: &Post) {
    outrank_components();
    let watch = post.loss.watch();
    let mut condemned = 0;
    loop {
        condemned = post.channel.wait_for_condemnation(condemned);
        // The generation first: it is that of the call if the call is still the condemned one.
        let generation = watch.inside().generation;
        while post.call.load(Ordering::Acquire) == condemned
            && let Some(thread) = watch.thread()
        {
            watch.condemn(generation);
            interrupt(thread);
            std::thread::sleep(TICK);
        }
    }
}

/// Threads that were lost inside a component, outside its own code: the container is told in their
/// place.
fn watch_for_losses(posts: &Posts) {
    loop {
        let seen = losses();
        let all = posts.lock().unwrap_or_else(PoisonError::into_inner).clone();
        for post in all {
            if let Some(lost) = post.loss.take() {
                tell_loss(&post, lost.trap);
            }
        }
        wait_for_loss(seen, LOSS_PERIOD);
    }
}

fn tell_loss(post: &Post, trap: Trap) {
    let ended = HostEnding {
        ending: Ending::Trapped(trap),
        stray: None,
        allocated_bytes: 0,
        misbehaved_ns: 0,
    };
    post.channel.say(&ToContainer::Ended(ended).words(0));
    post.channel.hand_to_container();
    leave_backtrace(post, &[]);
}

/// Leaves the functions that were being called where the container can look when it has time.
fn leave_backtrace(post: &Post, functions: &[String]) {
    let text = functions.join("\n");
    let area = post.setup.layout.to_container;
    let size = text.len().min(area.size);
    let _fits = post.channel.bytes(area).copy_from(&text.as_bytes()[..size]);
    post.channel.leave_text(size);
}
