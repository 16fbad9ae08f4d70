//! Tests of the console, operated by the names on its screen.
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod access;
mod alarms;
mod bench;
mod blind;
mod connecting;
mod console;
mod contrast;
mod degrees;
mod demo;
mod drift;
mod endoscope_view;
mod faults;
mod identity;
mod image;
mod instruments;
mod language;
mod looks;
mod monitor;
mod palette;
mod playback;
mod ready;
mod roles;
mod starting;
mod studies;
mod tiles;
mod tradeoff;
mod training;
mod view;
mod virtual_rig;
mod walk;
mod wizard_camera;
mod wizard_correspondence;
mod wizard_frames;
mod wizard_gravity;
mod wizard_tip_force;
