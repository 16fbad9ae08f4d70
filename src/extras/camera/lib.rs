//! Calibration of the endoscope camera from images of a checkerboard.
//!
//! [`find`] finds a complete [`Board`](nima_endoscope::Board) in a grey image, with its corners accurate to some
//! hundredths of a pixel, or returns the reason ([`Unseen`]). [`Session`] collects the views for a calibration and
//! requests the next one. [`calibrate`] computes the lens (Zhang 2000, refined by Levenberg and Marquardt's method),
//! with those terms that improve held-out views, and judges it. [`place`] computes the pose of the camera from corners
//! of the board that were touched with the instrument's tip. Uses no file, thread, clock or window.

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

pub use calibrate::{View, calibrate};
pub use coverage::{CELLS, Coverage, Region};
pub use detect::{Sight, Unseen, find};
pub use fit::Terms;
pub use grey::Grey;
pub use place::{Lack, PlaceError, Placed, Touch, board_pose, place};
pub use report::{Cause, Deviations, LeftOut, Report};
pub use session::{Ask, Offer, Session, Way};
