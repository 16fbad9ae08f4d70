//! Taking the tool's weight and the sensor's bias out of a wrist sensor's readings.
//!
//! At rest the tool pulls on the sensor with its weight: `f = m R u + f0` and `tau = com x (m R u) + tau0` in `s1`, with `u` the
//! field of gravity (m/s^2, pointing down) in the frame of the orientation source. That source is either the accelerometer
//! (`u = -a`, frame `imu`, `R = s1_from_imu`) or the arm (`u = s1_from_kbf * (0, 0, -g)`, frame `s1`, `R` near the identity).
//! The accelerometer's reading is not normalised: its own constant bias then disappears in `f0`. The sensor's drift after the
//! calibration does not; the drift check sees that.
//!
//! Three models are fitted to the same still poses and compared on poses they were not fitted on: the physical one above, one
//! with a free 3x3 gain in place of `m R`, and the paper's, linear in sine and cosine of roll and pitch.

mod model;
mod record;

pub use model::{GravityModel, ModelKind, Parameters, Source, TorqueParameters};
pub use record::{GravityKind, GravityRecord};
