//! FNV-1a (64 bit) over the bytes read.

use std::io;

// Offset basis and prime of FNV-1a with 64 bits.
pub(super) const FNV_START: u64 = 0xcbf2_9ce4_8422_2325;
const FNV_PRIME: u64 = 0x0100_0000_01b3;

/// A reader that also hashes the bytes read.
pub(super) struct HashingReader<'a, R> {
    pub(super) from: R,
    pub(super) hash: &'a mut u64,
}

impl<R: io::Read> io::Read for HashingReader<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.from.read(buffer)?;
        let add = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(FNV_PRIME);
        *self.hash = buffer[..count].iter().fold(*self.hash, add);
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The published test vectors of FNV-1a 64.
    #[test]
    fn the_hash_is_the_published_one() {
        for (text, expected) in [("", FNV_START), ("a", 0xaf63_dc4c_8601_ec8c), ("foobar", 0x8594_4171_f739_67e8)] {
            let mut hash = FNV_START;
            io::copy(&mut HashingReader { from: text.as_bytes(), hash: &mut hash }, &mut io::sink()).unwrap();
            assert_eq!(hash, expected, "{text}");
        }
    }
}
