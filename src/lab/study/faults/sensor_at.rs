//! Where the force is measured, and on which rig.

use nima_emulation::emulated::Wiring;
use serde::Serialize;

use super::{Kind, Place};

/// Place of the force sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SensorAt {
    /// At the tip, scene `peg_transfer`.
    Tip,
    /// At the wrist, scene `palpation`, gravity calibrated.
    Wrist,
    /// The same on rigs with an arm of joints, which turns the sensor: the devices of the emulated rig.
    ArmTip,
    /// See above.
    ArmWrist,
    /// Devices of a lab's own, the sensor at half of the loop's rate.
    ExternalTip,
    /// See above.
    ExternalWrist,
}

impl SensorAt {
    /// The places on the simulated rig.
    pub const SIMULATED: [Self; 2] = [Self::Tip, Self::Wrist];
    /// Those on rigs with an arm.
    pub const ON_ARMS: [Self; 4] = [Self::ArmTip, Self::ArmWrist, Self::ExternalTip, Self::ExternalWrist];
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Tip, Self::Wrist, Self::ArmTip, Self::ArmWrist, Self::ExternalTip, Self::ExternalWrist];

    pub(super) const fn scene(self) -> &'static str {
        if self.is_at_wrist() { "palpation" } else { "peg_transfer" }
    }

    pub(super) const fn is_at_wrist(self) -> bool {
        matches!(self, Self::Wrist | Self::ArmWrist | Self::ExternalWrist)
    }

    /// The devices around the world; none of the simulated rig.
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

    /// The states in which faults are tried: without an engagement the arm changes nothing.
    pub(super) const fn places(self) -> &'static [Place] {
        if self.wiring().is_some() { &[Place::Free, Place::Contact] } else { &Place::ALL }
    }

    /// Whether this kind of fault is tried here.
    pub(super) const fn has(self, kind: Kind) -> bool {
        let has_imu = matches!(self, Self::Wrist | Self::ArmWrist);
        (has_imu || !kind.needs_wrist()) && (self.wiring().is_none() || kind.is_of_devices())
    }
}
