//! The stream of one session: payloads to encrypted datagrams and back, without its own socket, thread or clock.
//!
//! The endpoint feeds it from a socket; a study feeds it from a virtual clock and an impaired line.

use snow::StatelessTransportState;

use crate::{
    clock::{ClockExchange, ClockStep, NetworkClock},
    figures::{Copies, FigureMeter, Limit, SessionMeasurements},
    keys::KeyError,
    playout::{DuePayload, Playout, PlayoutSettings},
    rate::RateBucket,
    redundancy::{DatagramContent, Losses, RedundancyHistory, copies_for},
    replay::{ReplayRefusal, ReplayWindow},
    secure,
    wire::{
        self, DATAGRAM_MAX, DatagramHead, HEAD_MIN, OUTER_LEN, PAYLOAD_MAX, RECORD_MAX, TAG_LEN, UDP_LEN, WireReport,
    },
};

/// Maximum age of an echo that is used, s.
const EXCHANGE_MAX_S: f64 = 30.0;
/// One in this many datagrams contains a report; the first datagrams all contain one. More reports do not improve the
/// clock: at 20 ms of jitter its error is 1 to 7 ms, whether every, every second or every fourth datagram has a report.
const REPORT_EVERY: u64 = 2;

/// Settings of a stream.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StreamSettings {
    /// Maximum payload, bytes; at most [`PAYLOAD_MAX`].
    pub payload_max: usize,
    /// Maximum rate sent, bit/s, with the headers of IPv4 and UDP. 1 Mbit/s per arm.
    pub rate_max_bit_s: f64,
    /// Delivery of payloads.
    pub playout: PlayoutSettings,
}

impl Default for StreamSettings {
    fn default() -> Self {
        Self { payload_max: 256, rate_max_bit_s: 1e6, playout: PlayoutSettings::default() }
    }
}

impl StreamSettings {
    /// Returns settings for the messages of a console and a follower with this many arms: 2 Mbit/s for each, which
    /// redundancy uses up on a bad link. A good link needs 1 Mbit/s.
    pub fn of_arms(arms: usize) -> Self {
        Self { payload_max: PAYLOAD_MAX, rate_max_bit_s: 2e6 * arms as f64, ..Self::default() }
    }
}

/// Result of sending a payload.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SendResult {
    /// A datagram of this length, bytes.
    Datagram(usize),
    /// The rate limit leaves no room now: the payload is sent with the next datagram.
    Held,
    /// The payload exceeds the maximum of the settings.
    TooLong,
}

/// Why a datagram of a session was dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DropCause {
    /// The datagram is not encrypted with this session's keys.
    Forged,
    /// A duplicate.
    Replayed,
    Old,
    /// Authentic but unreadable.
    Malformed,
}

/// The content of an accepted datagram, other than payloads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AcceptedDatagram {
    /// Whether the datagram is newer than all earlier ones.
    pub is_newest: bool,
    /// Control byte, if there is one.
    pub(crate) control: Option<u8>,
    /// Clock step that the datagram revealed.
    pub step: Option<ClockStep>,
}

/// Both directions of one session.
#[derive(Debug)]
pub struct NetworkStream {
    keys: StatelessTransportState,
    /// Number of the session at the other side.
    session: u32,
    counter: u64,
    window: ReplayWindow,
    clock: NetworkClock,
    playout: Playout,
    history: RedundancyHistory,
    losses: Losses,
    bucket: RateBucket,
    /// Loss of our datagrams, as reported by the other side: fraction, and fraction after a lost one.
    reported_loss: (f64, f64),
    /// Fraction of our datagrams that arrive after a later one, as reported by the other side.
    reported_overtaken: f64,
    /// The newest datagram received: when it was sent (µs, their clock) and when it arrived (s, ours).
    newest: Option<(u64, f64)>,
    /// Control byte in the last datagram that was sent.
    reported_control: u8,
    copies: Copies,
    sent: FigureMeter,
    received: FigureMeter,
    held: u64,
    /// Number of payloads that no datagram has carried yet.
    waiting: usize,
    plain: [u8; DATAGRAM_MAX],
}

/// Converts a time to µs, the unit on the wire.
fn micros(now_s: f64) -> u64 {
    (now_s * 1e6).round().clamp(0.0, 281_474_976_710_655.0) as u64
}

fn seconds(us: u64) -> f64 {
    us as f64 * 1e-6
}

fn fraction(byte: u8) -> f64 {
    f64::from(byte) / 255.0
}

fn byte(fraction: f64) -> u8 {
    (fraction * 255.0).ceil().clamp(0.0, 255.0) as u8
}

impl NetworkStream {
    /// Creates a stream with the keys of a handshake; `session` is its number at the other side. All memory is
    /// allocated here.
    pub(crate) fn new(keys: StatelessTransportState, session: u32, settings: &StreamSettings) -> Self {
        let payload_max = settings.payload_max.min(PAYLOAD_MAX);
        Self {
            keys,
            session,
            counter: 0,
            window: ReplayWindow::default(),
            clock: NetworkClock::default(),
            playout: Playout::new(settings.playout, payload_max),
            history: RedundancyHistory::new(payload_max),
            losses: Losses::default(),
            bucket: RateBucket::of_bits(settings.rate_max_bit_s, DATAGRAM_MAX + UDP_LEN),
            reported_loss: (0.0, 0.0),
            reported_overtaken: 0.0,
            newest: None,
            reported_control: 0,
            copies: Copies::default(),
            sent: FigureMeter::default(),
            received: FigureMeter::default(),
            held: 0,
            waiting: 0,
            plain: [0; DATAGRAM_MAX],
        }
    }

    /// Makes both ends of a session, for a virtual clock; the caller simulates the network between them.
    ///
    /// # Errors
    /// [`KeyError::Random`] if the system provides no random numbers.
    ///
    /// ```
    /// use nima_network::{stream::{SendResult, NetworkStream, StreamSettings}, wire::DATAGRAM_MAX};
    ///
    /// let (mut console, mut follower) = NetworkStream::pair(&StreamSettings::default())?;
    /// let mut datagram = [0; DATAGRAM_MAX];
    /// let mut got = 0;
    /// for tick in 0..1000 {
    ///     let now_s = f64::from(tick) * 1e-3;
    ///     if let SendResult::Datagram(len) = console.send(now_s, Some(b"hello"), 0, &mut datagram) {
    ///         follower.receive(&datagram[..len], now_s).expect("authentic");
    ///     }
    ///     follower.advance(now_s);
    ///     while let Some(payload) = follower.take(now_s) {
    ///         assert_eq!(payload.bytes, b"hello");
    ///         got += 1;
    ///     }
    /// }
    /// assert!(got > 850, "the first tenth of a second only measures: {got}");
    /// # Ok::<(), nima_network::keys::KeyError>(())
    /// ```
    pub fn pair(settings: &StreamSettings) -> Result<(Self, Self), KeyError> {
        let [one, other] = secure::both_ends()?;
        Ok((Self::new(one.keys, one.theirs, settings), Self::new(other.keys, other.theirs, settings)))
    }

    /// Writes a datagram with this payload and the last ones before it; without a payload, one that keeps the session
    /// alive. `now_s` is the time of sending, s; `control` is the endpoints' byte about control of the follower, 0 for
    /// none.
    pub fn send(
        &mut self,
        now_s: f64,
        payload: Option<&[u8]>,
        control: u8,
        out: &mut [u8; DATAGRAM_MAX],
    ) -> SendResult {
        if let Some(payload) = payload {
            if !self.history.add(payload, now_s) {
                return SendResult::TooLong;
            }
            self.waiting += 1;
        }
        let mut head = self.head(now_s, payload.is_none(), control);
        let frame = OUTER_LEN + head.length() + TAG_LEN;
        let allowed = self.bucket.level(now_s) as usize;
        let Some(room) = allowed.checked_sub(UDP_LEN + frame) else { return self.hold(payload) };
        let is_limited = room < DATAGRAM_MAX - frame;
        // Send at least all held payloads, because they have not been sent before.
        let (loss, again) = self.reported_loss;
        let overtaken = self.reported_overtaken;
        let wanted = copies_for(loss + overtaken, f64::max(again, loss + overtaken)).max(self.waiting);
        // Copies leave room for the next long payload: a held one follows newer ones and might never fit.
        let for_copies = room.saturating_sub(RECORD_MAX + self.history.longest());
        let end = head.length() + room.min(DATAGRAM_MAX - frame);
        let plain = &mut self.plain[head.length()..end];
        let DatagramContent { bytes, records, carried } =
            self.history.write(wanted, self.waiting, now_s, plain, for_copies);
        if payload.is_some() && records == 0 {
            return self.hold(payload);
        }
        let limit = if carried >= wanted || self.history.count() < wanted as u64 {
            Limit::None
        } else if is_limited {
            Limit::Rate
        } else {
            Limit::Datagram
        };
        if payload.is_some() {
            self.copies = Copies { wanted, used: carried, limit };
        }
        head.count = records as u8;
        self.plain[..head.length()].copy_from_slice(&head.bytes()[..head.length()]);
        out[..OUTER_LEN].copy_from_slice(&wire::outer(self.session, self.counter));
        let plain = &self.plain[..head.length() + bytes];
        // It fails only for datagrams that are too long, which these are not.
        let Ok(sealed) = self.keys.write_message(self.counter, plain, &mut out[OUTER_LEN..]) else {
            return SendResult::Held;
        };
        self.counter += 1;
        self.reported_control = control;
        self.waiting = self.waiting.saturating_sub(records);
        self.bucket.spend((OUTER_LEN + sealed + UDP_LEN) as f64, now_s);
        self.sent.add(OUTER_LEN + sealed + UDP_LEN, now_s);
        SendResult::Datagram(OUTER_LEN + sealed)
    }

    /// Returns the head of the next datagram. A change of control is sent at once.
    fn head(&self, now_s: f64, is_alone: bool, control: u8) -> DatagramHead {
        let is_due = self.counter < REPORT_EVERY || self.counter.is_multiple_of(REPORT_EVERY);
        let report = || WireReport {
            echo: self
                .newest
                .map(|(sent_us, came_s)| (sent_us as u32, micros((now_s - came_s).clamp(0.0, 4000.0)) as u32)),
            loss: byte(self.losses.fractions().0),
            loss_again: byte(self.losses.fractions().1),
            overtaken: byte(self.losses.overtaken()),
            control,
        };
        DatagramHead {
            sent_us: micros(now_s),
            report: (is_due || is_alone || control != self.reported_control).then(report),
            newest: self.history.count().saturating_sub(1) as u32,
            count: 0,
        }
    }

    const fn hold(&mut self, payload: Option<&[u8]>) -> SendResult {
        self.held += payload.is_some() as u64;
        SendResult::Held
    }

    /// Processes a datagram of this session that arrived at `arrived_s` (s, our clock).
    ///
    /// # Errors
    /// [`DropCause`] with the cause; its payloads are then not used.
    pub fn receive(&mut self, datagram: &[u8], arrived_s: f64) -> Result<AcceptedDatagram, DropCause> {
        let Some((_, low, sealed)) = wire::open_outer(datagram) else { return Err(DropCause::Malformed) };
        if sealed.len() < HEAD_MIN + TAG_LEN || datagram.len() > DATAGRAM_MAX {
            return Err(DropCause::Malformed);
        }
        let number = wire::whole(self.window.next(), low);
        let refused = |refused| match refused {
            ReplayRefusal::Replayed => DropCause::Replayed,
            ReplayRefusal::Old => DropCause::Old,
        };
        self.window.check(number).map_err(refused)?;
        let mut plain = [0; DATAGRAM_MAX];
        let len = self.keys.read_message(number, sealed, &mut plain).map_err(|_| DropCause::Forged)?;
        let is_newest = number >= self.window.next();
        self.window.accept(number).map_err(refused)?;
        let Some((mut head, records)) = DatagramHead::from_bytes(&plain[..len]) else {
            return Err(DropCause::Malformed);
        };
        self.received.add(datagram.len() + UDP_LEN, arrived_s);
        self.losses.add(number, arrived_s);
        let control = head.report.map(|report| report.control);
        let Some(sent_us) = self.when(&head, arrived_s) else {
            return Ok(AcceptedDatagram { is_newest, control, step: None });
        };
        head.sent_us = sent_us;
        let step = self.compare_clocks(&head, arrived_s);
        if is_newest {
            self.newest = Some((sent_us, arrived_s));
            if let Some(WireReport { loss, loss_again, overtaken, .. }) = head.report {
                self.reported_loss = (fraction(loss), fraction(loss_again));
                self.reported_overtaken = fraction(overtaken);
            }
        }
        self.take_payloads(&head, records, arrived_s);
        Ok(AcceptedDatagram { is_newest, control, step })
    }

    /// Returns when a datagram was sent, µs. Without a report, a datagram contains only the lower half of the time; the
    /// first datagram with a report provides the rest.
    fn when(&self, head: &DatagramHead, arrived_s: f64) -> Option<u64> {
        if head.report.is_some() {
            return Some(head.sent_us);
        }
        let (sent_us, came_s) = self.newest?;
        let near = sent_us.saturating_add(micros(arrived_s - came_s));
        Some(wire::whole(near, head.sent_us as u32))
    }

    fn compare_clocks(&mut self, head: &DatagramHead, arrived_s: f64) -> Option<ClockStep> {
        let (echo_us, held_us) = head.report?.echo?;
        let origin_s = seconds(wire::whole(micros(arrived_s), echo_us));
        let sent_s = seconds(head.sent_us);
        if !(0.0..EXCHANGE_MAX_S).contains(&(arrived_s - origin_s + 1e-6)) {
            return None;
        }
        let received_s = sent_s - seconds(u64::from(held_us));
        let step = self.clock.add(&ClockExchange { origin_s, received_s, sent_s, arrived_s })?;
        self.playout.clock_stepped(step.by_s);
        Some(step)
    }

    fn take_payloads(&mut self, head: &DatagramHead, mut records: &[u8], arrived_s: f64) {
        if head.count == 0 {
            return;
        }
        let newest = wire::whole24(self.playout.end(), head.newest);
        let sent_s = seconds(head.sent_us);
        for back in 0..u64::from(head.count) {
            let (Some((record, rest)), Some(number)) = (wire::record(records), newest.checked_sub(back)) else {
                return;
            };
            records = rest;
            if let Some(bytes) = record.bytes {
                self.playout.insert(number, sent_s - record.age_s, arrived_s, back == 0, bytes);
            }
        }
    }

    /// Restarts with the next payload of the other side.
    pub fn begin(&mut self) {
        self.playout.begin();
    }

    /// Adjusts the playout delay; call it once per tick, before payloads are taken.
    pub fn advance(&mut self, now_s: f64) {
        self.playout.advance(now_s);
    }

    /// Returns the next payload that is due.
    pub fn take(&mut self, now_s: f64) -> Option<DuePayload<'_>> {
        let offset_s = self.clock.estimate(now_s).map_or(0.0, |estimate| estimate.offset_s);
        self.playout.take(now_s, offset_s)
    }

    /// Returns the arrival of the newest datagram, s.
    pub fn received_s(&self) -> Option<f64> {
        self.newest.map(|(_, came_s)| came_s)
    }

    /// Returns the clock of the other side.
    pub const fn clock(&self) -> &NetworkClock {
        &self.clock
    }

    pub const fn payloads(&self) -> u64 {
        self.history.count()
    }

    /// Returns the measurements.
    pub fn figures(&self, now_s: f64) -> SessionMeasurements {
        let clock = self.clock.estimate(now_s);
        let offset_s = clock.map_or(0.0, |clock| clock.offset_s);
        let (datagrams, lost) = self.losses.totals();
        SessionMeasurements {
            clock,
            steps: self.clock.steps(),
            one_way: self.playout.delays().map(|delays| delays.shifted(offset_s)),
            playout_s: self.playout.delay_s().map(|delay_s| delay_s + offset_s),
            playout_wanted_s: self.playout.wanted_s().map(|wanted_s| wanted_s + offset_s),
            loss: self.losses.fractions().0,
            loss_there: self.reported_loss.0,
            datagrams_expected: datagrams,
            datagrams_lost: lost,
            copies: self.copies,
            counts: self.playout.counts(),
            held: self.held,
            sent: self.sent,
            received: self.received,
        }
    }
}

#[cfg(test)]
#[path = "stream_tests.rs"]
mod tests;
