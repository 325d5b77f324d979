//! Runs an application's executors in this process and prints how often the container allocated in
//! it after the first cycles. Components have allocators of their own, which are not counted.
//!
//! A program of its own, because the allocator belongs to a whole process. Arguments: the
//! application, the folder with the component libraries.
#![allow(unsafe_code)] // an allocator that counts

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use container::assembly::Assembly;
use container::component::ComponentCell;
use container::executor::Executor;
use container::guard::loss::LostThread;
use container::lane::{Crew, Lane, SETUP_TOKEN, Work};
use container::persistence::{CopyReceiver, handover};
use system_model::life_cycle::Operation;
use tests::{assembled, environment};

/// Cycles until every buffer has been used.
const WARM_UP_CYCLES: u64 = 1_000;

/// Cycles in which nothing may be allocated.
const CYCLES: u64 = 100_000;

/// What the components that register memory register.
const CRITICAL_BYTES: usize = 16;

/// More than the cycles take on a slow machine.
const LIMIT: Duration = Duration::from_secs(300);

thread_local! {
    // Only the lane's thread counts; const-initialised, so that reading it does not allocate.
    static COUNTING: Cell<bool> = const { Cell::new(false) };
}

static ALLOCATIONS: AtomicU64 = AtomicU64::new(0);

struct Counting;

impl Counting {
    fn count() {
        if COUNTING.get() {
            ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        }
    }
}

// SAFETY: everything is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        Self::count();
        // SAFETY: by this function's contract.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        Self::count();
        // SAFETY: by this function's contract.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        Self::count();
        // SAFETY: by this function's contract.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// All executors by turns, with a count of what is allocated meanwhile.
struct Cycles {
    components: Vec<Arc<ComponentCell>>,
    executors: Vec<Executor>,
    allocations: Arc<Mutex<Option<u64>>>,
}

impl Cycles {
    fn run_cycles(&mut self, cycles: u64, lane: &Lane) {
        for cycle in 0..cycles {
            for executor in &mut self.executors {
                executor.cycle(cycle, lane);
            }
        }
    }
}

impl Work for Cycles {
    fn run(&mut self, lane: &Lane) {
        for operation in [Operation::Initialize, Operation::Start] {
            for component in &self.components {
                let mut component = component.enter(lane.token(), LIMIT).expect("free");
                if operation == Operation::Initialize {
                    component.construct(lane.loss()).expect("constructed");
                }
                component.operate(operation, lane.loss()).expect("operated");
            }
        }
        self.run_cycles(WARM_UP_CYCLES, lane);
        COUNTING.set(true);
        // That it counts at all.
        drop(std::hint::black_box(Box::new(0_u8)));
        let own = ALLOCATIONS.swap(0, Ordering::Relaxed);
        assert_eq!(own, 2, "one allocation, one release");
        self.run_cycles(CYCLES, lane);
        COUNTING.set(false);
        let counted = ALLOCATIONS.load(Ordering::Relaxed);
        *self.allocations.lock().expect("not poisoned") = Some(counted);
    }

    fn after_loss(&mut self, lost: &LostThread) {
        panic!("a healthy component was lost: {lost:?}");
    }
}

fn main() {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let application = arguments.next().expect("the application");
    let libraries = arguments.next().expect("the folder of the libraries");
    let allocations = count(&application, &libraries);
    println!("{allocations}");
}

/// Checkpoints of every cycle that are handed over to be written; the ends at which they arrive.
fn persist(components: &[Arc<ComponentCell>]) -> Vec<CopyReceiver> {
    let hand_over = |component: &Arc<ComponentCell>| {
        let (sender, receiver) = handover(CRITICAL_BYTES);
        let mut component = component.enter(SETUP_TOKEN, Duration::ZERO).expect("free");
        component.keep_checkpoints(Duration::from_nanos(1));
        component.persist_checkpoints(sender);
        receiver
    };
    components.iter().map(hand_over).collect()
}

fn count(application: &Path, libraries: &Path) -> u64 {
    let (environment, writer) = environment();
    let Assembly {
        components,
        executors,
        ..
    } = assembled(application, libraries, &environment);
    let mut handed_over = persist(&components);
    let allocations = Arc::new(Mutex::new(None));
    let work = Cycles {
        components,
        executors,
        allocations: Arc::clone(&allocations),
    };
    let crew = Crew::new().expect("a crew");
    let lane = Lane::new("cycles", Box::new(work));
    crew.start(&lane, || {}).expect("a thread");
    assert!(lane.wait(LIMIT), "the cycles end");
    crew.dismiss();
    environment.events.finish();
    writer.close().expect("no file to fail");
    let arrived = handed_over.iter_mut().any(|it| it.take().is_some());
    assert!(arrived, "a component has checkpoints");
    let counted = *allocations.lock().expect("not poisoned");
    counted.expect("the cycles were run to their end")
}
