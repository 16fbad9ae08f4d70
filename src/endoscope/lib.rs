//! The endoscope image, from an address to pixels.
//!
//! An [`EndoscopeFeed`] takes an [`Address`] (motion JPEG over HTTP, H.264 over RTSP, a camera of this computer, a
//! file, a folder), opens it on its own threads and reopens it when it is lost. It provides the newest image with its
//! age, its rate and its status ([`FrameHealth`]). No thread waits for another: an image that was not taken is replaced
//! by the next one. A recording receives all compressed images unmodified through a [`FrameQueue`]. [`Camera`]
//! describes the pose and the lens of the endoscope; [`Checkerboard`] is the calibration target; [`time_code`],
//! [`jpeg::encode`] and [`board::Portrait`] are for emulators and tests. Bad input (an image or a response that is
//! truncated, too large, or of another format) is an [`EndoscopeError`] with its remedy, or a [`Damage`] of one image.
//! Independent of loop, devices and window.
//!
//! ```
//! use nima_endoscope::{Damage, jpeg};
//!
//! let grey = vec![128; 3 * 16 * 16];
//! let frame = jpeg::encode(&grey, [16, 16], 90);
//! let image = jpeg::decode(&frame)?;
//! assert_eq!(image.size_px, [16, 16]);
//! assert!(image.rgba.iter().all(|&value| value == 255 || value.abs_diff(128) < 3));
//! assert_eq!(jpeg::decode(&frame[..frame.len() / 2]).unwrap_err(), Damage::Torn);
//! # Ok::<(), Damage>(())
//! ```

mod address;
pub mod board;
mod camera;
pub mod colour;
mod error;
mod feed;
mod files;
mod frame_health;
mod frame_queue;
pub mod h264;
mod http;
pub mod jpeg;
mod plugged;
#[cfg(feature = "h264")]
mod rtsp;
mod source;
mod steady;
pub mod time_code;
mod tone;
#[cfg(all(target_os = "linux", target_pointer_width = "64"))]
mod v4l2;
mod waiting_frames;

pub use address::{Address, AddressError, Capture, Endpoint, Login, Pixels};
pub use board::{BoardError, Checkerboard};
pub use camera::{Bend, Camera, Lens};
pub use colour::{Colours, PixelLayout, RawLayout};
pub use error::EndoscopeError;
pub use feed::{EndoscopeFeed, FeedSnapshot};
pub use frame_health::{FROZEN, FrameFault, FrameHealth, LATE};
pub use frame_queue::{FrameQueue, LatestFrame, ReelEnd};
pub use jpeg::{Damage, DecodedImage};
pub use plugged::{PluggedCamera, plugged_cameras};
pub use source::{CompressedFrame, Format, ImageSource};
pub use steady::steadied;
pub use tone::Tone;
