//! Calibration of the endoscope camera from images of a checkerboard.
//!
//! [`find`] finds a complete [`Board`](nima_endoscope::Checkerboard) in a greyscale image, with its corners accurate to
//! some hundredths of a pixel, or returns the reason ([`DetectionFailure`]). [`CameraSession`] collects the views for a
//! calibration and requests the next one. [`calibrate`] computes the lens (Zhang 2000, refined by Levenberg and
//! Marquardt's method), with those terms that improve held-out views, and judges it. [`place`] computes the pose of the
//! camera from corners of the board that were touched with the instrument's tip. Uses no file, thread, clock or window.

mod calibrate;
mod coverage;
mod detect;
mod fit;
mod grey;
mod grid;
mod held_out;
mod place;
mod plane;
mod refine;
mod report;
mod saddle;
mod session;
#[cfg(test)]
mod tests;

pub use calibrate::{BoardView, calibrate};
pub use coverage::{CELLS, CameraCoverage, Region};
pub use detect::{BoardSight, DetectionFailure, find};
pub use fit::Terms;
pub use grey::Grey;
pub use place::{CameraPlacement, PlaceError, PlaceLack, TouchedCorner, board_pose, place};
pub use report::{CameraCause, Deviations, LeftOut, LensReport};
pub use session::{CameraSession, LensSide, ViewOutcome, ViewRequest};
