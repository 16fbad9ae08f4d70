//! Exchanges bytes and datagrams with a device without waiting: the only part of a driver that calls the operating
//! system.
//!
//! Reading returns the data that have arrived (`Ok(0)` if none); an error means that the connection is closed. Opening
//! may block and must run on another thread; reading and writing allocate nothing.

mod example;
mod memory;
mod serial;
mod tcp;
mod udp;

pub use example::{check_no_example, is_example};
pub use memory::{MemoryBytes, MemoryDatagrams};
pub use serial::{Serial, SerialSettings};
pub use tcp::Tcp;
pub use udp::Udp;

use super::Loss;

/// A stream of bytes: a serial line or a TCP connection.
pub trait ByteStream: Send {
    /// Reads what has arrived into `buffer`; returns 0 if nothing has arrived.
    ///
    /// # Errors
    /// [`Loss::Disconnected`] if the connection is closed.
    fn receive(&mut self, buffer: &mut [u8]) -> Result<usize, Loss>;
    /// Sends a short message completely or not at all.
    ///
    /// # Errors
    /// [`Loss::Disconnected`] if it cannot be sent at once.
    fn send(&mut self, bytes: &[u8]) -> Result<(), Loss>;
}

pub trait TransportDatagrams: Send {
    /// Reads the next datagram; returns `None` if none has arrived.
    ///
    /// # Errors
    /// [`Loss::Disconnected`] if the peer is gone.
    fn receive(&mut self, buffer: &mut [u8]) -> Result<Option<usize>, Loss>;
    /// Sends one datagram.
    ///
    /// # Errors
    /// [`Loss::Disconnected`] if the peer is gone.
    fn send(&mut self, bytes: &[u8]) -> Result<(), Loss>;
    /// From now on, accepts datagrams only from the sender of the newest one. Has no effect if only one sender is
    /// possible.
    fn keep_to_sender(&mut self) {}
}

impl<T: ByteStream + ?Sized> ByteStream for Box<T> {
    fn receive(&mut self, buffer: &mut [u8]) -> Result<usize, Loss> {
        (**self).receive(buffer)
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Loss> {
        (**self).send(bytes)
    }
}

impl<T: TransportDatagrams + ?Sized> TransportDatagrams for Box<T> {
    fn receive(&mut self, buffer: &mut [u8]) -> Result<Option<usize>, Loss> {
        (**self).receive(buffer)
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Loss> {
        (**self).send(bytes)
    }

    fn keep_to_sender(&mut self) {
        (**self).keep_to_sender();
    }
}
