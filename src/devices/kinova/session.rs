//! The two connections to an arm: numbering of messages and sessions, and calls that either wait for the answer (for
//! opening and closing) or do not wait.

use std::{
    net::ToSocketAddrs as _,
    thread::sleep,
    time::{Duration, Instant},
};

use prost::Message;

use super::{
    frame::{self, KinovaFrame, KinovaHeader, PacketReader, REQUEST, RESPONSE},
    messages::{CreateSessionInfo, Rpc},
    settings::KinovaSettings,
};
use crate::{
    DeviceError, Loss,
    transport::{ByteStream as _, Tcp, TransportDatagrams as _, Udp},
};

/// Maximum size of a datagram: of UDP over IPv4, 65 535 bytes less 8 and 20 bytes of headers (RFC 768, RFC 791).
pub const DATAGRAM_MAX: usize = 65_507;

/// Time without messages after which the arm closes a session, ms, as in the manufacturer's Python examples, so that a
/// program that crashed does not block the arm for the minute of the other examples.
const SESSION_INACTIVITY_MS: u32 = 10_000;
/// High-level motion stops when its session has been silent for this time, ms; the shortest value in the manufacturer's
/// examples.
const CONNECTION_INACTIVITY_MS: u32 = 2_000;
/// Requests are repeated after this time during opening, because a datagram may be lost.
const AGAIN: Duration = Duration::from_millis(200);
// A fifth of the arm's period of 1 ms.
const NAP: Duration = Duration::from_micros(200);

/// Numbers requests and encodes them into a buffer that is allocated once.
#[derive(Debug)]
pub(super) struct Caller {
    session: u16,
    message: u16,
    out: Vec<u8>,
    packets: bool,
}

impl Caller {
    fn new(packets: bool) -> Self {
        Self { session: 0, message: 0, out: Vec::with_capacity(4096), packets }
    }

    /// Returns the bytes of a request, and its number. Numbers start at 1 and wrap.
    pub(super) fn request(&mut self, rpc: Rpc, payload: &impl Message) -> (u16, &[u8]) {
        // 16 bits in the header; after the last number the count continues at 0.
        self.message = self.message.wrapping_add(1);
        let Rpc { service, function } = rpc;
        let header = KinovaHeader {
            kind: REQUEST,
            session: self.session,
            message: self.message,
            service,
            function,
            ..KinovaHeader::default()
        };
        self.out.clear();
        if self.packets {
            frame::encode_packet(&header, payload, &mut self.out);
        } else {
            frame::encode(&header, payload, &mut self.out);
        }
        (self.message, &self.out)
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum KinovaFailure {
    /// Refused with this error and sub error.
    Refused(u8, u16),
    Silent,
    Nonsense,
    Lost,
}

pub(super) type CallResult<T> = Result<T, KinovaFailure>;

#[derive(Debug)]
pub struct KinovaLines {
    pub(super) tcp: Tcp,
    pub(super) packets: PacketReader,
    pub(super) calls: Caller,
    pub(super) udp: Udp,
    pub(super) cyclic: Caller,
    pub(super) datagram: Box<[u8]>,
    pub(super) place: String,
    timeout: Duration,
}

impl KinovaLines {
    /// Connects, without opening sessions.
    ///
    /// # Errors
    /// [`DeviceError`] if the address cannot be reached.
    pub fn connect(settings: &KinovaSettings) -> Result<Self, DeviceError> {
        let place = format!("{}:{}", settings.host, settings.tcp_port);
        let timeout = Duration::from_secs_f64(settings.timeout_s);
        let tcp = Tcp::open(&place, timeout)?;
        let to = (settings.host.as_str(), settings.udp_port).to_socket_addrs();
        let to = to.map_err(|error| DeviceError::of_address(&place, &error))?.next();
        let udp = Udp::connect(to.ok_or_else(|| DeviceError::Unreachable { place: place.clone() })?)?;
        let datagram = vec![0; DATAGRAM_MAX].into_boxed_slice();
        let packets = PacketReader::default();
        Ok(Self { tcp, packets, calls: Caller::new(true), udp, cyclic: Caller::new(false), datagram, place, timeout })
    }

    /// Returns a duplicate of the TCP connection and an encoded request, for emergencies.
    pub(super) fn last_text(&self, rpc: Rpc, question: &impl Message) -> std::io::Result<(Tcp, Vec<u8>)> {
        // A number far from those of ordinary calls, which count up from 1.
        let mut caller = Caller { session: self.calls.session, message: u16::MAX - 1, out: Vec::new(), packets: true };
        caller.request(rpc, question);
        Ok((self.tcp.duplicate()?, caller.out))
    }

    /// Opens a session on each connection.
    ///
    /// # Errors
    /// [`DeviceError`] if the arm refuses the user or does not answer.
    pub fn log_in(&mut self, settings: &KinovaSettings) -> Result<(), DeviceError> {
        let login = CreateSessionInfo {
            username: settings.user.clone(),
            session_inactivity_ms: SESSION_INACTIVITY_MS,
            password: settings.password.clone(),
            connection_inactivity_ms: CONNECTION_INACTIVITY_MS,
        };
        let trouble = |failure: KinovaFailure, place: &str| match failure {
            KinovaFailure::Refused(
                _,
                super::messages::sub::INVALID_PASSWORD | super::messages::sub::USER_NOT_FOUND,
            ) => DeviceError::RefusedLogin { place: place.to_owned(), user: settings.user.clone() },
            other => other.trouble(place, Rpc::CREATE_SESSION),
        };
        // TCP and UDP are separate connections for the arm: each needs its own session.
        self.ask(Rpc::CREATE_SESSION, &login).map_err(|failure| trouble(failure, &self.place))?;
        let place = format!("{} UDP port {}", settings.host, settings.udp_port);
        self.ask_cyclic(Rpc::CREATE_SESSION, &login).map_err(|failure| match failure {
            KinovaFailure::Lost => DeviceError::NobodyListens { place },
            other => trouble(other, &place),
        })?;
        Ok(())
    }

    /// Calls and waits for the payload of the answer (TCP).
    pub fn ask(&mut self, rpc: Rpc, question: &impl Message) -> CallResult<Vec<u8>> {
        self.ask_within(rpc, question, self.timeout)
    }

    /// Calls with another timeout.
    pub(super) fn ask_within(&mut self, rpc: Rpc, question: &impl Message, timeout: Duration) -> CallResult<Vec<u8>> {
        let (number, bytes) = self.calls.request(rpc, question);
        self.tcp.send(bytes).map_err(|_| KinovaFailure::Lost)?;
        let before = (self.packets.skipped, self.packets.damaged);
        let end = Instant::now() + timeout;
        while Instant::now() < end {
            let count = self.tcp.receive(self.packets.room()).map_err(|loss| self.broken(loss, before.0))?;
            self.packets.filled(count);
            while let Some(frame) = self.packets.next_frame() {
                if frame.header.kind == RESPONSE && frame.header.message == number {
                    self.calls.session = frame.header.session;
                    return payload(&frame);
                }
            }
            sleep(NAP);
        }
        // Unknown bytes instead of silence show another protocol at this port.
        let dirty = (self.packets.skipped, self.packets.damaged) != before;
        Err(if dirty { KinovaFailure::Nonsense } else { KinovaFailure::Silent })
    }

    /// Returns the error for a peer with another protocol, which answers with unknown bytes and closes the connection.
    const fn broken(&self, _: Loss, skipped: u64) -> KinovaFailure {
        if self.packets.skipped > skipped { KinovaFailure::Nonsense } else { KinovaFailure::Lost }
    }

    /// Calls on the cyclic connection and waits for the payload of the answer; repeats the request until an answer
    /// arrives.
    pub fn ask_cyclic(&mut self, rpc: Rpc, question: &impl Message) -> CallResult<Vec<u8>> {
        let end = Instant::now() + self.timeout;
        let mut dirty = false;
        while Instant::now() < end {
            // A new number for each repetition, so that a late answer is not mistaken for the newest.
            let (number, bytes) = self.cyclic.request(rpc, question);
            self.udp.send(bytes).map_err(|_| KinovaFailure::Lost)?;
            let again = (Instant::now() + AGAIN).min(end);
            while Instant::now() < again {
                let Some(count) = self.udp.receive(&mut self.datagram).map_err(|_| KinovaFailure::Lost)? else {
                    sleep(NAP);
                    continue;
                };
                let Ok(frame) = KinovaFrame::decode(&self.datagram[..count]) else {
                    dirty = true;
                    continue;
                };
                if frame.header.kind == RESPONSE && frame.header.message == number {
                    self.cyclic.session = frame.header.session;
                    return payload(&frame);
                }
            }
        }
        Err(if dirty { KinovaFailure::Nonsense } else { KinovaFailure::Silent })
    }
}

fn payload(frame: &KinovaFrame<'_>) -> CallResult<Vec<u8>> {
    match frame.header.error {
        0 => Ok(frame.payload.to_vec()),
        error => Err(KinovaFailure::Refused(error, frame.header.sub_error)),
    }
}

impl KinovaFailure {
    /// Returns the failure as a message for the user.
    pub(super) fn trouble(self, place: &str, rpc: Rpc) -> DeviceError {
        let place = place.to_owned();
        match self {
            Self::Refused(error, code) => {
                let answer = format!("{} (error {error}/{code})", super::messages::sub::words(code));
                DeviceError::Refused { place, command: rpc.name().to_owned(), answer }
            }
            Self::Silent => DeviceError::Silent { place },
            Self::Nonsense => DeviceError::WrongProduct {
                place,
                expected: "Kinova Gen3 (Kortex API 2)".to_owned(),
                found: "device with another protocol".to_owned(),
            },
            Self::Lost => DeviceError::Other { place, reason: "the connection was closed while opening".to_owned() },
        }
    }
}
