//! Connections: TCP on this computer's network, and streams or packets at a path.

use std::{
    io::{self, ErrorKind, Read, Write},
    net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream},
};

use super::{Arrival, End, Peer};
use crate::emulators::places::taken;

/// A TCP port of this computer; 0 takes a free one. A client that does not take what it is sent is cut off.
pub(in crate::emulators) fn tcp(port: u16) -> Box<dyn End> {
    Box::new(Listener::new(Port((Ipv4Addr::LOCALHOST, port).into())))
}

/// Where connections come from.
trait Place: Send {
    #[cfg(target_os = "linux")]
    type Socket: Send + std::os::fd::AsRawFd;
    #[cfg(not(target_os = "linux"))]
    type Socket: Send;
    #[cfg(target_os = "linux")]
    type Stream: Read + Write + Send + std::os::fd::AsRawFd;
    #[cfg(not(target_os = "linux"))]
    type Stream: Read + Write + Send;
    /// What a client does not take is lost; else the client is.
    const LOSES: bool;

    fn endpoint(&self) -> String;
    fn listen(&mut self) -> io::Result<Self::Socket>;
    fn accept(socket: &Self::Socket) -> io::Result<Self::Stream>;
    /// Nobody listens there any more.
    fn leave(&self) {}
}

struct Listener<P: Place> {
    place: P,
    socket: Option<P::Socket>,
    connections: Vec<Connection<P::Stream>>,
    accepted: u64,
    /// Which connection is asked next.
    next: usize,
}

struct Connection<S> {
    peer: Peer,
    stream: S,
    alive: bool,
}

impl<P: Place> Listener<P> {
    const fn new(place: P) -> Self {
        Self { place, socket: None, connections: Vec::new(), accepted: 0, next: 0 }
    }
}

impl<P: Place> End for Listener<P> {
    fn endpoint(&self) -> String {
        self.place.endpoint()
    }

    fn open(&mut self) -> io::Result<()> {
        if self.socket.is_none() {
            self.socket = Some(self.place.listen()?);
        }
        Ok(())
    }

    fn cut(&mut self) -> bool {
        self.connections.clear();
        let open = self.socket.take().is_some();
        if open {
            self.place.leave();
        }
        open
    }

    fn next(&mut self, buffer: &mut [u8], admits: bool) -> Option<Arrival> {
        if admits && let Some(stream) = self.socket.as_ref().and_then(|socket| P::accept(socket).ok()) {
            self.accepted += 1;
            let peer = Peer::Connection(self.accepted);
            self.connections.push(Connection { peer, stream, alive: true });
            return Some(Arrival::Came(peer, 0));
        }
        // Each in its turn: one that sends much keeps no other waiting.
        for _ in 0..self.connections.len() {
            let at = self.next % self.connections.len();
            self.next = at + 1;
            let Connection { peer, stream, alive } = &mut self.connections[at];
            match stream.read(buffer) {
                Ok(count) if *alive && count > 0 => return Some(Arrival::Heard(*peer, count)),
                Err(error) if *alive && matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => {}
                _ => return Some(Arrival::Gone(self.connections.remove(at).peer)),
            }
        }
        None
    }

    fn send(&mut self, to: Peer, bytes: &[u8]) {
        for Connection { peer, stream, alive } in &mut self.connections {
            if to == Peer::Everyone || to == *peer {
                let whole = stream.write(bytes).is_ok_and(|count| count == bytes.len());
                *alive &= whole || P::LOSES;
            }
        }
    }

    fn hang_up(&mut self, peer: Peer) {
        self.connections.retain(|connection| connection.peer != peer);
    }

    #[cfg(target_os = "linux")]
    fn watch(&self, admits: bool, watched: &mut Vec<std::os::fd::RawFd>) {
        use std::os::fd::AsRawFd as _;
        watched.extend(self.socket.iter().filter(|_| admits).map(P::Socket::as_raw_fd));
        watched.extend(self.connections.iter().map(|connection| connection.stream.as_raw_fd()));
    }
}

struct Port(SocketAddr);

impl Place for Port {
    type Socket = TcpListener;
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

#[cfg(target_os = "linux")]
pub(in crate::emulators) use at_a_path::{packets, stream};

#[cfg(target_os = "linux")]
mod at_a_path {
    use std::{
        fs, io,
        os::unix::net::{UnixListener, UnixStream},
        path::{Path, PathBuf},
    };

    use nima_devices::hid::seqpacket;

    use super::{End, Listener, Place};
    use crate::emulators::places::socket_path;

    /// Packets at `path`; without one, at `name` in a folder of its own.
    pub(in crate::emulators) fn packets(path: Option<&Path>, name: &str) -> io::Result<Box<dyn End>> {
        at_a_path(path, name, seqpacket::listen)
    }

    /// The same with a stream.
    pub(in crate::emulators) fn stream(path: Option<&Path>, name: &str) -> io::Result<Box<dyn End>> {
        at_a_path(path, name, |path| {
            let listener = UnixListener::bind(path)?;
            listener.set_nonblocking(true)?;
            Ok(listener)
        })
    }

    type Listen = fn(&Path) -> io::Result<UnixListener>;

    fn at_a_path(path: Option<&Path>, name: &str, listen: Listen) -> io::Result<Box<dyn End>> {
        let (path, folder) = socket_path(path, name)?;
        Ok(Box::new(Listener::new(SocketPath { path, _folder: folder, listen })))
    }

    struct SocketPath {
        path: PathBuf,
        /// The folder of its own, where no place was asked for.
        _folder: Option<tempfile::TempDir>,
        listen: Listen,
    }

    impl Place for SocketPath {
        type Socket = UnixListener;
        type Stream = UnixStream;
        const LOSES: bool = true;

        fn endpoint(&self) -> String {
            self.path.display().to_string()
        }

        fn listen(&mut self) -> io::Result<UnixListener> {
            (self.listen)(&self.path)
        }

        fn accept(listener: &UnixListener) -> io::Result<UnixStream> {
            let (stream, _) = listener.accept()?;
            stream.set_nonblocking(true)?;
            Ok(stream)
        }

        fn leave(&self) {
            fs::remove_file(&self.path).ok();
        }
    }
}
