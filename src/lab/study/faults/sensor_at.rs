//! Location of the force sensor, and the kind of rig.

use nima_emulation::emulated::Wiring;
use serde::Serialize;

use super::{FaultKind, FaultPlace};

/// Location of the force sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SensorAt {
    /// Sensor at the tip, scene `peg_transfer`.
    Tip,
    /// Sensor at the wrist, scene `palpation`, gravity calibrated.
    Wrist,
    /// Sensor at the tip of rigs with a jointed arm, which rotates the sensor: the devices of the emulated rig.
    ArmTip,
    /// Sensor at the wrist of the same rigs.
    ArmWrist,
    /// Sensor at the tip, with devices of a lab's own design; the sensor runs at half the loop's rate.
    ExternalTip,
    /// Sensor at the wrist, with the same devices.
    ExternalWrist,
}

impl SensorAt {
    /// The locations on the simulated rig.
    pub const SIMULATED: [Self; 2] = [Self::Tip, Self::Wrist];
    /// The locations on rigs with an arm.
    pub const ON_ARMS: [Self; 4] = [Self::ArmTip, Self::ArmWrist, Self::ExternalTip, Self::ExternalWrist];
    pub const ALL: [Self; 6] =
        [Self::Tip, Self::Wrist, Self::ArmTip, Self::ArmWrist, Self::ExternalTip, Self::ExternalWrist];

    pub(super) const fn scene(self) -> &'static str {
        if self.is_at_wrist() { "palpation" } else { "peg_transfer" }
    }

    pub(super) const fn is_at_wrist(self) -> bool {
        matches!(self, Self::Wrist | Self::ArmWrist | Self::ExternalWrist)
    }

    /// Returns the devices around the world; `None` for the simulated rig.
    pub(super) const fn wiring(self) -> Option<Wiring> {
        match self {
            Self::Tip | Self::Wrist => None,
            Self::ArmTip | Self::ArmWrist => Some(Wiring::Emulated),
            Self::ExternalTip | Self::ExternalWrist => Some(Wiring::External),
        }
    }

    pub(super) const fn word(self) -> &'static str {
        match self {
            Self::Tip => "tip",
            Self::Wrist => "wrist",
            Self::ArmTip => "tip, arm",
            Self::ArmWrist => "wrist, arm",
            Self::ExternalTip => "tip, external",
            Self::ExternalWrist => "wrist, external",
        }
    }

    /// Returns the states in which faults are tested: without an engagement the arm changes nothing.
    pub(super) const fn places(self) -> &'static [FaultPlace] {
        if self.wiring().is_some() { &[FaultPlace::Free, FaultPlace::Contact] } else { &FaultPlace::ALL }
    }

    /// Returns whether this kind of fault is tested here.
    pub(super) const fn has(self, kind: FaultKind) -> bool {
        let has_imu = matches!(self, Self::Wrist | Self::ArmWrist);
        (has_imu || !kind.needs_wrist()) && (self.wiring().is_none() || kind.is_of_devices())
    }
}
