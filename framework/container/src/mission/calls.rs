//! Calls of services for trees: a tick asks, somebody else calls, a later tick sees the answer. Where
//! time is real that is a lane of its own, so that a component that hangs or takes its thread along
//! holds up no tree.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use component_abi::Status;
use crossbeam::queue::ArrayQueue;

use crate::component::{ComponentCell, Environment, mark_lost};
use crate::guard::ServiceCall;
use crate::guard::loss::LostThread;
use crate::lane::{Lane, Work, remaining};
use crate::wake::Wake;

/// Calls that may wait: one for each node of a few trees.
const QUEUE: usize = 64;

/// How often the lane looks whether it is to end.
const LOOK_PERIOD: Duration = Duration::from_millis(100);

/// A method that trees call.
#[derive(Clone)]
pub(super) struct Method {
    pub(super) provider: Arc<ComponentCell>,
    pub(super) port: u32,
    pub(super) method: u32,
    pub(super) reply_size: usize,
}

/// One call.
pub(super) struct Call {
    method: Method,
    /// By the machine's clock: a call that nobody waits for any more is not begun.
    until: Instant,
    content: Mutex<Content>,
}

struct Content {
    request: Box<[u8]>,
    reply: Box<[u8]>,
    /// Once it has been answered.
    answer: Option<Status>,
}

/// Calls that wait for somebody who makes them.
pub struct Calls {
    queue: ArrayQueue<Arc<Call>>,
    wake: Wake,
    is_used: AtomicBool,
}

impl Call {
    /// What was answered, if anything was, with the reply.
    pub(super) fn answer(&self) -> Option<(Status, Box<[u8]>)> {
        let content = self.content();
        let answer = content.answer?;
        Some((answer, content.reply.clone()))
    }

    /// Makes the call, on a thread of `lane`.
    fn make(&self, now_ns: u64, lane: &Lane) {
        let limit = remaining(self.until);
        let mut content = self.content();
        let entered = self.method.provider.enter(lane.token(), limit);
        let answer = match entered {
            None => Status::TIMED_OUT,
            Some(mut callee) => {
                let call = ServiceCall {
                    port: self.method.port,
                    method: self.method.method,
                    request: content.request.as_ptr(),
                    request_size: content.request.len(),
                    reply: content.reply.as_mut_ptr(),
                    reply_size: content.reply.len(),
                };
                callee.serve(call, now_ns, lane.loss())
            }
        };
        content.answer = Some(answer);
    }

    fn content(&self) -> MutexGuard<'_, Content> {
        self.content.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Default for Calls {
    fn default() -> Self {
        Self {
            queue: ArrayQueue::new(QUEUE),
            wake: Wake::default(),
            is_used: AtomicBool::new(false),
        }
    }
}

impl Calls {
    /// Some tree calls services: somebody must make the calls.
    pub(super) fn use_them(&self) {
        self.is_used.store(true, Ordering::Relaxed);
    }

    /// Whether any tree calls services.
    pub fn is_used(&self) -> bool {
        self.is_used.load(Ordering::Relaxed)
    }

    /// Asks for a call; none if too many wait.
    pub(super) fn ask(
        &self,
        method: &Method,
        request: Box<[u8]>,
        limit: Duration,
    ) -> Option<Arc<Call>> {
        let call = Arc::new(Call {
            until: Instant::now() + limit,
            content: Mutex::new(Content {
                request,
                reply: vec![0; method.reply_size].into_boxed_slice(),
                answer: None,
            }),
            method: method.clone(),
        });
        self.queue.push(Arc::clone(&call)).ok()?;
        self.wake.wake();
        Some(call)
    }

    /// Makes the calls that wait, on a thread of `lane`; whether there were any.
    pub fn make_all(&self, now_ns: u64, lane: &Lane) -> bool {
        let mut any = false;
        while let Some(call) = self.queue.pop() {
            call.make(now_ns, lane);
            any = true;
        }
        any
    }
}

/// Makes calls on a lane of its own.
pub struct Caller {
    calls: Arc<Calls>,
    components: Arc<[Arc<ComponentCell>]>,
    environment: Arc<Environment>,
}

impl Caller {
    /// Not begun.
    pub fn new(
        calls: Arc<Calls>,
        components: Arc<[Arc<ComponentCell>]>,
        environment: Arc<Environment>,
    ) -> Self {
        Self {
            calls,
            components,
            environment,
        }
    }
}

impl Work for Caller {
    fn run(&mut self, lane: &Lane) {
        while !lane.is_stopping() {
            self.calls.make_all(self.environment.clock.now_ns(), lane);
            self.calls.wake.sleep(LOOK_PERIOD);
            self.calls.wake.take();
        }
    }

    /// The call that was under way is never answered: its node comes to its deadline.
    fn after_loss(&mut self, lost: &LostThread) {
        mark_lost(&self.components, lost, false);
    }
}
