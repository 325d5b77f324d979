//! Colour camera.
