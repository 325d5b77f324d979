//! `steadfast run --metrics`: figures for Prometheus, scraped and parsed; and `--foxglove` in a build
//! without it.

use std::collections::BTreeMap;
use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::time::Duration;

use tests::{Application, Member, until};

/// Longer than anything here takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

fn application() -> Application {
    Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("recorder", "recorder"))
        .connect("data", "counter.output", "recorder.input")
}

/// An address that nobody listens at.
fn free_address() -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").expect("there is a free port");
    listener.local_addr().expect("it has an address")
}

/// What is answered to this.
fn ask(address: SocketAddr, request: &str) -> Option<String> {
    let mut stream = TcpStream::connect(address).ok()?;
    stream.set_read_timeout(Some(PATIENCE)).ok()?;
    stream.write_all(request.as_bytes()).ok()?;
    let mut answer = String::new();
    stream.read_to_string(&mut answer).ok()?;
    Some(answer)
}

/// Figures by name and labels; comments left out.
fn scrape(address: SocketAddr) -> Option<BTreeMap<String, f64>> {
    let answer = ask(address, "GET /metrics HTTP/1.1\r\nHost: robot\r\n\r\n")?;
    let (head, body) = answer.split_once("\r\n\r\n").expect("a head and a body");
    assert!(head.starts_with("HTTP/1.1 200 OK"), "{head}");
    assert!(head.contains("application/openmetrics-text"), "{head}");
    assert!(body.ends_with("# EOF\n"), "it is whole");
    let figures = body
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| {
            let (name, figure) = line.rsplit_once(' ').expect("name and figure");
            (name.to_owned(), figure.parse().expect("a number"))
        });
    Some(figures.collect())
}

#[test]
fn figures_are_scraped_while_a_component_fails_and_recovers() {
    let application = application();
    let address = free_address();
    let run = application.start(&["--metrics", &address.to_string()]);
    let operator = application.operator();
    operator.socket();
    let figures = || scrape(address).unwrap_or_default();
    assert!(until(PATIENCE, || !figures().is_empty()), "nobody answers");
    let counter = |name: &str| format!("steadfast_component_{name}{{component=\"counter\"}}");
    let cycles = counter("cycles_total");
    let before = figures()[&cycles];
    assert!(
        until(PATIENCE, || figures()[&cycles] > before),
        "it stands still"
    );
    operator.answer(&["inject", "<inject component='counter' fault='panic'/>"]);
    let recovered = counter("recovery_duration_seconds_count");
    let has_recovered = || figures().get(&recovered) == Some(&1.0);
    assert!(
        until(PATIENCE, has_recovered),
        "no recovery: {:#?}",
        figures()
    );
    let after = figures();
    let faults = "steadfast_component_faults_total{component=\"counter\",kind=\"panic\"}";
    assert_eq!(after[faults], 1.0);
    assert_eq!(after[&counter("incarnation")], 2.0);
    let state = |state: &str| {
        after[&format!("steadfast_component_state{{component=\"counter\",state=\"{state}\"}}")]
    };
    assert_eq!((state("ACTIVE"), state("ERROR")), (1.0, 0.0));
    let drops =
        "steadfast_port_data_dropped_total{source=\"counter.output\",target=\"recorder.input\"}";
    assert!(after.contains_key(drops), "{after:#?}");
    let sum = after[&counter("recovery_duration_seconds_sum")];
    assert!(sum > 0.0 && sum < 60.0, "in seconds: {sum}");
    let _outcome = application.interrupt(run).ended_well();
    assert!(TcpStream::connect(address).is_err(), "it ends with the run");
}

#[test]
fn slow_and_foolish_clients_change_nothing() {
    let application = application();
    let address = free_address();
    let run = application.start(&["--metrics", &address.to_string()]);
    application.operator().socket();
    assert!(
        until(PATIENCE, || scrape(address).is_some()),
        "nobody answers"
    );
    let silent: Vec<TcpStream> = (0..3)
        .filter_map(|_| TcpStream::connect(address).ok())
        .collect();
    for (request, status) in [
        ("GET /other HTTP/1.1\r\n\r\n", "404"),
        ("POST /metrics HTTP/1.1\r\n\r\n", "405"),
        ("nonsense\r\n\r\n", "400"),
    ] {
        let answer = ask(address, request).expect("an answer");
        assert!(
            answer.starts_with(&format!("HTTP/1.1 {status}")),
            "{answer}"
        );
    }
    let endless = "a".repeat(100_000);
    let _may_be_cut_off = ask(address, &endless);
    assert!(scrape(address).is_some(), "it goes on");
    drop(silent);
    let _outcome = application.interrupt(run).ended_well();
}

#[test]
fn an_address_that_is_taken_is_refused_before_anything_runs() {
    let application = application();
    let taken = TcpListener::bind("127.0.0.1:0").expect("there is a free port");
    let address = taken.local_addr().expect("it has an address").to_string();
    let outcome = application.run(&["--for", "1s", "--metrics", &address]);
    let finished = outcome.finished();
    assert_eq!(finished.code, Some(6), "{finished}");
    assert!(
        finished.stderr.contains("choose another port"),
        "{finished}"
    );
}

#[test]
fn foxglove_is_refused_in_words_by_a_build_without_it() {
    let outcome = application().run(&["--for", "1s", "--foxglove"]);
    let finished = outcome.finished();
    assert_eq!(finished.code, Some(6), "{finished}");
    assert!(
        finished.stderr.contains("--features container/foxglove"),
        "{finished}"
    );
}
