//! Content of a frame calibration file: the result, its devices, and its quality.

use nalgebra::{Isometry3, Quaternion, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize, de::DeserializeOwned};

use super::{FrameCause, FrameReport, Sizes};
use crate::calibration::{CalibrationRecord, Judgement, RecordHead};

/// Serial numbers of the devices that measured, apart from the wrist sensor in the head; absent if not used.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Serials {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub arm: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tracker: Option<String>,
    /// Serial number of the marker, or the name of its definition file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub marker: Option<String>,
}

/// Result of a calibration, as stored in a file.
pub trait CalibrationResult: Clone + Serialize + DeserializeOwned {
    /// Kind of the record, also the first part of the file's name.
    const KIND: &'static str;
    /// Returns the fault that makes the numbers unusable; `None` if they are usable.
    fn fault(&self) -> Option<&'static str>;
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, bound = "F: CalibrationResult")]
pub struct FrameRecord<F> {
    /// [`CalibrationResult::KIND`]; a file of another kind is refused on reading.
    pub kind: String,
    /// Wrist sensor, tool, date and program version.
    #[serde(flatten)]
    pub head: RecordHead,
    #[serde(flatten)]
    pub judgement: Judgement,
    pub poses: usize,
    /// Indices of the poses left out as outliers, from 0.
    pub outliers: Vec<usize>,
    /// Other devices that measured.
    pub serials: Serials,
    pub cause: FrameCause,
    /// Root mean square error of the poses in the fit.
    pub fitted: Sizes,
    pub held_out: Sizes,
    pub held_out_max: Sizes,
    /// Half the length of the 95 % interval.
    pub uncertainty: Sizes,
    pub found: F,
    /// Changes by the calibration in the rig file.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rig: Vec<RigChange>,
}

/// A value of the rig file that a calibration changed: before and after, as TOML text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RigChange {
    /// Key, with dots.
    pub key: String,
    /// Value before; `None` if the key did not exist.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub before: Option<String>,
    /// Value after; `None` if the key was removed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub after: Option<String>,
}

impl RigChange {
    /// Returns the change that undoes this one.
    #[must_use]
    pub fn undone(self) -> Self {
        Self { key: self.key, before: self.after, after: self.before }
    }
}

impl<F: CalibrationResult> FrameRecord<F> {
    pub(super) fn of(report: &FrameReport<F>, head: RecordHead, serials: Serials, reason: &str) -> Option<Self> {
        Some(Self {
            kind: F::KIND.to_owned(),
            head,
            judgement: Judgement::new(report.verdict, reason),
            poses: report.poses,
            outliers: report.outliers.clone(),
            serials,
            cause: report.cause,
            fitted: report.fitted,
            held_out: report.held_out,
            held_out_max: report.held_out_max,
            uncertainty: report.uncertainty,
            found: report.found.clone()?,
            rig: Vec::new(),
        })
    }
}

impl<F: CalibrationResult> CalibrationRecord for FrameRecord<F> {
    const KIND: &'static str = F::KIND;

    fn head(&self) -> &RecordHead {
        &self.head
    }

    fn judgement(&self) -> &Judgement {
        &self.judgement
    }

    fn fault(&self) -> Option<&'static str> {
        if self.kind != F::KIND {
            return Some("kind belongs to another calibration");
        }
        // A file may contain an override, but not a verdict that contradicts the cause.
        if self.judgement.verdict != self.cause.verdict() {
            return Some("verdict does not follow from cause");
        }
        let sizes = [self.fitted, self.held_out, self.held_out_max, self.uncertainty];
        let sound = |size: Option<f64>| size.is_none_or(|size| size >= 0.0 && size.is_finite());
        if !sizes.iter().all(|sizes| sound(sizes.place_m) && sound(sizes.angle_deg)) {
            return Some("an error or uncertainty is negative or not a number");
        }
        self.found.fault()
    }
}

/// A pose as stored in a file: position (m) and rotation (w, x, y, z).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredPose {
    /// Origin of the source frame in the target frame, m.
    pub place_m: [f64; 3],
    /// Rotation from the source frame to the target frame.
    pub rotation_wxyz: [f64; 4],
}

impl StoredPose {
    pub(super) fn of(pose: &Isometry3<f64>) -> Self {
        Self { place_m: pose.translation.vector.into(), rotation_wxyz: wxyz(&pose.rotation) }
    }

    pub fn pose(&self) -> Isometry3<f64> {
        Isometry3::from_parts(Vector3::from(self.place_m).into(), rotation(&self.rotation_wxyz))
    }

    pub(super) fn fault(&self) -> Option<&'static str> {
        place_fault(&self.place_m).or_else(|| rotation_fault(&self.rotation_wxyz))
    }
}

/// Returns the components of a rotation, with `w` not negative.
pub(super) fn wxyz(rotation: &UnitQuaternion<f64>) -> [f64; 4] {
    // One of the two quaternions of a rotation, so that files compare equal.
    let sign = if rotation.w < 0.0 { -1.0 } else { 1.0 };
    [rotation.w, rotation.i, rotation.j, rotation.k].map(|part| part * sign)
}

pub(super) fn rotation(wxyz: &[f64; 4]) -> UnitQuaternion<f64> {
    let [w, x, y, z] = *wxyz;
    UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z))
}

pub(super) fn place_fault(place_m: &[f64; 3]) -> Option<&'static str> {
    // Equal to `FARTHEST_M` in `sample.rs`.
    (!place_m.iter().all(|x| x.is_finite() && x.abs() <= 10.0)).then_some("a position is not finite or beyond 10 m")
}

pub(super) fn rotation_fault(wxyz: &[f64; 4]) -> Option<&'static str> {
    let length = wxyz.iter().map(|part| part * part).sum::<f64>().sqrt();
    // Written so that NaN is rejected too.
    let unit = (length - 1.0).abs() < 1e-6;
    (!unit).then_some("rotation_wxyz is not a quaternion of length one")
}
