//! The program of an external arm (`docs/external-device.md`): it sends readings to the address at which the driver
//! listens, and follows the commands that come back.

pub(super) mod standalone;
#[cfg(test)]
mod tests;

use std::{io, net::SocketAddr};

use nima_devices::{
    ARM_JOINTS,
    external::{
        ExternalKind,
        codec::{BYTES_MAX, Datagram, ExternalMessage, padded, status},
    },
};

use super::{
    EmulatedFault, Emulator, EmulatorTurn, WireEnd, WirePeer,
    kinova::{BodyCommand, BodyState, KinovaBody},
    wires::udp,
};

/// Interval of readings, s.
const PERIOD_S: f64 = 1e-3;
/// Maximum number of readings made up after a pause; otherwise a paused process would flood the driver.
const CATCH_UP: u32 = 20;
/// Time without a command after which the arm holds, s: as the driver demands by default.
const WATCHDOG_S: f64 = 0.02;
/// Code of the arm's own fault.
const FAULT: u16 = 7;

/// Properties of an emulated arm.
#[derive(Clone, Debug, PartialEq)]
pub struct EmulatedExternalArm {
    /// Where the driver listens.
    pub listen: SocketAddr,
    /// 6 or 7.
    pub joints: usize,
    pub serial: String,
}

impl EmulatedExternalArm {
    /// Makes the emulator with the arm that it moves.
    pub fn with(self, body: impl KinovaBody + 'static) -> Box<dyn Emulator> {
        Box::new(ExternalArmProgram {
            // Different after every start.
            session: fastrand::u32(1..),
            of: self,
            body: Box::new(body),
            sequence: 0,
            newest: None,
            last_s: 0.0,
            next_s: 0.0,
            frozen: None,
        })
    }
}

struct ExternalArmProgram {
    of: EmulatedExternalArm,
    body: Box<dyn KinovaBody>,
    session: u32,
    sequence: u32,
    /// The newest command, and when it came, s.
    newest: Option<(f64, Datagram)>,
    last_s: f64,
    next_s: f64,
    frozen: Option<BodyState>,
}

impl ExternalArmProgram {
    /// Returns the angles of a fresh command to follow.
    fn asked_rad(&self, now_s: f64) -> Option<[f64; ARM_JOINTS]> {
        let (_, command) = self.newest.filter(|(came_s, _)| now_s - came_s <= WATCHDOG_S)?;
        command.has(status::ON).then(|| std::array::from_fn(|joint| command.numbers[joint]))
    }

    fn reading(&mut self, now_s: f64, fault: EmulatedFault) -> Datagram {
        let asked_rad = self.asked_rad(now_s).filter(|_| fault != EmulatedFault::DeviceFault);
        let asked = asked_rad.map_or(BodyCommand::Rest, BodyCommand::Joints);
        let state = self.body.step(now_s - self.last_s, &asked);
        self.last_s = now_s;
        self.sequence = self.sequence.wrapping_add(1);
        let state = if fault == EmulatedFault::Freeze { *self.frozen.get_or_insert(state) } else { self.moving(state) };
        let mut datagram = Datagram {
            session: self.session,
            sequence: self.sequence,
            time_us: 1 + (now_s * 1e6) as u64,
            echo_us: self.newest.map_or(0, |(_, command)| command.time_us),
            watchdog_us: (WATCHDOG_S * 1e6) as u32,
            status: if asked_rad.is_some() { status::ON } else { 0 },
            product: padded("emulated arm"),
            serial: padded(&self.of.serial),
            joints: self.of.joints,
            ..Datagram::blank(ExternalMessage::Reading(ExternalKind::Arm))
        };
        let groups = [&state.joint_rad, &state.joint_rad_s, &state.joint_nm];
        let numbers = groups.into_iter().flat_map(|group| &group[..self.of.joints]);
        datagram.numbers.iter_mut().zip(numbers).for_each(|(to, number)| *to = *number);
        match fault {
            EmulatedFault::DeviceFault => {
                datagram.status |= status::FAULT;
                datagram.fault = FAULT;
            }
            EmulatedFault::NotANumber => datagram.numbers[0] = f64::NAN,
            _ => {}
        }
        datagram
    }

    fn moving(&mut self, state: BodyState) -> BodyState {
        self.frozen = None;
        state
    }
}

impl Emulator for ExternalArmProgram {
    fn wires(&self) -> io::Result<Vec<Box<dyn WireEnd>>> {
        Ok(vec![udp(0)])
    }

    fn endpoint(&self, _: &[String]) -> String {
        self.of.listen.to_string()
    }

    fn receive(&mut self, _: WirePeer, bytes: &[u8], turn: &mut EmulatorTurn<'_>) {
        let command = Datagram::decode(bytes).ok().filter(|command| {
            command.message == ExternalMessage::Command(ExternalKind::Arm)
                && command.session == self.session
                && command.joints == self.of.joints
        });
        // An older command that arrives late is not followed.
        let is_newer = |command: &Datagram| self.newest.is_none_or(|(_, newest)| command.time_us > newest.time_us);
        if let Some(command) = command.filter(is_newer) {
            self.newest = Some((turn.now_s, command));
        }
    }

    fn pass(&mut self, turn: &mut EmulatorTurn<'_>) {
        self.next_s = self.next_s.max(turn.now_s - f64::from(CATCH_UP) * PERIOD_S);
        while self.next_s <= turn.now_s {
            let mut wire = [0; BYTES_MAX];
            let length = self.reading(self.next_s, turn.fault).encode(&mut wire);
            self.next_s += PERIOD_S;
            match turn.fault {
                EmulatedFault::BadChecksum => wire[length - 1] ^= 1,
                EmulatedFault::WrongFrame => wire[5] = 0,
                _ => {}
            }
            turn.send(WirePeer::Address(self.of.listen), &wire[..length]);
        }
    }

    fn due_s(&self) -> Option<f64> {
        Some(self.next_s)
    }
}
