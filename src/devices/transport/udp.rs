//! A UDP socket for one peer; it never waits.

use std::{
    io::ErrorKind,
    net::{IpAddr, SocketAddr, UdpSocket},
};

use super::{TransportDatagrams, check_no_example};
use crate::{DeviceError, Loss};

#[derive(Debug)]
pub struct Udp {
    socket: UdpSocket,
    /// Address of the peer; datagrams from others are dropped.
    from: IpAddr,
    /// Port of the peer, once it is known.
    sender: Option<SocketAddr>,
    kept: bool,
}

impl Udp {
    /// Listens at one address of this computer (port 0: any free one) for datagrams of one peer.
    ///
    /// # Errors
    /// [`DeviceError`] if this computer cannot listen at the address.
    pub fn listen(at: SocketAddr, from: IpAddr) -> Result<Self, DeviceError> {
        let trouble = |error| DeviceError::of_address(&format!("UDP port {} of {}", at.port(), at.ip()), &error);
        let socket = UdpSocket::bind(at).map_err(trouble)?;
        Self::of(socket, from).map_err(trouble)
    }

    /// Returns whether this computer can listen at this address, which must be a single address, not the wildcard.
    pub fn is_local(ip: IpAddr) -> bool {
        !ip.is_unspecified() && UdpSocket::bind((ip, 0)).is_ok()
    }

    /// Communicates with one address.
    ///
    /// # Errors
    /// [`DeviceError`] if the socket cannot be created or connected.
    pub fn connect(to: SocketAddr) -> Result<Self, DeviceError> {
        check_no_example(&to.to_string())?;
        let trouble = |error| DeviceError::of_address(&to.to_string(), &error);
        // Unspecified, so that the system chooses a free port and the right interface.
        let socket = UdpSocket::bind(("0.0.0.0", 0)).map_err(trouble)?;
        socket.connect(to).map_err(trouble)?;
        Self::of(socket, to.ip()).map_err(trouble)
    }

    fn of(socket: UdpSocket, from: IpAddr) -> std::io::Result<Self> {
        socket.set_nonblocking(true)?;
        Ok(Self { socket, from, sender: None, kept: false })
    }

    /// Returns the address at which the socket listens.
    pub fn local_address(&self) -> Option<SocketAddr> {
        self.socket.local_addr().ok()
    }
}

impl Udp {
    fn is_received(&self, sender: SocketAddr) -> bool {
        // Before the first good datagram only the address is known, because the program of a device may choose its
        // port.
        if self.kept { self.sender == Some(sender) } else { sender.ip() == self.from }
    }
}

/// Returns whether a datagram was longer than the buffer, for which Windows gives an error (`WSAEMSGSIZE`) and no
/// sender; other systems truncate it.
fn is_too_long(error: &std::io::Error) -> bool {
    cfg!(windows) && error.raw_os_error() == Some(10040)
}

/// Maximum number of datagrams skipped in one call because of another sender or their length. A flood of datagrams must
/// not hold up the loop; the rest waits for the next call.
const STRANGERS_MAX: usize = 16;

impl TransportDatagrams for Udp {
    fn receive(&mut self, buffer: &mut [u8]) -> Result<Option<usize>, Loss> {
        for _ in 0..STRANGERS_MAX {
            match self.socket.recv_from(buffer) {
                Ok((count, sender)) if self.is_received(sender) => {
                    self.sender = Some(sender);
                    return Ok(Some(count));
                }
                Ok(_) => {}
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => {
                    return Ok(None);
                }
                Err(error) if is_too_long(&error) => {}
                // The peer's port is closed (an ICMP answer to an earlier datagram).
                Err(_) => return Err(Loss::Disconnected),
            }
        }
        Ok(None)
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Loss> {
        match self.socket.send(bytes) {
            Ok(_) => Ok(()),
            // If the send queue is full, the datagram is lost, as may happen in the network.
            Err(error) if error.kind() == ErrorKind::WouldBlock => Ok(()),
            Err(_) => Err(Loss::Disconnected),
        }
    }

    fn keep_to_sender(&mut self) {
        let Some(sender) = self.sender.filter(|_| !self.kept) else { return };
        // From here on the system drops datagrams from other senders before they use buffer space; this code drops
        // those already queued.
        self.kept = self.socket.connect(sender).is_ok();
    }
}

#[cfg(test)]
mod tests {
    use std::{
        net::Ipv4Addr,
        time::{Duration, Instant},
    };

    use super::*;

    const HOME: IpAddr = IpAddr::V4(Ipv4Addr::LOCALHOST);

    /// Returns the next datagram, with a long timeout for busy computers.
    fn next(udp: &mut Udp) -> Vec<u8> {
        let begin = Instant::now();
        let mut buffer = [0; 8];
        while begin.elapsed() < Duration::from_secs(20) {
            if let Some(count) = udp.receive(&mut buffer).unwrap() {
                return buffer[..count].to_vec();
            }
            std::thread::sleep(Duration::from_micros(200));
        }
        panic!("no datagram")
    }

    #[test]
    fn it_listens_at_one_address_only() {
        let udp = Udp::listen(SocketAddr::new(HOME, 0), HOME).unwrap();
        let port = udp.local_address().unwrap().port();
        assert_eq!(udp.local_address().unwrap().ip(), HOME);
        // If the socket listened at every address, this one could not be opened.
        #[cfg(target_os = "linux")]
        UdpSocket::bind(("127.0.0.2", port)).unwrap();
        assert!(matches!(Udp::listen(SocketAddr::new(HOME, port), HOME), Err(DeviceError::Busy { .. })));
        assert!(Udp::is_local(HOME));
        assert!(!Udp::is_local(Ipv4Addr::UNSPECIFIED.into()) && !Udp::is_local([192, 0, 2, 1].into()));
    }

    #[test]
    fn a_datagram_longer_than_any_is_no_lost_device() {
        let mut udp = Udp::listen(SocketAddr::new(HOME, 0), HOME).unwrap();
        let to = udp.local_address().unwrap();
        let [sensor, stranger] = [(), ()].map(|()| UdpSocket::bind((HOME, 0)).unwrap());
        for sender in [&stranger, &sensor] {
            sender.send_to(&[1; 100], to).unwrap();
            sensor.send_to(b"good", to).unwrap();
            let mut received = next(&mut udp);
            if received == [1; 8] {
                received = next(&mut udp);
            }
            assert_eq!(received, b"good");
        }
    }

    #[test]
    fn once_the_sender_is_known_nobody_else_is_heard() {
        let mut udp = Udp::listen(SocketAddr::new(HOME, 0), HOME).unwrap();
        let to = udp.local_address().unwrap();
        let [sensor, stranger] = [(), ()].map(|()| UdpSocket::bind((HOME, 0)).unwrap());
        udp.keep_to_sender();
        stranger.send_to(b"early", to).unwrap();
        assert_eq!(next(&mut udp), b"early", "any program with its address may be the sender");
        sensor.send_to(b"good", to).unwrap();
        assert_eq!(next(&mut udp), b"good");
        // One arrives before the sender is chosen, the others after it.
        stranger.send_to(b"between", to).unwrap();
        udp.keep_to_sender();
        for count in 0..1000 {
            stranger.send_to(b"late", to).ok();
            if count % 100 == 0 {
                sensor.send_to(b"more", to).unwrap();
                assert_eq!(next(&mut udp), b"more");
            }
        }
        sensor.send_to(b"last", to).unwrap();
        assert_eq!(next(&mut udp), b"last");
    }
}
