//! Sessions and calls of the emulated base.

use prost::Message;

use super::{Body, EmulatedArm, robot::Robot, server::Link};
use crate::device::{
    emulation::EmulatedFault,
    kinova::{
        frame::Frame,
        kinematics::{theta_rad, tool},
        limits::wire_degrees,
        messages::{
            Command, CreateSessionInfo, ERROR_DEVICE, ERROR_SERVER, JointAngle, JointAngles, Number, Pose, Rpc, Text,
            TwistCommand, sub,
        },
    },
};

/// Error class and sub error.
type Refused = (u8, u16);

struct Session {
    number: u16,
    link: Link,
    heard_s: f64,
    /// Silent for so long it is closed, s.
    closes_s: f64,
    /// Silent for so long its motion stops, s.
    stops_s: f64,
}

/// The base: who is logged in, who drives, and the robot behind it.
pub(super) struct Base {
    arm: EmulatedArm,
    robot: Robot,
    sessions: Vec<Session>,
    made: u16,
    /// Session whose twist moves the arm.
    driving: Option<u16>,
}

const SERVICES: [u16; 4] = [1, 2, 3, 9];
/// Firmware that it tells: 2.5.2 in the manufacturer's way.
const FIRMWARE: u32 = 0x0205_0002;

impl Base {
    pub(super) fn new(arm: EmulatedArm, body: Box<dyn Body>) -> Self {
        let robot = Robot::new(arm.clone(), body);
        Self { arm, robot, sessions: Vec::new(), made: 0, driving: None }
    }

    pub(super) fn advance(&mut self, now_s: f64, fault: EmulatedFault) {
        self.robot.advance(now_s, fault);
        let silent = |session: &Session| now_s - session.heard_s > session.stops_s;
        if self.sessions.iter().any(|session| Some(session.number) == self.driving && silent(session)) {
            self.release();
        }
        self.sessions.retain(|session| now_s - session.heard_s <= session.closes_s);
    }

    /// Sessions of links that are gone.
    pub(super) fn forget(&mut self, gone: impl Fn(Link) -> bool) {
        if self.sessions.iter().any(|session| Some(session.number) == self.driving && gone(session.link)) {
            self.release();
        }
        self.sessions.retain(|session| !gone(session.link));
    }

    const fn release(&mut self) {
        self.robot.stop();
        self.driving = None;
    }

    /// The number of the session and the payload of the answer.
    pub(super) fn answer(
        &mut self,
        link: Link,
        asked: &Frame<'_>,
        now_s: f64,
        fault: EmulatedFault,
    ) -> Result<(u16, Vec<u8>), Refused> {
        let (header, rpc) = (&asked.header, asked.header.rpc());
        if rpc == Rpc::CREATE_SESSION {
            return self.log_in(link, &read(asked)?, now_s).map(|number| (number, Vec::new()));
        }
        let own = |session: &&mut Session| session.number == header.session && session.link == link;
        let session = self.sessions.iter_mut().find(own).ok_or((ERROR_DEVICE, sub::INVALID_SESSION))?;
        session.heard_s = now_s;
        let number = session.number;
        // The cyclic connection carries the cycle and its session only.
        if !SERVICES.contains(&rpc.service) || (matches!(link, Link::Udp(_)) && !matches!(rpc.service, 1 | 3)) {
            return Err((ERROR_SERVER, sub::UNSUPPORTED_SERVICE));
        }
        let payload = match rpc.service {
            3 => self.cycle(rpc, asked, now_s, fault),
            2 => self.base_call(rpc, asked, number),
            _ => self.other_call(rpc, link, number),
        }?;
        Ok((number, payload))
    }

    fn log_in(&mut self, link: Link, login: &CreateSessionInfo, now_s: f64) -> Result<u16, Refused> {
        if login.username != self.arm.user {
            return Err((ERROR_DEVICE, sub::USER_NOT_FOUND));
        }
        if login.password != self.arm.password {
            return Err((ERROR_DEVICE, sub::INVALID_PASSWORD));
        }
        self.made = self.made.checked_add(1).unwrap_or(1);
        self.sessions.retain(|session| session.link != link);
        self.sessions.push(Session {
            number: self.made,
            link,
            heard_s: now_s,
            closes_s: f64::from(login.session_inactivity_ms) * 1e-3,
            stops_s: f64::from(login.connection_inactivity_ms) * 1e-3,
        });
        Ok(self.made)
    }

    fn cycle(&mut self, rpc: Rpc, asked: &Frame<'_>, now_s: f64, fault: EmulatedFault) -> Result<Vec<u8>, Refused> {
        let device = |code| (ERROR_DEVICE, code);
        match rpc {
            Rpc::REFRESH => self.robot.command(now_s, &read::<Command>(asked)?).map_err(device)?,
            Rpc::REFRESH_COMMAND => {
                self.robot.command(now_s, &read::<Command>(asked)?).map_err(device)?;
                return Ok(Vec::new());
            }
            Rpc::REFRESH_FEEDBACK => {}
            _ => return Err((ERROR_SERVER, sub::UNSUPPORTED_METHOD)),
        }
        Ok(self.robot.told(fault).encode_to_vec())
    }

    fn base_call(&mut self, rpc: Rpc, asked: &Frame<'_>, session: u16) -> Result<Vec<u8>, Refused> {
        let device = |code| (ERROR_DEVICE, code);
        match rpc {
            Rpc::STOP => self.release(),
            Rpc::EMERGENCY_STOP => self.robot.emergency_stop(),
            Rpc::CLEAR_FAULTS => self.robot.clear_faults(),
            Rpc::SEND_TWIST => {
                if self.driving.is_some_and(|driving| driving != session) {
                    return Err(device(sub::NOT_IN_CONTROL));
                }
                self.robot.twist(&read::<TwistCommand>(asked)?).map_err(device)?;
                self.driving = Some(session);
            }
            Rpc::SET_SERVOING_MODE => {
                self.robot.set_mode(read::<Number>(asked)?.value).map_err(device)?;
                self.driving = None;
            }
            Rpc::GET_SERVOING_MODE => return Ok(Number { value: self.robot.mode() as u32 }.encode_to_vec()),
            Rpc::ACTUATOR_COUNT => return Ok(Number { value: self.arm.joints }.encode_to_vec()),
            Rpc::ARM_STATE => return Ok(Number { value: self.robot.state() }.encode_to_vec()),
            Rpc::MEASURED_ANGLES => return Ok(self.angles().encode_to_vec()),
            Rpc::MEASURED_POSE => return Ok(self.pose().encode_to_vec()),
            _ => return Err((ERROR_SERVER, sub::UNSUPPORTED_METHOD)),
        }
        Ok(Vec::new())
    }

    fn other_call(&mut self, rpc: Rpc, link: Link, session: u16) -> Result<Vec<u8>, Refused> {
        match rpc {
            Rpc::KEEP_ALIVE => Ok(Vec::new()),
            Rpc::CLOSE_SESSION => {
                if self.driving == Some(session) {
                    self.release();
                }
                self.sessions.retain(|one| one.link != link);
                Ok(Vec::new())
            }
            Rpc::FIRMWARE_VERSION => Ok(Number { value: FIRMWARE }.encode_to_vec()),
            Rpc::MODEL_NUMBER => Ok(Text { value: "emulated".to_owned() }.encode_to_vec()),
            Rpc::SERIAL_NUMBER => Ok(Text { value: "EMULATED-1".to_owned() }.encode_to_vec()),
            _ => Err((ERROR_SERVER, sub::UNSUPPORTED_METHOD)),
        }
    }

    fn angles(&self) -> JointAngles {
        let angle = |(joint, angle): (usize, &f64)| JointAngle { joint: joint as u32, value_deg: wire_degrees(*angle) };
        JointAngles { angles: self.robot.body().joint_rad.iter().enumerate().map(angle).collect() }
    }

    fn pose(&self) -> Pose {
        let pose = tool(&self.robot.body().joint_rad);
        let theta = theta_rad(&pose.rotation).map(|angle| angle.to_degrees() as f32);
        let place = pose.translation.vector.cast::<f32>();
        Pose { x: place.x, y: place.y, z: place.z, theta_x: theta[0], theta_y: theta[1], theta_z: theta[2] }
    }
}

fn read<T: Message + Default>(asked: &Frame<'_>) -> Result<T, Refused> {
    T::decode(asked.payload).map_err(|_| (ERROR_SERVER, sub::PAYLOAD_DECODING))
}
