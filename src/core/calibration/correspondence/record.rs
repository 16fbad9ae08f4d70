use nalgebra::UnitQuaternion;
use serde::{Deserialize, Serialize};

use super::{
    Correspondence, CorrespondenceReport, FitTarget, PushAgreement, SensorDiagnosis,
    report::{from_wxyz, parts},
};
use crate::calibration::{CalibrationRecord, Judgement, RecordHead};

/// Type of the record; a file of another kind is refused on reading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CorrespondenceKind {
    #[default]
    Correspondence,
}

/// A fitted correspondence and its quality.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CorrespondenceRecord {
    pub kind: CorrespondenceKind,
    #[serde(flatten)]
    pub head: RecordHead,
    #[serde(flatten)]
    pub judgement: Judgement,
    pub target: FitTarget,
    /// Whether the sensor under the tissue measured the force on the tissue, so that its sign was inverted before the
    /// fit.
    pub flip_s2: bool,
    pub pairs: usize,
    /// The rotation (w, x, y, z).
    pub rotation_wxyz: [f64; 4],
    /// The rotation as roll, pitch, yaw, degrees; for readers of the file, ignored on loading.
    pub roll_pitch_yaw_deg: [f64; 3],
    pub uncertainty_deg: f64,
    pub agreement: PushAgreement,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub diagnosis: Option<SensorDiagnosis>,
}

impl CorrespondenceRecord {
    /// Creates the record of a report; `None` if the report has no rotation. `date` in ISO 8601, UTC.
    pub fn of(report: &CorrespondenceReport, [sensor, tool]: [&str; 2], flip_s2: bool, date: &str) -> Option<Self> {
        let solution = report.solution.as_ref()?;
        Some(Self {
            kind: CorrespondenceKind::Correspondence,
            head: RecordHead::new(sensor, tool, date),
            judgement: Judgement::new(report.verdict, report.reason.clone()),
            target: solution.target,
            flip_s2,
            // The pairs that the fit used.
            pairs: report.pairs - report.weak.len() - report.outliers.len(),
            rotation_wxyz: solution.rotation_wxyz,
            roll_pitch_yaw_deg: parts(&solution.rotation()).1,
            uncertainty_deg: solution.uncertainty_deg,
            agreement: solution.agreement,
            diagnosis: solution.diagnosis,
        })
    }

    pub fn correspondence(&self) -> Correspondence {
        Correspondence { target: self.target, rotation: self.rotation(), flip_s2: self.flip_s2 }
    }

    pub fn rotation(&self) -> UnitQuaternion<f64> {
        from_wxyz(&self.rotation_wxyz)
    }
}

impl CalibrationRecord for CorrespondenceRecord {
    const KIND: &'static str = "correspondence";

    fn head(&self) -> &RecordHead {
        &self.head
    }

    fn judgement(&self) -> &Judgement {
        &self.judgement
    }

    fn fault(&self) -> Option<&'static str> {
        let length = self.rotation_wxyz.iter().map(|part| part * part).sum::<f64>().sqrt();
        // Written so that NaN is rejected too.
        let unit = (length - 1.0).abs() < 1e-6;
        if !unit {
            return Some("rotation_wxyz is not a quaternion of length one");
        }
        let known = (0.0..=180.0).contains(&self.uncertainty_deg);
        (!known).then_some("uncertainty_deg is not an angle of 0 to 180")
    }
}
