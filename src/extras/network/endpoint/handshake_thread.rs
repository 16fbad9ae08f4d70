//! A thread that performs handshakes, because key agreements and allocations take too long for the loop's thread.
//!
//! The loop passes it the datagrams of handshakes and receives sessions; ended sessions go back to the thread to be
//! freed. Neither side ever waits for the other: the queues between them are wait-free.

use std::{
    io,
    net::SocketAddr,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering::Relaxed},
    },
    time::Duration,
};

use rtrb::{Consumer, Producer, PushError, RingBuffer};

use super::session::NetworkSession;
use crate::{
    control::SessionRefusal,
    secure::{Approach, HandshakeError, HandshakeResult, Reception},
    socket::Socket,
    stream::StreamSettings,
    wire::HANDSHAKE_MAX,
    worker::NetworkWorker,
};

/// Maximum number of datagrams waiting for the thread; more are dropped.
const LETTERS: usize = 64;
/// Maximum number of sessions waiting for the loop, and waiting to be freed.
const SESSIONS: usize = 16;
/// Polling interval while active, and while idle.
const BUSY: Duration = Duration::from_millis(1);
const REST: Duration = Duration::from_millis(10);
/// Time for which it stays active.
const BUSY_S: f64 = 1.0;

#[derive(Clone, Copy, Debug)]
pub(super) struct Letter {
    from: SocketAddr,
    len: usize,
    bytes: [u8; HANDSHAKE_MAX],
}

/// Notifications from the thread to the loop.
#[derive(Debug)]
pub(super) enum HandshakeEvent {
    Opened(Box<NetworkSession>),
    Refused(SessionRefusal),
}

/// Counters and switches used by both sides.
#[derive(Debug, Default)]
pub(super) struct ClerkShared {
    /// Whether a session is requested by the console.
    pub(super) is_wanted: AtomicBool,
    /// Whether a follower admits no more consoles.
    pub(super) is_full: AtomicBool,
    pub(super) malformed: AtomicU64,
    pub(super) foreign_version: AtomicU64,
    pub(super) flooded: AtomicU64,
    pub(super) refused: AtomicU64,
    /// Datagrams of handshakes that were sent.
    pub(super) sent: AtomicU64,
}

/// This end of the handshake.
#[derive(Debug)]
pub(super) enum Handshake {
    Follower(Box<Reception>),
    Console(Box<Approach>, SocketAddr),
}

/// The loop's end.
#[derive(Debug)]
pub(super) struct HandshakeThread {
    letters: Producer<Letter>,
    news: Consumer<HandshakeEvent>,
    ended: Producer<Box<NetworkSession>>,
    pub(super) shared: Arc<ClerkShared>,
    _thread: NetworkWorker,
}

impl HandshakeThread {
    pub(super) fn start(handshake: Handshake, socket: Socket, settings: StreamSettings) -> io::Result<Self> {
        let (letters, inbox) = RingBuffer::new(LETTERS);
        let (outbox, news) = RingBuffer::new(SESSIONS);
        let (ended, rest) = RingBuffer::new(SESSIONS);
        let shared = Arc::new(ClerkShared::default());
        let mut desk = HandshakeState {
            handshake,
            socket,
            settings,
            inbox,
            outbox,
            ended: rest,
            shared: Arc::clone(&shared),
            busy_s: 0.0,
            out: [0; HANDSHAKE_MAX],
        };
        let thread = NetworkWorker::start("network", move |now_s| desk.turn(now_s))?;
        Ok(Self { letters, news, ended, shared, _thread: thread })
    }

    /// Passes on a datagram; `false` if too many wait.
    pub(super) fn give(&mut self, datagram: &[u8], from: SocketAddr) -> bool {
        let mut letter = Letter { from, len: datagram.len(), bytes: [0; HANDSHAKE_MAX] };
        let Some(room) = letter.bytes.get_mut(..letter.len) else { return false };
        room.copy_from_slice(datagram);
        self.letters.push(letter).is_ok()
    }

    pub(super) fn news(&mut self) -> Option<HandshakeEvent> {
        self.news.pop().ok()
    }

    /// Takes a session that has ended, to free it; returns the session if too many are waiting.
    pub(super) fn free(&mut self, session: Box<NetworkSession>) -> Option<Box<NetworkSession>> {
        self.ended.push(session).err().map(|PushError::Full(session)| session)
    }
}

/// The thread's end.
struct HandshakeState {
    handshake: Handshake,
    socket: Socket,
    settings: StreamSettings,
    inbox: Consumer<Letter>,
    outbox: Producer<HandshakeEvent>,
    ended: Consumer<Box<NetworkSession>>,
    shared: Arc<ClerkShared>,
    /// When the last datagram arrived.
    busy_s: f64,
    out: [u8; HANDSHAKE_MAX],
}

impl HandshakeState {
    fn turn(&mut self, now_s: f64) -> Duration {
        for _ in 0..LETTERS {
            let Ok(letter) = self.inbox.pop() else { break };
            self.busy_s = now_s;
            self.answer(&letter, now_s);
        }
        while self.ended.pop().is_ok() {}
        let is_wanted = self.shared.is_wanted.load(Relaxed);
        if let Handshake::Console(approach, to) = &mut self.handshake
            && is_wanted
        {
            let len = approach.due(now_s, &mut self.out);
            let to = *to;
            self.send(len, to);
        }
        if is_wanted || now_s - self.busy_s < BUSY_S { BUSY } else { REST }
    }

    fn send(&self, len: usize, to: SocketAddr) {
        if len > 0 && self.socket.send(&self.out[..len], to) {
            self.shared.sent.fetch_add(1, Relaxed);
        }
    }

    fn answer(&mut self, letter: &Letter, now_s: f64) {
        let datagram = &letter.bytes[..letter.len];
        let received = match &mut self.handshake {
            Handshake::Follower(reception) => {
                reception.is_full = self.shared.is_full.load(Relaxed);
                reception.receive(datagram, letter.from, now_s, &mut self.out)
            }
            Handshake::Console(approach, _) => approach.receive(datagram, now_s, &mut self.out),
        };
        let HandshakeResult { answer, trouble, agreed } = received;
        if let Some(agreed) = agreed {
            // Pass the session on before the other side is notified of it.
            let session = Box::new(NetworkSession::new(*agreed, letter.from, &self.settings));
            self.outbox.push(HandshakeEvent::Opened(session)).ok();
        }
        self.send(answer, letter.from);
        let counter = match trouble {
            None => return,
            Some(HandshakeError::TheyRefuse(refusal)) => {
                self.outbox.push(HandshakeEvent::Refused(refusal)).ok();
                return;
            }
            Some(HandshakeError::Malformed) => &self.shared.malformed,
            Some(HandshakeError::ForeignVersion) => &self.shared.foreign_version,
            Some(HandshakeError::Flooded) => &self.shared.flooded,
            Some(HandshakeError::Refused) => &self.shared.refused,
        };
        counter.fetch_add(1, Relaxed);
    }
}
