//! Incoming data: answers of the cycle and to calls, checked and counted.

use super::{CallAnswer, KinovaDriver, KinovaMode};
use crate::{
    ARM_JOINTS, ArmReading, Loss, TimedReading,
    kinova::{
        faults::KinovaFaults,
        feedback::KinovaFeedback,
        frame::{KinovaFrame, KinovaHeader, NOTIFICATION, RESPONSE},
        limits::unwrapped,
        messages::{ArmState, Rpc, sub},
    },
    transport::{ByteStream as _, TransportDatagrams as _},
};

/// Malformed frames in a row after which the arm is lost: 10 ms at 1 kHz, so that a single one does no harm.
const DAMAGED_MAX: u32 = 10;
/// Fewer than damaged ones, because an answer that passes the length checks and is still impossible rarely comes from
/// the line.
const IMPOSSIBLE_MAX: u32 = 5;
/// Maximum number of datagrams handled in one poll, so that a sender that floods the port cannot hold up the loop.
const DATAGRAMS: usize = 64;
/// Maximum number of reads of the stream in one poll, so that a flood of notifications cannot hold up the loop.
const READS: usize = 4;
/// Maximum plausible speed of a joint, rad/s; with [`JUMP_RAD`] it bounds the change between two readings. About seven
/// times the fastest joint of a Gen3 (1.4 rad/s).
const JUMP_RAD_S: f64 = 10.0;
// Noise and a lost reading at a moderate speed stay below it.
const JUMP_RAD: f64 = 0.2;

impl KinovaDriver {
    /// Handles the answers of the cycle and returns the newest valid one.
    pub(super) fn take_cycle(&mut self, now_s: f64) -> Option<TimedReading<ArmReading>> {
        let mut newest = None;
        for _ in 0..DATAGRAMS {
            let count = match self.lines.udp.receive(&mut self.lines.datagram) {
                Ok(Some(count)) => count,
                Ok(None) => break,
                Err(loss) => {
                    self.health.lose(loss);
                    break;
                }
            };
            let joints = self.command.actuators.len();
            let report = KinovaFrame::decode(&self.lines.datagram[..count]).map(|frame| {
                let feedback = KinovaFeedback::decode(frame.payload).ok().filter(|report| report.count == joints);
                (frame.header, feedback)
            });
            let good = match report {
                Ok((header, feedback)) => self.take_datagram(&header, feedback.as_ref(), now_s),
                Err(_) => self.damaged(),
            };
            if good {
                newest = Some(TimedReading { device_s: None, arrival_s: now_s, value: self.reading() });
            }
        }
        newest
    }

    fn damaged(&mut self) -> bool {
        self.health.damaged += 1;
        self.damaged_in_row += 1;
        if self.damaged_in_row >= DAMAGED_MAX {
            self.health.lose(Loss::Corrupt);
        }
        false
    }

    /// Returns true if it is a new and valid reading.
    fn take_datagram(&mut self, header: &KinovaHeader, feedback: Option<&KinovaFeedback>, now_s: f64) -> bool {
        let cyclic = matches!(header.rpc(), Rpc::REFRESH | Rpc::REFRESH_FEEDBACK);
        match header.kind {
            RESPONSE if header.error != 0 => {
                self.refused(header);
                return false;
            }
            RESPONSE if cyclic => {}
            // Answers to other services on this connection carry no reading, but they are not damaged.
            RESPONSE if header.service == Rpc::KEEP_ALIVE.service => return false,
            NOTIFICATION => return false,
            _ => return self.damaged(),
        }
        let Some(feedback) = feedback else { return self.damaged() };
        self.damaged_in_row = 0;
        // After the checks of the format, so that a damaged frame cannot mark a request as answered.
        if !self.cycle.answered(header.message, &mut self.health) {
            return false;
        }
        let faults = KinovaFaults::of(feedback);
        if faults.any() {
            self.feedback = *feedback;
            self.health.refused += 1;
            self.health.lose(Loss::Device { code: faults.code() });
            return false;
        }
        // The protocol reports angles from 0 to 360 degrees; a continuous joint would jump by a turn at its end.
        let joint_rad = std::array::from_fn(|j| unwrapped(feedback.actuators[j].position_deg, self.joint_rad[j]));
        if !self.is_possible(feedback, &joint_rad, now_s) {
            self.health.refused += 1;
            self.impossible_in_row += 1;
            if self.impossible_in_row >= IMPOSSIBLE_MAX {
                self.health.lose(Loss::Implausible);
            }
            return false;
        }
        self.impossible_in_row = 0;
        self.unanswered_s = None;
        self.feedback = *feedback;
        self.joint_rad = joint_rad;
        self.health.accept(now_s);
        true
    }

    /// Returns whether the numbers are finite, within the arm's limits, and close enough to the last ones.
    fn is_possible(&self, feedback: &KinovaFeedback, joint_rad: &[f64; ARM_JOINTS], now_s: f64) -> bool {
        // Before the first reading there is nothing to compare with, so `age_s` is infinite and any jump is accepted.
        let reach_rad = JUMP_RAD_S.mul_add(self.health.age_s(now_s), JUMP_RAD);
        feedback.is_finite()
            && feedback.actuators.iter().all(|a| a.position_deg.abs() <= 720.0 && a.velocity_deg_s.abs() <= 1000.0)
            && joint_rad.iter().zip(&self.joint_rad).all(|(now, last)| (now - last).abs() <= reach_rad)
    }

    /// Handles an error that arrived instead of an answer, on either connection.
    fn refused(&mut self, header: &KinovaHeader) {
        let answer = CallAnswer { rpc: header.rpc(), error: header.error, sub_error: header.sub_error };
        let cyclic = matches!(answer.rpc, Rpc::REFRESH | Rpc::REFRESH_FEEDBACK);
        if cyclic {
            self.cycle.answered(header.message, &mut self.health);
            self.health.refused += 1;
        }
        match header.sub_error {
            // The arm has forgotten us, as after a restart: only a new login helps.
            sub::INVALID_SESSION => {
                self.health.lose(Loss::Disconnected);
            }
            sub::WRONG_SERVOING_MODE if cyclic => {
                self.unanswered_s = None;
                // Another client returned the arm to single-level servoing.
                if matches!(self.mode, KinovaMode::Low | KinovaMode::Braking) {
                    self.mode = KinovaMode::Single;
                    self.ousted += 1;
                    self.answer = Some(answer);
                }
            }
            code if cyclic => {
                self.health.lose(Loss::Device { code: u32::from(code) });
            }
            _ => self.answer = Some(answer),
        }
    }

    fn reading(&self) -> ArmReading {
        let actuators = &self.feedback.actuators;
        ArmReading {
            joint_rad: self.joint_rad,
            joint_rad_s: std::array::from_fn(|j| f64::from(actuators[j].velocity_deg_s).to_radians()),
            // The arm reports measured torques with the opposite sign to commanded torques.
            joint_nm: std::array::from_fn(|j| -f64::from(actuators[j].torque_nm)),
            // Both must agree: our mode is what was requested, the arm's state is what it does.
            servoing: self.mode == KinovaMode::Low && self.feedback.state == ArmState::SERVOING_LOW_LEVEL,
        }
    }

    pub(super) fn take_answers(&mut self, now_s: f64) {
        for _ in 0..READS {
            match self.lines.tcp.receive(self.lines.packets.room()) {
                Ok(0) => break,
                Ok(count) => self.lines.packets.filled(count),
                Err(loss) => {
                    self.health.lose(loss);
                    return;
                }
            }
            while let Some(header) = self.lines.packets.next_frame().map(|frame| frame.header) {
                if header.kind == RESPONSE {
                    self.call_unanswered_s = None;
                    self.take_answer(&header, now_s);
                }
            }
        }
        let packets = &self.lines.packets;
        self.health.skipped_bytes += packets.skipped - self.seen.0;
        self.health.damaged += packets.damaged - self.seen.1;
        self.seen = (packets.skipped, packets.damaged);
    }

    fn take_answer(&mut self, header: &KinovaHeader, now_s: f64) {
        let good = header.error == 0;
        if !good {
            self.refused(header);
        }
        match self.mode {
            KinovaMode::Entering { number, .. } if number == header.message => {
                self.mode = if good { KinovaMode::Low } else { KinovaMode::Single };
                // Also after a refusal, so that a command of the previous servoing can never be sent.
                self.guard.seed(&self.joint_rad);
            }
            KinovaMode::Leaving { number, .. } if number == header.message && good => self.mode = KinovaMode::Single,
            KinovaMode::Leaving { number, .. } if number == header.message => self.ask_single_level(now_s),
            _ => {}
        }
    }
}
