//! `ControlConfig`: gravity, load and tool, and the limits of the base's own motion. Values are stored and returned,
//! but do not affect the emulated motion.

use nima_core::kinematics::ACCELERATION_RAD_S2;
use nima_devices::kinova::{
    limits::{GEN3, TWIST_MAX},
    messages::{KinovaNumber, KinovaPose},
};
use prost::Message;

use super::{
    forms::{
        AllKinematicLimits, DesiredSpeeds, FormTool, FormVector, JointsLimit, KinematicLimits, PayloadForm, Real,
        Reals, TwistLimit,
    },
    interface::{ABOVE_MAXIMUM, AnswerPayload, INVALID_PARAM, InterfaceError, JOINT_COUNT, UNSUPPORTED_METHOD, read},
    setting::KinovaSetting,
};

/// Control modes with their own limits: joystick and trajectory, each angular and Cartesian, and Cartesian waypoints.
const LIMITED_MODES: [u32; 5] = [1, 2, 4, 5, 12];

pub(super) struct KinovaControl {
    /// Settings, each with the event that reports its change (`ControlConfigurationEvent`).
    settings: Vec<(KinovaSetting, u32)>,
    soft: Vec<KinematicLimits>,
    desired: DesiredSpeeds,
}

impl KinovaControl {
    pub(super) fn new() -> Self {
        let gravity = FormVector { z: -9.81, ..FormVector::default() };
        let within =
            |vector: &FormVector| [vector.x, vector.y, vector.z].iter().all(|x| x.is_finite() && x.abs() <= 20.0);
        let payload = |load: &PayloadForm| is_mass(load.mass_kg) && load.centre.as_ref().is_none_or(is_place);
        let tool = |tool: &FormTool| {
            is_mass(tool.mass_kg)
                && tool.centre.as_ref().is_none_or(is_place)
                && tool.transform.as_ref().is_none_or(is_finite)
        };
        let frame = |frame: &KinovaNumber| (1..=3).contains(&frame.value);
        Self {
            settings: vec![
                (KinovaSetting::new(2, 1, &gravity, within).with_reset(25), 2),
                (KinovaSetting::new(4, 3, &PayloadForm::default(), payload).with_reset(26), 12),
                (KinovaSetting::new(6, 5, &FormTool::default(), tool).with_reset(27), 11),
                (KinovaSetting::new(10, 9, &KinovaNumber { value: 1 }, frame), 13),
            ],
            soft: LIMITED_MODES.map(hard).to_vec(),
            desired: DesiredSpeeds { linear_m_s: 0.1, angular_deg_s: 25.0, joint_deg_s: vec![25.0; GEN3.len()] },
        }
    }

    /// Returns the answer, and the event of the call.
    pub(super) fn answer(&mut self, function: u16, payload: &[u8]) -> Result<(Vec<u8>, Option<u32>), InterfaceError> {
        for (setting, event) in &mut self.settings {
            if let Some(answered) = setting.answer(function, payload) {
                return answered.map(|answer| (answer, setting.is_changed_by(function).then_some(*event)));
            }
        }
        match function {
            14 => self.set_joints(payload, |limits| &mut limits.joint_deg_s).map(|answer| (answer, Some(16))),
            15 => self.set_twist(payload, |limits| &mut limits.linear_m_s).map(|answer| (answer, Some(17))),
            16 => self.set_twist(payload, |limits| &mut limits.angular_deg_s).map(|answer| (answer, Some(18))),
            17 => self.set_joints(payload, |limits| &mut limits.joint_deg_s2).map(|answer| (answer, Some(19))),
            18 => Ok((hard(0).encode_to_vec(), None)),
            19 => Ok((self.soft(read::<KinovaNumber>(payload)?.value)?.encode_to_vec(), None)),
            20 => Ok((AllKinematicLimits { limits: self.soft.clone() }.encode_to_vec(), None)),
            21..=24 => self.joystick(function, payload),
            28 => self.reset_joints(payload, |limits| &mut limits.joint_deg_s).map(|answer| (answer, Some(16))),
            29 => self.reset_twist(payload, |limits| &mut limits.linear_m_s).map(|answer| (answer, Some(17))),
            30 => self.reset_twist(payload, |limits| &mut limits.angular_deg_s).map(|answer| (answer, Some(18))),
            31 => self.reset_joints(payload, |limits| &mut limits.joint_deg_s2).map(|answer| (answer, Some(19))),
            _ => Err(UNSUPPORTED_METHOD),
        }
    }

    /// Returns the speeds of the joystick, which the emulated arm does not have.
    fn joystick(&mut self, function: u16, payload: &[u8]) -> Result<(Vec<u8>, Option<u32>), InterfaceError> {
        let max = hard(0);
        match function {
            21 => self.desired.linear_m_s = within(read::<Real>(payload)?.value, max.linear_m_s)?,
            22 => self.desired.angular_deg_s = within(read::<Real>(payload)?.value, max.angular_deg_s)?,
            23 => self.desired.joint_deg_s = all_within(read::<Reals>(payload)?.values, &max.joint_deg_s)?,
            _ => return Ok((self.desired.encode_to_vec(), None)),
        }
        Ok((Vec::new(), Some(u32::from(function) - 1)))
    }

    fn soft(&mut self, mode: u32) -> Result<&mut KinematicLimits, InterfaceError> {
        self.soft.iter_mut().find(|limits| limits.mode == mode).ok_or(INVALID_PARAM)
    }

    fn set_twist(&mut self, payload: &[u8], pick: fn(&mut KinematicLimits) -> &mut f32) -> AnswerPayload {
        let asked = read::<TwistLimit>(payload)?;
        let value = within(asked.value, *pick(&mut hard(0)))?;
        *pick(self.soft(asked.mode)?) = value;
        Ok(Vec::new())
    }

    fn set_joints(&mut self, payload: &[u8], pick: fn(&mut KinematicLimits) -> &mut Vec<f32>) -> AnswerPayload {
        let asked = read::<JointsLimit>(payload)?;
        let values = all_within(asked.values, pick(&mut hard(0)))?;
        *pick(self.soft(asked.mode)?) = values;
        Ok(Vec::new())
    }

    fn reset_twist(&mut self, payload: &[u8], pick: fn(&mut KinematicLimits) -> &mut f32) -> AnswerPayload {
        let mode = read::<KinovaNumber>(payload)?.value;
        let value = *pick(&mut hard(mode));
        *pick(self.soft(mode)?) = value;
        Ok(TwistLimit { mode, value }.encode_to_vec())
    }

    fn reset_joints(&mut self, payload: &[u8], pick: fn(&mut KinematicLimits) -> &mut Vec<f32>) -> AnswerPayload {
        let mode = read::<KinovaNumber>(payload)?.value;
        let values = pick(&mut hard(mode)).clone();
        pick(self.soft(mode)?).clone_from(&values);
        Ok(JointsLimit { mode, values }.encode_to_vec())
    }
}

/// Returns the upper bounds of all limits: the arm's own limits.
fn hard(mode: u32) -> KinematicLimits {
    KinematicLimits {
        mode,
        linear_m_s: TWIST_MAX.0 as f32,
        angular_deg_s: TWIST_MAX.1.to_degrees() as f32,
        joint_deg_s: GEN3.iter().map(|joint| joint.speed_rad_s.to_degrees() as f32).collect(),
        joint_deg_s2: ACCELERATION_RAD_S2.iter().map(|limit| limit.to_degrees() as f32).collect(),
    }
}

fn within(value: f32, max: f32) -> Result<f32, InterfaceError> {
    match value {
        value if value > max => Err(ABOVE_MAXIMUM),
        value if value >= 0.0 => Ok(value),
        _ => Err(INVALID_PARAM),
    }
}

fn all_within(values: Vec<f32>, max: &[f32]) -> Result<Vec<f32>, InterfaceError> {
    if values.len() != max.len() {
        return Err(JOINT_COUNT);
    }
    values.into_iter().zip(max).map(|(value, max)| within(value, *max)).collect()
}

fn is_mass(mass_kg: f32) -> bool {
    (0.0..=100.0).contains(&mass_kg)
}

fn is_place(place: &FormVector) -> bool {
    [place.x, place.y, place.z].iter().all(|x| x.is_finite())
}

fn is_finite(pose: &KinovaPose) -> bool {
    [pose.x, pose.y, pose.z, pose.theta_x, pose.theta_y, pose.theta_z].iter().all(|x| x.is_finite())
}
