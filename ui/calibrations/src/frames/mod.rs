//! The frame calibrations: their sessions, results, records, and the values of the rig file that they change.

pub mod job;
pub mod kind;
pub mod numbers;
mod subject;

use nima_core::calibration::frames::Sizes;

pub use job::{FrameCalibration, StoredFrame, frame_kept};
pub use kind::FrameKind;
pub use subject::FrameSubject;

/// A result to save: its record, and the resulting values of the rig file, as TOML text.
#[derive(Clone, Debug)]
pub struct FrameSaving {
    /// The record, without its changes to the rig file.
    pub record: FrameCalibration,
    /// Keys with dots and their new values.
    pub numbers: Vec<(String, String)>,
}

/// Returns a position and a rotation as text; `None` if both are unknown.
pub fn sizes_text(sizes: Sizes) -> Option<String> {
    let place = sizes.place_m.map(|m| format!("{:.2} mm", m * 1e3));
    let angle = sizes.angle_deg.map(|deg| format!("{deg:.2} deg"));
    let words: Vec<_> = place.into_iter().chain(angle).collect();
    (!words.is_empty()).then(|| words.join(", "))
}
