//! What is told of the force at the tip: where it comes from, and what each stage made of it.

use nalgebra::Vector3;
use nima_core::{
    frames::Wrench,
    tip_force::{Fallback, TipForceReport, Unsure},
};

/// Where the tip force of a tick comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say it")]
pub enum ForceSource {
    /// Measured at the tip.
    AtTip,
    /// Measured at the wrist, weight and bias taken out; friction in the trocar is still in it.
    Wrist,
    /// Measured at the wrist, weight, bias and friction taken out.
    Network,
    /// The network is not sure: the fallback answers.
    InDoubt { unsure: Unsure, fallback: Fallback },
    /// Measured at the wrist, and no calibration is in force: nothing is rendered from it.
    Uncalibrated,
    /// Calibrated, but the sample lacks the orientation that the calibration needs.
    NoOrientation,
    /// A calibration or the network made an impossible number of a good sample.
    Poisoned,
}

impl ForceSource {
    /// The tip force may be felt by a hand.
    pub const fn is_usable(self) -> bool {
        !matches!(self, Self::Uncalibrated | Self::NoOrientation | Self::Poisoned)
    }

    /// Why the network does not answer, where it does not.
    pub const fn doubt(self) -> Option<Unsure> {
        match self {
            Self::InDoubt { unsure, .. } => Some(unsure),
            _ => None,
        }
    }
}

/// What the path made of one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceReport {
    /// Where the tip force comes from.
    pub source: ForceSource,
    /// Force of the tissue on the tip, N, world frame; zero when there is no usable one.
    pub tip_n: Vector3<f64>,
    /// What the wrist feels without weight and bias (`s1`), once gravity is calibrated.
    pub gravity_free: Option<Wrench>,
    /// What the network said, where one is in force.
    pub tip_force: Option<TipForceReport>,
}

impl ForceReport {
    /// No force, for this reason.
    pub const fn none(source: ForceSource, gravity_free: Option<Wrench>) -> Self {
        Self { source, tip_n: Vector3::new(0.0, 0.0, 0.0), gravity_free, tip_force: None }
    }
}
