//! A TCP connection that never waits.

use std::{
    io::{ErrorKind, Read as _, Write as _},
    net::{IpAddr, TcpStream, ToSocketAddrs as _},
    time::Duration,
};

use super::{ByteStream, check_no_example};
use crate::{DeviceError, Loss};

#[derive(Debug)]
pub struct Tcp {
    stream: TcpStream,
}

impl Tcp {
    /// Connects to `host:port` within `timeout`.
    ///
    /// # Errors
    /// [`DeviceError`] if the address cannot be resolved or connected to in time.
    pub fn open(address: &str, timeout: Duration) -> Result<Self, DeviceError> {
        check_no_example(address)?;
        let trouble = |error| DeviceError::of_address(address, &error);
        let resolved = address.to_socket_addrs().map_err(trouble)?.next();
        let resolved = resolved.ok_or_else(|| DeviceError::Unreachable { place: address.to_owned() })?;
        let stream = TcpStream::connect_timeout(&resolved, timeout).map_err(trouble)?;
        // Nagle's algorithm would hold back a short command until the previous one is acknowledged.
        stream.set_nodelay(true).map_err(trouble)?;
        Self::of(stream).map_err(trouble)
    }

    /// Returns this computer's address on the connection.
    pub fn local_ip(&self) -> Option<IpAddr> {
        self.stream.local_addr().ok().map(|address| address.ip())
    }

    /// Returns a second handle of the same connection, for emergencies.
    ///
    /// # Errors
    /// If the operating system cannot duplicate the connection.
    pub fn duplicate(&self) -> std::io::Result<Self> {
        Ok(Self { stream: self.stream.try_clone()? })
    }

    /// Wraps an accepted connection.
    ///
    /// # Errors
    /// If the connection cannot be configured.
    pub fn of(stream: TcpStream) -> std::io::Result<Self> {
        stream.set_nonblocking(true)?;
        Ok(Self { stream })
    }
}

impl ByteStream for Tcp {
    fn receive(&mut self, buffer: &mut [u8]) -> Result<usize, Loss> {
        match self.stream.read(buffer) {
            // A read of 0 bytes is the end of the stream, unless the buffer has no room.
            Ok(0) if !buffer.is_empty() => Err(Loss::Disconnected),
            Ok(count) => Ok(count),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => Ok(0),
            Err(_) => Err(Loss::Disconnected),
        }
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Loss> {
        match self.stream.write(bytes) {
            // Half a message would spoil the next one, as on a serial line.
            Ok(count) if count == bytes.len() => Ok(()),
            _ => Err(Loss::Disconnected),
        }
    }
}
