//! The endoscope's picture, from an address to pixels.
//!
//! A [`Feed`] takes an [`Address`] (motion JPEG over HTTP, a file, a folder), opens it on threads of its own, opens it again when it is lost,
//! and has the newest picture ready, with its age, its rate and what is wrong with it ([`Standing`]). Nobody waits for anybody: a picture that
//! nobody took is replaced by the next one; a recording gets all of them as they came, over a [`Reel`]. [`Camera`] is where the endoscope looks and how its lens bends the picture; [`time_code`] and
//! [`jpeg::encode`] are for emulators and tests. Bad input (a picture or an answer that is cut off, too large, of another format) is a
//! [`Trouble`] with its cure, or a [`Damage`] of one picture. Knows no loop, device or window.
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
#![warn(missing_docs)]

mod address;
mod camera;
mod feed;
mod files;
mod http;
pub mod jpeg;
mod judge;
mod reel;
mod source;
pub mod time_code;
mod tone;
mod trouble;

pub use address::{Address, AddressError};
pub use camera::{Camera, Lens};
pub use feed::{Feed, Look};
pub use jpeg::{Damage, Picture};
pub use judge::{FROZEN, LATE, Standing, Wrong};
pub use reel::{Reel, ReelEnd};
pub use source::{Compressed, Source};
pub use tone::Tone;
pub use trouble::Trouble;
