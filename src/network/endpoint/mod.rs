//! One end of a link: a console or a follower, on a real socket.
//!
//! The thread of a control loop drives it: [`Endpoint::poll`] once per tick, then [`Endpoint::send`]. Once a session is open, neither
//! allocates, locks, logs, waits, panics or runs an unbounded loop. What takes time, the key agreements, is done by a thread of its own.
//! Times are handed in: any clock of the caller's that does not stand still, s.
//!
//! A follower listens on loopback unless an address is given, and admits the machines that it is paired with. One console holds it; others may
//! be connected and ask the holder for control.

mod clerk;
mod holding;
mod session;

use std::{
    io,
    net::{Ipv4Addr, Ipv6Addr, SocketAddr},
    sync::atomic::Ordering::Relaxed,
};

use self::{
    clerk::{Clerk, News, Side},
    holding::Holding,
    session::Session,
};
use crate::{
    control::{Cause, FromConsole, FromFollower, Refusal, Standing},
    figures::{Dropped, Figures},
    keys::{KeyError, Keys, Peers, PublicKey},
    playout::Payload,
    secure::{Approach, Reception},
    socket::{Arrival, Socket},
    stream::{Sent, StreamSettings, Unaccepted},
    wire::{self, DATAGRAM_MAX, Kind, Unreadable},
};

/// Where a follower listens unless told otherwise.
pub const PORT: u16 = 47_110;
/// Consoles that are connected to a follower at once.
pub const CONSOLES_MAX: usize = 6;
/// Sessions at once: those, and some whose handshake has only just ended.
const SESSIONS: usize = CONSOLES_MAX + 2;
/// Datagrams that are taken from the socket in one call.
const RECEIVE_MAX: usize = 128;
/// Without payloads, datagrams are sent this often, s: by the holder and to it, and otherwise.
const ALIVE_S: f64 = 0.02;
const ALIVE_WAITING_S: f64 = 0.05;
/// A session that the other side has not confirmed for this long is none, s.
const CONFIRM_S: f64 = 3.0;
/// A console that has heard nothing for this long makes a new session beside the old one, s.
const SEEK_AFTER_S: f64 = 0.5;
/// A jump of a clock and a refusal are told for this long, s.
const TOLD_S: f64 = 1.0;
const REFUSED_TOLD_S: f64 = 5.0;
/// How often a goodbye is said: datagrams may be lost.
const GOODBYES: usize = 3;

/// Which end it is.
#[derive(Clone, Debug)]
pub enum Role {
    /// The end with the arm.
    Follower {
        /// Where it listens; `None` for [`PORT`] of loopback, so that nobody outside can reach it.
        at: Option<SocketAddr>,
        /// The consoles that it admits.
        consoles: Peers,
    },
    /// The end with the handle.
    Console {
        /// Where the follower listens.
        follower: SocketAddr,
        /// The follower's key.
        key: PublicKey,
    },
}

/// What an endpoint is made with.
#[derive(Clone, Debug)]
pub struct Config {
    /// Which end.
    pub role: Role,
    /// The key of this machine.
    pub keys: Keys,
    /// The stream.
    pub stream: StreamSettings,
    /// Without a datagram for this long the link is silent, s.
    pub silent_after_s: f64,
    /// A follower forgets a console that is silent for this long, s; it is then free for others.
    pub forget_after_s: f64,
}

impl Config {
    /// With the usual settings.
    pub fn new(role: Role, keys: Keys) -> Self {
        Self { role, keys, stream: StreamSettings::default(), silent_after_s: 0.1, forget_after_s: 5.0 }
    }
}

/// Why an endpoint cannot be opened.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// The address cannot be used.
    #[error("cannot use the UDP address {address}: {source}; is another nima running, or is it another machine's address?")]
    Address {
        /// The address.
        address: SocketAddr,
        /// Why.
        source: io::Error,
    },
    /// No thread can be started.
    #[error("cannot start a thread: {0}")]
    Thread(io::Error),
    /// Keys.
    #[error(transparent)]
    Keys(#[from] KeyError),
}

/// What a link is now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LinkState {
    /// Nobody has been there yet.
    Waiting,
    /// Payloads pass.
    Open,
    /// They do not, or not as they should.
    Down(Cause),
}

/// What came of sending a payload.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It is under way.
    Sent,
    /// It goes with the next datagram: the rate's limit leaves no room.
    Held,
    /// There is nobody to send it to, or another console holds the follower.
    NotOpen,
    /// It is longer than the settings allow.
    TooLong,
}

/// A console's part in who holds the follower.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// Not connected.
    None,
    /// It holds the follower.
    Holds,
    /// It holds the follower, and another console asks for control: [`Endpoint::answer`].
    HoldsAsked,
    /// Another console, or nobody, holds it.
    Waits,
    /// It waits for an answer.
    Asks,
    /// The holder has refused. It may ask again.
    Denied,
}

/// One end of a link.
#[derive(Debug)]
pub struct Endpoint {
    is_follower: bool,
    silent_after_s: f64,
    forget_after_s: f64,
    socket: Socket,
    clerk: Clerk,
    sessions: [Option<Box<Session>>; SESSIONS],
    /// The session whose payloads count: a follower's holder, a console's follower.
    active: Option<usize>,
    /// A follower's.
    holding: Holding,
    /// A console's: it asks for control, was denied, and what it answers to the question with a number.
    asks: bool,
    is_denied: bool,
    answer: Option<(u8, bool)>,
    dropped: Dropped,
    now_s: f64,
    /// When the active session was last heard, s; also after it has ended.
    heard_s: Option<f64>,
    is_closed: bool,
    jumped: Option<(f64, f64)>,
    refused: Option<(f64, Refusal)>,
    buffer: [u8; 2 * DATAGRAM_MAX],
    out: [u8; DATAGRAM_MAX],
}

impl Endpoint {
    /// Opens the socket and starts the thread for handshakes.
    ///
    /// # Errors
    /// [`OpenError`] if the address cannot be used.
    pub fn open(config: Config) -> Result<Self, OpenError> {
        let Config { role, keys, stream, silent_after_s, forget_after_s } = config;
        let (at, to) = match &role {
            Role::Follower { at, .. } => (at.unwrap_or((Ipv4Addr::LOCALHOST, PORT).into()), None),
            Role::Console { follower, .. } => (towards(follower), Some(*follower)),
        };
        let address = |source| OpenError::Address { address: to.unwrap_or(at), source };
        let socket = Socket::open(at, to).map_err(address)?;
        let theirs = socket.try_clone().map_err(address)?;
        let is_follower = to.is_none();
        let side = match role {
            Role::Follower { consoles, .. } => Side::Follower(Box::new(Reception::new(keys, consoles, 0.0)?)),
            Role::Console { follower, key } => Side::Console(Box::new(Approach::new(keys, key)?), follower),
        };
        Ok(Self {
            is_follower,
            silent_after_s,
            forget_after_s,
            socket,
            clerk: Clerk::start(side, theirs, stream).map_err(OpenError::Thread)?,
            sessions: [const { None }; SESSIONS],
            active: None,
            holding: Holding::default(),
            asks: false,
            is_denied: false,
            answer: None,
            dropped: Dropped::default(),
            now_s: 0.0,
            heard_s: None,
            is_closed: false,
            jumped: None,
            refused: None,
            buffer: [0; 2 * DATAGRAM_MAX],
            out: [0; DATAGRAM_MAX],
        })
    }

    /// The address of its socket.
    ///
    /// # Errors
    /// What the system says.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.socket.address()
    }

    /// Takes what has arrived and sends what keeps the session alive; once per tick. Gives the payloads that are due at `now_s`.
    pub fn poll(&mut self, now_s: f64) -> Received<'_> {
        self.now_s = now_s;
        self.take_news();
        self.hear();
        self.look_after_sessions();
        self.keep_alive();
        let seeks = !self.is_follower && self.session().is_none_or(|session| now_s - session.heard_s > SEEK_AFTER_S);
        self.clerk.shared.is_wanted.store(seeks, Relaxed);
        let carries = self.carries();
        let session = self.active.and_then(|at| self.sessions[at].as_mut());
        if let Some(session) = session
            && carries
        {
            session.stream.advance(now_s);
            return Received { session: Some(session), now_s };
        }
        Received { session: None, now_s }
    }

    /// Sends a payload to the other side. `now_s` is the time of sending, s: the time that the caller's work has taken since
    /// [`Endpoint::poll`] would otherwise count as the network's delay.
    pub fn send(&mut self, now_s: f64, payload: &[u8]) -> Outcome {
        match self.active {
            Some(at) if self.carries() => match self.send_to(at, now_s, Some(payload)) {
                Sent::Datagram(_) => Outcome::Sent,
                Sent::Held => Outcome::Held,
                Sent::TooLong => Outcome::TooLong,
            },
            _ => Outcome::NotOpen,
        }
    }

    /// What the link is, at the last poll.
    pub fn state(&self) -> LinkState {
        let silent_s = self.heard_s.map(|heard_s| self.now_s - heard_s);
        let recent = |at_s: f64, told_s: f64| self.now_s - at_s <= told_s;
        let Some(session) = self.session() else {
            return match (self.refused, silent_s) {
                (Some((at_s, refusal)), _) if recent(at_s, REFUSED_TOLD_S) => LinkState::Down(Cause::Refused(refusal)),
                _ if self.is_closed => LinkState::Down(Cause::PeerClosed),
                (_, Some(for_s)) => LinkState::Down(Cause::Silent { for_s }),
                _ => LinkState::Waiting,
            };
        };
        let for_s = self.now_s - session.heard_s;
        if session.is_confirmed && for_s > self.silent_after_s {
            // A follower that was started anew with other keys refuses while the old session is silent.
            return match self.refused {
                Some((at_s, refusal)) if recent(at_s, REFUSED_TOLD_S) => LinkState::Down(Cause::Refused(refusal)),
                _ => LinkState::Down(Cause::Silent { for_s }),
            };
        }
        match (self.jumped, self.standing()) {
            (Some((at_s, by_s)), _) if recent(at_s, TOLD_S) => LinkState::Down(Cause::ClockJumped { by_s }),
            (_, Standing::Holds) => LinkState::Open,
            (_, Standing::Waits) => LinkState::Down(Cause::HeldByAnother),
            (_, Standing::Free) => LinkState::Down(Cause::NotAsked),
            (_, Standing::Unknown) => LinkState::Waiting,
        }
    }

    /// What the session whose payloads count has measured; all zero without one.
    pub fn figures(&self) -> Figures {
        self.session().map_or_else(Figures::default, |session| session.stream.figures(self.now_s))
    }

    /// Datagrams that were dropped since the endpoint was opened.
    pub fn dropped(&self) -> Dropped {
        let (shared, own) = (&self.clerk.shared, self.dropped);
        Dropped {
            malformed: own.malformed + shared.malformed.load(Relaxed),
            foreign_version: own.foreign_version + shared.foreign_version.load(Relaxed),
            flooded: own.flooded + shared.flooded.load(Relaxed),
            refused: own.refused + shared.refused.load(Relaxed),
            ..own
        }
    }

    /// Datagrams of handshakes that this end has sent.
    pub fn handshake_datagrams(&self) -> u64 {
        self.clerk.shared.sent.load(Relaxed)
    }

    /// The key of the other side: the follower's, or that of the console that holds this follower.
    pub fn peer(&self) -> Option<PublicKey> {
        self.session().map(|session| session.peer)
    }

    /// Asks for control of the follower, until it is given or refused. Nobody has to consent if nobody holds it.
    pub const fn ask_for_control(&mut self) {
        (self.asks, self.is_denied) = (true, false);
    }

    /// Does not ask any more.
    pub const fn withdraw(&mut self) {
        self.asks = false;
    }

    /// Answers the console that asks for control ([`Control::HoldsAsked`]); with `true` control goes to it.
    pub fn answer(&mut self, consents: bool) {
        let asked = self.session().map_or(0, |session| session.from_follower.asked);
        if asked != 0 {
            self.answer = Some((asked, consents));
        }
    }

    /// A console's part in who holds the follower; [`Control::None`] for a follower.
    pub fn control(&self) -> Control {
        let Some(session) = self.session().filter(|_| !self.is_follower) else { return Control::None };
        match session.from_follower.standing {
            Standing::Unknown => Control::None,
            Standing::Holds if session.from_follower.asked != 0 && self.answer.is_none() => Control::HoldsAsked,
            Standing::Holds => Control::Holds,
            _ if self.asks => Control::Asks,
            _ if self.is_denied => Control::Denied,
            _ => Control::Waits,
        }
    }

    /// Tells the other side that the session ends. Dropping the endpoint does it too.
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

    fn session(&self) -> Option<&Session> {
        self.sessions[self.active?].as_deref()
    }

    /// What this end is to the active session.
    fn standing(&self) -> Standing {
        match self.session() {
            Some(_) if self.is_follower => Standing::Holds,
            Some(session) => session.from_follower.standing,
            None => Standing::Unknown,
        }
    }

    fn carries(&self) -> bool {
        self.standing() == Standing::Holds
    }

    fn hear(&mut self) {
        for _ in 0..RECEIVE_MAX {
            let Some(arrival) = self.socket.receive(&mut self.buffer) else { return };
            self.take(arrival);
        }
    }

    fn take(&mut self, arrival: Arrival) {
        let Some(datagram) = self.buffer.get(..arrival.len).filter(|datagram| datagram.len() <= DATAGRAM_MAX) else {
            self.dropped.malformed += 1;
            return;
        };
        match wire::kind(datagram) {
            Ok(Kind::Data) => self.take_data(arrival),
            Ok(Kind::Pairing) | Err(Unreadable::Malformed) => self.dropped.malformed += 1,
            // The thread answers a foreign version.
            Ok(_) | Err(Unreadable::ForeignVersion(_)) => {
                if !self.clerk.give(datagram, arrival.from) {
                    self.dropped.flooded += 1;
                }
            }
        }
    }

    fn take_data(&mut self, arrival: Arrival) {
        let datagram = &self.buffer[..arrival.len];
        let number = wire::open_outer(datagram).map(|(session, ..)| session);
        let is_it = |session: &Option<Box<Session>>| session.as_ref().is_some_and(|s| Some(s.ours) == number);
        let Some(at) = self.sessions.iter().position(is_it) else {
            self.dropped.unknown_session += 1;
            return;
        };
        let Some(session) = self.sessions[at].as_mut() else { return };
        let accepted = match session.stream.receive(datagram, self.now_s - arrival.age_s) {
            Ok(accepted) => accepted,
            Err(cause) => {
                *match cause {
                    Unaccepted::Forged => &mut self.dropped.forged,
                    Unaccepted::Replayed => &mut self.dropped.replayed,
                    Unaccepted::Old => &mut self.dropped.old,
                    Unaccepted::Malformed => &mut self.dropped.malformed,
                } += 1;
                return;
            }
        };
        if let Some(step) = accepted.step.filter(|_| self.active == Some(at)) {
            self.jumped = Some((self.now_s, step.by_s));
        }
        if !accepted.is_newest {
            return;
        }
        session.heard_s = self.now_s;
        session.at = arrival.from;
        if self.is_follower {
            session.from_console = FromConsole::from_byte(accepted.control);
            self.heard_console(at);
        } else {
            let before = session.from_follower.standing;
            session.from_follower = FromFollower::from_byte(accepted.control);
            session.is_confirmed = true;
            if matches!(before, Standing::Waits | Standing::Free) && session.from_follower.standing == Standing::Holds {
                session.stream.begin();
            }
            self.heard_follower(at);
        }
    }

    /// What a console does with the byte of its follower.
    fn heard_follower(&mut self, at: usize) {
        let Some(said) = self.sessions[at].as_ref().map(|session| session.from_follower) else { return };
        self.heard_s = Some(self.now_s);
        if said.goodbye {
            self.is_closed = true;
            self.end(at);
            return;
        }
        if said.asked == 0 || self.answer.is_some_and(|(number, _)| number != said.asked) {
            self.answer = None;
        }
        if said.standing == Standing::Holds {
            (self.asks, self.is_denied) = (false, false);
        }
        if said.is_denied && self.asks {
            (self.asks, self.is_denied) = (false, true);
        }
    }

    fn take_news(&mut self) {
        for _ in 0..SESSIONS {
            match self.clerk.news() {
                Some(News::Opened(session)) => self.opened(session),
                Some(News::Refused(refusal)) => self.refused = Some((self.now_s, refusal)),
                None => return,
            }
        }
    }

    /// A session of a handshake that has ended. A console uses it from now on, a follower when it is confirmed.
    fn opened(&mut self, mut session: Box<Session>) {
        (session.opened_s, session.heard_s) = (self.now_s, self.now_s);
        if !self.is_follower {
            if let Some(old) = self.active {
                self.end(old);
            }
            (self.refused, self.is_closed, self.answer) = (None, false, None);
        }
        let free = self.sessions.iter().position(Option::is_none);
        let unconfirmed = |session: &Option<Box<Session>>| session.as_ref().is_some_and(|s| !s.is_confirmed);
        match free.or_else(|| self.sessions.iter().position(unconfirmed)) {
            Some(at) => {
                self.end(at);
                if self.sessions[at].is_none() {
                    self.sessions[at] = Some(session);
                    if !self.is_follower {
                        self.active = Some(at);
                    }
                }
            }
            // It is freed by the thread; if that is behind, here: nothing is lost but time.
            None => drop(self.clerk.free(session)),
        }
    }

    /// Ends a session; its memory goes back to the thread.
    fn end(&mut self, at: usize) {
        if self.active == Some(at) {
            self.active = None;
        }
        self.holding.forget(at);
        if let Some(session) = self.sessions[at].take() {
            self.sessions[at] = self.clerk.free(session);
        }
    }

    fn look_after_sessions(&mut self) {
        for at in 0..SESSIONS {
            let Some(session) = self.sessions[at].as_ref() else { continue };
            let silent_s = self.now_s - session.heard_s;
            let is_over = if !self.is_follower {
                self.active != Some(at)
            } else if session.is_confirmed {
                silent_s > self.forget_after_s
            } else {
                self.now_s - session.opened_s > CONFIRM_S
            };
            if is_over {
                self.end(at);
            }
        }
        if self.is_follower {
            self.hand_over();
            let connected = self.sessions.iter().flatten().filter(|session| session.is_confirmed).count();
            self.clerk.shared.is_full.store(connected >= CONSOLES_MAX, Relaxed);
        }
    }

    fn keep_alive(&mut self) {
        for at in 0..SESSIONS {
            let Some(session) = self.sessions[at].as_ref() else { continue };
            let pause_s = if self.active == Some(at) && self.carries() { ALIVE_S } else { ALIVE_WAITING_S };
            // A follower says nothing in a session that its console has not confirmed.
            if (session.is_confirmed || !self.is_follower) && self.now_s - session.sent_s >= pause_s {
                self.send_to(at, self.now_s, None);
            }
        }
    }

    fn send_to(&mut self, at: usize, now_s: f64, payload: Option<&[u8]>) -> Sent {
        self.send_with(at, now_s, payload, false)
    }

    fn send_with(&mut self, at: usize, now_s: f64, payload: Option<&[u8]>, goodbye: bool) -> Sent {
        let control = self.control_byte(at, goodbye);
        let Some(session) = self.sessions[at].as_mut() else { return Sent::Held };
        let sent = session.stream.send(now_s, payload, control, &mut self.out);
        if let Sent::Datagram(len) = sent {
            session.sent_s = now_s;
            if !self.socket.send(&self.out[..len], session.at) {
                self.dropped.unsent += 1;
            }
        }
        sent
    }

    fn control_byte(&self, at: usize, goodbye: bool) -> u8 {
        if self.is_follower {
            return FromFollower { goodbye, ..self.told_to(at) }.byte();
        }
        let (answers, consents) = self.answer.unwrap_or_default();
        FromConsole { asks: self.asks, answers, consents, goodbye }.byte()
    }
}

impl Drop for Endpoint {
    fn drop(&mut self) {
        self.close();
    }
}

/// The address that a socket for datagrams to this one is bound to: what is on this machine is not reached through the network.
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
pub struct Received<'a> {
    session: Option<&'a mut Box<Session>>,
    now_s: f64,
}

impl Received<'_> {
    /// The next, in order; `None` when all that are due have been taken.
    pub fn next_due(&mut self) -> Option<Payload<'_>> {
        self.session.as_mut()?.stream.take(self.now_s)
    }
}

#[cfg(test)]
mod tests;
