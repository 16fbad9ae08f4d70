//! The force at the tip: its source, and the result of each processing stage.

use nalgebra::Vector3;
use nima_core::{
    frames::Wrench,
    tip_force::{Fallback, TipForceReport, Unsure},
};

/// An unknown force, N. A constant, because a computed NaN has different bits on another processor, and digests compare
/// bits.
pub const UNKNOWN_N: Vector3<f64> = Vector3::new(f64::NAN, f64::NAN, f64::NAN);

/// Source of the tip force in a tick, or the reason why the force is unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForceSource {
    AtTip,
    /// Measured at the wrist, with weight and bias removed; friction in the trocar is still included.
    Wrist,
    /// Measured at the wrist, with weight, bias and friction removed.
    Network,
    /// Like `Network`, but outside the training data: only the network's linear path contributes.
    Extrapolated,
    /// The network is uncertain about this sample, so the force of the fallback is used.
    InDoubt {
        unsure: Unsure,
        fallback: Fallback,
    },
    /// Measured at the wrist without a calibration; no force is rendered.
    Uncalibrated,
    /// Calibrated, but the sample lacks the orientation that the calibration needs.
    NoOrientation,
    /// A calibration or the network turned a valid sample into an impossible force.
    Poisoned,
    /// No measurement yet, or the last sample is too old.
    NoSample,
    /// The sensor at the wrist was connected or lost, and has not been identified since: its calibrations do not apply.
    Unidentified,
}

impl ForceSource {
    /// Every reason for which there is no force to render.
    pub const UNUSABLE: [Self; 5] =
        [Self::Uncalibrated, Self::NoOrientation, Self::Poisoned, Self::NoSample, Self::Unidentified];

    pub const fn is_usable(self) -> bool {
        !matches!(self, Self::Uncalibrated | Self::NoOrientation | Self::Poisoned | Self::NoSample | Self::Unidentified)
    }

    /// Returns whether the tip force is known. A force that the network's fallback holds and fades may be rendered, but
    /// it is not a measurement.
    pub const fn is_known(self) -> bool {
        self.is_usable() && !matches!(self, Self::InDoubt { fallback: Fallback::HoldAndFade, .. })
    }

    /// Returns the smallest force that indicates a touch, N: several times the noise of a sensor at the tip, and five
    /// times the error that calibrations leave at the wrist (0.08 N per axis).
    pub const fn min_n(self) -> f64 {
        if matches!(self, Self::AtTip) { 0.1 } else { 0.4 }
    }

    /// Returns the reason why the network does not provide the force, if it does not.
    pub const fn doubt(self) -> Option<Unsure> {
        match self {
            Self::InDoubt { unsure, .. } => Some(unsure),
            _ => None,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceReport {
    pub source: ForceSource,
    /// Force at the tip that the loop uses, N, world frame; [`UNKNOWN_N`] if there is no usable force.
    pub tip_n: Vector3<f64>,
    /// Wrench at the wrist without weight and bias (`s1`), if gravity is calibrated.
    pub gravity_free: Option<Wrench>,
    /// Output of the network, if the rig has one.
    pub tip_force: Option<TipForceReport>,
}

impl ForceReport {
    /// Creates a report without a force, for this reason.
    pub const fn none(source: ForceSource, gravity_free: Option<Wrench>) -> Self {
        Self { source, tip_n: UNKNOWN_N, gravity_free, tip_force: None }
    }

    /// Creates a report of a force that was computed at another machine.
    pub const fn of_far_end(source: ForceSource, force_n: Vector3<f64>) -> Self {
        let none = Self::none(source, None);
        if source.is_usable() { Self { tip_n: force_n, ..none } } else { none }
    }

    /// Returns the force of the tissue on the tip, N, world frame; [`UNKNOWN_N`] while it is unknown.
    pub const fn measured_n(&self) -> Vector3<f64> {
        if self.source.is_known() { self.tip_n } else { UNKNOWN_N }
    }
}
