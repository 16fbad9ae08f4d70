//! The connection to the program of an external device: order and age of received datagrams, watchdog, and answers.
//!
//! Nothing here waits or allocates. The age of a reading is bounded without a common clock: a reading is fresh if its
//! sender had received a command that is itself not older than the limit.

use super::{
    codec::{BYTES_MAX, Datagram, ExternalMessage, status},
    opening::OpeningResult,
    settings::{ExternalKind, ExternalSettings},
};
use crate::{ConnectionState, DeviceIdentity, Health, Loss, TimedReading, transport::TransportDatagrams};

/// Maximum number of datagrams read in one tick: 64 ms of a device at 1 kHz, and about 0.1 ms of work.
pub const READS_MAX: usize = 64;
/// Number of consecutive damaged or impossible datagrams after which the device is lost: 10 ms at 1 kHz, so that a
/// single one does no harm.
const BAD_MAX: u32 = 10;
/// Number of commands whose send time is stored: at 10 kHz this covers an age of 25 ms.
const SENT: usize = 256;
/// Offset between the time stamps during opening and those of the loop, us: opening counts from its own zero, and time
/// stamps must not decrease.
const OPENING_US: u64 = 1_000_000;

/// Times at which the newest commands were sent, on our clock, us.
#[derive(Debug)]
struct SentTimes {
    times_us: [u64; SENT],
    count: usize,
}

impl SentTimes {
    const fn add(&mut self, time_us: u64) {
        self.times_us[self.count % SENT] = time_us;
        self.count += 1;
    }

    /// Returns the newest command that was sent at or before this time, if it is still stored.
    fn newest_until(&self, time_us: u64) -> Option<u64> {
        let kept = self.count.min(SENT);
        let mut newest_first = (1..=kept).map(|back| self.times_us[(self.count - back) % SENT]);
        newest_first.find(|sent_us| *sent_us <= time_us)
    }
}

pub(super) struct ExternalLine {
    datagrams: Box<dyn TransportDatagrams>,
    kind: ExternalKind,
    /// Number of joints of an arm: every command to it, also the last one, has this many angles.
    joints: usize,
    session: u32,
    /// Sequence number and time of the newest accepted datagram.
    received: Option<(u32, u64)>,
    /// Sequence number of our newest command.
    sequence: u32,
    sent: SentTimes,
    silence_s: f64,
    age_max_us: u64,
    watchdog_us: u32,
    /// Lower bound of our time stamps.
    begins_us: u64,
    now_us: u64,
    first_s: Option<f64>,
    bad_in_a_row: u32,
    buffer: [u8; BYTES_MAX + 1],
    health: Health,
    identity: DeviceIdentity,
}

enum ReceivedDatagram<R> {
    Reading(R),
    /// Late, repeated, out of order, or from another program.
    Stale,
    Damaged,
    Refused,
    Fault(u16),
}

impl ExternalLine {
    /// Creates the connection to the program found while opening.
    pub(super) fn new(
        datagrams: Box<dyn TransportDatagrams>,
        kind: ExternalKind,
        settings: &ExternalSettings,
        met: &OpeningResult,
        identity: DeviceIdentity,
    ) -> Self {
        Self {
            datagrams,
            kind,
            joints: met.newest.joints,
            session: met.newest.session,
            received: Some((met.newest.sequence, met.newest.time_us)),
            sequence: met.sequence,
            sent: SentTimes { times_us: [0; SENT], count: 0 },
            silence_s: settings.silence_ms * 1e-3,
            age_max_us: (settings.age_max_ms * 1e3) as u64,
            watchdog_us: (settings.watchdog_ms * 1e3) as u32,
            begins_us: met.begins_us,
            now_us: met.begins_us + OPENING_US,
            first_s: None,
            bad_in_a_row: 0,
            buffer: [0; BYTES_MAX + 1],
            health: Health::opening(),
            identity,
        }
    }

    pub(super) const fn about(&self) -> (&Health, &DeviceIdentity) {
        (&self.health, &self.identity)
    }

    pub(super) const fn joints(&self) -> usize {
        self.joints
    }

    pub(super) const fn is_lost(&self) -> bool {
        matches!(self.health.standing, ConnectionState::Lost(_))
    }

    /// Reads the data that have arrived and returns the newest fresh reading; `read` converts a datagram, or rejects
    /// its numbers.
    pub(super) fn receive<R>(
        &mut self,
        now_s: f64,
        read: impl Fn(&Datagram) -> Option<R>,
    ) -> Option<(TimedReading<R>, u16)> {
        if self.is_lost() || !now_s.is_finite() {
            return None;
        }
        let first_s = *self.first_s.get_or_insert(now_s);
        self.now_us = self.begins_us + OPENING_US + ((now_s - first_s).max(0.0) * 1e6) as u64;
        let known_us = self.sent.newest_until(self.now_us.saturating_sub(self.age_max_us));
        let must_know_us = known_us.unwrap_or(self.begins_us + 1);
        let mut newest = None;
        let mut is_backlog = true;
        for _ in 0..READS_MAX {
            let count = match self.datagrams.receive(&mut self.buffer) {
                Ok(Some(count)) => count,
                Ok(None) => {
                    is_backlog = false;
                    break;
                }
                Err(loss) => {
                    self.health.lose(loss);
                    return None;
                }
            };
            let decoded = Datagram::decode(&self.buffer[..count]);
            let taken =
                decoded.map_or(ReceivedDatagram::Damaged, |datagram| self.judge(&datagram, must_know_us, &read));
            newest = self.count(taken, now_s).or(newest);
            if self.is_lost() {
                return None;
            }
        }
        // Data from the middle of a queue are old, regardless of their content.
        if is_backlog && newest.take().is_some() {
            self.health.out_of_order += 1;
        }
        if now_s - self.health.newest_s.unwrap_or(first_s) > self.silence_s {
            self.health.lose(Loss::Silent);
            return None;
        }
        newest.map(|(value, status, time_us)| {
            let device_s = Some(time_us as f64 * 1e-6);
            (TimedReading { device_s, arrival_s: now_s, value }, status)
        })
    }

    fn judge<R>(
        &mut self,
        datagram: &Datagram,
        must_know_us: u64,
        read: &impl Fn(&Datagram) -> Option<R>,
    ) -> ReceivedDatagram<(R, u16, u64)> {
        if datagram.message != ExternalMessage::Reading(self.kind) {
            return ReceivedDatagram::Damaged;
        }
        if datagram.session != self.session {
            return ReceivedDatagram::Stale;
        }
        if let Some((sequence, time_us)) = self.received {
            let ahead = datagram.sequence.wrapping_sub(sequence);
            // A difference of more than half the range means that the clock is behind. A sender whose clock is stopped
            // repeats itself.
            if ahead == 0 || ahead > u32::MAX / 2 || datagram.time_us <= time_us {
                return ReceivedDatagram::Stale;
            }
            self.health.lost += u64::from(ahead - 1);
        }
        self.received = Some((datagram.sequence, datagram.time_us));
        // An echoed time in the future is from an earlier session.
        if !(must_know_us..=self.now_us).contains(&datagram.echo_us) {
            return ReceivedDatagram::Stale;
        }
        if datagram.has(status::FAULT) {
            return ReceivedDatagram::Fault(datagram.fault);
        }
        if self.kind.is_driven() && !is_watched(datagram, self.watchdog_us) {
            return ReceivedDatagram::Refused;
        }
        read(datagram).map_or(ReceivedDatagram::Refused, |value| {
            ReceivedDatagram::Reading((value, datagram.status, datagram.time_us))
        })
    }

    fn count<R>(&mut self, taken: ReceivedDatagram<R>, now_s: f64) -> Option<R> {
        let loss = match taken {
            ReceivedDatagram::Reading(reading) => {
                self.bad_in_a_row = 0;
                self.health.accept(now_s);
                return Some(reading);
            }
            ReceivedDatagram::Stale => {
                self.health.out_of_order += 1;
                return None;
            }
            ReceivedDatagram::Fault(code) => {
                self.health.lose(Loss::Device { code: code.into() });
                return None;
            }
            ReceivedDatagram::Damaged => {
                self.health.damaged += 1;
                Loss::Corrupt
            }
            ReceivedDatagram::Refused => {
                self.health.refused += 1;
                Loss::Implausible
            }
        };
        self.bad_in_a_row += 1;
        if self.bad_in_a_row >= BAD_MAX {
            self.health.lose(loss);
        }
        None
    }

    /// Sends a command: whether the device may be on, and its values. A lost device gets no commands.
    pub(super) fn report(&mut self, on: bool, numbers: &[f64]) {
        if self.is_lost() {
            return;
        }
        self.sequence = self.sequence.wrapping_add(1);
        let command = command_of(self.kind, on, numbers);
        let command = Datagram {
            joints: self.joints,
            session: self.session,
            sequence: self.sequence,
            time_us: self.now_us,
            echo_us: self.received.map_or(0, |(_, time_us)| time_us),
            watchdog_us: self.watchdog_us,
            ..command
        };
        let mut wire = [0; BYTES_MAX];
        let length = command.encode(&mut wire);
        match self.datagrams.send(&wire[..length]) {
            Ok(()) => self.sent.add(self.now_us),
            Err(loss) => {
                self.health.lose(loss);
            }
        }
    }

    pub(super) const fn refuse_command(&mut self) {
        self.health.refused += 1;
    }

    /// Sends the last command before the connection is closed, in any state: off.
    pub(super) fn leave(&mut self) {
        self.health.standing = ConnectionState::Closed;
        self.report(false, &[]);
    }
}

/// Returns a command of this kind with these values; missing ones are 0.
pub(super) fn command_of(kind: ExternalKind, on: bool, numbers: &[f64]) -> Datagram {
    let mut command = Datagram::blank(ExternalMessage::Command(kind));
    command.status = if on { status::ON } else { 0 };
    command.numbers.iter_mut().zip(numbers).for_each(|(to, number)| *to = *number);
    command
}

/// Returns whether the device switches itself off in time.
pub(super) fn is_watched(datagram: &Datagram, watchdog_us: u32) -> bool {
    (1..=watchdog_us).contains(&datagram.watchdog_us)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_command_before_a_time_is_found_after_the_ring_has_gone_round() {
        let mut sent = SentTimes { times_us: [0; SENT], count: 0 };
        assert_eq!(sent.newest_until(u64::MAX), None);
        for time_us in (1000..=1_000_000).step_by(1000) {
            sent.add(time_us);
        }
        assert_eq!(sent.newest_until(990_500), Some(990_000));
        assert_eq!(sent.newest_until(990_000), Some(990_000));
        assert_eq!(sent.newest_until(999), None, "older than what is kept");
    }
}
