//! What the machine around a supervised run hears and is told.

use std::os::unix::net::UnixDatagram;

use rustix::process::Signal;
use tests::{Supervised, Watched, until};

use super::{LIMIT, PATIENT, application, start, wait_until_running};

/// A plain file is no watchdog, but takes the same bytes.
#[test]
fn a_hardware_watchdog_is_disarmed_only_at_an_orderly_end() {
    for (killed, expected_code, disarmed) in [(false, 0, true), (true, 7, false)] {
        let application = application();
        let device = application.write("watchdog", "");
        let device_name = device.display().to_string();
        let run = start(
            &application,
            &["--restarts", "0", "--hardware-watchdog", &device_name],
        );
        wait_until_running(&application, 1);
        let finished = if killed {
            let container = Supervised::by(&run).container(None);
            Supervised::signal(container, Signal::KILL);
            run.wait(LIMIT)
        } else {
            run.signal(Signal::TERM);
            run.wait(LIMIT)
        };
        assert_eq!(finished.code, Some(expected_code), "{finished}");
        let written = std::fs::read(&device).expect("it is there");
        assert!(written.starts_with(&[0]), "it was fed");
        assert_eq!(written.ends_with(b"V"), disarmed, "{written:?}");
    }
}

#[test]
fn a_service_manager_hears_what_becomes_of_the_run() {
    let application = application();
    let path = application.folder().join("notify");
    let socket = UnixDatagram::bind(&path).expect("a socket");
    socket.set_nonblocking(true).expect("it does not wait");
    let arguments = ["--supervised", "--supervision-timeout", PATIENT];
    let mut command = application.command(&[application.profile()], &arguments);
    command
        .env("NOTIFY_SOCKET", &path)
        .env("WATCHDOG_USEC", "400000");
    let run = Watched::spawn(&mut command);
    let mut heard = Vec::new();
    let mut listen = |wanted: &str, from: usize| {
        let came = until(LIMIT, || {
            let mut buffer = [0; 256];
            while let Ok(length) = socket.recv(&mut buffer) {
                heard.push(String::from_utf8_lossy(&buffer[..length]).into_owned());
            }
            heard[from.min(heard.len())..]
                .iter()
                .any(|it| it.contains(wanted))
        });
        assert!(came, "{wanted} is not among {heard:?}");
        heard.len()
    };
    let ready = listen("READY=1", 0);
    listen("WATCHDOG=1", ready);
    let container = Supervised::by(&run).container(None);
    Supervised::signal(container, Signal::KILL);
    let back = listen("STATUS=running, 1 restarts", ready);
    listen("WATCHDOG=1", back);
    run.signal(Signal::TERM);
    listen("STOPPING=1", back);
    let finished = run.wait(LIMIT);
    assert_eq!(finished.code, Some(0), "{finished}");
}

/// A plain file takes the bytes that an actuator would.
#[test]
fn an_actuator_is_told_to_be_safe_while_no_container_runs() {
    let application = application();
    let device = application.write("actuator", "");
    let application = application.rules(&format!(
        "<component name='recorder'><actuator stop_category='0'>
           <command port='input' safe_value='0'/>
           <safe_state device='{}' bytes='02 10' period='10'/>
         </actuator></component>",
        device.display()
    ));
    let run = start(&application, &[]);
    wait_until_running(&application, 1);
    let written = || std::fs::read(&device).expect("it is there");
    assert_eq!(written(), b"", "the container runs");
    let container = Supervised::by(&run).container(None);
    Supervised::signal(container, Signal::KILL);
    wait_until_running(&application, 2);
    let told = written();
    assert!(told.len() > 4, "every period: {told:?}");
    assert!(told.chunks(2).all(|command| command == [2, 16]), "{told:?}");
    let outcome = application.interrupt(run).ended_well();
    assert_eq!(written(), told, "and no longer than that");
    let events = outcome.raw_events();
    assert!(events.contains(", safe state on "), "{events}");
}
