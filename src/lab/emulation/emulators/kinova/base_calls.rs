//! Calls of the service `Base` other than actions and entities.

use nima_devices::{
    ARM_JOINTS,
    kinova::{
        kinematics::{theta_rad, tool},
        limits::wire_degrees,
        messages::{ERROR_DEVICE, JointAngle, JointAngles, KinovaNumber, KinovaPose, Rpc, TwistCommand},
    },
};
use prost::Message as _;

use super::{
    calls::{Base, Call},
    forms::{BridgeResult, InverseQuestion, JointSpeeds, Product, Reals},
    interface::{
        AnswerPayload, CONTROL_MODE, ENABLE_BRIDGE, EXECUTE_ACTION, EXECUTE_REFERENCE, EXECUTE_WAYPOINTS,
        FORWARD_KINEMATICS, GRIPPER_COMMAND, GRIPPER_MOVEMENT, INVALID_PARAM, INVERSE_KINEMATICS, InterfaceError,
        JOINT_COUNT, JOINT_SPEEDS, PLAY_SEQUENCE, PRODUCT, STOP_ACTION, STOP_SEQUENCE, UNSUPPORTED_METHOD, read,
    },
    joint_motion::{KinovaJoints, goal, reach},
};

/// `BridgeStatus`: there is no bridge to a serial port or a network behind the arm.
const NO_BRIDGES: u32 = 5;

impl Base {
    pub(super) fn base_call(&mut self, call: &Call<'_>) -> AnswerPayload {
        let device = |code| (ERROR_DEVICE, code);
        let Call { rpc, payload, session, .. } = *call;
        match rpc {
            Rpc::STOP | STOP_ACTION | STOP_SEQUENCE => self.release(),
            Rpc::EMERGENCY_STOP => self.robot.emergency_stop(),
            Rpc::CLEAR_FAULTS => self.robot.clear_faults(),
            Rpc::SEND_TWIST => {
                let command = read::<TwistCommand>(payload)?;
                self.drive(session, |base| base.robot.twist(&command).map_err(device))?;
            }
            JOINT_SPEEDS => {
                let rad_s = speeds(&read(payload)?)?;
                self.drive(session, |base| base.robot.move_joints(rad_s))?;
            }
            EXECUTE_REFERENCE | EXECUTE_ACTION | EXECUTE_WAYPOINTS | PLAY_SEQUENCE => {
                self.drive(session, |base| {
                    base.player.answer(rpc, payload, &mut base.robot, &mut base.topics).map(drop)
                })?;
            }
            Rpc::SET_SERVOING_MODE => {
                self.robot.set_mode(read::<KinovaNumber>(payload)?.value).map_err(device)?;
                self.release();
            }
            // There is no gripper: the command has no effect, and no finger is reported.
            GRIPPER_COMMAND => {}
            _ => return self.question(call),
        }
        Ok(Vec::new())
    }

    fn question(&mut self, call: &Call<'_>) -> AnswerPayload {
        let Call { rpc, payload, .. } = *call;
        let number = |value: u32| Ok(KinovaNumber { value }.encode_to_vec());
        let joint_rad = self.robot.body().joint_rad;
        match rpc {
            Rpc::GET_SERVOING_MODE => number(self.robot.mode() as u32),
            Rpc::ACTUATOR_COUNT => number(self.arm.joints),
            Rpc::ARM_STATE => number(self.robot.state()),
            CONTROL_MODE => number(self.robot.control_mode()),
            Rpc::MEASURED_ANGLES => Ok(angles(&joint_rad).encode_to_vec()),
            Rpc::MEASURED_POSE => Ok(pose(&joint_rad).encode_to_vec()),
            FORWARD_KINEMATICS => Ok(pose(&given(&read(payload)?)?).encode_to_vec()),
            INVERSE_KINEMATICS => {
                let asked = read::<InverseQuestion>(payload)?;
                let near_rad = asked.guess.as_ref().map_or(Ok(joint_rad), given)?;
                Ok(angles(&reach(&asked.pose.ok_or(INVALID_PARAM)?, &near_rad)?).encode_to_vec())
            }
            GRIPPER_MOVEMENT => Ok(Reals::default().encode_to_vec()),
            ENABLE_BRIDGE => Ok(BridgeResult { bridge: None, status: NO_BRIDGES }.encode_to_vec()),
            PRODUCT => Ok(self.product().encode_to_vec()),
            _ => match self.player.answer(rpc, payload, &mut self.robot, &mut self.topics) {
                Err(UNSUPPORTED_METHOD) => self.kept.answer(rpc, payload, &mut self.player.sequences, &mut self.topics),
                answered => answered,
            },
        }
    }

    /// Returns the description of a Gen3 on a fixed base, with a spherical wrist and no end effector.
    fn product(&self) -> Product {
        Product {
            kin: self.arm.serial.clone(),
            model: 1,
            joints: self.arm.joints,
            base: 2,
            end_effector: 1,
            vision: 1,
            interconnect: 2,
            wrist: 2,
        }
    }
}

fn angles(joint_rad: &KinovaJoints) -> JointAngles {
    let angle = |(joint, angle): (usize, &f64)| JointAngle { joint: joint as u32, value_deg: wire_degrees(*angle) };
    JointAngles { angles: joint_rad.iter().enumerate().map(angle).collect() }
}

fn pose(joint_rad: &KinovaJoints) -> KinovaPose {
    let pose = tool(joint_rad);
    let theta = theta_rad(&pose.rotation).map(|angle| angle.to_degrees() as f32);
    let place = pose.translation.vector.cast::<f32>();
    KinovaPose { x: place.x, y: place.y, z: place.z, theta_x: theta[0], theta_y: theta[1], theta_z: theta[2] }
}

/// Returns the joint angles of a client, in order.
fn given(angles: &JointAngles) -> Result<KinovaJoints, InterfaceError> {
    let degrees: Vec<f32> = angles.angles.iter().map(|angle| angle.value_deg).collect();
    goal(&degrees, &[0.0; ARM_JOINTS])
}

/// Returns the joint speeds of a client, rad/s, by the numbers of the joints.
fn speeds(asked: &JointSpeeds) -> Result<KinovaJoints, InterfaceError> {
    if asked.speeds.len() != ARM_JOINTS {
        return Err(JOINT_COUNT);
    }
    let mut rad_s = [0.0; ARM_JOINTS];
    for speed in &asked.speeds {
        let value = f64::from(speed.value_deg_s).to_radians();
        let joint = rad_s.get_mut(speed.joint as usize).ok_or(INVALID_PARAM)?;
        *joint = if value.is_finite() { value } else { return Err(INVALID_PARAM) };
    }
    Ok(rad_s)
}
