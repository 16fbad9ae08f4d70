//! A UDP socket that talks to one peer and never waits.

use std::{
    io::ErrorKind,
    net::{IpAddr, SocketAddr, UdpSocket},
};

use super::Datagrams;
use crate::device::{Loss, Trouble};

/// An open socket.
#[derive(Debug)]
pub struct Udp {
    socket: UdpSocket,
    /// Whose datagrams are taken; others are dropped.
    from: IpAddr,
}

impl Udp {
    /// Listens on `port` of every interface (0: any free one) for datagrams of one sender.
    pub fn listen(port: u16, from: IpAddr) -> Result<Self, Trouble> {
        let place = format!("UDP port {port}");
        let socket = UdpSocket::bind(("0.0.0.0", port)).map_err(|error| Trouble::of_address(&place, &error))?;
        Self::of(socket, from).map_err(|error| Trouble::of_address(&place, &error))
    }

    /// Talks to one address.
    pub fn connect(to: SocketAddr) -> Result<Self, Trouble> {
        let trouble = |error| Trouble::of_address(&to.to_string(), &error);
        let socket = UdpSocket::bind(("0.0.0.0", 0)).map_err(trouble)?;
        socket.connect(to).map_err(trouble)?;
        Self::of(socket, to.ip()).map_err(trouble)
    }

    fn of(socket: UdpSocket, from: IpAddr) -> std::io::Result<Self> {
        socket.set_nonblocking(true)?;
        Ok(Self { socket, from })
    }

    /// The port it listens on.
    pub fn port(&self) -> Option<u16> {
        self.socket.local_addr().ok().map(|address| address.port())
    }
}

/// Strangers' datagrams skipped in one call.
const STRANGERS_MAX: usize = 16;

impl Datagrams for Udp {
    fn receive(&mut self, buffer: &mut [u8]) -> Result<Option<usize>, Loss> {
        for _ in 0..STRANGERS_MAX {
            match self.socket.recv_from(buffer) {
                Ok((count, sender)) if sender.ip() == self.from => return Ok(Some(count)),
                Ok(_) => {}
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => {
                    return Ok(None);
                }
                // The peer's port is closed (an ICMP answer to what was sent).
                Err(_) => return Err(Loss::Disconnected),
            }
        }
        Ok(None)
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Loss> {
        match self.socket.send(bytes) {
            Ok(_) => Ok(()),
            // A full queue loses a datagram, as the network may.
            Err(error) if error.kind() == ErrorKind::WouldBlock => Ok(()),
            Err(_) => Err(Loss::Disconnected),
        }
    }
}
