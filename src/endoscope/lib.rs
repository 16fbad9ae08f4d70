//! The endoscope image, from an address to pixels.
//!
//! A [`Feed`] takes an [`Address`] (motion JPEG over HTTP, H.264 over RTSP, a camera of this computer, a file, a
//! folder), opens it on its own threads and reopens it when it is lost. It provides the newest image with its age, its
//! rate and its status ([`Standing`]). No thread waits for another: an image that was not taken is replaced by the next
//! one. A recording receives all compressed images unmodified through a [`Reel`]. [`Camera`] describes the pose and the
//! lens of the endoscope; [`Board`] is the calibration target; [`time_code`], [`jpeg::encode`] and [`board::Portrait`]
//! are for emulators and tests. Bad input (an image or a response that is truncated, too large, or of another format)
//! is a [`Trouble`] with its remedy, or a [`Damage`] of one image. Independent of loop, devices and window.
//!
//! ```
//! use nima_endoscope::{Damage, jpeg};
//!
//! let grey = vec![128; 3 * 16 * 16];
//! let frame = jpeg::encode(&grey, [16, 16], 90);
//! let picture = jpeg::decode(&frame)?;
//! assert_eq!(picture.size_px, [16, 16]);
//! assert!(picture.rgba.iter().all(|&value| value == 255 || value.abs_diff(128) < 3));
//! assert_eq!(jpeg::decode(&frame[..frame.len() / 2]).unwrap_err(), Damage::Torn);
//! # Ok::<(), Damage>(())
//! ```

mod address;
pub mod board;
mod camera;
pub mod colour;
mod feed;
mod files;
pub mod h264;
mod http;
pub mod jpeg;
mod judge;
mod plugged;
mod reel;
#[cfg(feature = "h264")]
mod rtsp;
mod source;
mod steady;
pub mod time_code;
mod tone;
mod trouble;
#[cfg(all(target_os = "linux", target_pointer_width = "64"))]
mod v4l2;
mod waiting;

pub use address::{Address, AddressError, Capture, Endpoint, Login, Pixels};
pub use board::{Board, BoardError};
pub use camera::{Bend, Camera, Lens};
pub use colour::{Colours, Layout, Raw};
pub use feed::{Feed, Look};
pub use jpeg::{Damage, Picture};
pub use judge::{FROZEN, LATE, Standing, Wrong};
pub use plugged::{PluggedCamera, plugged_cameras};
pub use reel::{Glimpse, Reel, ReelEnd};
pub use source::{Compressed, Format, Source};
pub use steady::steadied;
pub use tone::Tone;
pub use trouble::Trouble;
