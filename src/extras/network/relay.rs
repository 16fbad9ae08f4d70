//! A relay between two real ends that impairs the link between them, on any system, without special permissions.
//!
//! Consoles send to it instead of to the follower. Each console gets its own socket towards the follower, so that the
//! follower can tell them apart. The relay handles encrypted datagrams only, and adds 0.1 to 0.2 ms.

use std::{
    io,
    net::SocketAddr,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering::Relaxed},
    },
    time::Duration,
};

use crate::{
    impairment::{ImpairedLine, ImpairmentSettings},
    socket::Socket,
    worker::NetworkWorker,
};

/// Maximum number of consoles; a new one replaces the one that has been silent longest.
const CLIENTS_MAX: usize = 8;
/// Polling interval while datagrams are in transit, and while idle.
const BUSY: Duration = Duration::from_micros(100);
const REST: Duration = Duration::from_millis(1);
/// Time without a datagram after which the relay is idle, s.
const REST_AFTER_S: f64 = 0.1;
/// Datagrams read from a socket before the others have their turn.
const TURN: usize = 64;
/// Maximum datagram, bytes.
const BUFFER_LEN: usize = 2048;

/// Addresses and impairments of a relay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelaySettings {
    /// Own address.
    pub at: SocketAddr,
    /// The follower's address.
    pub to: SocketAddr,
    /// Towards the follower.
    pub there: ImpairmentSettings,
    /// From the follower to the console.
    pub back: ImpairmentSettings,
    /// Seed; the same seed loses the same datagrams.
    pub seed: u64,
}

/// Counts of a relay.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Totals {
    /// Datagrams to the follower.
    pub there: u64,
    /// Datagrams to the follower, lost on purpose.
    pub there_lost: u64,
    /// Datagrams from the follower.
    pub back: u64,
    /// Datagrams from the follower, lost on purpose.
    pub back_lost: u64,
}

/// A relay that runs until it is dropped.
#[derive(Debug)]
pub struct Relay {
    address: SocketAddr,
    totals: Arc<[AtomicU64; 4]>,
    _thread: NetworkWorker,
}

impl Relay {
    /// # Errors
    /// I/O errors, or [`io::ErrorKind::InvalidInput`] with the invalid setting.
    pub fn start(settings: RelaySettings) -> io::Result<Self> {
        for direction in [&settings.there, &settings.back] {
            direction.check().map_err(|what| io::Error::new(io::ErrorKind::InvalidInput, what))?;
        }
        let socket = Socket::open(settings.at, None)?;
        let address = socket.address()?;
        let totals = Arc::<[AtomicU64; 4]>::default();
        let mut work =
            RelayWork { socket, settings, totals: Arc::clone(&totals), clients: Vec::new(), made: 0, busy_s: 0.0 };
        let thread = NetworkWorker::start("relay", move |now_s| work.turn(now_s))?;
        Ok(Self { address, totals, _thread: thread })
    }

    pub const fn address(&self) -> SocketAddr {
        self.address
    }

    pub fn totals(&self) -> Totals {
        let [there, there_lost, back, back_lost] = self.totals.each_ref().map(|total| total.load(Relaxed));
        Totals { there, there_lost, back, back_lost }
    }
}

struct RelayClient {
    address: SocketAddr,
    socket: Socket,
    there: ImpairedLine,
    back: ImpairedLine,
    received_s: f64,
}

struct RelayWork {
    socket: Socket,
    settings: RelaySettings,
    totals: Arc<[AtomicU64; 4]>,
    clients: Vec<RelayClient>,
    /// Number of clients so far, which determines the seeds of each.
    made: u64,
    /// When the last datagram arrived.
    busy_s: f64,
}

impl RelayWork {
    fn turn(&mut self, now_s: f64) -> Duration {
        if self.take(now_s) {
            self.busy_s = now_s;
        }
        for client in &mut self.clients {
            while let Some((_, datagram)) = client.there.receive(now_s) {
                client.socket.send(&datagram, self.settings.to);
            }
            while let Some((_, datagram)) = client.back.receive(now_s) {
                self.socket.send(&datagram, client.address);
            }
        }
        self.count();
        let is_busy = now_s - self.busy_s < REST_AFTER_S
            || self.clients.iter().any(|c| c.there.due_s().or(c.back.due_s()).is_some());
        if is_busy { BUSY } else { REST }
    }

    /// Processes received datagrams; returns whether there were any.
    fn take(&mut self, now_s: f64) -> bool {
        let mut buffer = [0; BUFFER_LEN];
        let mut any = false;
        for _ in 0..TURN {
            let Some(arrival) = self.socket.receive(&mut buffer) else { break };
            any = true;
            if let (Some(datagram), Some(client)) = (buffer.get(..arrival.len), self.client(arrival.from, now_s)) {
                client.received_s = now_s;
                client.there.send(now_s, datagram);
            }
        }
        for client in &mut self.clients {
            for _ in 0..TURN {
                let Some(arrival) = client.socket.receive(&mut buffer) else { break };
                any = true;
                if let Some(datagram) = buffer.get(..arrival.len) {
                    client.back.send(now_s, datagram);
                }
            }
        }
        any
    }

    fn client(&mut self, address: SocketAddr, now_s: f64) -> Option<&mut RelayClient> {
        let known = self.clients.iter().position(|client| client.address == address);
        if let Some(at) = known {
            return self.clients.get_mut(at);
        }
        if self.clients.len() == CLIENTS_MAX {
            let oldest = self.clients.iter().enumerate().min_by(|(_, a), (_, b)| a.received_s.total_cmp(&b.received_s));
            let at = oldest.map(|(at, _)| at)?;
            self.clients.swap_remove(at);
        }
        let RelaySettings { to, there, back, seed, .. } = self.settings;
        let socket = Socket::open(crate::endpoint::towards(&to), Some(to)).ok()?;
        let seed = seed.wrapping_add(self.made * 2);
        self.made += 1;
        let there = ImpairedLine::new(there, seed);
        let back = ImpairedLine::new(back, seed.wrapping_add(1));
        self.clients.push(RelayClient { address, socket, there, back, received_s: now_s });
        self.clients.last_mut()
    }

    fn count(&self) {
        let mut totals = [0; 4];
        for client in &self.clients {
            let (there, there_lost) = client.there.totals();
            let (back, back_lost) = client.back.totals();
            for (total, more) in totals.iter_mut().zip([there, there_lost, back, back_lost]) {
                *total += more;
            }
        }
        for (shared, total) in self.totals.iter().zip(totals) {
            shared.store(total, Relaxed);
        }
    }
}
