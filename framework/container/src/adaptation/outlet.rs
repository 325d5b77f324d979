//! Outputs that somebody of the adaptation listens to: one more connection of the port, so that
//! neither its component nor its readers notice.

use std::collections::VecDeque;
use std::time::Duration;

use fault_manager::detection::NumberReader;

use crate::clock::nanoseconds;
use crate::port::Receiver;

use super::wiring::PortKey;

/// What is known of an output.
pub struct Outlet {
    /// Which output.
    pub key: PortKey,
    /// Its data; each is kept until it was looked at.
    receiver: Receiver,
    /// The newest datum.
    newest: Option<Heard>,
    /// Numbers of which the last ones are kept.
    windows: Vec<Window>,
    /// Data of before are forgotten.
    since_ns: u64,
}

/// A datum as it came.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Heard {
    /// When it was written, in nanoseconds of the container's clock.
    pub stamp_ns: u64,
    /// Incarnation of its writer.
    pub incarnation: u32,
    /// The content.
    pub bytes: Vec<u8>,
}

/// The last values of a number.
struct Window {
    reader: NumberReader,
    length: usize,
    values: VecDeque<f64>,
}

impl Outlet {
    /// Nothing heard yet.
    pub fn new(key: PortKey, receiver: Receiver) -> Self {
        Self {
            key,
            receiver,
            newest: None,
            windows: Vec::new(),
            since_ns: 0,
        }
    }

    /// The last values of a number are kept from now on; by which index they are asked for.
    pub fn keep(&mut self, reader: NumberReader, length: usize) -> usize {
        self.windows.push(Window {
            reader,
            length,
            values: VecDeque::with_capacity(length),
        });
        self.windows.len() - 1
    }

    /// Takes what has come since the last time; whether anything has.
    pub fn listen(&mut self) -> bool {
        let mut any = false;
        while let Some(datum) = self.receiver.receive() {
            if datum.stamp_ns() < self.since_ns {
                continue;
            }
            any = true;
            for window in &mut self.windows {
                window.take(datum.bytes());
            }
            let heard = self.newest.get_or_insert_with(|| Heard {
                stamp_ns: 0,
                incarnation: 0,
                bytes: Vec::new(),
            });
            heard.stamp_ns = datum.stamp_ns();
            heard.incarnation = datum.incarnation();
            heard.bytes.clear();
            heard.bytes.extend_from_slice(datum.bytes());
        }
        any
    }

    /// Forgets all that was written before this time.
    pub fn forget_before(&mut self, time_ns: u64) {
        self.since_ns = time_ns;
        if self.newest.as_ref().is_some_and(|it| it.stamp_ns < time_ns) {
            self.newest = None;
        }
        for window in &mut self.windows {
            window.values.clear();
        }
    }

    /// The newest datum.
    pub fn newest(&self) -> Option<&Heard> {
        self.newest.as_ref()
    }

    /// How old the newest datum is at this time; where there is none, how long none has come.
    pub fn age(&self, now: Duration) -> Duration {
        let stamp_ns = self.newest.as_ref().map_or(self.since_ns, |it| it.stamp_ns);
        Duration::from_nanos(nanoseconds(now).saturating_sub(stamp_ns))
    }

    /// The standard deviation of a number, once its window is full.
    pub fn deviation(&self, window: usize) -> Option<f64> {
        let window = self.windows.get(window)?;
        (window.values.len() >= window.length)
            .then(|| standard_deviation(window.values.iter().copied()))
    }
}

impl Window {
    fn take(&mut self, bytes: &[u8]) {
        if self.values.len() >= self.length {
            self.values.pop_front();
        }
        self.values.push_back(self.reader.read(bytes));
    }
}

/// Of a sample: by one less than the number of values, which is two at least.
fn standard_deviation(values: impl Iterator<Item = f64> + Clone) -> f64 {
    #[allow(clippy::cast_precision_loss)] // a window is no longer than 60 000
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    let squares: f64 = values.map(|value| (value - mean).powi(2)).sum();
    (squares / (count - 1.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use system_model::data_type::{DataType, Field, Scalar};
    use system_model::specification::QueuePolicy;

    use super::*;
    use crate::port::{Sender, connection};

    fn outlet() -> (Sender, Outlet) {
        let (sender, receiver) = connection(QueuePolicy::Fifo, 8, 8);
        let key = PortKey {
            component: 0,
            port: "out".into(),
        };
        (sender, Outlet::new(key, receiver))
    }

    fn reader() -> NumberReader {
        let number = DataType {
            name: "Number".into(),
            size: 8,
            layout_hash: 0,
            fields: vec![Field {
                path: "value".into(),
                unit: String::new(),
                offset: 0,
                scalar: Scalar::F64,
                count: 1,
            }],
        };
        NumberReader::compile(&number, None, 0).expect("a number")
    }

    fn send(sender: &mut Sender, stamp_ns: u64, value: f64) {
        sender.send(stamp_ns, 1, |bytes| {
            bytes.copy_from_slice(&value.to_ne_bytes());
            true
        });
    }

    #[test]
    fn the_deviation_is_of_the_last_values_only() {
        let (mut sender, mut outlet) = outlet();
        let window = outlet.keep(reader(), 3);
        for (stamp, value) in [(1, 100.0), (2, 1.0), (3, 2.0)] {
            send(&mut sender, stamp, value);
            assert_eq!(outlet.deviation(window), None);
        }
        send(&mut sender, 4, 3.0);
        assert!(outlet.listen() && !outlet.listen());
        assert_eq!(outlet.deviation(window), Some(1.0));
    }

    #[test]
    fn what_was_written_before_a_change_is_forgotten() {
        let (mut sender, mut outlet) = outlet();
        send(&mut sender, 10, 1.0);
        assert!(outlet.listen());
        assert_eq!(outlet.age(Duration::from_nanos(30)).as_nanos(), 20);
        outlet.forget_before(20);
        assert_eq!(outlet.newest(), None);
        send(&mut sender, 19, 1.0);
        assert!(!outlet.listen());
        assert_eq!(outlet.age(Duration::from_nanos(30)).as_nanos(), 10);
        send(&mut sender, 20, 2.0);
        assert!(outlet.listen());
        assert_eq!(outlet.newest().map(|it| it.stamp_ns), Some(20));
    }
}
