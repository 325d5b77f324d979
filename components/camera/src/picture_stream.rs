//! The newest picture out of the bytes that a camera sends.

use std::io::{self, ErrorKind, Read};

use robot_interface::camera_stream::{Picture, PictureDecoder};
use robot_interface::port_data::{IMAGE_HEIGHT, IMAGE_PIXEL_BYTES, IMAGE_WIDTH, Image};

/// One picture at a read, nearly.
const BUFFER_LENGTH: usize = 64 * 1024;
/// A device that brings bytes faster than they are read must not keep the component for ever:
/// pictures of half a second at ten a second.
const READS_MAXIMUM: usize = 5;

/// A camera's byte stream. Reading never blocks if the device does not.
pub struct PictureStream<Device> {
    device: Device,
    decoder: PictureDecoder,
    buffer: Vec<u8>,
}

impl<Device: Read> PictureStream<Device> {
    /// A stream at its start.
    pub fn new(device: Device) -> Self {
        Self {
            device,
            decoder: PictureDecoder::new(),
            buffer: vec![0; BUFFER_LENGTH],
        }
    }

    /// Reads what has arrived and puts the newest whole picture into `image`; false if there is
    /// none.
    ///
    /// # Errors
    /// What the device says; `UnexpectedEof` when the stream has ended, `InvalidData` for a picture
    /// that is too large for an image.
    pub fn receive(&mut self, image: &mut Image) -> io::Result<bool> {
        let mut newest = None;
        for _ in 0..READS_MAXIMUM {
            match self.device.read(&mut self.buffer) {
                Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
                Ok(length) => newest = self.decoder.push(&self.buffer[..length]).or(newest),
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        newest.map_or(Ok(false), |picture| {
            copy(&picture, image)?;
            Ok(true)
        })
    }
}

fn copy(picture: &Picture, image: &mut Image) -> io::Result<()> {
    let (width, height) = (usize::from(picture.width), usize::from(picture.height));
    if picture.pixels.len() > IMAGE_PIXEL_BYTES {
        let message = format!(
            "pictures of {width} x {height} do not fit into {IMAGE_WIDTH} x {IMAGE_HEIGHT} pixels"
        );
        return Err(io::Error::new(ErrorKind::InvalidData, message));
    }
    image.time = picture.time_stamp_ns;
    image.width = u32::from(picture.width);
    image.height = u32::from(picture.height);
    image.pixels[..picture.pixels.len()].copy_from_slice(&picture.pixels);
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::io::Write;
    use std::os::unix::net::UnixStream;

    use robot_interface::camera_stream::encode;

    use super::*;

    fn picture(width: u16, height: u16, time_stamp_ns: u64) -> Picture {
        Picture {
            width,
            height,
            time_stamp_ns,
            pixels: vec![7; usize::from(width) * usize::from(height) * 3],
        }
    }

    fn line() -> (UnixStream, PictureStream<UnixStream>) {
        let (camera, component) = UnixStream::pair().expect("a socket pair");
        component.set_nonblocking(true).expect("a setting");
        (camera, PictureStream::new(component))
    }

    #[test]
    fn the_newest_whole_picture_counts() {
        let (mut camera, mut stream) = line();
        let mut image = Box::new(Image::empty());
        assert!(!stream.receive(&mut image).expect("a live line"));
        for time_stamp_ns in [1, 2] {
            let frame = encode(&picture(4, 2, time_stamp_ns));
            camera.write_all(&frame).expect("room");
        }
        camera
            .write_all(&encode(&picture(4, 2, 3))[..20])
            .expect("room");
        assert!(stream.receive(&mut image).expect("a live line"));
        assert_eq!((image.time, image.width, image.height), (2, 4, 2));
        assert_eq!(image.used_pixels(), [7; 24]);
    }

    #[test]
    fn the_end_of_the_line_is_an_error() {
        let (camera, mut stream) = line();
        drop(camera);
        let error = stream
            .receive(&mut Box::new(Image::empty()))
            .expect_err("an end");
        assert_eq!(error.kind(), ErrorKind::UnexpectedEof);
    }

    #[test]
    fn a_picture_that_does_not_fit_is_refused() {
        let mut image = Box::new(Image::empty());
        assert!(copy(&picture(160, 120, 1), &mut image).is_ok());
        let error = copy(&picture(161, 120, 1), &mut image).expect_err("too large");
        assert!(error.to_string().contains("161 x 120"), "{error}");
    }
}
