//! SSD tracker: learns what it sees at a place of its first picture, and finds it in each later one
//! by the least sum of squared differences.
//!
//! Properties: `column` and `row`, the middle of what is learnt (by default that of the picture);
//! `search_radius`, how far the target can move between two pictures, in pixels;
//! `lost_error`, the matching error above which the target counts as lost; `field_of_view_deg` of
//! the camera. What was learnt and found is registered as critical memory of 976 bytes.
#![forbid(unsafe_code)]

mod template_matching;

use component_sdk::prelude::*;
use robot_interface::port_data::{Image, TrackedTarget};

use template_matching::{Search, Track, grey_values};

/// Horizontal field of view of the reference robot's camera.
const FIELD_OF_VIEW_DEG: f64 = 65.0;

/// Ports of the tracker.
#[derive(Ports)]
pub struct SsdTrackerPorts {
    image: Input<Image>,
    target: Output<TrackedTarget>,
}

/// The tracker.
pub struct SsdTracker {
    ports: SsdTrackerPorts,
    search: Search,
    field_of_view_rad: f64,
    track: Option<&'static mut Track>,
}

impl SsdTracker {
    /// Direction of the middle of a column, to the left is positive.
    fn bearing_rad(&self, column: f64, width: f64) -> f64 {
        let focal_length = width / 2.0 / (self.field_of_view_rad / 2.0).tan();
        ((width / 2.0 - column) / focal_length).atan()
    }
}

impl Component for SsdTracker {
    type Ports = SsdTrackerPorts;

    fn new(ports: SsdTrackerPorts) -> Self {
        Self {
            ports,
            search: Search::default(),
            field_of_view_rad: FIELD_OF_VIEW_DEG.to_radians(),
            track: None,
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        let default = Search::default();
        self.search = Search {
            column: context.property_or("column", default.column)?,
            row: context.property_or("row", default.row)?,
            radius: context.property_or("search_radius", default.radius)?,
            lost_error: context.property_or("lost_error", default.lost_error)?,
        };
        self.field_of_view_rad = context
            .property_or("field_of_view_deg", FIELD_OF_VIEW_DEG)?
            .to_radians();
        match &mut self.track {
            Some(track) => **track = Track::nothing(),
            None => self.track = Some(context.critical(Track::nothing())?),
        }
        Ok(())
    }

    fn on_execute(&mut self, _context: &Context) -> Outcome {
        let Some(image) = self.ports.image.read() else {
            return Ok(());
        };
        let Some(grey) = grey_values(&image) else {
            return Ok(());
        };
        let Some(track) = &mut self.track else {
            return Ok(());
        };
        let Some(matching_error) = track.follow(&self.search, &grey) else {
            return Err(Failure::new(
                Status::INPUT_OUT_OF_RANGE,
                "the picture is smaller than what is to be learnt of it: 31 x 31 pixels",
            ));
        };
        let (column, row) = track.middle();
        let target = TrackedTarget {
            time: image.time,
            visible: u32::from(track.pictures_lost() == 0),
            pictures_lost: track.pictures_lost(),
            column,
            row,
            bearing: self.bearing_rad(column, f64::from(image.width)),
            matching_error,
        };
        self.ports.target.write(&target);
        Ok(())
    }
}

export_component!(SsdTracker);
