//! Datagrams on this computer's network.

#[cfg(unix)]
use std::os::fd::{AsRawFd as _, RawFd};
use std::{
    io,
    net::{Ipv4Addr, SocketAddr, UdpSocket},
};

use super::{Arrival, End, Peer};
use crate::emulators::places::taken;

/// A UDP port of this computer; 0 selects a free one.
pub(in crate::emulators) fn udp(port: u16) -> Box<dyn End> {
    Box::new(Datagrams { address: (Ipv4Addr::LOCALHOST, port).into(), socket: None })
}

struct Datagrams {
    address: SocketAddr,
    socket: Option<UdpSocket>,
}

impl End for Datagrams {
    fn endpoint(&self) -> String {
        self.address.to_string()
    }

    fn open(&mut self) -> io::Result<()> {
        if self.socket.is_none() {
            let socket = taken(self.address.port(), "UDP", UdpSocket::bind(self.address))?;
            socket.set_nonblocking(true)?;
            self.address = socket.local_addr()?;
            self.socket = Some(socket);
        }
        Ok(())
    }

    fn cut(&mut self) -> bool {
        self.socket.take().is_some()
    }

    fn next(&mut self, buffer: &mut [u8], _: bool) -> Option<Arrival> {
        let (count, from) = self.socket.as_ref()?.recv_from(buffer).ok()?;
        Some(Arrival::Heard(Peer::Address(from), count))
    }

    fn send(&mut self, to: Peer, bytes: &[u8]) {
        if let (Some(socket), Peer::Address(to)) = (&self.socket, to) {
            // A closed port returns an error, which does not matter here.
            socket.send_to(bytes, to).ok();
        }
    }

    #[cfg(unix)]
    fn watch(&self, _: bool, watched: &mut Vec<RawFd>) {
        watched.extend(self.socket.iter().map(UdpSocket::as_raw_fd));
    }
}
