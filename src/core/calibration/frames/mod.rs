//! Frame calibrations: positions of tip, marker, tracker, trocar and table, orientation of the camera image, and mount
//! of the wrist sensor.
//!
//!  settings | find | from |
//! ---|---|---|
//!  [`TipSettings`] | the tip in the frame of marker or flange | poses of it while the tip stays in a dimple |
//!  [`HandEyeSettings`] | `flange_from_m` and `base_from_c` | flange and marker in many orientations |
//!  [`TrocarSettings`] | the remote centre of motion | lines of the shaft while the instrument pivots |
//!  [`TableSettings`] | `base_from_table` | points touched with the tip |
//!  [`ViewSettings`] | `base_from_view`, `leader_from_view` | moves to the right, up and into the image |
//!  [`SensorMount`] | `flange_from_s1` | still poses with the weight of the tool on the wrist sensor |
//!
//! ```
//! use nalgebra::{Isometry3, Vector3};
//! use nima_core::calibration::{
//!     Verdict,
//!     frames::{Calibration, FrameSample, TipSettings},
//! };
//!
//! let (tip_in_m_m, dimple_in_c_m) = (Vector3::new(0.01, -0.02, 0.4), Vector3::new(0.1, 0.2, 1.5));
//! let sample = |i: u32| {
//!     let i = f64::from(i);
//!     let turn = Isometry3::rotation(Vector3::new(0.5 * i.sin(), 0.5 * (1.7 * i).cos(), 0.1 * i));
//!     let place = Isometry3::translation(dimple_in_c_m.x, dimple_in_c_m.y, dimple_in_c_m.z);
//!     let c_from_m = place * turn * Isometry3::translation(-tip_in_m_m.x, -tip_in_m_m.y, -tip_in_m_m.z);
//!     FrameSample { c_from_m: Some(c_from_m), ..FrameSample::default() }
//! };
//! let report = TipSettings::by_tracker().fit(&(0..20).map(sample).collect::<Vec<_>>())?;
//! assert_eq!(report.verdict, Verdict::Accepted);
//! let found_m = Vector3::from(report.found.expect("a tip").tip_in_carrier_m);
//! assert!((found_m - tip_in_m_m).norm() < 1e-9);
//! assert!(TipSettings::by_tracker().fit(&[FrameSample::default()]).is_err(), "there is no marker");
//! # Ok::<(), nima_core::calibration::frames::FrameError>(())
//! ```
//!
//! Each is a [`Calibration`]; a [`FrameSession`] records for it, [`Calibration::fit`] gives a [`FrameReport`] with the
//! errors on held-out poses, the 95 % uncertainty and a [`FrameCause`], and [`FrameReport::record`] the file content.
//! [`TrocarWatch`] detects afterwards whether the trocar has moved. Lengths in m, forces in N, rotations
//! `target_from_source`; invalid samples are a [`FrameError`], poor or insufficient ones a verdict.

mod cause;
mod examine;
mod hand_eye;
mod hold;
mod record;
mod report;
mod sample;
mod sensor_mount;
mod session;
mod spread;
mod table;
#[cfg(test)]
mod tests;
mod tip;
mod trocar;
mod view;

pub use cause::{FrameCause, Mistake, SignedAxes, SignedAxis};
pub use hand_eye::{HandEyeResult, HandEyeSettings, HandEyeSolver};
pub use record::{CalibrationResult, FrameRecord, RigChange, Serials, StoredPose};
pub use report::{Calibration, FrameLimits, FrameReport, Sizes};
pub use sample::{CalibrationSource, Carrier, FrameSample};
pub use sensor_mount::{SensorMount, SensorMountResult};
pub use session::{FrameCoverage, FramePhase, FrameSession, MAX_POSES, MissingMotion};
pub use table::{TableResult, TableSettings};
pub use tip::{TipResult, TipSettings};
pub use trocar::{ShaftLine, TrocarResult, TrocarSettings, TrocarState, TrocarWatch};
pub use view::{ViewMove, ViewResult, ViewSettings};

/// Reason why samples could not be fitted. Messages count poses from 1.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FrameError {
    #[error("pose {} has no {from:?} reading; remove it", index + 1)]
    Missing { index: usize, from: CalibrationSource },
    #[error("pose {} contains a non-finite number or an invalid rotation; remove or repeat it", index + 1)]
    NotFinite { index: usize },
    #[error("pose {} is {place_m:.0} m from the origin; check the units (m)", index + 1)]
    NotPlausible { index: usize, place_m: f64 },
    #[error("{setting}; correct the settings")]
    Setting { setting: &'static str },
}
