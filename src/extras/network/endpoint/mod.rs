//! One end of a link: a console or a follower, on a real socket.
//!
//! The thread of a control loop drives it: [`Endpoint::poll`] once per tick, then [`Endpoint::send`]. Once a session is
//! open, neither allocates, locks, logs, waits, panics or runs an unbounded loop. Slow work, the key agreements, is
//! done by a separate thread. Times are passed in as arguments: any running clock of the caller's, s.
//!
//! A follower listens on loopback unless an address is given, and admits its paired machines. One console has control;
//! others may be connected and request it.

mod config;
mod control_owner;
mod handshake_thread;
mod receive;
mod session;
mod session_upkeep;

use std::{
    io,
    net::{Ipv4Addr, Ipv6Addr, SocketAddr},
    sync::atomic::Ordering::Relaxed,
    time::Duration,
};

pub use self::config::{ControlRole, EndpointConfig, EndpointRole, LinkState, OpenError, SendOutcome};
use self::{
    config::ControlRequest,
    control_owner::OpenQuestion,
    handshake_thread::{Handshake, HandshakeThread},
    session::NetworkSession,
};
use crate::{
    control::{ControlState, LinkCause, SessionRefusal},
    figures::{DroppedCounts, SessionMeasurements},
    keys::PublicKey,
    playout::DuePayload,
    secure::{Approach, Reception},
    socket::{Socket, system_time},
    stream::SendResult,
    wire::DATAGRAM_MAX,
};

/// The follower's default port.
pub const PORT: u16 = 47_150;
/// Maximum number of consoles connected to a follower.
pub const CONSOLES_MAX: usize = 6;
/// Maximum number of sessions: one per console, and some whose handshake has just ended.
const SESSIONS: usize = CONSOLES_MAX + 2;
/// Maximum number of datagrams read from the socket in one call.
const RECEIVE_MAX: usize = 128;
/// Interval of datagrams without payloads, s, from and to the controlling console.
pub const ALIVE_S: f64 = 0.02;
/// The same for waiting consoles, s.
const ALIVE_WAITING_S: f64 = 0.05;
/// A session that the other side does not confirm within this time is dropped, s.
const CONFIRM_S: f64 = 3.0;
/// A console that has received nothing for this long starts a new session in addition to the old one, s.
const SEEK_AFTER_S: f64 = 0.5;
/// A clock jump or a flood, and a refusal, are reported for this long, s.
const REPORTED_S: f64 = 1.0;
const REFUSED_REPORTED_S: f64 = 5.0;
/// Number of goodbyes sent, because datagrams may be lost.
const GOODBYES: usize = 3;

#[derive(Debug)]
pub struct Endpoint {
    is_follower: bool,
    silent_after_s: f64,
    forget_after_s: f64,
    socket: Socket,
    clerk: HandshakeThread,
    sessions: [Option<Box<NetworkSession>>; SESSIONS],
    /// The session whose payloads count: on a follower, the controlling console's; on a console, the follower's.
    active: Option<usize>,
    /// Only on a follower.
    holding: OpenQuestion,
    /// On a console: its request for control, and its answer to the request with a number.
    wish: ControlRequest,
    answer: Option<(u8, bool)>,
    dropped: DroppedCounts,
    /// The caller's time of the last poll, s, and the system's at that moment.
    now_s: f64,
    looked: Duration,
    /// Last reception in the active session, s; kept after the session has ended.
    received_s: Option<f64>,
    /// Measurements of the last session whose payloads counted.
    last_figures: SessionMeasurements,
    is_closed: bool,
    jumped: Option<(f64, f64)>,
    refused: Option<(f64, SessionRefusal)>,
    /// Last time that the socket held more than is read in one call, most of it from others, s.
    flooded_s: Option<f64>,
    buffer: [u8; 2 * DATAGRAM_MAX],
    out: [u8; DATAGRAM_MAX],
}

impl Endpoint {
    /// Opens the socket and starts the thread for handshakes.
    ///
    /// # Errors
    /// [`OpenError`] if the address cannot be used.
    pub fn open(config: EndpointConfig) -> Result<Self, OpenError> {
        let EndpointConfig { role, keys, stream, silent_after_s, forget_after_s } = config;
        let (at, to) = match &role {
            EndpointRole::Follower { at, .. } => (at.unwrap_or((Ipv4Addr::LOCALHOST, PORT).into()), None),
            EndpointRole::Console { follower, .. } => (towards(follower), Some(*follower)),
        };
        let address = |source| OpenError::Address { address: to.unwrap_or(at), source };
        let socket = Socket::open(at, to).map_err(address)?;
        let theirs = socket.try_clone().map_err(address)?;
        let is_follower = to.is_none();
        let handshake = match role {
            EndpointRole::Follower { consoles, .. } => {
                Handshake::Follower(Box::new(Reception::new(keys, consoles, 0.0)?))
            }
            EndpointRole::Console { follower, key } => {
                Handshake::Console(Box::new(Approach::new(keys, key)?), follower)
            }
        };
        Ok(Self {
            is_follower,
            silent_after_s,
            forget_after_s,
            socket,
            clerk: HandshakeThread::start(handshake, theirs, stream).map_err(OpenError::Thread)?,
            sessions: [const { None }; SESSIONS],
            active: None,
            holding: OpenQuestion::default(),
            wish: ControlRequest::None,
            answer: None,
            dropped: DroppedCounts::default(),
            now_s: 0.0,
            looked: Duration::ZERO,
            received_s: None,
            last_figures: SessionMeasurements::default(),
            is_closed: false,
            jumped: None,
            refused: None,
            flooded_s: None,
            buffer: [0; 2 * DATAGRAM_MAX],
            out: [0; DATAGRAM_MAX],
        })
    }

    /// Returns the address of its socket.
    ///
    /// # Errors
    /// I/O errors.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.socket.address()
    }

    /// Processes received datagrams and keeps the session alive; call it once per tick. Returns the payloads that are
    /// due at `now_s`.
    pub fn poll(&mut self, now_s: f64) -> ReceivedPayloads<'_> {
        self.now_s = now_s;
        self.looked = system_time();
        self.take_news();
        self.receive();
        self.look_after_sessions();
        self.keep_alive();
        let seeks = !self.is_follower && self.session().is_none_or(|session| now_s - session.received_s > SEEK_AFTER_S);
        self.clerk.shared.is_wanted.store(seeks, Relaxed);
        let carries = self.carries();
        let session = self.active.and_then(|at| self.sessions[at].as_mut());
        if let Some(session) = session
            && carries
        {
            session.stream.advance(now_s);
            return ReceivedPayloads { session: Some(session), now_s };
        }
        ReceivedPayloads { session: None, now_s }
    }

    /// Sends a payload to the other side. `now_s` is the time of sending, s: otherwise the time of the caller's work
    /// since [`Endpoint::poll`] would count as network delay.
    pub fn send(&mut self, now_s: f64, payload: &[u8]) -> SendOutcome {
        match self.active {
            Some(at) if self.carries() => match self.send_to(at, now_s, Some(payload)) {
                SendResult::Datagram(_) => SendOutcome::Sent,
                SendResult::Held => SendOutcome::Held,
                SendResult::TooLong => SendOutcome::TooLong,
            },
            _ => SendOutcome::NotOpen,
        }
    }

    /// Returns the status of the link at the last poll.
    pub fn state(&self) -> LinkState {
        let silent_s = self.received_s.map(|received_s| self.now_s - received_s);
        let recent = |at_s: f64, reported_s: f64| self.now_s - at_s <= reported_s;
        let is_flooded = self.flooded_s.is_some_and(|at_s| recent(at_s, REPORTED_S));
        let silent = |for_s: f64| if is_flooded { LinkCause::Flooded } else { LinkCause::Silent { for_s } };
        let Some(session) = self.session() else {
            return match (self.refused, silent_s) {
                (Some((at_s, refusal)), _) if recent(at_s, REFUSED_REPORTED_S) => {
                    LinkState::Down(LinkCause::Refused(refusal))
                }
                _ if self.is_closed => LinkState::Down(LinkCause::PeerClosed),
                (_, Some(for_s)) => LinkState::Down(silent(for_s)),
                _ => LinkState::Waiting,
            };
        };
        let for_s = self.now_s - session.received_s;
        if session.is_confirmed && for_s > self.silent_after_s {
            // A restarted follower with other keys refuses while the old session is silent.
            return match self.refused {
                Some((at_s, refusal)) if recent(at_s, REFUSED_REPORTED_S) => {
                    LinkState::Down(LinkCause::Refused(refusal))
                }
                _ => LinkState::Down(silent(for_s)),
            };
        }
        match (self.jumped, self.standing()) {
            (Some((at_s, by_s)), _) if recent(at_s, REPORTED_S) => LinkState::Down(LinkCause::ClockJumped { by_s }),
            (_, ControlState::Holds) => LinkState::Open,
            (_, ControlState::Waits) => LinkState::Down(LinkCause::HeldByAnother),
            (_, ControlState::Free) => LinkState::Down(LinkCause::NotAsked),
            (_, ControlState::Unknown) => LinkState::Waiting,
        }
    }

    /// Returns the measurements of the session whose payloads count, or of the last one; all zero before the first.
    pub fn figures(&self) -> SessionMeasurements {
        self.session().map_or(self.last_figures, |session| session.stream.figures(self.now_s))
    }

    /// Returns the number of datagrams that were dropped since the endpoint was opened.
    pub fn dropped(&self) -> DroppedCounts {
        let shared = &self.clerk.shared;
        let own = self.dropped;
        DroppedCounts {
            malformed: own.malformed + shared.malformed.load(Relaxed),
            foreign_version: own.foreign_version + shared.foreign_version.load(Relaxed),
            flooded: own.flooded + shared.flooded.load(Relaxed),
            refused: own.refused + shared.refused.load(Relaxed),
            ..own
        }
    }

    /// Returns the number of handshake datagrams that this end has sent.
    pub fn handshake_datagrams(&self) -> u64 {
        self.clerk.shared.sent.load(Relaxed)
    }

    /// Returns the other side's key: at a console, the follower's; at a follower, the controlling console's.
    pub fn peer(&self) -> Option<PublicKey> {
        self.session().map(|session| session.peer)
    }

    /// Requests control of the follower until it is granted or refused. No consent is required while no console has
    /// control.
    pub fn ask_for_control(&mut self) {
        let is_stale = self.session().is_some_and(|session| session.from_follower.is_denied);
        self.wish = if is_stale { ControlRequest::AsksAgain } else { ControlRequest::Asks };
    }

    /// Withdraws the request.
    pub const fn withdraw(&mut self) {
        self.wish = ControlRequest::None;
    }

    /// Answers the console that requests control ([`ControlRole::HoldsAsked`]); `true` transfers control to it.
    pub fn answer(&mut self, consents: bool) {
        let asked = self.session().map_or(0, |session| session.from_follower.asked);
        if asked != 0 {
            self.answer = Some((asked, consents));
        }
    }

    /// Returns a console's status of control; [`ControlRole::None`] for a follower.
    pub fn control(&self) -> ControlRole {
        let Some(session) = self.session().filter(|_| !self.is_follower) else { return ControlRole::None };
        match session.from_follower.standing {
            ControlState::Unknown => ControlRole::None,
            ControlState::Holds if session.from_follower.asked != 0 && self.answer.is_none() => ControlRole::HoldsAsked,
            ControlState::Holds => ControlRole::Holds,
            _ => match self.wish {
                ControlRequest::Asks | ControlRequest::AsksAgain => ControlRole::Asks,
                ControlRequest::Denied => ControlRole::Denied,
                ControlRequest::None => ControlRole::Waits,
            },
        }
    }

    /// Ends the session and informs the other side. Dropping the endpoint does the same.
    pub fn close(&mut self) {
        for at in 0..SESSIONS {
            if self.sessions[at].is_some() {
                for _ in 0..GOODBYES {
                    self.send_with(at, self.now_s, None, true);
                }
            }
        }
        self.active = None;
        self.sessions = [const { None }; SESSIONS];
    }

    fn session(&self) -> Option<&NetworkSession> {
        self.sessions[self.active?].as_deref()
    }

    /// Returns this end's status in the active session.
    fn standing(&self) -> ControlState {
        match self.session() {
            Some(_) if self.is_follower => ControlState::Holds,
            Some(session) => session.from_follower.standing,
            None => ControlState::Unknown,
        }
    }

    fn carries(&self) -> bool {
        self.standing() == ControlState::Holds
    }
}

impl Drop for Endpoint {
    fn drop(&mut self) {
        self.close();
    }
}

/// Returns the address to which a socket for datagrams to this address is bound; a local address is not reached through
/// the network.
pub(crate) fn towards(to: &SocketAddr) -> SocketAddr {
    match to {
        SocketAddr::V4(v4) if v4.ip().is_loopback() => (Ipv4Addr::LOCALHOST, 0).into(),
        SocketAddr::V4(_) => (Ipv4Addr::UNSPECIFIED, 0).into(),
        SocketAddr::V6(v6) if v6.ip().is_loopback() => (Ipv6Addr::LOCALHOST, 0).into(),
        SocketAddr::V6(_) => (Ipv6Addr::UNSPECIFIED, 0).into(),
    }
}

/// Payloads that are due, one after the other.
#[derive(Debug)]
pub struct ReceivedPayloads<'a> {
    session: Option<&'a mut Box<NetworkSession>>,
    now_s: f64,
}

impl ReceivedPayloads<'_> {
    /// Returns the next in order; `None` when all due payloads have been taken.
    pub fn next_due(&mut self) -> Option<DuePayload<'_>> {
        self.session.as_mut()?.stream.take(self.now_s)
    }
}

#[cfg(test)]
mod tests;
#[cfg(test)]
mod two_hosts_tests;
