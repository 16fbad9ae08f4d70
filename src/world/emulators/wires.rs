//! Our ends of the wires on which clients reach an emulator: pseudo-terminals, streams, datagrams. None of them ever waits; [`Wires`]
//! waits for all of them at once.

mod datagrams;
mod listener;
#[cfg(unix)]
mod terminal;

use std::{io, net::SocketAddr, time::Duration};

pub(super) use datagrams::udp;
pub(super) use listener::tcp;
#[cfg(target_os = "linux")]
pub(super) use listener::{packets, stream};
#[cfg(unix)]
pub(super) use terminal::terminal;

/// Who is at the other end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Peer {
    /// Whoever has the terminal open; all that are connected.
    Everyone,
    /// One connection, by its number.
    Connection(u64),
    /// Who sent a datagram from there.
    Address(SocketAddr),
}

/// What happened at an end; the bytes, so many, are in the buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// Somebody new, and the first bytes.
    Came(Peer, usize),
    /// Bytes.
    Heard(Peer, usize),
    /// Somebody is there no longer.
    Gone(Peer),
}

/// One end of a wire, at a place that is its own for as long as it lives.
pub trait End: Send {
    /// Where clients find it; known once it was open.
    fn endpoint(&self) -> String;
    /// Opens it, if it is not.
    fn open(&mut self) -> io::Result<()>;
    /// Closes it, as when the cable is pulled; true if it was open.
    fn cut(&mut self) -> bool;
    /// What has arrived and was not told yet. New clients are taken only where the emulator `admits` them.
    fn next(&mut self, buffer: &mut [u8], admits: bool) -> Option<Arrival>;
    /// Sends to those who are meant and here.
    fn send(&mut self, to: Peer, bytes: &[u8]);
    /// Ends a connection.
    fn hang_up(&mut self, _: Peer) {}
    /// The speed that the client of a serial line has set, bit/s.
    fn baud(&self) -> Option<u32> {
        None
    }
    /// Adds what is readable when something arrives.
    #[cfg(target_os = "linux")]
    fn watch(&self, admits: bool, watched: &mut Vec<std::os::fd::RawFd>);
}

/// Taken from one end in one turn at most, so that the others, the time and the faults are never far away.
const ARRIVALS: usize = 64;

/// All ends of an emulator.
pub(super) struct Wires {
    ends: Vec<Box<dyn End>>,
    /// Which end is next in this turn, and what it may still tell.
    at: (usize, usize),
}

impl Wires {
    pub(super) fn new(ends: Vec<Box<dyn End>>) -> Self {
        Self { ends, at: (0, 0) }
    }

    /// Opens what is closed; what cannot be opened is tried again in the next turn.
    pub(super) fn open(&mut self) {
        self.ends.iter_mut().for_each(|end| drop(end.open()));
    }

    /// True if anything was open.
    pub(super) fn cut(&mut self) -> bool {
        self.ends.iter_mut().fold(false, |any, end| end.cut() | any)
    }

    pub(super) const fn begin_turn(&mut self) {
        self.at = (0, ARRIVALS);
    }

    pub(super) fn next(&mut self, buffer: &mut [u8], admits: bool) -> Option<Arrival> {
        while let Some(end) = self.ends.get_mut(self.at.0) {
            if self.at.1 > 0
                && let Some(arrival) = end.next(buffer, admits)
            {
                self.at.1 -= 1;
                return Some(arrival);
            }
            self.at = (self.at.0 + 1, ARRIVALS);
        }
        None
    }

    pub(super) fn send(&mut self, to: Peer, bytes: &[u8]) {
        self.ends.iter_mut().for_each(|end| end.send(to, bytes));
    }

    pub(super) fn hang_up(&mut self, peer: Peer) {
        self.ends.iter_mut().for_each(|end| end.hang_up(peer));
    }

    pub(super) fn baud(&self) -> Option<u32> {
        self.ends.iter().find_map(|end| end.baud())
    }

    /// Until something arrives, at most this long.
    #[cfg(target_os = "linux")]
    #[expect(unsafe_code, reason = "std waits for one descriptor only")]
    pub(super) fn wait(&self, longest: Duration, admits: bool) {
        let mut watched = Vec::new();
        self.ends.iter().for_each(|end| end.watch(admits, &mut watched));
        let of = |fd| libc::pollfd { fd, events: libc::POLLIN, revents: 0 };
        let mut watched: Vec<libc::pollfd> = watched.into_iter().map(of).collect();
        let longest = libc::timespec { tv_sec: 0, tv_nsec: longest.subsec_nanos().into() };
        // SAFETY: both pointers are valid for the call, and the count is that of the vector.
        unsafe {
            libc::ppoll(watched.as_mut_ptr(), watched.len() as libc::nfds_t, &raw const longest, std::ptr::null())
        };
    }

    /// Until something may have arrived, at most this long.
    #[cfg(not(target_os = "linux"))]
    pub(super) fn wait(&self, longest: Duration, _: bool) {
        std::thread::sleep(longest.min(Duration::from_micros(300)));
    }
}
