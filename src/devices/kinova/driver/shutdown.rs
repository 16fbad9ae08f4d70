//! Closes a connection: in every case the arm is left at rest, in single-level servoing, with our sessions closed.
//!
//! Waits for up to two seconds, so it must not run on the real-time thread.

use std::{
    thread::sleep,
    time::{Duration, Instant},
};

use super::{KinovaDriver, KinovaMode};
use crate::{
    Device as _,
    kinova::{
        messages::{KinovaNumber, Rpc, ServoingMode},
        session::KinovaLines,
    },
    transport::TransportDatagrams as _,
};

/// Maximum time to brake and leave low-level servoing; from full speed braking takes 0.3 s.
const LEAVE: Duration = Duration::from_millis(800);
/// Short, because the arm's own watchdog ends a session that is not closed.
const ANSWER: Duration = Duration::from_millis(200);
// 1 kHz, the rate of the arm's cyclic connection.
const TICK: Duration = Duration::from_millis(1);

impl KinovaDriver {
    pub(super) fn leave(&mut self) {
        // Release an active twist first: it occurs only in single-level servoing, which needs no braking afterwards.
        if self.twist.active {
            self.release_twist();
        }
        self.leave_low_level();
        let begin = Instant::now();
        let begin_s = self.now_s;
        while self.mode != KinovaMode::Single && !self.is_lost() && begin.elapsed() < LEAVE {
            sleep(TICK);
            self.poll(begin_s + begin.elapsed().as_secs_f64());
        }
        if self.mode != KinovaMode::Single {
            // The cyclic connection does not work: at least request single-level servoing and a stop.
            let single = KinovaNumber { value: ServoingMode::Single as u32 };
            self.lines.ask_within(Rpc::SET_SERVOING_MODE, &single, ANSWER).ok();
        }
        close_sessions(&mut self.lines);
    }
}

pub(in crate::kinova) fn close_sessions(lines: &mut KinovaLines) {
    let (_, bytes) = lines.cyclic.request(Rpc::CLOSE_SESSION, &());
    // Without waiting for an answer: if the datagram is lost, the session ends by its timeout.
    lines.udp.send(bytes).ok();
    lines.ask_within(Rpc::CLOSE_SESSION, &(), ANSWER).ok();
}
