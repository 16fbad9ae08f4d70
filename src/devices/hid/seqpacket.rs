//! Packets over a UNIX socket, used by the emulator instead of a hidraw node, which no kernel interface can emulate on
//! every computer.
//!
//! One read returns one packet, like the reports of a hidraw node. The other end detects that one end is closed, as
//! when a device is unplugged.
#![expect(unsafe_code, reason = "std makes no sequenced-packet sockets; everything after making them is safe")]

use std::{
    io::{self, ErrorKind, Read as _, Write as _},
    mem::offset_of,
    os::{
        fd::{AsRawFd as _, FromRawFd as _, OwnedFd},
        unix::{
            ffi::OsStrExt as _,
            net::{UnixListener, UnixStream},
        },
    },
    path::Path,
};

use crate::{Loss, transport::TransportDatagrams};

/// Maximum number of connections that wait to be accepted.
const BACKLOG: libc::c_int = 8;

fn socket() -> io::Result<OwnedFd> {
    // SAFETY: the descriptor is new and has one owner.
    unsafe {
        let fd = libc::socket(libc::AF_UNIX, libc::SOCK_SEQPACKET | libc::SOCK_CLOEXEC | libc::SOCK_NONBLOCK, 0);
        if fd < 0 { Err(io::Error::last_os_error()) } else { Ok(OwnedFd::from_raw_fd(fd)) }
    }
}

fn address(path: &Path) -> io::Result<(libc::sockaddr_un, libc::socklen_t)> {
    // SAFETY: all zeros are a valid address structure.
    let mut address: libc::sockaddr_un = unsafe { std::mem::zeroed() };
    address.sun_family = libc::AF_UNIX as libc::sa_family_t;
    let bytes = path.as_os_str().as_bytes();
    if bytes.is_empty() || bytes.len() >= address.sun_path.len() || bytes.contains(&0) {
        return Err(io::Error::new(ErrorKind::InvalidInput, "the path of a socket has 1 to 107 bytes"));
    }
    address.sun_path.iter_mut().zip(bytes).for_each(|(to, from)| *to = libc::c_char::from_ne_bytes([*from]));
    let length = offset_of!(libc::sockaddr_un, sun_path) + bytes.len() + 1;
    Ok((address, length as libc::socklen_t))
}

fn succeeded(code: libc::c_int) -> io::Result<()> {
    if code == 0 { Ok(()) } else { Err(io::Error::last_os_error()) }
}

/// Listens for connections at a path that does not exist yet.
///
/// # Errors
/// I/O errors, for instance if the path exists or is too long.
pub fn listen(path: &Path) -> io::Result<UnixListener> {
    let socket = socket()?;
    let (address, length) = address(path)?;
    // SAFETY: the address outlives the call and `length` is within it.
    succeeded(unsafe { libc::bind(socket.as_raw_fd(), (&raw const address).cast(), length) })?;
    // SAFETY: the descriptor is open.
    succeeded(unsafe { libc::listen(socket.as_raw_fd(), BACKLOG) })?;
    Ok(UnixListener::from(socket))
}

/// Connects to a listener.
///
/// # Errors
/// I/O errors, for instance if nothing listens at the path.
pub fn connect(path: &Path) -> io::Result<Packets> {
    let socket = socket()?;
    let (address, length) = address(path)?;
    // SAFETY: the address outlives the call and `length` is within it.
    succeeded(unsafe { libc::connect(socket.as_raw_fd(), (&raw const address).cast(), length) })?;
    Ok(Packets { stream: UnixStream::from(socket) })
}

/// One end of a connection; reading does not wait.
#[derive(Debug)]
pub struct Packets {
    stream: UnixStream,
}

impl TransportDatagrams for Packets {
    fn receive(&mut self, buffer: &mut [u8]) -> Result<Option<usize>, Loss> {
        match self.stream.read(buffer) {
            Ok(0) => Err(Loss::Disconnected),
            Ok(count) => Ok(Some(count)),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => Ok(None),
            Err(_) => Err(Loss::Disconnected),
        }
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Loss> {
        match self.stream.write(bytes) {
            Ok(_) => Ok(()),
            Err(error) if error.kind() == ErrorKind::WouldBlock => Ok(()),
            Err(_) => Err(Loss::Disconnected),
        }
    }
}
