//! What a bare trap takes: from the instruction to the container's stack, through the handler and
//! the coroutine, on a thread that does other work between two of them.

use std::hint::black_box;
use std::time::{Duration, Instant};

use component_abi::{Callbacks, HostContext, HostTable, Instance, Status};
use container::guard::loss::Loss;
use container::guard::{
    CallLimit, Callback, CodeRange, Ending, Guarded, HostServices, Misbehaviour, Request,
};
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};

use super::Plan;
use super::application::{EVERY_CYCLES, PRIORITY};

/// Cycles before each fault, in which the thread does as the application's does: it works and sleeps,
/// and others have the processor meanwhile.
const CYCLES: usize = EVERY_CYCLES;
const PERIOD: Duration = Duration::from_millis(1);

const EMPTY: Callbacks = Callbacks {
    create: Some(create),
    on_execute: Some(on_execute),
    ..Callbacks::NONE
};

unsafe extern "C" fn create(_: *const HostTable, _: *mut HostContext) -> *mut Instance {
    std::ptr::dangling_mut()
}

unsafe extern "C" fn on_execute(_: *mut Instance) -> Status {
    Status::SUCCESS
}

struct NoServices;

impl HostServices for NoServices {
    fn answer(&mut self, _request: &Request) -> u64 {
        0
    }
}

/// Measures as many as the plan has faults, in nanoseconds.
pub fn measure(plan: &Plan) -> Vec<u64> {
    let (faults, walks, fifo) = (
        plan.faults,
        plan.walks_kib * 1024,
        plan.policy == "SCHED_FIFO",
    );
    let thread = std::thread::spawn(move || {
        if fifo {
            let priority = ThreadPriorityValue::try_from(PRIORITY).expect("a priority");
            set_thread_priority_and_policy(
                thread_native_id(),
                ThreadPriority::Crossplatform(priority),
                ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo),
            )
            .expect("real-time scheduling is permitted");
        }
        let mut ground = vec![0u8; walks];
        Guarded::prepare_thread().expect("a stack for the handler");
        let sample = |_| trap(&mut ground);
        (0..faults).map(sample).collect()
    });
    thread.join().expect("it ends")
}

fn trap(ground: &mut [u8]) -> u64 {
    let loss = Loss::default();
    let limit = CallLimit::from(Duration::from_millis(100));
    let code = CodeRange { start: 0, end: 0 };
    let mut guarded = Guarded::new(EMPTY, code, 0).expect("a stack");
    guarded.call(Callback::Create, limit, &loss, &mut NoServices);
    guarded.inject(Some(Misbehaviour::Segfault));
    for _cycle in 0..CYCLES {
        for line in ground.chunks_mut(64) {
            line[0] = line[0].wrapping_add(1);
        }
        black_box(&ground);
        std::thread::sleep(PERIOD);
    }
    let ending = guarded.call(Callback::Execute, limit, &loss, &mut NoServices);
    let end = Instant::now();
    assert!(matches!(ending, Ending::Trapped(_)), "{ending:?}");
    let begin = guarded.misbehaved().expect("it trapped");
    (end - begin).as_nanos() as u64
}
