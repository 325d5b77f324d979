//! Lines: opening, cutting off, unplugging, filling up, and the pseudo-terminal.

use std::fs::File;
use std::io::{ErrorKind, Read, Write};
use std::os::fd::AsFd;
use std::time::{Duration, Instant};

use nix::fcntl::{FcntlArg, FdFlag, OFlag, fcntl};
use robot_interface::camera_stream::{PictureDecoder, frame_length};
use robot_interface::serial_line::{Decoder, Message, encode};
use robot_simulation::{CAMERA, MOTION_BOARD, Side, Simulation, Transport};

use crate::driver::{empty_world, wheels};

fn simulation() -> Simulation {
    Simulation::new(&empty_world(), 1).expect("a good world")
}

fn open(simulation: &mut Simulation, device: &str, transport: Transport) -> File {
    File::from(simulation.open(device, transport).expect("a device"))
}

/// All that is there now; the second value is true when the line has ended.
fn read_all(line: &mut File) -> (Vec<u8>, bool) {
    let mut received = Vec::new();
    let mut buffer = [0; 4096];
    loop {
        match line.read(&mut buffer) {
            Ok(0) => return (received, true),
            Ok(length) => received.extend_from_slice(&buffer[..length]),
            Err(error) if error.kind() == ErrorKind::WouldBlock => return (received, false),
            Err(_) => return (received, true),
        }
    }
}

#[test]
fn a_component_end_never_blocks_and_is_not_inherited() {
    let mut simulation = simulation();
    for (device, transport) in [
        (MOTION_BOARD, Transport::InProcess),
        (MOTION_BOARD, Transport::PseudoTerminal),
        (CAMERA, Transport::PseudoTerminal),
    ] {
        let line = simulation.open(device, transport).expect("a device");
        let status = fcntl(line.as_fd(), FcntlArg::F_GETFL).expect("status flags");
        assert!(OFlag::from_bits_retain(status).contains(OFlag::O_NONBLOCK));
        let descriptor = fcntl(line.as_fd(), FcntlArg::F_GETFD).expect("descriptor flags");
        assert!(FdFlag::from_bits_retain(descriptor).contains(FdFlag::FD_CLOEXEC));
    }
}

#[test]
fn opening_again_cuts_the_old_end_off() {
    let mut simulation = simulation();
    let mut old = open(&mut simulation, MOTION_BOARD, Transport::InProcess);
    let mut new = open(&mut simulation, MOTION_BOARD, Transport::InProcess);
    assert_eq!(read_all(&mut old), (Vec::new(), true));
    simulation.advance_to(Duration::from_millis(100));
    assert_eq!(Decoder::new().push(&read_all(&mut new).0).len(), 5);
}

#[test]
fn an_unplugged_line_ends_and_cannot_be_opened() {
    let mut simulation = simulation();
    for transport in [Transport::InProcess, Transport::PseudoTerminal] {
        let mut line = open(&mut simulation, MOTION_BOARD, transport);
        simulation.unplug(MOTION_BOARD).expect("a device");
        assert!(read_all(&mut line).1, "{transport:?}");
        let refusal = simulation
            .open(MOTION_BOARD, transport)
            .map_err(|error| error.kind());
        assert_eq!(refusal.err(), Some(ErrorKind::NotFound), "{transport:?}");
        simulation.plug_in(MOTION_BOARD).expect("a device");
    }
    assert!(simulation.open("toaster", Transport::InProcess).is_err());
}

#[test]
fn a_full_line_drops_whole_frames() {
    let mut simulation = simulation();
    let mut board = open(&mut simulation, MOTION_BOARD, Transport::InProcess);
    let mut camera = open(&mut simulation, CAMERA, Transport::InProcess);
    simulation.advance_to(Duration::from_secs(60));
    assert!(simulation.dropped_frames(MOTION_BOARD) > Some(0));
    assert!(simulation.dropped_frames(CAMERA) > Some(0));
    // Room again: what was begun is finished, what follows is whole.
    let (mut reports, mut pictures) = (Decoder::new(), PictureDecoder::new());
    reports.push(&read_all(&mut board).0);
    pictures.push(&read_all(&mut camera).0);
    simulation.advance_to(Duration::from_secs(61));
    let now = reports.push(&read_all(&mut board).0);
    let picture = pictures.push(&read_all(&mut camera).0).expect("a picture");
    assert_eq!((reports.bad_frames(), pictures.bad_frames()), (0, 0));
    assert!(now.len() >= 49, "{} reports", now.len());
    assert!(picture.time_stamp_ns > 60_000_000_000);
    assert_eq!(frame_length(picture.width, picture.height), 57_600 + 22);
}

#[test]
fn nobody_at_the_line_is_no_fault() {
    let mut simulation = simulation();
    drop(open(&mut simulation, MOTION_BOARD, Transport::InProcess));
    drop(open(&mut simulation, CAMERA, Transport::InProcess));
    simulation.advance_to(Duration::from_secs(2));
    assert_eq!(simulation.time(), Duration::from_secs(2));
}

#[test]
fn a_pseudo_terminal_carries_both_ways() {
    let mut simulation = simulation();
    drop(open(
        &mut simulation,
        MOTION_BOARD,
        Transport::PseudoTerminal,
    ));
    let path = simulation
        .slave_path(MOTION_BOARD)
        .expect("a path")
        .to_owned();
    let mut line = open(&mut simulation, MOTION_BOARD, Transport::PseudoTerminal);
    assert_eq!(simulation.slave_path(MOTION_BOARD), Some(path.as_path()));
    let mut decoder = Decoder::new();
    let mut reports = Vec::new();
    // The kernel moves the bytes when it likes: the world waits for them, but not for ever.
    let deadline = Instant::now() + Duration::from_secs(20);
    while reports.len() < 100 || simulation.wheel_rpm(Side::Right) < 35.0 {
        assert!(Instant::now() < deadline, "{} reports", reports.len());
        line.write_all(&encode(&Message::Command(wheels(20.0, 40.0))))
            .expect("room");
        simulation.advance_to(simulation.time() + Duration::from_millis(20));
        reports.extend(decoder.push(&read_all(&mut line).0));
        std::thread::yield_now();
    }
    assert_eq!(decoder.bad_frames(), 0);
}

#[test]
fn a_simulation_can_move_to_a_thread() {
    let simulation = simulation();
    let moved = std::thread::spawn(move || {
        let mut simulation = simulation;
        simulation.advance_to(Duration::from_millis(50));
        simulation.time()
    });
    assert_eq!(moved.join().expect("no panic"), Duration::from_millis(50));
}
