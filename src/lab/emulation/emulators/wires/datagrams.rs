//! Datagrams on this computer's network.

#[cfg(unix)]
use std::os::fd::{AsRawFd as _, RawFd};
use std::{
    io,
    net::{Ipv4Addr, SocketAddr, UdpSocket},
};

use super::{WireArrival, WireEnd, WirePeer};
use crate::emulators::addresses::taken;

/// Returns a UDP port of this computer; 0 selects a free one.
pub(in crate::emulators) fn udp(port: u16) -> Box<dyn WireEnd> {
    Box::new(WireDatagrams { address: (Ipv4Addr::LOCALHOST, port).into(), socket: None })
}

struct WireDatagrams {
    address: SocketAddr,
    socket: Option<UdpSocket>,
}

impl WireEnd for WireDatagrams {
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

    fn next(&mut self, buffer: &mut [u8], _: bool) -> Option<WireArrival> {
        let (count, from) = self.socket.as_ref()?.recv_from(buffer).ok()?;
        Some(WireArrival::Heard(WirePeer::Address(from), count))
    }

    fn send(&mut self, to: WirePeer, bytes: &[u8]) {
        if let (Some(socket), WirePeer::Address(to)) = (&self.socket, to) {
            // A closed port returns an error, which does not matter here.
            socket.send_to(bytes, to).ok();
        }
    }

    #[cfg(unix)]
    fn watch(&self, _: bool, watched: &mut Vec<RawFd>) {
        watched.extend(self.socket.iter().map(UdpSocket::as_raw_fd));
    }
}
