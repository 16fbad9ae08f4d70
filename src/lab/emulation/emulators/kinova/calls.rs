//! Sessions and calls of the emulated base.

use nima_devices::kinova::{
    frame::KinovaFrame,
    messages::{CreateSessionInfo, ERROR_DEVICE, KinovaCommand, KinovaNumber, Rpc, ServoingMode, sub},
};
use prost::Message;

use super::{
    EmulatedKinova, KinovaBody,
    actions::Player,
    control::KinovaControl,
    devices::KinovaDevices,
    entities::StoredEntity,
    interface::{
        ACTION_TOPIC, ARM_STATE_TOPIC, AnswerPayload, CLEAR_ACTUATOR_FAULTS, CONFIGURATION_TOPIC, CONTROL_CONFIG_MODE,
        CONTROL_TOPIC, CONTROL_UNSUBSCRIBE, InterfaceError, SEQUENCE_TOPIC, SERVOING_TOPIC, UNSUBSCRIBE,
        UNSUPPORTED_METHOD, UNSUPPORTED_SERVICE, read,
    },
    robot::Robot,
    topics::{KinovaTopics, Notice},
};
use crate::emulators::{EmulatedFault, WirePeer};

struct CallSession {
    number: u16,
    link: WirePeer,
    received_s: f64,
    /// Time without data after which the session is closed, s.
    closes_s: f64,
    /// Time without data after which the session's motion stops, s.
    stops_s: f64,
}

#[derive(Clone, Copy)]
pub(super) struct Call<'a> {
    pub(super) rpc: Rpc,
    device: u8,
    pub(super) payload: &'a [u8],
    pub(super) session: u16,
    link: WirePeer,
}

/// The base: sessions, control of the arm, the devices within the arm, and the robot behind it.
pub(super) struct Base {
    pub(super) arm: EmulatedKinova,
    pub(super) robot: Robot,
    pub(super) devices: KinovaDevices,
    pub(super) control: KinovaControl,
    pub(super) kept: StoredEntity,
    pub(super) player: Player,
    pub(super) topics: KinovaTopics,
    sessions: Vec<CallSession>,
    made: u16,
    /// Session whose command moves the arm.
    driving: Option<u16>,
    /// Arm state and servoing mode of the last notification.
    report: (u32, ServoingMode),
}

impl Base {
    pub(super) fn new(arm: EmulatedKinova, body: Box<dyn KinovaBody>) -> Self {
        let robot = Robot::new(arm.clone(), body);
        Self {
            devices: KinovaDevices::new(arm.joints, arm.serial.clone()),
            control: KinovaControl::new(),
            kept: StoredEntity::default(),
            player: Player::default(),
            topics: KinovaTopics::default(),
            report: (robot.state(), robot.mode()),
            arm,
            robot,
            sessions: Vec::new(),
            made: 0,
            driving: None,
        }
    }

    pub(super) fn advance(&mut self, now_s: f64, fault: EmulatedFault) {
        self.robot.advance(now_s, fault);
        let silent = |session: &CallSession| now_s - session.received_s > session.stops_s;
        if self.sessions.iter().any(|session| Some(session.number) == self.driving && silent(session)) {
            self.release();
        }
        self.sessions.retain(|session| now_s - session.received_s <= session.closes_s);
        self.forget_topics();
        if self.player.advance(&mut self.robot, &mut self.topics) {
            self.driving = None;
        }
        let state = self.robot.state();
        let mode = self.robot.mode();
        if self.report.0 != state {
            self.topics.report(ARM_STATE_TOPIC, &KinovaNumber { value: state });
        }
        if self.report.1 != mode {
            self.topics.report(SERVOING_TOPIC, &KinovaNumber { value: mode as u32 });
        }
        self.report = (state, mode);
    }

    fn forget_topics(&mut self) {
        let sessions = &self.sessions;
        self.topics.keep(|number| sessions.iter().any(|session| session.number == number));
    }

    /// Returns the notifications due now.
    pub(super) fn notices(&mut self) -> Vec<Notice> {
        self.topics.take()
    }

    /// Removes the sessions of closed connections.
    pub(super) fn forget(&mut self, gone: impl Fn(WirePeer) -> bool) {
        if self.sessions.iter().any(|session| Some(session.number) == self.driving && gone(session.link)) {
            self.release();
        }
        self.sessions.retain(|session| !gone(session.link));
    }

    pub(super) fn release(&mut self) {
        self.robot.stop();
        self.driving = None;
    }

    /// Executes a motion command, unless another session moves the arm.
    pub(super) fn drive(
        &mut self,
        session: u16,
        command: impl FnOnce(&mut Self) -> Result<(), InterfaceError>,
    ) -> Result<(), InterfaceError> {
        if self.driving.is_some_and(|driving| driving != session) {
            return Err((ERROR_DEVICE, sub::NOT_IN_CONTROL));
        }
        command(self)?;
        self.driving = Some(session);
        Ok(())
    }

    /// Returns the session number and the payload of the answer.
    pub(super) fn answer(
        &mut self,
        link: WirePeer,
        asked: &KinovaFrame<'_>,
        now_s: f64,
        fault: EmulatedFault,
    ) -> Result<(u16, Vec<u8>), InterfaceError> {
        let header = &asked.header;
        let rpc = asked.header.rpc();
        if rpc == Rpc::CREATE_SESSION {
            return self.log_in(link, &read(asked.payload)?, now_s).map(|number| (number, Vec::new()));
        }
        let own = |session: &&mut CallSession| session.number == header.session && session.link == link;
        let session = self.sessions.iter_mut().find(own).ok_or((ERROR_DEVICE, sub::INVALID_SESSION))?;
        session.received_s = now_s;
        let number = session.number;
        let call = Call { rpc, device: header.device, payload: asked.payload, session: number, link };
        Ok((number, self.serve(&call, now_s, fault)?))
    }

    fn serve(&mut self, call: &Call<'_>, now_s: f64, fault: EmulatedFault) -> AnswerPayload {
        let Call { rpc, device, payload, .. } = *call;
        // The cyclic connection carries only the cyclic service and its session.
        if matches!(call.link, WirePeer::Address(_)) && !matches!(rpc.service, 1 | 3) {
            return Err(UNSUPPORTED_SERVICE);
        }
        match rpc.service {
            9 => return self.devices.config(rpc, device),
            10 if rpc == CLEAR_ACTUATOR_FAULTS => {
                self.robot.clear_actuator(self.devices.actuator_index(device)?);
                return Ok(Vec::new());
            }
            10 => return self.devices.actuator(rpc, device, payload),
            14 => return self.devices.interconnect(rpc, device, payload),
            _ => self.devices.check_base(device)?,
        }
        match rpc.service {
            1 => self.session_call(call),
            2 | 16 if is_topic(rpc) => {
                let identifier = self.topics.subscribe(rpc, call.session, call.link)?;
                Ok(KinovaNumber { value: u32::from(identifier) }.encode_to_vec())
            }
            2 | 16 if matches!(rpc, UNSUBSCRIBE | CONTROL_UNSUBSCRIBE) => {
                self.topics.unsubscribe(read::<KinovaNumber>(payload)?.value, call.session)?;
                Ok(Vec::new())
            }
            2 => self.base_call(call),
            3 => self.cycle(rpc, payload, now_s, fault),
            16 => self.control_call(rpc, payload),
            23 => self.devices.manager(rpc),
            _ => Err(UNSUPPORTED_SERVICE),
        }
    }

    fn log_in(&mut self, link: WirePeer, login: &CreateSessionInfo, now_s: f64) -> Result<u16, InterfaceError> {
        if login.username != self.arm.user {
            return Err((ERROR_DEVICE, sub::USER_NOT_FOUND));
        }
        if login.password != self.arm.password {
            return Err((ERROR_DEVICE, sub::INVALID_PASSWORD));
        }
        self.made = self.made.checked_add(1).unwrap_or(1);
        self.sessions.retain(|session| session.link != link);
        self.sessions.push(CallSession {
            number: self.made,
            link,
            received_s: now_s,
            closes_s: f64::from(login.session_inactivity_ms) * 1e-3,
            stops_s: f64::from(login.connection_inactivity_ms) * 1e-3,
        });
        Ok(self.made)
    }

    fn session_call(&mut self, call: &Call<'_>) -> AnswerPayload {
        match call.rpc {
            Rpc::KEEP_ALIVE => {}
            Rpc::CLOSE_SESSION => {
                if self.driving == Some(call.session) {
                    self.release();
                }
                self.sessions.retain(|one| one.link != call.link);
                self.forget_topics();
            }
            _ => return Err(UNSUPPORTED_METHOD),
        }
        Ok(Vec::new())
    }

    fn cycle(&mut self, rpc: Rpc, payload: &[u8], now_s: f64, fault: EmulatedFault) -> AnswerPayload {
        let device = |code| (ERROR_DEVICE, code);
        match rpc {
            Rpc::REFRESH => self.robot.command(now_s, &read::<KinovaCommand>(payload)?).map_err(device)?,
            Rpc::REFRESH_COMMAND => {
                self.robot.command(now_s, &read::<KinovaCommand>(payload)?).map_err(device)?;
                return Ok(Vec::new());
            }
            Rpc::REFRESH_FEEDBACK => {}
            _ => return Err(UNSUPPORTED_METHOD),
        }
        Ok(self.robot.report(fault).encode_to_vec())
    }

    fn control_call(&mut self, rpc: Rpc, payload: &[u8]) -> AnswerPayload {
        if rpc == CONTROL_CONFIG_MODE {
            return Ok(KinovaNumber { value: self.robot.control_mode() }.encode_to_vec());
        }
        let (answer, event) = self.control.answer(rpc.function, payload)?;
        if let Some(event) = event {
            self.topics.report(CONTROL_TOPIC, &KinovaNumber { value: event });
        }
        Ok(answer)
    }
}

/// Returns whether this call is about topics of notifications.
const fn is_topic(rpc: Rpc) -> bool {
    matches!(
        rpc,
        CONFIGURATION_TOPIC | SEQUENCE_TOPIC | ACTION_TOPIC | SERVOING_TOPIC | ARM_STATE_TOPIC | CONTROL_TOPIC
    )
}
