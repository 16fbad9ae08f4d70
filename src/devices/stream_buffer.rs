//! Bytes of a stream that have not been decoded yet: the common buffer of all stream decoders.

/// A buffer of fixed size; only [`with_room`](Self::with_room) allocates. Write into [`room`](Self::room), report the
/// number with [`filled`](Self::filled), read [`bytes`](Self::bytes), and [`pass`](Self::pass) the bytes that are
/// decoded or refused.
#[derive(Debug)]
pub(crate) struct Unread {
    memory: Box<[u8]>,
    begin: usize,
    end: usize,
}

impl Unread {
    /// Creates an empty buffer for at most `max` bytes.
    pub(crate) fn with_room(max: usize) -> Self {
        Self { memory: vec![0; max].into_boxed_slice(), begin: 0, end: 0 }
    }

    /// Returns space for new bytes; empty only while the whole buffer is unread.
    pub(crate) fn room(&mut self) -> &mut [u8] {
        if self.begin > 0 {
            self.memory.copy_within(self.begin..self.end, 0);
            (self.begin, self.end) = (0, self.end - self.begin);
        }
        &mut self.memory[self.end..]
    }

    /// Reports that `count` bytes were written into the room.
    pub(crate) fn filled(&mut self, count: usize) {
        self.end = self.end.saturating_add(count).min(self.memory.len());
    }

    /// Copies as many of these bytes as fit, and returns their number.
    pub(crate) fn feed(&mut self, bytes: &[u8]) -> usize {
        let room = self.room();
        let count = bytes.len().min(room.len());
        room[..count].copy_from_slice(&bytes[..count]);
        self.filled(count);
        count
    }

    pub(crate) fn bytes(&self) -> &[u8] {
        &self.memory[self.begin..self.end]
    }

    pub(crate) const fn is_empty(&self) -> bool {
        self.begin == self.end
    }

    pub(crate) fn is_full(&self) -> bool {
        self.bytes().len() == self.memory.len()
    }

    /// Marks the first `count` bytes as read and returns them.
    pub(crate) fn pass(&mut self, count: usize) -> &[u8] {
        let from = self.begin;
        self.begin = from.saturating_add(count).min(self.end);
        &self.memory[from..self.begin]
    }

    pub(crate) const fn clear(&mut self) -> usize {
        let count = self.end - self.begin;
        self.begin = 0;
        self.end = 0;
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_read_in_order_whatever_the_pieces() {
        let mut random = fastrand::Rng::with_seed(11);
        let mut unread = Unread::with_room(16);
        let mut next_in = 0_u8;
        let mut next_out = 0_u8;
        for _ in 0..2000 {
            let fed: Vec<u8> = (0..random.u8(0..12)).map(|ahead| next_in.wrapping_add(ahead)).collect();
            let before = unread.bytes().len();
            let taken = unread.feed(&fed);
            assert_eq!(taken, fed.len().min(16 - before), "as many as there is room for");
            next_in = next_in.wrapping_add(taken as u8);
            for byte in unread.pass(random.usize(0..20)) {
                assert_eq!(*byte, next_out);
                next_out = next_out.wrapping_add(1);
            }
            assert_eq!(unread.bytes().len(), usize::from(next_in.wrapping_sub(next_out)));
        }
    }

    #[test]
    fn what_is_full_takes_nothing_until_something_is_passed() {
        let mut unread = Unread::with_room(4);
        assert!(unread.is_empty() && unread.feed(b"abcdef") == 4 && unread.is_full());
        assert!(unread.room().is_empty() && unread.feed(b"e") == 0);
        assert_eq!(unread.pass(1), b"a");
        assert!(!unread.is_full() && unread.feed(b"ef") == 1);
        assert_eq!(unread.bytes(), b"bcde");
        assert_eq!((unread.clear(), unread.clear(), unread.room().len()), (4, 0, 4));
        unread.filled(usize::MAX);
        assert_eq!(unread.bytes().len(), 4, "never more than there is");
    }
}
