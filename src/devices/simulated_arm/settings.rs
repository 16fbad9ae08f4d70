use std::f64::consts::TAU;

use nima_core::kinematics::{ArmModel, JointLimits, Joints};
use serde::{Deserialize, Deserializer, Serialize, de::Error as _};

use crate::{ARM_JOINTS, DeviceError};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, tag = "make", rename = "simulated")]
pub struct SimulatedArmSettings {
    /// Initial joint angles, rad, at which the instrument must be in its trocar; zero for an unused joint.
    #[serde(deserialize_with = "start_rad")]
    pub start_rad: [f64; ARM_JOINTS],
    /// Bandwidth of the joints, Hz, above 0 to 100.
    #[serde(default = "SimulatedArmSettings::usual_bandwidth_hz")]
    pub bandwidth_hz: f64,
    /// Fraction of the arm's joint speeds that commands may use, above 0 to 1.
    #[serde(default = "SimulatedArmSettings::usual_speed_fraction")]
    pub speed_fraction: f64,
    /// Maximum lead of a commanded angle over the measured one, rad, above 0 to 0.2.
    #[serde(default = "SimulatedArmSettings::usual_lead_rad")]
    pub lead_rad: f64,
}

impl SimulatedArmSettings {
    const fn usual_bandwidth_hz() -> f64 {
        10.0
    }

    const fn usual_speed_fraction() -> f64 {
        0.5
    }

    const fn usual_lead_rad() -> f64 {
        0.05
    }

    /// Creates settings with these initial joint angles (rad) and default values otherwise.
    pub const fn at(start_rad: [f64; ARM_JOINTS]) -> Self {
        Self {
            start_rad,
            bandwidth_hz: Self::usual_bandwidth_hz(),
            speed_fraction: Self::usual_speed_fraction(),
            lead_rad: Self::usual_lead_rad(),
        }
    }

    /// Returns the limits of position, speed and acceleration: the planner keeps to them, the driver checks them.
    pub fn joint_limits(&self, model: &ArmModel) -> JointLimits {
        JointLimits::of_arm(model, self.speed_fraction, self.lead_rad)
    }

    /// Returns the angular frequency with which the joints follow, rad/s.
    pub(super) fn omega_rad_s(&self) -> f64 {
        TAU * self.bandwidth_hz
    }

    /// Checks every value.
    ///
    /// # Errors
    /// [`DeviceError::Setting`] for the first value outside its range.
    pub fn check(&self, model: &ArmModel) -> Result<(), DeviceError> {
        let refuse =
            |key: &str, value: String, allowed: String| DeviceError::Setting { key: key.to_owned(), value, allowed };
        let margin_rad = model.limit_margin_rad(&Joints::from(self.start_rad));
        let unused = &self.start_rad[model.joints()..];
        let is_still = unused.iter().all(|rad| *rad == 0.0);
        if !self.start_rad.iter().all(|rad| rad.is_finite()) || margin_rad <= 0.0 || !is_still {
            let allowed = format!("{} angles within the ranges of the arm's joints, rad", model.joints());
            return Err(refuse("start_rad", format!("{:?}", self.start_rad), allowed));
        }
        let within = |key: &str, value: f64, high: f64| {
            let allowed = format!("above 0 and at most {high}");
            if value > 0.0 && value <= high { Ok(()) } else { Err(refuse(key, value.to_string(), allowed)) }
        };
        within("bandwidth_hz", self.bandwidth_hz, 100.0)?;
        within("speed_fraction", self.speed_fraction, 1.0)?;
        within("lead_rad", self.lead_rad, 0.2)
    }
}

/// Reads one angle for each joint: an arm of six joints has six.
fn start_rad<'de, D: Deserializer<'de>>(from: D) -> Result<[f64; ARM_JOINTS], D::Error> {
    let angles = Vec::<f64>::deserialize(from)?;
    if !(ARM_JOINTS - 1..=ARM_JOINTS).contains(&angles.len()) {
        return Err(D::Error::invalid_length(angles.len(), &"6 or 7 angles, one for each joint"));
    }
    Ok(std::array::from_fn(|joint| angles.get(joint).copied().unwrap_or(0.0)))
}
