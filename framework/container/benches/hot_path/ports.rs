//! Put and get through a port, against the bare queue underneath and against crossbeam's, in one
//! thread and across two.

use std::hint::black_box;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use container::port::connection;
use criterion::{BenchmarkGroup, Criterion, measurement::WallTime};
use crossbeam::queue::ArrayQueue;
use system_model::specification::QueuePolicy;

/// Places of the FIFOs.
const CAPACITY: usize = 16;

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
        bencher.iter_custom(|count| across(make(), count));
    });
}

/// One message on its way at a time, so that no queue can gain by dropping: the writer puts the
/// next when the reader says that it has got the last.
fn across<const SIZE: usize, Put, Get>((mut put, mut get): (Put, Get), count: u64) -> Duration
where
    Put: FnMut(&[u8; SIZE]) -> bool + Send + 'static,
    Get: FnMut(&mut [u8; SIZE]) -> bool + Send + 'static,
{
    let received = Arc::new(AtomicU64::new(0));
    let seen = Arc::clone(&received);
    let reader = std::thread::spawn(move || {
        let mut taken = [0u8; SIZE];
        let mut number = 0;
        while number < count {
            if get(&mut taken) {
                number += 1;
                seen.store(number, Ordering::Release);
            }
            std::hint::spin_loop();
        }
    });
    let datum = [7u8; SIZE];
    let start = Instant::now();
    for number in 0..count {
        put(&datum);
        while received.load(Ordering::Acquire) <= number {
            std::hint::spin_loop();
        }
    }
    let time = start.elapsed();
    reader.join().expect("the reader does not panic");
    time
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
            .map(|datum| taken.copy_from_slice(&datum.bytes))
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
