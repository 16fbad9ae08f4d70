//! From what the wrist feels to the force at the tip: one step a tick, allocation-free.

use nalgebra::Vector3;

use crate::{device::Sensed, frames::Wrench};

/// Where the tip force of a tick comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForceSource {
    /// Measured at the tip.
    AtTip,
    /// Measured at the wrist, and no calibration is in force: nothing is rendered from it.
    Uncalibrated,
}

impl ForceSource {
    /// The tip force may be felt by a hand.
    pub const fn is_usable(self) -> bool {
        !matches!(self, Self::Uncalibrated)
    }
}

/// What the path made of one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceReport {
    /// Where the tip force comes from.
    pub source: ForceSource,
    /// Force of the tissue on the tip, N, workspace frame (`kbf`); zero when there is no usable one.
    pub tip_n: Vector3<f64>,
    /// What the wrist feels without weight and bias (`s1`), once gravity is calibrated.
    pub gravity_free: Option<Wrench>,
}

/// The chain of calibrations in force.
#[derive(Clone, Debug, Default)]
pub struct ForcePath {}

impl ForcePath {
    /// The tip force of this sample.
    pub fn step(&mut self, sensed: &Sensed) -> ForceReport {
        match sensed {
            Sensed::AtTip(tip_n) => ForceReport { source: ForceSource::AtTip, tip_n: *tip_n, gravity_free: None },
            Sensed::AtWrist(_) => {
                ForceReport { source: ForceSource::Uncalibrated, tip_n: Vector3::zeros(), gravity_free: None }
            }
        }
    }
}
