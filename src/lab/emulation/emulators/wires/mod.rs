//! The emulators' ends of the wires: pseudo-terminals, connections, datagrams.

mod connections;
mod datagrams;
#[cfg(target_os = "linux")]
mod paths;
#[cfg(unix)]
mod terminal;

#[cfg(unix)]
use std::os::fd::RawFd;
use std::{io, net::SocketAddr, time::Duration};

pub(super) use connections::{tcp, tcp_for_one};
pub(super) use datagrams::udp;
#[cfg(target_os = "linux")]
pub(super) use paths::socket;
#[cfg(unix)]
pub(super) use terminal::terminal;

/// Other systems have no pseudo-terminals.
///
/// # Errors
/// Always.
#[cfg(not(unix))]
pub(super) fn terminal(_: Option<&std::path::Path>, name: &str, _: Option<u32>) -> io::Result<Box<dyn WireEnd>> {
    let report =
        format!("{name}: this system has no pseudo-terminals, so serial lines are emulated on Linux and macOS only");
    Err(io::Error::new(io::ErrorKind::Unsupported, report))
}

/// The client at the other end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WirePeer {
    /// All clients: every program that has the terminal open, or every connection.
    Everyone,
    /// One connection, by its number.
    Connection(u64),
    /// The sender of a datagram.
    Address(SocketAddr),
}

/// An event at an end. The number of bytes refers to the buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WireArrival {
    /// A client connected, or sent this many bytes.
    Came(WirePeer, usize),
    /// Bytes.
    Heard(WirePeer, usize),
    /// A client disconnected.
    Gone(WirePeer),
}

/// One end of a wire, at an endpoint that it owns for its lifetime. It never blocks.
pub trait WireEnd: Send {
    /// Returns the address for clients; known once the end has been opened.
    fn endpoint(&self) -> String;
    /// Opens the end if it is closed.
    fn open(&mut self) -> io::Result<()>;
    /// Closes the end, as when the cable is unplugged; returns whether it was open.
    fn cut(&mut self) -> bool;
    /// Returns the next event. New clients are accepted only if the emulator `admits` them.
    fn next(&mut self, buffer: &mut [u8], admits: bool) -> Option<WireArrival>;
    /// Sends to the addressed clients that are connected.
    fn send(&mut self, to: WirePeer, bytes: &[u8]);
    /// Closes all connections.
    fn hang_up(&mut self) {}
    /// Returns the baud rate that the client of a serial port has set, bit/s.
    fn baud(&self) -> Option<u32> {
        None
    }
    /// Adds the descriptors that become readable when data arrive.
    #[cfg(unix)]
    fn watch(&self, admits: bool, watched: &mut Vec<RawFd>);
}

/// Maximum events from one end in one turn, so that the others, the time and the faults are handled soon.
pub(super) const ARRIVALS: usize = 64;

/// Waits until data arrive at one of the ends, for at most this long.
#[cfg(unix)]
#[expect(unsafe_code, reason = "std waits for one descriptor only")]
pub(super) fn wait(ends: &[Box<dyn WireEnd>], longest: Duration, admits: bool) {
    let mut watched = Vec::new();
    for end in ends {
        end.watch(admits, &mut watched);
    }
    let of = |fd| libc::pollfd { fd, events: libc::POLLIN, revents: 0 };
    let mut watched: Vec<libc::pollfd> = watched.into_iter().map(of).collect();
    let first = watched.as_mut_ptr();
    let count = watched.len() as libc::nfds_t;
    // SAFETY: the pointers are valid for the call, and the count is the length of the vector.
    #[cfg(target_os = "linux")]
    unsafe {
        let longest = libc::timespec { tv_sec: 0, tv_nsec: longest.subsec_nanos().into() };
        libc::ppoll(first, count, &raw const longest, std::ptr::null());
    }
    // SAFETY: as above. Elsewhere there are whole milliseconds only.
    #[cfg(not(target_os = "linux"))]
    unsafe {
        libc::poll(first, count, longest.as_millis() as libc::c_int);
    }
}

/// Polling interval where the system cannot wait for all ends.
#[cfg(not(unix))]
const LOOK: Duration = Duration::from_millis(1);

/// Waits for at most this long, because the ends are polled.
#[cfg(not(unix))]
pub(super) fn wait(_: &[Box<dyn WireEnd>], longest: Duration, _: bool) {
    std::thread::sleep(longest.min(LOOK));
}
