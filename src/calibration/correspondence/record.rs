//! A correspondence as it is kept in a file.

use nalgebra::UnitQuaternion;
use serde::{Deserialize, Serialize};

use super::{
    Agreement, Correspondence, CorrespondenceReport, Diagnosis, Target,
    report::{from_wxyz, parts},
};
use crate::calibration::{Verdict, store};

/// The only kind of this record: a file of another kind is refused on reading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CorrespondenceKind {
    /// `kind = "correspondence"`.
    #[default]
    Correspondence,
}

/// A fitted correspondence with all that proves it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CorrespondenceRecord {
    /// What the file is.
    pub kind: CorrespondenceKind,
    /// Serial number of the wrist sensor.
    pub sensor: String,
    /// Name of the tool on it.
    pub tool: String,
    /// When it was made, UTC, ISO 8601 (`2026-08-21T10:20:30Z`).
    pub date: String,
    /// Version of the program that made it.
    pub software: String,
    /// Its verdict.
    pub verdict: Verdict,
    /// Why, in one sentence.
    pub reason: String,
    /// Who chose to keep it although it was refused.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub override_by: Option<String>,
    /// And why.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub override_reason: Option<String>,
    /// Which rotation it holds.
    pub target: Target,
    /// The sensor under the tissue told the force on the tissue: its sign was changed before the fit.
    pub flip_s2: bool,
    /// Pairs used.
    pub pairs: usize,
    /// The rotation (w, x, y, z).
    pub rotation_wxyz: [f64; 4],
    /// The same as roll, pitch, yaw, degrees; for the reader, not used on loading.
    pub roll_pitch_yaw_deg: [f64; 3],
    /// Expected angle of its error, degrees.
    pub uncertainty_deg: f64,
    /// Errors, fitted and held out, N.
    pub agreement: Agreement,
    /// Gain and constant between the sensors.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub diagnosis: Option<Diagnosis>,
}

impl CorrespondenceRecord {
    /// The record of a report, dated now; `None` when the report has no rotation.
    pub fn of(report: &CorrespondenceReport, sensor: &str, tool: &str, flip_s2: bool) -> Option<Self> {
        let solution = report.solution.as_ref()?;
        Some(Self {
            kind: CorrespondenceKind::Correspondence,
            sensor: sensor.to_owned(),
            tool: tool.to_owned(),
            date: store::utc_now(),
            software: env!("CARGO_PKG_VERSION").to_owned(),
            verdict: report.verdict,
            reason: report.reason.clone(),
            override_by: None,
            override_reason: None,
            target: solution.target,
            flip_s2,
            pairs: report.pairs - report.weak.len() - report.outliers.len(),
            rotation_wxyz: solution.rotation_wxyz,
            roll_pitch_yaw_deg: parts(&solution.rotation()).1,
            uncertainty_deg: solution.uncertainty_deg,
            agreement: solution.agreement,
            diagnosis: solution.diagnosis,
        })
    }

    /// For use.
    pub fn correspondence(&self) -> Correspondence {
        Correspondence { target: self.target, rotation: self.rotation(), flip_s2: self.flip_s2 }
    }

    /// The rotation.
    pub fn rotation(&self) -> UnitQuaternion<f64> {
        from_wxyz(&self.rotation_wxyz)
    }
}

impl store::Record for CorrespondenceRecord {
    const KIND: &'static str = "correspondence";

    fn sensor(&self) -> &str {
        &self.sensor
    }

    fn tool(&self) -> &str {
        &self.tool
    }

    fn date(&self) -> &str {
        &self.date
    }

    fn verdict(&self) -> Verdict {
        self.verdict
    }

    fn reason(&self) -> &str {
        &self.reason
    }

    fn override_by(&self) -> Option<&str> {
        self.override_by.as_deref()
    }

    fn fault(&self) -> Option<&'static str> {
        let length = self.rotation_wxyz.iter().map(|part| part * part).sum::<f64>().sqrt();
        // Written so that a NaN is a fault.
        let unit = (length - 1.0).abs() < 1e-6;
        if !unit {
            return Some("rotation_wxyz is not a quaternion of length one");
        }
        let known = (0.0..=180.0).contains(&self.uncertainty_deg);
        (!known).then_some("uncertainty_deg is no angle of 0 to 180")
    }
}
