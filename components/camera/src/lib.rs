//! Colour camera: takes the newest picture from its device and sends it.
//!
//! Property `device`: what to open, by default the camera of the simulated world.
#![forbid(unsafe_code)]

mod picture_stream;

use std::fs::File;

use component_sdk::prelude::*;
use robot_interface::port_data::Image;

use picture_stream::PictureStream;

/// Ports of the camera.
#[derive(Ports)]
pub struct CameraPorts {
    image: Output<Image>,
}

/// The camera.
pub struct Camera {
    ports: CameraPorts,
    device: String,
    stream: Option<PictureStream<File>>,
    /// Kept, because a picture is too large to be built anew on the stack in every cycle.
    image: Box<Image>,
}

impl Camera {
    fn connect(&mut self, context: &Context) -> Outcome {
        self.stream = Some(PictureStream::new(context.open_device(&self.device)?));
        Ok(())
    }
}

impl Component for Camera {
    type Ports = CameraPorts;

    fn new(ports: CameraPorts) -> Self {
        Self {
            ports,
            device: String::new(),
            stream: None,
            image: Box::new(Image::empty()),
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        self.device = context.property_or("device", "simulated:camera".to_owned())?;
        self.connect(context)
    }

    fn on_reset(&mut self, _context: &Context) -> Outcome {
        self.stream = None;
        Ok(())
    }

    fn on_recover(&mut self, context: &Context) -> Outcome {
        self.connect(context)
    }

    fn on_execute(&mut self, _context: &Context) -> Outcome {
        let Some(stream) = &mut self.stream else {
            return Ok(());
        };
        let has_picture = stream.receive(&mut self.image).map_err(|error| {
            Failure::internal(format!(
                "the camera '{}' does not answer: {error}; plug it in again and reset the component",
                self.device
            ))
        })?;
        if has_picture {
            self.ports.image.write(&self.image);
        }
        Ok(())
    }
}

export_component!(Camera);
