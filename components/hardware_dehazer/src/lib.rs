//! Hardware dehazer: clears pictures of haze by the dark channel prior, on all cores. It stands for an
//! accelerator: what it needs of one is declared where a task is.
//!
//! Properties, all in pixels of the picture unless they are shares: `patch_radius`, `strength`,
//! `transmission_minimum`, `filter_radius`, `filter_smoothness`.
#![forbid(unsafe_code)]

use component_sdk::prelude::*;
use robot_interface::port_data::Image;
use robot_vision::Dehazer;

/// Ports of the dehazer.
#[derive(Ports)]
pub struct HardwareDehazerPorts {
    image: Input<Image>,
    clear_image: Output<Image>,
}

/// The dehazer.
pub struct HardwareDehazer {
    ports: HardwareDehazerPorts,
    dehazer: Dehazer,
    /// Kept, because a picture is too large to be built anew on the stack in every cycle.
    clear: Box<Image>,
}

impl Component for HardwareDehazer {
    type Ports = HardwareDehazerPorts;

    fn new(ports: HardwareDehazerPorts) -> Self {
        Self {
            ports,
            dehazer: Dehazer::default(),
            clear: Box::new(Image::empty()),
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        let default = Dehazer::default();
        self.dehazer = Dehazer {
            patch_radius: context.property_or("patch_radius", default.patch_radius)?,
            strength: context.property_or("strength", default.strength)?,
            transmission_minimum: context
                .property_or("transmission_minimum", default.transmission_minimum)?,
            filter_radius: context.property_or("filter_radius", default.filter_radius)?,
            filter_smoothness: context
                .property_or("filter_smoothness", default.filter_smoothness)?,
            cores: std::thread::available_parallelism().map_or(1, usize::from),
        };
        Ok(())
    }

    fn on_execute(&mut self, _context: &Context) -> Outcome {
        let Some(image) = self.ports.image.read() else {
            return Ok(());
        };
        let clear = &mut *self.clear;
        (clear.time, clear.width, clear.height) = (image.time, image.width, image.height);
        let hazy = image.used_pixels();
        // Its width may be anything when it has no pixel.
        let width = if hazy.is_empty() {
            0
        } else {
            image.width as usize
        };
        self.dehazer
            .clear(hazy, width, &mut clear.pixels[..hazy.len()]);
        self.ports.clear_image.write(clear);
        Ok(())
    }
}

export_component!(HardwareDehazer);
