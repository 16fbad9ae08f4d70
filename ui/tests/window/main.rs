//! The real window on an X server without a screen.
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod code_to_pixel;
mod console;
mod first_day;
mod peg_transfer;
mod playback;
mod player;
mod real_window;
mod same_window;
mod server;
mod sessions;
mod sight;
