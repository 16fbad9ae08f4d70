//! Calibration of the endoscope's camera, from pictures of a checkerboard.
//!
//! [`find`] finds a [`Board`](nima_endoscope::Board) in a grey picture, whole, with its corners to some hundredths of a pixel, or says what it
//! lacks ([`Unseen`]). [`Session`] takes the views that a calibration needs and says which is wanted next. [`calibrate`] finds the lens (Zhang
//! 2000, refined by Levenberg and Marquardt's method) with as many terms as pay on held-out views, and judges it. [`place`] finds where the
//! camera is from corners of the board that the instrument's tip has touched. No file, thread,
//! clock or window.

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
