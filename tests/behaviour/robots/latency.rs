//! How long data are under way between two containers, beside what zenoh alone takes.

use std::sync::mpsc::channel;
use std::time::{SystemTime, UNIX_EPOCH};

use serde_json::json;
use zenoh::Wait as _;
use zenoh::qos::{CongestionControl, Priority};

use super::*;

/// Both send every 10 ms, small and large by turns.
const PERIOD: Duration = Duration::from_millis(10);
/// 500 of each size.
const TIMES: usize = 1000;
const SIZES: [(&str, usize); 2] = [("small", 64), ("large", 57_600)];

/// Number of times, and the times that half and 99 of 100 do not exceed, in nanoseconds.
type Figures = (usize, u64, u64);

fn now_ns() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    u64::try_from(since.expect("after 1970").as_nanos()).expect("before 2554")
}

fn session(address: &str, listens: bool) -> zenoh::Session {
    let mut config = zenoh::Config::default();
    let (own, other) = if listens {
        ("listen", "connect")
    } else {
        ("connect", "listen")
    };
    for (key, value) in [
        (&*format!("{own}/endpoints"), json!([address])),
        (&*format!("{other}/endpoints"), json!([])),
        ("scouting/multicast/enabled", json!(false)),
        ("scouting/gossip/enabled", json!(false)),
    ] {
        let set = config.insert_json5(key, &value.to_string());
        set.unwrap_or_else(|error| panic!("{key}: {error}"));
    }
    zenoh::open(config).wait().expect("a session")
}

/// From a put to the callback, between two sessions over loopback, with what the container's
/// publishers are set to.
fn bare() -> [Figures; 2] {
    let address = format!("tcp/127.0.0.1:{}", free_port());
    let (receiving, sending) = (session(&address, true), session(&address, false));
    let (sender, times) = channel();
    let subscriber = receiving
        .declare_subscriber("bare/*")
        .callback(move |sample| {
            let bytes = sample.payload().to_bytes();
            let sent = bytes[..8].try_into().map(u64::from_le_bytes);
            let took = now_ns().saturating_sub(sent.expect("eight bytes"));
            let _over = sender.send((bytes.len(), took));
        })
        .wait();
    let _subscriber = subscriber.expect("a subscriber");
    let publishers = SIZES.map(|(name, size)| {
        let publisher = sending
            .declare_publisher(format!("bare/{name}"))
            .congestion_control(CongestionControl::Drop)
            .priority(Priority::RealTime)
            .express(true)
            .wait();
        (publisher.expect("a publisher"), vec![9; size])
    });
    for number in 0..TIMES {
        std::thread::sleep(PERIOD);
        let (publisher, bytes) = &publishers[number % 2];
        let mut bytes = bytes.clone();
        bytes[..8].copy_from_slice(&now_ns().to_le_bytes());
        publisher.put(bytes).wait().expect("sent");
    }
    std::thread::sleep(PERIOD);
    let times: Vec<(usize, u64)> = times.try_iter().collect();
    SIZES.map(|(_, size)| {
        let of_size = times.iter().filter(|(length, _)| *length == size);
        let mut of_size: Vec<u64> = of_size.map(|(_, took)| *took).collect();
        of_size.sort_unstable();
        let at = |part: usize| of_size[of_size.len() * part / 100];
        (of_size.len(), at(50), at(99))
    })
}

/// What the timekeeper says of a size.
fn measured(logs: &[String], name: &str) -> Figures {
    let said = logs
        .iter()
        .find_map(|log| log.strip_prefix(&format!("{name}: ")));
    let said = said.unwrap_or_else(|| panic!("no times of {name}: {logs:?}"));
    let numbers: Vec<u64> = said
        .split(' ')
        .map(|it| it.parse().expect("a number"))
        .collect();
    let count = usize::try_from(numbers[0]).expect("few");
    (count, numbers[1], numbers[2])
}

/// From the moment before a component writes to that at which a component of another robot, woken by
/// the datum, has read it.
#[test]
#[ignore = "a measurement of ten seconds that nothing else may disturb"]
fn from_port_to_port_takes_at_most_twice_what_zenoh_takes() {
    let _turn = take_turn();
    let (one, other) = (free_port(), free_port());
    let names = SIZES.map(|(name, _)| name);
    let offers = names.map(|it| format!("<offer component_name='stamper' port_name='{it}'/>"));
    let sources = names.map(|it| {
        format!(
            "<remote_connection><source robot='R1' component_name='stamper' port_name='{it}'/>
             <target component_name='timekeeper' port_name='{it}'/></remote_connection>"
        )
    });
    let ports = |usage: &str| {
        let kinds = [("small", "SmallStamp"), ("large", "LargeStamp")];
        kinds
            .map(|(name, kind)| {
                format!(
                    "<data_port><name>{name}</name><usage>{usage}</usage>\
                     <data_type>{kind}</data_type></data_port>"
                )
            })
            .concat()
    };
    let stamper = Member::new("stamper", "stamper").ports(&ports("output"));
    let timekeeper = Member::new("timekeeper", "timekeeper").ports(&ports("input"));
    let first =
        Application::new()
            .with(&stamper)
            .element(&network("R1", one, &[], &offers.concat()));
    let second = Application::new()
        .with(&timekeeper.kind("aperiodic").queue("FIFO", 4))
        .element(&network("R2", other, &[one], &sources.concat()));
    let (_first, run) = (start(&first), start(&second));
    wait_for(&second, "R1 decides", 1);
    let bare = bare();
    run.signal(Signal::INT);
    let outcome = second.outcome(run.wait(Duration::from_secs(30)));
    let logs = outcome.ended_well().logs("timekeeper");
    for ((name, size), (times, p50, p99)) in SIZES.into_iter().zip(bare) {
        let (own_times, own_p50, own_p99) = measured(&logs, name);
        #[allow(clippy::cast_precision_loss)] // nanoseconds of a second
        let ratio = own_p50 as f64 / p50 as f64;
        println!(
            "{size} bytes: bare zenoh p50 {p50} ns, p99 {p99} ns ({times} times); port to port p50 \
             {own_p50} ns, p99 {own_p99} ns ({own_times} times); p50 {ratio:.2} x"
        );
        assert!(times > TIMES / 4 && own_times > TIMES / 4, "too few times");
        assert!(ratio <= 2.0, "{size} bytes take {ratio:.2} times as long");
    }
}
