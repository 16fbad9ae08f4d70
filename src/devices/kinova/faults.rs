//! Text for the fault bits.
//!
//! Bits of bank A: `Base.SafetyIdentifier` and `ActuatorConfig.SafetyIdentifierBankA` of the Kortex API. No public
//! source names the bits of bank B, so they are shown as a number.
//!
//! Source: the `.proto` files in `Kinovarobotics/ros_kortex`.

use std::fmt::{self, Display, Formatter};

use super::{feedback::KinovaFeedback, messages::ArmState};
use crate::ARM_JOINTS;

/// Base, bank A: a joint has a fault.
pub const JOINT_FAULT: u32 = 0x10;
/// Base, bank A: emergency stop.
pub const EMERGENCY_STOP: u32 = 0x80_0000;
/// Actuator, bank A: the difference between command and measurement is too large.
pub const FOLLOWING_ERROR: u32 = 1;
/// Bit of bank A of an actuator: above the joint's range.
pub const JOINT_LIMIT_HIGH: u32 = 4;
/// Bit of bank A of an actuator: below the joint's range.
pub const JOINT_LIMIT_LOW: u32 = 8;
/// Actuator, bank A: torque too large.
pub const MAXIMUM_TORQUE: u32 = 0x20;
/// Actuator, bank A: a cyclic command was missed.
pub const COMMUNICATION_TICK_LOST: u32 = 0x40_0000;

// One text per bit of fault bank A, from bit 0 on (Kortex API 2).
const BASE: [&str; 31] = [
    "firmware update failed",
    "external communication error",
    "outside of the base too hot",
    "inside of the base too hot",
    "fault of a joint",
    "jitter of the cyclic data",
    "event log full",
    "no kinematics",
    "too many joints",
    "network error",
    "pose cannot be reached",
    "joints not detected",
    "network not initialised",
    "too much current",
    "voltage too high",
    "voltage too low",
    "tool too fast",
    "tool turns too fast",
    "tool accelerates too much",
    "tool turns up too much",
    "too much force at the tool",
    "too much torque at the tool",
    "too much payload",
    "emergency stop",
    "emergency line",
    "inrush current limiter",
    "memory of settings corrupted",
    "firmware does not fit",
    "self test failed",
    "digital input stuck",
    "arm near an illegal position (singularity)",
];

// One text per bit of fault bank A, from bit 0 on (Kortex API 2).
const ACTUATOR: [&str; 29] = [
    "following error",
    "too fast",
    "upper joint limit",
    "lower joint limit",
    "strain gauges disagree",
    "too much torque",
    "absolute position unreliable",
    "magnetic position",
    "Hall position",
    "Hall sequence",
    "encoder and Hall sensors disagree",
    "encoder index",
    "encoder and magnetic sensor disagree",
    "too much motor current",
    "motor currents disagree",
    "voltage too high",
    "voltage too low",
    "motor too hot",
    "core too hot",
    "memory of settings corrupted",
    "motor driver",
    "emergency line",
    "cyclic command missed",
    "watchdog",
    "capacitive sensor unreliable",
    "unexpected gear ratio",
    "Hall and magnetic sensors disagree",
    "brake driver",
    "moved too far while the brake opened",
];

/// All faults of an arm at one time. `Display` returns text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct KinovaFaults {
    /// Whether the arm reports the state `IN_FAULT`.
    pub in_fault: bool,
    /// Fault banks A and B of the base.
    pub base: [u32; 2],
    /// Fault banks A and B of each actuator.
    pub actuators: [[u32; 2]; ARM_JOINTS],
}

impl KinovaFaults {
    pub fn of(feedback: &KinovaFeedback) -> Self {
        let in_fault = feedback.state == ArmState::IN_FAULT;
        Self { in_fault, base: feedback.banks.fault, actuators: feedback.actuators.map(|a| a.banks.fault) }
    }

    pub fn any(&self) -> bool {
        *self != Self::default()
    }

    /// Returns a single code: bank A of the first faulty joint (the likely cause); otherwise bank A of the base;
    /// otherwise 1 (a fault without bits).
    pub fn code(&self) -> u32 {
        let joint = self.actuators.iter().map(|bank| bank[0]).find(|bank| *bank != 0);
        joint.unwrap_or(if self.base[0] == 0 { 1 } else { self.base[0] })
    }
}

impl Display for KinovaFaults {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let mut first = true;
        let mut say = |f: &mut Formatter<'_>, who: &dyn Display, banks: [u32; 2], names: &[&str]| {
            for (letter, bank, names) in [('A', banks[0], names), ('B', banks[1], &[])] {
                for bit in (0..32).filter(|bit| bank & (1 << bit) != 0) {
                    let between = if std::mem::take(&mut first) { "" } else { ", " };
                    match names.get(bit) {
                        Some(name) => write!(f, "{between}{who}: {name}")?,
                        None => write!(f, "{between}{who}: bit {bit} of bank {letter}")?,
                    }
                    write!(f, " ({:#x})", 1_u32 << bit)?;
                }
            }
            Ok(())
        };
        say(f, &"base", self.base, &BASE)?;
        for (joint, banks) in self.actuators.iter().enumerate() {
            say(f, &format_args!("joint {}", joint + 1), *banks, &ACTUATOR)?;
        }
        if !first {
            return Ok(());
        }
        f.write_str(if self.in_fault { "an unnamed fault" } else { "none" })
    }
}
