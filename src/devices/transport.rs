//! Bytes and datagrams to and from a device, never waiting: the only part of a driver that touches the operating system.
//!
//! A read gives what is there (`Ok(0)` when nothing is); an error means the connection is gone. Opening may block and belongs
//! on another thread; reading and writing allocate nothing.

mod memory;
mod serial;
mod tcp;
mod udp;

pub use memory::{MemoryBytes, MemoryDatagrams};
pub use serial::{Serial, SerialSettings};
pub use tcp::Tcp;
pub use udp::Udp;

use super::Loss;

/// A stream of bytes: a serial line or a TCP connection.
pub trait Bytes: Send {
    /// Takes what has arrived into `buffer`; 0 when there is nothing now.
    fn receive(&mut self, buffer: &mut [u8]) -> Result<usize, Loss>;
    /// Sends all or nothing of a short message; [`Loss::Disconnected`] where it cannot be taken at once.
    fn send(&mut self, bytes: &[u8]) -> Result<(), Loss>;
}

/// Datagrams to and from one peer.
pub trait Datagrams: Send {
    /// Takes the next datagram; `None` when there is none now.
    fn receive(&mut self, buffer: &mut [u8]) -> Result<Option<usize>, Loss>;
    /// Sends one.
    fn send(&mut self, bytes: &[u8]) -> Result<(), Loss>;
    /// Hears from now on only who sent the newest one; nothing where there is only one to be heard.
    fn keep_to_sender(&mut self) {}
}

impl<T: Bytes + ?Sized> Bytes for Box<T> {
    fn receive(&mut self, buffer: &mut [u8]) -> Result<usize, Loss> {
        (**self).receive(buffer)
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Loss> {
        (**self).send(bytes)
    }
}

impl<T: Datagrams + ?Sized> Datagrams for Box<T> {
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
