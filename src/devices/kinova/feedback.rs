//! The arm's cyclic feedback, decoded in place into fixed memory.
//!
//! `BaseCyclic.KinovaFeedback { fixed32 frame_id = 1; BaseFeedback base = 2; repeated ActuatorFeedback actuators = 3 }`;
//! field numbers as in `BaseCyclic.proto`. Units of the protocol: degrees, metres, newtons.
//!
//! Source: `Kinovarobotics/ros_kortex`, `kortex_driver/protos`.

use super::{
    messages::ArmState,
    wire::{DamagedMessage, Value, WireFields},
};
use crate::ARM_JOINTS;

/// Fault and warning bits of the base or of an actuator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Banks {
    pub fault: [u32; 2],
    pub warning: [u32; 2],
}

impl Banks {
    pub const fn is_faulty(&self) -> bool {
        self.fault[0] | self.fault[1] != 0
    }

    /// Stores field `k` of four consecutive fields: fault A, B, warning A, B.
    fn take(&mut self, k: u32, value: Value<'_>) -> Result<(), DamagedMessage> {
        let bank = if k < 2 { &mut self.fault } else { &mut self.warning };
        bank[(k & 1) as usize] = value.fixed32()?;
        Ok(())
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Actuator {
    /// Number of the last command that the actuator accepted.
    pub command_id: u32,
    pub status: u32,
    /// Angle, degrees in [0, 360).
    pub position_deg: f32,
    /// Speed, degrees/s.
    pub velocity_deg_s: f32,
    /// Torque, Nm, with the sign opposite to that of torque commands.
    pub torque_nm: f32,
    pub current_a: f32,
    pub banks: Banks,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KinovaFeedback {
    /// Number of the cycle.
    pub frame_id: u32,
    pub state: ArmState,
    /// Position of the tool, m, and its angles theta x, y, z, degrees.
    pub tool_pose: [f32; 6],
    /// Velocity of the tool, m/s and degrees/s.
    pub tool_twist: [f32; 6],
    /// Force and torque on the tool as the base estimates them, N and Nm.
    pub tool_wrench: [f32; 6],
    pub banks: Banks,
    /// The actuators, starting at the base.
    pub actuators: [Actuator; ARM_JOINTS],
    /// Number of actuators in the message; more than seven are counted and not stored.
    pub count: usize,
}

impl Default for KinovaFeedback {
    fn default() -> Self {
        Self {
            frame_id: 0,
            state: ArmState(0),
            tool_pose: [0.0; 6],
            tool_twist: [0.0; 6],
            tool_wrench: [0.0; 6],
            banks: Banks::default(),
            actuators: [Actuator::default(); ARM_JOINTS],
            count: 0,
        }
    }
}

impl KinovaFeedback {
    /// Decodes the payload of an answer to `Refresh` or `RefreshFeedback`.
    ///
    /// # Errors
    /// [`DamagedMessage`] if the bytes are not a valid message.
    pub fn decode(payload: &[u8]) -> Result<Self, DamagedMessage> {
        let mut feedback = Self::default();
        for field in WireFields::of(payload) {
            match field? {
                (1, value) => feedback.frame_id = value.fixed32()?,
                (2, value) => feedback.take_base(value.bytes()?)?,
                (3, value) => {
                    let actuator = actuator(value.bytes()?)?;
                    // An arm with more joints must be refused with its count, not with an index out of range.
                    if let Some(place) = feedback.actuators.get_mut(feedback.count) {
                        *place = actuator;
                    }
                    feedback.count += 1;
                }
                _ => {}
            }
        }
        Ok(feedback)
    }

    fn take_base(&mut self, bytes: &[u8]) -> Result<(), DamagedMessage> {
        for field in WireFields::of(bytes) {
            let (number, value) = field?;
            match number {
                2 => self.state = ArmState(value.uint32()?),
                13..19 => self.tool_pose[number as usize - 13] = value.float()?,
                19..25 => self.tool_twist[number as usize - 19] = value.float()?,
                25..31 => self.tool_wrench[number as usize - 25] = value.float()?,
                31..35 => self.banks.take(number - 31, value)?,
                _ => {}
            }
        }
        Ok(())
    }

    /// Returns whether every number that is used is finite.
    pub fn is_finite(&self) -> bool {
        let tool = self.tool_pose.iter().chain(&self.tool_twist).chain(&self.tool_wrench);
        tool.chain(self.actuators.iter().flat_map(|a| [&a.position_deg, &a.velocity_deg_s, &a.torque_nm]))
            .all(|x| x.is_finite())
    }
}

fn actuator(bytes: &[u8]) -> Result<Actuator, DamagedMessage> {
    let mut report = Actuator::default();
    for field in WireFields::of(bytes) {
        let (number, value) = field?;
        match number {
            1 => report.command_id = value.fixed32()?,
            2 => report.status = value.fixed32()?,
            4 => report.position_deg = value.float()?,
            5 => report.velocity_deg_s = value.float()?,
            6 => report.torque_nm = value.float()?,
            7 => report.current_a = value.float()?,
            11..15 => report.banks.take(number - 11, value)?,
            _ => {}
        }
    }
    Ok(report)
}
