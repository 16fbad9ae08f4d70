//! A non-blocking UDP socket that reports when a datagram arrived.

use std::{
    io::{self, ErrorKind},
    net::{SocketAddr, UdpSocket},
    time::{Duration, SystemTime, UNIX_EPOCH},
};

use socket2::{Domain, Protocol, Socket as Maker, Type};

/// Buffers of the system, bytes: more than a second of two arms.
const BUFFER_LEN: usize = 1 << 20;
/// Marks datagrams as urgent for networks that support it: expedited forwarding (RFC 3246).
const EXPEDITED: u32 = 0xb8;

/// A received datagram.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DatagramArrival {
    /// Length, bytes; more than the buffer's if it was truncated (on Linux; Windows drops such a datagram).
    pub(crate) len: usize,
    pub(crate) from: SocketAddr,
    /// Arrival at this machine, since 1970; `None` if the system does not report it.
    pub(crate) stamp: Option<Duration>,
}

impl DatagramArrival {
    /// Returns the arrival time, s, by the clock that showed `now_s` at `looked` (since 1970).
    pub(crate) fn came_s(&self, now_s: f64, looked: Duration) -> f64 {
        let Some(stamp) = self.stamp else { return now_s };
        let age_s = looked.as_secs_f64() - stamp.as_secs_f64();
        // A recent datagram may be slightly newer than `looked`; an older time stamp shows that the system's clock was
        // changed.
        if (-0.01..1.0).contains(&age_s) { now_s - age_s } else { now_s }
    }
}

/// Returns the time since 1970: the clock of the stamps.
pub(crate) fn system_time() -> Duration {
    SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default()
}

#[derive(Debug)]
pub(crate) struct Socket {
    socket: UdpSocket,
    to: Option<SocketAddr>,
}

impl Socket {
    /// Opens a socket at this address; with `to`, only for datagrams from and to that address.
    pub(crate) fn open(at: SocketAddr, to: Option<SocketAddr>) -> io::Result<Self> {
        let socket = Maker::new(Domain::for_address(at), Type::DGRAM, Some(Protocol::UDP))?;
        socket.set_nonblocking(true)?;
        // A refusal by the system is harmless.
        socket.set_recv_buffer_size(BUFFER_LEN).ok();
        socket.set_send_buffer_size(BUFFER_LEN).ok();
        if at.is_ipv4() {
            socket.set_tos_v4(EXPEDITED).ok();
        }
        stamps::switch_on(&socket);
        socket.bind(&at.into())?;
        if let Some(to) = to {
            socket.connect(&to.into())?;
        }
        Ok(Self { socket: socket.into(), to })
    }

    pub(crate) fn try_clone(&self) -> io::Result<Self> {
        Ok(Self { socket: self.socket.try_clone()?, to: self.to })
    }

    pub(crate) fn address(&self) -> io::Result<SocketAddr> {
        self.socket.local_addr()
    }

    /// Returns the next datagram, if there is one.
    pub(crate) fn receive(&self, buffer: &mut [u8]) -> Option<DatagramArrival> {
        // An error may report that an earlier datagram of ours was rejected; tolerate a few in a row.
        for _ in 0..4 {
            match stamps::receive(&self.socket, buffer) {
                Ok(arrival) => return Some(arrival),
                Err(error) if error.kind() == ErrorKind::WouldBlock => return None,
                Err(_) => {}
            }
        }
        None
    }

    /// Returns whether the system has accepted it.
    pub(crate) fn send(&self, datagram: &[u8], to: SocketAddr) -> bool {
        match self.to {
            Some(_) => self.socket.send(datagram).is_ok(),
            None => self.socket.send_to(datagram, to).is_ok(),
        }
    }
}

/// Time stamps from the kernel: each datagram is stamped on arrival, so that its delay does not depend on when it is
/// read.
#[cfg(target_os = "linux")]
#[expect(unsafe_code, reason = "std receives no time stamps")]
mod stamps {
    use std::{
        io,
        mem::{size_of, zeroed},
        net::{Ipv4Addr, Ipv6Addr, SocketAddr, SocketAddrV4, SocketAddrV6, UdpSocket},
        os::fd::AsRawFd as _,
        time::Duration,
    };

    use super::DatagramArrival;

    pub(super) fn switch_on(socket: &socket2::Socket) {
        let on: libc::c_int = 1;
        let len = size_of::<libc::c_int>() as libc::socklen_t;
        // SAFETY: pointer and length describe `on`. Without stamps, ages are 0.
        unsafe {
            libc::setsockopt(socket.as_raw_fd(), libc::SOL_SOCKET, libc::SO_TIMESTAMPNS, (&raw const on).cast(), len);
        }
    }

    pub(super) fn receive(socket: &UdpSocket, buffer: &mut [u8]) -> io::Result<DatagramArrival> {
        // SAFETY: both types are valid when all bytes are zero.
        let (mut name, mut message): (libc::sockaddr_storage, libc::msghdr) = unsafe { (zeroed(), zeroed()) };
        let mut control = [0_u64; 16];
        let mut part = libc::iovec { iov_base: buffer.as_mut_ptr().cast(), iov_len: buffer.len() };
        message.msg_name = (&raw mut name).cast();
        message.msg_namelen = size_of::<libc::sockaddr_storage>() as libc::socklen_t;
        message.msg_iov = &raw mut part;
        message.msg_iovlen = 1;
        message.msg_control = control.as_mut_ptr().cast();
        message.msg_controllen = size_of::<[u64; 16]>() as _;
        // SAFETY: every pointer in the message is valid for the stated length during the call. `MSG_TRUNC` returns the
        // true length of a truncated datagram; the kernel writes no more than the buffer holds.
        let len = unsafe { libc::recvmsg(socket.as_raw_fd(), &raw mut message, libc::MSG_TRUNC) };
        let Ok(len) = usize::try_from(len) else { return Err(io::Error::last_os_error()) };
        let from = address(&name).ok_or(io::ErrorKind::InvalidData)?;
        Ok(DatagramArrival { len, from, stamp: stamp(&message) })
    }

    /// Returns when the datagram arrived, since 1970.
    fn stamp(message: &libc::msghdr) -> Option<Duration> {
        // SAFETY: `recvmsg` filled the message, and its control data are alive; the macro reads within them.
        let first = unsafe { libc::CMSG_FIRSTHDR(message).as_ref() }?;
        if (first.cmsg_level, first.cmsg_type) != (libc::SOL_SOCKET, libc::SCM_TIMESTAMPNS) {
            return None;
        }
        // SAFETY: a header of this type is followed by a `timespec`, which need not be aligned.
        let time = unsafe { libc::CMSG_DATA(first).cast::<libc::timespec>().read_unaligned() };
        Some(Duration::new(time.tv_sec.try_into().ok()?, time.tv_nsec.try_into().ok()?))
    }

    fn address(name: &libc::sockaddr_storage) -> Option<SocketAddr> {
        match libc::c_int::from(name.ss_family) {
            libc::AF_INET => {
                // SAFETY: the family identifies this structure, which is smaller than the storage.
                let v4 = unsafe { &*(&raw const *name).cast::<libc::sockaddr_in>() };
                let ip = Ipv4Addr::from(u32::from_be(v4.sin_addr.s_addr));
                Some(SocketAddrV4::new(ip, u16::from_be(v4.sin_port)).into())
            }
            libc::AF_INET6 => {
                // SAFETY: as above.
                let v6 = unsafe { &*(&raw const *name).cast::<libc::sockaddr_in6>() };
                let ip = Ipv6Addr::from(v6.sin6_addr.s6_addr);
                Some(SocketAddrV6::new(ip, u16::from_be(v6.sin6_port), v6.sin6_flowinfo, v6.sin6_scope_id).into())
            }
            _ => None,
        }
    }
}

#[cfg(not(target_os = "linux"))]
mod stamps {
    use std::{io, net::UdpSocket};

    use super::DatagramArrival;

    pub(super) fn switch_on(_: &socket2::Socket) {}

    pub(super) fn receive(socket: &UdpSocket, buffer: &mut [u8]) -> io::Result<DatagramArrival> {
        let (len, from) = socket.recv_from(buffer)?;
        Ok(DatagramArrival { len, from, stamp: None })
    }
}

#[cfg(test)]
mod tests {
    use std::thread::sleep;

    use super::*;

    #[test]
    fn a_datagram_comes_with_its_sender_its_true_length_and_its_age() {
        for home in ["127.0.0.1:0", "[::1]:0"] {
            let Ok(one) = Socket::open(home.parse().unwrap(), None) else { continue };
            let two = Socket::open(home.parse().unwrap(), Some(one.address().unwrap())).unwrap();
            let mut buffer = [0; 60];
            let mut age_s = 0.0;
            // The first socket that requests time stamps gets them after a short delay.
            for _ in 0..50 {
                // Windows drops datagrams longer than the buffer; the next one is received by the same call.
                for len in if cfg!(windows) { &[100, 60][..] } else { &[100] } {
                    assert!(two.send(&[7; 100][..*len], one.address().unwrap()));
                }
                sleep(Duration::from_millis(20));
                let arrival = one.receive(&mut buffer).unwrap();
                assert_eq!((arrival.from, buffer), (two.address().unwrap(), [7; 60]));
                assert!(!cfg!(target_os = "linux") || arrival.len == 100, "longer than the buffer");
                age_s = -arrival.came_s(0.0, system_time());
                if age_s > 0.019 {
                    break;
                }
            }
            assert!(!cfg!(target_os = "linux") || (0.019..1.0).contains(&age_s), "{age_s}");
            assert!(one.receive(&mut buffer).is_none());
        }
    }
}
