//! The main board's end: commands and reports as bytes of a line that never blocks.

use std::io::{self, ErrorKind, Read, Write};

use super::{BoardReport, Decoder, MAXIMUM_FRAME_LENGTH, Message, MotionCommand, encode};

/// Ten reports at a read.
const BUFFER_LENGTH: usize = 10 * MAXIMUM_FRAME_LENGTH;
/// A line that babbles must not keep the component for ever; this is a second of reports.
const READS_MAXIMUM: usize = 5;

/// The line to the motion board.
pub struct BoardLine<Device> {
    device: Device,
    decoder: Decoder,
    /// What is left of a command of which the line took only a part.
    unsent: Vec<u8>,
}

impl<Device: Read + Write> BoardLine<Device> {
    /// A line at its start.
    pub fn new(device: Device) -> Self {
        Self {
            device,
            decoder: Decoder::new(),
            unsent: Vec::with_capacity(MAXIMUM_FRAME_LENGTH),
        }
    }

    /// Reads what has arrived and returns the newest report; none if there is no new one.
    ///
    /// # Errors
    /// What the device says; `UnexpectedEof` when the line has ended.
    pub fn receive(&mut self) -> io::Result<Option<BoardReport>> {
        let mut newest = None;
        let mut buffer = [0; BUFFER_LENGTH];
        for _ in 0..READS_MAXIMUM {
            match self.device.read(&mut buffer) {
                Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
                Ok(length) => {
                    for message in self.decoder.push(&buffer[..length]) {
                        if let Message::Report(report) = message {
                            newest = Some(report);
                        }
                    }
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(newest)
    }

    /// Sends a command. A line that is full loses it: the next one is newer.
    ///
    /// # Errors
    /// What the device says.
    pub fn send(&mut self, command: MotionCommand) -> io::Result<()> {
        self.finish()?;
        if self.unsent.is_empty() {
            let frame = encode(&Message::Command(command));
            let written = self.write(&frame)?;
            if written > 0 {
                self.unsent.extend_from_slice(&frame[written..]);
            }
        }
        Ok(())
    }

    fn finish(&mut self) -> io::Result<()> {
        let unsent = std::mem::take(&mut self.unsent);
        let written = if unsent.is_empty() {
            0
        } else {
            self.write(&unsent)?
        };
        self.unsent.extend_from_slice(&unsent[written..]);
        Ok(())
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.device.write(bytes) {
            Err(error)
                if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) =>
            {
                Ok(0)
            }
            written => written,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::VecDeque;
    use std::os::unix::net::UnixStream;

    use super::*;

    fn line() -> (UnixStream, BoardLine<UnixStream>) {
        let (board, component) = UnixStream::pair().expect("a socket pair");
        component.set_nonblocking(true).expect("a setting");
        (board, BoardLine::new(component))
    }

    fn report(sequence: u16) -> BoardReport {
        BoardReport {
            sequence,
            ..BoardReport::default()
        }
    }

    #[test]
    fn the_newest_report_counts() {
        let (mut board, mut line) = line();
        assert_eq!(line.receive().expect("a live line"), None);
        for sequence in 1..=3 {
            let frame = encode(&Message::Report(report(sequence)));
            board.write_all(&frame).expect("room");
        }
        assert_eq!(line.receive().expect("a live line"), Some(report(3)));
        assert_eq!(line.receive().expect("a live line"), None);
    }

    #[test]
    fn an_unplugged_line_is_an_error() {
        let (board, mut line) = line();
        drop(board);
        let error = line.receive().expect_err("an end");
        assert_eq!(error.kind(), ErrorKind::UnexpectedEof);
    }

    /// Takes as many bytes at each write as it is told.
    struct Narrow {
        room: VecDeque<usize>,
        taken: Vec<u8>,
    }

    impl Read for Narrow {
        fn read(&mut self, _buffer: &mut [u8]) -> io::Result<usize> {
            Err(ErrorKind::WouldBlock.into())
        }
    }

    impl Write for Narrow {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let length = self.room.pop_front().unwrap_or_default().min(bytes.len());
            if length == 0 {
                return Err(ErrorKind::WouldBlock.into());
            }
            self.taken.extend_from_slice(&bytes[..length]);
            Ok(length)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_command_that_was_begun_is_finished_before_the_next() {
        let mut line = BoardLine::new(Narrow {
            room: VecDeque::from([4, 0, 100, 100]),
            taken: Vec::new(),
        });
        let commands = [(10.0, 10.0), (20.0, 20.0), (30.0, 30.0)]
            .map(|(left, right)| MotionCommand::from_wheel_rpm(left, right));
        for command in commands {
            line.send(command).expect("a live line");
        }
        let expected = [commands[0], commands[2]].map(Message::Command);
        assert_eq!(Decoder::new().push(&line.device.taken), expected);
    }
}
