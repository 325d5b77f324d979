//! Ports as a whole: what each policy keeps, and what of a dead writer or reader is left.

use super::*;

fn put(sender: &mut Sender, value: u8) {
    assert!(sender.send(u64::from(value), 1, |bytes| {
        bytes.fill(value);
        true
    }));
}

fn all(receiver: &mut Receiver) -> Vec<u8> {
    let mut found = Vec::new();
    while let Some(datum) = receiver.receive() {
        found.push(datum.bytes()[0]);
    }
    found
}

#[test]
fn each_policy_keeps_what_it_should() {
    type Case = (QueuePolicy, usize, &'static [u8], &'static [u8], u64);
    let cases: [Case; 5] = [
        (QueuePolicy::Last, 1, &[1, 2, 3], &[3], 0),
        (QueuePolicy::Fifo, 3, &[1, 2], &[1, 2], 0),
        (QueuePolicy::Fifo, 3, &[1, 2, 3, 4, 5], &[3, 4, 5], 2),
        (QueuePolicy::Lifo, 3, &[1, 2, 3], &[3, 2, 1], 0),
        (QueuePolicy::Lifo, 2, &[1, 2, 3, 4], &[4, 3], 2),
    ];
    for (policy, size, sent, expected, dropped) in cases {
        let (mut sender, mut receiver) = connection(policy, size, 8);
        assert!(receiver.receive().is_none(), "{policy:?} starts empty");
        for value in sent {
            put(&mut sender, *value);
        }
        assert_eq!(all(&mut receiver), expected, "{policy:?} of {size}");
        assert_eq!(receiver.dropped(), dropped, "{policy:?} of {size}");
    }
}

#[test]
fn a_fill_that_fails_sends_nothing() {
    for policy in [QueuePolicy::Last, QueuePolicy::Fifo, QueuePolicy::Lifo] {
        let (mut sender, mut receiver) = connection(policy, 4, 8);
        assert!(!sender.send(0, 1, |_bytes| false));
        assert!(receiver.receive().is_none());
    }
}

#[test]
fn what_an_older_incarnation_sent_is_not_delivered() {
    for policy in [QueuePolicy::Last, QueuePolicy::Fifo, QueuePolicy::Lifo] {
        let (mut sender, mut receiver) = connection(policy, 4, 8);
        put(&mut sender, 1);
        sender.succeed(2);
        assert!(receiver.receive().is_none(), "{policy:?}");
        put(&mut sender, 2);
        assert!(
            receiver.receive().is_none(),
            "{policy:?}: still the old one"
        );
        let sent = sender.send(3, 2, |bytes| {
            bytes.fill(3);
            true
        });
        assert!(sent);
        assert_eq!(all(&mut receiver), [3], "{policy:?}");
    }
}

#[test]
fn a_datum_is_given_to_a_second_incarnation_and_to_no_third() {
    for policy in [QueuePolicy::Last, QueuePolicy::Fifo, QueuePolicy::Lifo] {
        let (mut sender, mut receiver) = connection(policy, 4, 8);
        put(&mut sender, 7);
        assert!(receiver.receive().is_some());
        assert_eq!(receiver.leave(), Leftover::Again, "{policy:?}");
        assert_eq!(all(&mut receiver), [7], "{policy:?}: once more, only once");
        assert_eq!(
            receiver.leave(),
            Leftover::SetAside { stamp_ns: 7 },
            "{policy:?}"
        );
        assert!(receiver.receive().is_none(), "{policy:?}");
        put(&mut sender, 8);
        assert_eq!(all(&mut receiver), [8], "{policy:?}");
        assert_eq!(receiver.leave(), Leftover::Again, "{policy:?}: another one");
    }
}

#[test]
fn a_newer_last_value_wins_over_one_that_was_in_work() {
    let (mut sender, mut receiver) = connection(QueuePolicy::Last, 1, 8);
    put(&mut sender, 1);
    assert!(receiver.receive().is_some());
    receiver.leave();
    put(&mut sender, 2);
    assert_eq!(all(&mut receiver), [2]);
}

#[test]
fn clearing_forgets_what_had_arrived() {
    for policy in [QueuePolicy::Last, QueuePolicy::Fifo, QueuePolicy::Lifo] {
        let (mut sender, mut receiver) = connection(policy, 4, 8);
        put(&mut sender, 1);
        receiver.clear();
        assert!(receiver.receive().is_none());
        put(&mut sender, 2);
        assert_eq!(all(&mut receiver), [2]);
    }
}
