//! The checksum of the Combined API in both reply formats: CRC-16/ARC (polynomial 0x8005 reflected, start 0).
//!
//! Source: `ndicapi`; recomputed on published replies.

use crc::{CRC_16_ARC, Crc};

// CRC-16/ARC: polynomial 0x8005 reflected, initial value 0 (the checksum of `ndicapi`).
const CRC: Crc<u16> = Crc::<u16>::new(&CRC_16_ARC);

pub fn crc16(bytes: &[u8]) -> u16 {
    CRC.checksum(bytes)
}

/// Writes `number` as upper-case hexadecimal digits, most significant first, filling `digits`.
pub(super) fn write_hex(digits: &mut [u8], mut number: u64) {
    for digit in digits.iter_mut().rev() {
        *digit = b"0123456789ABCDEF"[(number & 15) as usize];
        number >>= 4;
    }
}

/// Parses hexadecimal digits (at most 8, of either case); returns `None` if one is not a digit.
pub(super) fn read_hex(digits: &[u8]) -> Option<u32> {
    if digits.is_empty() || digits.len() > 8 {
        return None;
    }
    digits.iter().try_fold(0_u32, |number, digit| Some(number << 4 | char::from(*digit).to_digit(16)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_that_of_the_published_lines() {
        for (text, crc) in [
            ("INIT:", 0xE3A5),
            ("OKAY", 0xA896),
            ("RESET", 0xBE6F),
            ("WARNING", 0x7423),
            ("VER:0", 0x65EE),
            ("GETINFO:Features.Firmware.Version", 0x0492),
            ("TSTART:", 0x5423),
            ("TSTOP:", 0x2C14),
            ("TX:0801", 0xC19B),
            ("BX:0801", 0x00EC),
            ("PHSR:01", 0xE03E),
            ("APIREV:", 0x443E),
            ("COMM:50000", 0x0048),
            ("ERROR0C", 0x4E42),
            ("00", 0x1414),
            ("010A001", 0xC1B5),
        ] {
            assert_eq!(crc16(text.as_bytes()), crc, "{text}");
        }
    }

    #[test]
    fn hexadecimal_numbers_are_written_and_read() {
        let mut digits = [0; 8];
        write_hex(&mut digits, 0x00C0_FFEE);
        assert_eq!((&digits, read_hex(&digits)), (b"00C0FFEE", Some(0x00C0_FFEE)));
        assert_eq!((read_hex(b"0g"), read_hex(b""), read_hex(b"123456789")), (None, None, None));
    }
}
