//! Transports within one process, for tests of drivers against emulators without the operating system.

use std::{
    collections::VecDeque,
    sync::{Arc, Mutex, PoisonError},
};

use super::{ByteStream, TransportDatagrams};
use crate::Loss;

#[derive(Debug, Default)]
struct MemoryLine<T> {
    queue: VecDeque<T>,
    cut: bool,
}

type SharedBuffer<T> = Arc<Mutex<MemoryLine<T>>>;

/// One end of a pair of byte streams.
///
/// ```
/// use nima_devices::{
///     Loss,
///     transport::{ByteStream, MemoryBytes},
/// };
///
/// let [mut here, mut there] = MemoryBytes::pair();
/// let mut buffer = [0; 8];
/// assert_eq!(there.receive(&mut buffer), Ok(0), "nothing has arrived yet");
/// here.send(b"abc").expect("both ends are connected");
/// assert_eq!((there.receive(&mut buffer).expect("three bytes"), &buffer[..3]), (3, &b"abc"[..]));
/// here.cut();
/// assert_eq!(there.receive(&mut buffer), Err(Loss::Disconnected));
/// ```
#[derive(Clone, Debug)]
pub struct MemoryBytes {
    incoming: SharedBuffer<u8>,
    outgoing: SharedBuffer<u8>,
}

/// One end of a pair of datagram sockets.
#[derive(Clone, Debug)]
pub struct MemoryDatagrams {
    incoming: SharedBuffer<Vec<u8>>,
    outgoing: SharedBuffer<Vec<u8>>,
}

fn with<T, R>(line: &SharedBuffer<T>, work: impl FnOnce(&mut MemoryLine<T>) -> R) -> R {
    work(&mut line.lock().unwrap_or_else(PoisonError::into_inner))
}

impl MemoryBytes {
    pub fn pair() -> [Self; 2] {
        let [one, other]: [SharedBuffer<u8>; 2] = Default::default();
        [Self { incoming: Arc::clone(&one), outgoing: Arc::clone(&other) }, Self { incoming: other, outgoing: one }]
    }

    pub fn cut(&self) {
        with(&self.incoming, |line| line.cut = true);
        with(&self.outgoing, |line| line.cut = true);
    }
}

impl MemoryDatagrams {
    pub fn pair() -> [Self; 2] {
        let [one, other]: [SharedBuffer<Vec<u8>>; 2] = Default::default();
        [Self { incoming: Arc::clone(&one), outgoing: Arc::clone(&other) }, Self { incoming: other, outgoing: one }]
    }

    pub fn cut(&self) {
        with(&self.incoming, |line| line.cut = true);
        with(&self.outgoing, |line| line.cut = true);
    }
}

impl ByteStream for MemoryBytes {
    fn receive(&mut self, buffer: &mut [u8]) -> Result<usize, Loss> {
        with(&self.incoming, |line| {
            let count = line.queue.len().min(buffer.len());
            if count == 0 && line.cut {
                return Err(Loss::Disconnected);
            }
            buffer.iter_mut().zip(line.queue.drain(..count)).for_each(|(to, byte)| *to = byte);
            Ok(count)
        })
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Loss> {
        with(&self.outgoing, |line| {
            if line.cut {
                return Err(Loss::Disconnected);
            }
            line.queue.extend(bytes);
            Ok(())
        })
    }
}

impl TransportDatagrams for MemoryDatagrams {
    fn receive(&mut self, buffer: &mut [u8]) -> Result<Option<usize>, Loss> {
        with(&self.incoming, |line| match line.queue.pop_front() {
            Some(datagram) => {
                // As in the operating system, a datagram longer than the buffer is truncated.
                let count = datagram.len().min(buffer.len());
                buffer[..count].copy_from_slice(&datagram[..count]);
                Ok(Some(count))
            }
            None if line.cut => Err(Loss::Disconnected),
            None => Ok(None),
        })
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Loss> {
        with(&self.outgoing, |line| {
            if line.cut {
                return Err(Loss::Disconnected);
            }
            line.queue.push_back(bytes.to_vec());
            Ok(())
        })
    }
}
