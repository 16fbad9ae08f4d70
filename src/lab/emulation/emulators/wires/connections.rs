//! Connections from any source: TCP on this computer's network.

#[cfg(unix)]
use std::os::fd::{AsRawFd, RawFd};
use std::{
    io::{self, ErrorKind, Read, Write},
    net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream},
};

use super::{WireArrival, WireEnd, WirePeer};
use crate::emulators::addresses::taken;

/// Returns a TCP port of this computer; 0 selects a free one. A client that does not read its data is disconnected.
pub(in crate::emulators) fn tcp(port: u16) -> Box<dyn WireEnd> {
    Box::new(Connections::new(ConnectionPort((Ipv4Addr::LOCALHOST, port).into()), false))
}

/// Returns the same for one client at a time: the next client replaces it.
pub(in crate::emulators) fn tcp_for_one(port: u16) -> Box<dyn WireEnd> {
    Box::new(Connections::new(ConnectionPort((Ipv4Addr::LOCALHOST, port).into()), true))
}

/// A descriptor that can be waited for together with others.
#[cfg(unix)]
pub(super) trait Waitable: AsRawFd {}
#[cfg(unix)]
impl<T: AsRawFd> Waitable for T {}
/// Other systems can wait for one descriptor only (see `wait`).
#[cfg(not(unix))]
pub(super) trait Waitable {}
#[cfg(not(unix))]
impl<T> Waitable for T {}

/// A source of connections.
pub(super) trait ConnectionPlace: Send {
    type Listener: Send + Waitable;
    type Stream: Send + Waitable + Read + Write;
    /// Whether unread data are dropped; otherwise the client is disconnected.
    const LOSES: bool;

    fn endpoint(&self) -> String;
    fn listen(&mut self) -> io::Result<Self::Listener>;
    fn accept(listener: &Self::Listener) -> io::Result<Self::Stream>;
    /// Called when listening ends.
    fn leave(&self) {}
}

pub(super) struct Connections<P: ConnectionPlace> {
    place: P,
    for_one: bool,
    listener: Option<P::Listener>,
    clients: Vec<ConnectionClient<P::Stream>>,
    accepted: u64,
    /// The client to be served next.
    next: usize,
}

struct ConnectionClient<S> {
    peer: WirePeer,
    stream: S,
    alive: bool,
}

impl<P: ConnectionPlace> Connections<P> {
    pub(super) const fn new(place: P, for_one: bool) -> Self {
        Self { place, for_one, listener: None, clients: Vec::new(), accepted: 0, next: 0 }
    }
}

impl<P: ConnectionPlace> WireEnd for Connections<P> {
    fn endpoint(&self) -> String {
        self.place.endpoint()
    }

    fn open(&mut self) -> io::Result<()> {
        if self.listener.is_none() {
            self.listener = Some(self.place.listen()?);
        }
        Ok(())
    }

    fn cut(&mut self) -> bool {
        self.clients.clear();
        self.listener.take().map(|_| self.place.leave()).is_some()
    }

    fn next(&mut self, buffer: &mut [u8], admits: bool) -> Option<WireArrival> {
        if admits && let Ok(stream) = P::accept(self.listener.as_ref()?) {
            if self.for_one {
                self.clients.clear();
            }
            self.accepted += 1;
            let peer = WirePeer::Connection(self.accepted);
            self.clients.push(ConnectionClient { peer, stream, alive: true });
            return Some(WireArrival::Came(peer, 0));
        }
        // Serve clients in turn, so that one that sends much data does not delay the others.
        for _ in 0..self.clients.len() {
            let at = self.next % self.clients.len();
            self.next = at + 1;
            let ConnectionClient { peer, stream, alive } = &mut self.clients[at];
            match stream.read(buffer) {
                Ok(count) if *alive && count > 0 => return Some(WireArrival::Heard(*peer, count)),
                Err(error) if *alive && matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => {}
                _ => return Some(WireArrival::Gone(self.clients.remove(at).peer)),
            }
        }
        None
    }

    fn send(&mut self, to: WirePeer, bytes: &[u8]) {
        for ConnectionClient { peer, stream, alive } in &mut self.clients {
            if to == WirePeer::Everyone || to == *peer {
                let whole = stream.write(bytes).is_ok_and(|count| count == bytes.len());
                *alive &= whole || P::LOSES;
            }
        }
    }

    fn hang_up(&mut self) {
        self.clients.iter_mut().for_each(|client| client.alive = false);
    }

    #[cfg(unix)]
    fn watch(&self, admits: bool, watched: &mut Vec<RawFd>) {
        watched.extend(self.listener.iter().filter(|_| admits).map(P::Listener::as_raw_fd));
        watched.extend(self.clients.iter().map(|client| client.stream.as_raw_fd()));
    }
}

struct ConnectionPort(SocketAddr);

impl ConnectionPlace for ConnectionPort {
    type Listener = TcpListener;
    type Stream = TcpStream;
    const LOSES: bool = false;

    fn endpoint(&self) -> String {
        self.0.to_string()
    }

    fn listen(&mut self) -> io::Result<TcpListener> {
        let listener = taken(self.0.port(), "TCP", TcpListener::bind(self.0))?;
        listener.set_nonblocking(true)?;
        self.0 = listener.local_addr()?;
        Ok(listener)
    }

    fn accept(listener: &TcpListener) -> io::Result<TcpStream> {
        let (stream, _) = listener.accept()?;
        stream.set_nodelay(true)?;
        stream.set_nonblocking(true)?;
        Ok(stream)
    }
}
