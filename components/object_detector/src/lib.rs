//! Colour object detector: finds the target in a picture by its colour.
//!
//! Properties: `red`, `green`, `blue` (0 to 255) and `tolerance` say which pixels belong to the
//! target, `field_of_view_deg` is that of the camera, `object_diameter_m` gives the distance.
#![forbid(unsafe_code)]

mod colour_segmentation;

use component_sdk::prelude::*;
use robot_interface::port_data::{DetectedObject, Image};

use colour_segmentation::Detector;

/// Ports of the detector.
#[derive(Ports)]
pub struct ObjectDetectorPorts {
    image: Input<Image>,
    object: Output<DetectedObject>,
}

/// The detector.
pub struct ObjectDetector {
    ports: ObjectDetectorPorts,
    detector: Detector,
}

impl Component for ObjectDetector {
    type Ports = ObjectDetectorPorts;

    fn new(ports: ObjectDetectorPorts) -> Self {
        Self {
            ports,
            detector: Detector::default(),
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        let default = Detector::default();
        let [red, green, blue] = default.colour;
        let field_of_view_deg = default.field_of_view_rad.to_degrees();
        self.detector = Detector {
            colour: [
                context.property_or("red", red)?,
                context.property_or("green", green)?,
                context.property_or("blue", blue)?,
            ],
            tolerance: context.property_or("tolerance", default.tolerance)?,
            field_of_view_rad: context
                .property_or("field_of_view_deg", field_of_view_deg)?
                .to_radians(),
            object_diameter_m: context
                .property_or("object_diameter_m", default.object_diameter_m)?,
        };
        Ok(())
    }

    fn on_execute(&mut self, _context: &Context) -> Outcome {
        if let Some(image) = self.ports.image.read() {
            self.ports.object.write(&self.detector.find(&image));
        }
        Ok(())
    }
}

export_component!(ObjectDetector);
