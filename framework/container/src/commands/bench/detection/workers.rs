//! Independent pieces of work on all processors, results in order.

use std::io;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;

/// The results of `work` for 0 to `count` - 1.
///
/// # Errors
/// The first one of a piece of work, by its number.
pub(super) fn in_parallel<T: Send>(
    count: u64,
    work: impl Fn(u64) -> io::Result<T> + Sync,
) -> io::Result<Vec<T>> {
    let next = AtomicU64::new(0);
    let results = Mutex::new(Vec::new());
    let worker = || {
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= count {
                return;
            }
            let result = work(number);
            if let Ok(mut results) = results.lock() {
                results.push((number, result));
            }
        }
    };
    let processors = thread::available_parallelism().map_or(1, usize::from);
    thread::scope(|scope| {
        for _ in 0..processors {
            scope.spawn(worker);
        }
    });
    let mut results = results
        .into_inner()
        .map_err(|_| io::Error::other("a worker panicked"))?;
    results.sort_by_key(|(number, _)| *number);
    results.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_in_order_and_the_first_error_counts() {
        let squares = in_parallel(100, |number| Ok(number * number)).expect("no error");
        assert!(
            squares
                .iter()
                .enumerate()
                .all(|(number, square)| (number * number) as u64 == *square)
        );
        let failed = in_parallel(100, |number| match number % 40 {
            30 => Err(io::Error::other(number.to_string())),
            _ => Ok(()),
        });
        assert_eq!(failed.expect_err("an error").to_string(), "30");
    }
}
