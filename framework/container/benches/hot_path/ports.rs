//! Put and get through a port, against the bare queue underneath and against crossbeam's, in one
//! thread and across two.

use std::hint::black_box;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use container::port::{connection, overwriting_queue};
use criterion::{BenchmarkGroup, Criterion, measurement::WallTime};
use crossbeam::queue::ArrayQueue;
use system_model::specification::QueuePolicy;

/// Places of the FIFOs.
const CAPACITY: usize = 16;

/// Data that cross a FIFO in one go between threads: half of its places.
const BURST: u64 = 8;

pub fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("ports");
    sizes::<64>(&mut group);
    sizes::<4096>(&mut group);
    group.finish();
}

fn sizes<const SIZE: usize>(group: &mut BenchmarkGroup<'_, WallTime>) {
    for policy in [QueuePolicy::Last, QueuePolicy::Fifo] {
        let name = if policy == QueuePolicy::Last {
            "last"
        } else {
            "fifo"
        };
        measure::<SIZE, _, _>(group, &format!("{name}_port"), || port(policy, SIZE));
        match policy {
            QueuePolicy::Last => {
                measure::<SIZE, _, _>(group, "last_bare", bare_last::<SIZE>);
                measure::<SIZE, _, _>(group, "last_crossbeam", || crossbeam_queue::<SIZE>(1));
            }
            _ => {
                measure::<SIZE, _, _>(group, "fifo_bare", bare_fifo::<SIZE>);
                measure::<SIZE, _, _>(group, "fifo_rtrb", rtrb_fifo::<SIZE>);
                measure::<SIZE, _, _>(group, "fifo_crossbeam", || {
                    crossbeam_queue::<SIZE>(CAPACITY)
                });
            }
        }
    }
}

fn measure<const SIZE: usize, Put, Get>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    make: impl Fn() -> (Put, Get),
) where
    Put: FnMut(&[u8; SIZE]) -> bool + Send + 'static,
    Get: FnMut(&mut [u8; SIZE]) -> bool + Send + 'static,
{
    group.bench_function(format!("{name}_{SIZE}_same_thread"), |bencher| {
        let (mut put, mut get) = make();
        let datum = [7u8; SIZE];
        let mut taken = [0u8; SIZE];
        bencher.iter(|| {
            put(black_box(&datum));
            black_box(get(&mut taken));
            black_box(&taken);
        });
    });
    group.bench_function(format!("{name}_{SIZE}_across_threads"), |bencher| {
        let burst = if name.starts_with("last") { 1 } else { BURST };
        bencher.iter_custom(|count| across(make(), burst, count));
    });
}

/// The two threads take turns by a flag of their own: the writer puts a burst, the reader gets it.
/// So no queue gains by dropping, and none is polled while the other side works on it, which makes
/// times jump by a factor of ten with the slightest change of pace.
fn across<const SIZE: usize, Put, Get>(
    (mut put, mut get): (Put, Get),
    burst: u64,
    count: u64,
) -> Duration
where
    Put: FnMut(&[u8; SIZE]) -> bool + Send + 'static,
    Get: FnMut(&mut [u8; SIZE]) -> bool + Send + 'static,
{
    let turns = count.div_ceil(burst);
    let turn = Arc::new(AtomicU64::new(0));
    let flag = Arc::clone(&turn);
    let reader = std::thread::spawn(move || {
        let mut taken = [0u8; SIZE];
        for number in 0..turns {
            wait_for(&flag, 2 * number + 1);
            for _ in 0..burst {
                assert!(get(&mut taken), "what was put is there");
                // Or nobody would ever look at the content, and only some queues would fetch it.
                black_box(&taken);
            }
            flag.store(2 * number + 2, Ordering::Release);
        }
    });
    let datum = [7u8; SIZE];
    let start = Instant::now();
    for number in 0..turns {
        for _ in 0..burst {
            put(&datum);
        }
        turn.store(2 * number + 1, Ordering::Release);
        wait_for(&turn, 2 * number + 2);
    }
    let time = start.elapsed();
    reader.join().expect("the reader does not panic");
    // Whole bursts may be more than what was asked for.
    time.mul_f64(count as f64 / (turns * burst) as f64)
}

fn wait_for(flag: &AtomicU64, value: u64) {
    while flag.load(Ordering::Acquire) != value {
        std::hint::spin_loop();
    }
}

fn port<const SIZE: usize>(
    policy: QueuePolicy,
    size: usize,
) -> (
    impl FnMut(&[u8; SIZE]) -> bool + Send + 'static,
    impl FnMut(&mut [u8; SIZE]) -> bool + Send + 'static,
) {
    let (mut sender, mut receiver) = connection(policy, CAPACITY, size);
    let put = move |datum: &[u8; SIZE]| {
        sender.send(1, 1, |bytes| {
            bytes.copy_from_slice(datum);
            true
        })
    };
    let get = move |taken: &mut [u8; SIZE]| {
        receiver
            .receive()
            .map(|datum| taken.copy_from_slice(datum.bytes()))
            .is_some()
    };
    (put, get)
}

fn bare_last<const SIZE: usize>() -> (
    impl FnMut(&[u8; SIZE]) -> bool + Send + 'static,
    impl FnMut(&mut [u8; SIZE]) -> bool + Send + 'static,
) {
    let (mut input, mut output) = triple_buffer::triple_buffer(&[0u8; SIZE]);
    let put = move |datum: &[u8; SIZE]| {
        input.input_buffer_mut().copy_from_slice(datum);
        input.publish();
        true
    };
    let get = move |taken: &mut [u8; SIZE]| {
        let new = output.update();
        if new {
            taken.copy_from_slice(output.output_buffer());
        }
        new
    };
    (put, get)
}

fn bare_fifo<const SIZE: usize>() -> (
    impl FnMut(&[u8; SIZE]) -> bool + Send + 'static,
    impl FnMut(&mut [u8; SIZE]) -> bool + Send + 'static,
) {
    let (mut writer, mut reader) = overwriting_queue::queue(CAPACITY, &[0u8; SIZE]);
    let put = move |datum: &[u8; SIZE]| {
        *writer.slot() = *datum;
        !writer.publish()
    };
    let get = move |taken: &mut [u8; SIZE]| reader.take().map(|datum| *taken = *datum).is_some();
    (put, get)
}

/// As a floor: a queue that cannot drop the oldest.
fn rtrb_fifo<const SIZE: usize>() -> (
    impl FnMut(&[u8; SIZE]) -> bool + Send + 'static,
    impl FnMut(&mut [u8; SIZE]) -> bool + Send + 'static,
) {
    let (mut producer, mut consumer) = rtrb::RingBuffer::<[u8; SIZE]>::new(CAPACITY);
    let put = move |datum: &[u8; SIZE]| producer.push(*datum).is_ok();
    let get = move |taken: &mut [u8; SIZE]| consumer.pop().map(|datum| *taken = datum).is_ok();
    (put, get)
}

fn crossbeam_queue<const SIZE: usize>(
    capacity: usize,
) -> (
    impl FnMut(&[u8; SIZE]) -> bool + Send + 'static,
    impl FnMut(&mut [u8; SIZE]) -> bool + Send + 'static,
) {
    let queue = Arc::new(ArrayQueue::<[u8; SIZE]>::new(capacity));
    let reader = Arc::clone(&queue);
    let put = move |datum: &[u8; SIZE]| queue.force_push(*datum).is_none();
    let get = move |taken: &mut [u8; SIZE]| reader.pop().map(|datum| *taken = datum).is_some();
    (put, get)
}
