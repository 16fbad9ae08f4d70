//! Text commands of the second generation, the same on a serial line and over TCP: numbered parameters with hexadecimal
//! values (reference `bota.md`, 1.3).
//!
//! `wh,<id>,<sub>,<value>` writes and `rh,<id>,<sub>,` reads; the answer repeats the two letters, then a status and the
//! value. The text may be in the middle of a stream of binary frames, so all received bytes are searched for it.

use nima_files::quoted;

/// Number of a parameter: id and sub-id.
pub type Parameter = (u8, u8);

/// Requested state: one of [`INIT`], [`CONFIG`], [`RUN`].
pub const STATE: Parameter = (1, 2);
/// Offset of the first component, f32; the offsets of the other five have the following numbers.
pub const OFFSET: Parameter = (2, 1);
/// Frame format: 0 and 1 force and torque, 2 and 3 with the inertial unit.
pub const MODE: Parameter = (3, 1);
/// Rate, as an index into [`RATES_HZ`].
pub const SUBMODE: Parameter = (4, 1);
/// The resulting rate, Hz; read only.
pub const RATE: Parameter = (4, 2);
/// Output rate: 0 sends every measurement.
pub const OUTPUT_RATE: Parameter = (6, 1);
/// Product name, text; read only.
pub const PRODUCT: Parameter = (23, 1);
/// Serial number, text; read only.
pub const SERIAL: Parameter = (24, 1);
/// Firmware version, text; read only.
pub const FIRMWARE: Parameter = (25, 1);
/// First byte of the address to which datagrams are sent; the other three have the next numbers.
pub const DESTINATION: Parameter = (30, 1);
/// Port to which datagrams are sent.
pub const DESTINATION_PORT: Parameter = (31, 1);

/// State: stopped.
pub const INIT: u32 = 0;
/// State: parameters can be changed.
pub const CONFIG: u32 = 1;
/// State: measuring and sending.
pub const RUN: u32 = 2;

/// Rates by submode, Hz.
pub const RATES_HZ: [u32; 16] = [10, 20, 25, 50, 100, 200, 250, 270, 400, 500, 800, 1000, 1600, 2133, 3200, 3840];
/// The highest frame format.
pub const MODE_MAX: u8 = 3;
/// The first frame format with the inertial unit.
pub const MODE_INERTIAL: u8 = 2;

/// Returns the command that writes an integer (or the bits of an f32).
pub fn write(parameter: Parameter, value: u32) -> String {
    format!("wh,{},{},{value:x}\n", parameter.0, parameter.1)
}

/// Returns the command that reads a parameter.
pub fn read(parameter: Parameter) -> String {
    format!("rh,{},{},\n", parameter.0, parameter.1)
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GenAAnswer {
    /// 0 is success; see [`words`].
    pub status: u32,
    /// The value in hexadecimal.
    pub value: String,
}

impl GenAAnswer {
    /// Returns the value as an integer; for a float parameter, the bits of its f32.
    pub fn number(&self) -> Option<u32> {
        u32::from_str_radix(&self.value, 16).ok()
    }

    pub fn text(&self) -> Option<String> {
        let digit = |byte: u8| char::from(byte).to_digit(16);
        let pairs = self.value.as_bytes().chunks_exact(2);
        if !pairs.remainder().is_empty() {
            return None;
        }
        let byte = |pair: &[u8]| u8::try_from(digit(pair[0])? * 16 + digit(pair[1])?).ok();
        let bytes: Option<Vec<u8>> = pairs.map(byte).collect();
        String::from_utf8(bytes?).ok().map(|text| quoted(text.trim_end_matches('\0')))
    }
}

/// Returns the newest complete answer in `bytes` to a command that began with `letters` (`wh` or `rh`).
pub fn answer(bytes: &[u8], letters: &[u8; 2]) -> Option<GenAAnswer> {
    let head = [letters[0], letters[1], b','];
    let mut begins = bytes.windows(head.len()).enumerate().rev().filter(|(_, window)| *window == head);
    begins.find_map(|(at, _)| whole(&bytes[at + head.len()..]))
}

/// Returns status and value up to the end of the line; `None` if anything else is in between.
fn whole(bytes: &[u8]) -> Option<GenAAnswer> {
    let end = bytes.iter().position(|byte| *byte == b'\n')?;
    let line = std::str::from_utf8(&bytes[..end]).ok()?;
    let (status, value) = line.trim_end_matches('\r').split_once(',')?;
    let good = (1..=3).contains(&status.len()) && value.bytes().all(|byte| byte.is_ascii_hexdigit());
    Some(GenAAnswer { status: status.parse().ok().filter(|_| good)?, value: value.to_owned() })
}

/// Returns the meaning of a status.
pub const fn words(status: u32) -> &'static str {
    match status {
        0 => "good",
        1 => "wrong state",
        2 => "syntax error",
        3 => "this parameter can only be read",
        4 => "this parameter can only be written",
        16 => "invalid value",
        17 => "the action failed",
        18 => "unknown parameter",
        19 => "unknown part of a parameter",
        _ => "unknown status",
    }
}

/// Encodes a text like the sensor.
pub fn hex_of(text: &str) -> String {
    let digit = |value: u8| char::from_digit(u32::from(value), 16).unwrap_or('0');
    text.bytes().flat_map(|byte| [digit(byte >> 4), digit(byte & 15)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_and_answers_are_as_in_the_reference() {
        assert_eq!(write(STATE, RUN), "wh,1,2,2\n");
        assert_eq!(write(OFFSET, 1.5_f32.to_bits()), "wh,2,1,3fc00000\n");
        assert_eq!(read(SERIAL), "rh,24,1,\n");
        assert_eq!(hex_of("BFT-SENS-SER-M8"), "4246542d53454e532d5345522d4d38");
        let report = answer(b"\xABrh,\x01rh,0,4246542d53454e532d5345522d4d38\n\xAB\x00", b"rh").unwrap();
        assert_eq!((report.status, report.text().as_deref()), (0, Some("BFT-SENS-SER-M8")));
        assert_eq!(answer(b"rh,0,10e\n", b"rh").unwrap().number(), Some(270));
        assert_eq!(answer(b"wh,16,4\n", b"wh").unwrap().status, 16);
        assert_eq!(answer(b"wh,0,4", b"wh"), None, "not yet whole");
        assert_eq!(answer(b"wh,0,4\n", b"rh"), None);
    }

    #[test]
    fn no_bytes_make_the_readers_fail() {
        let mut random = fastrand::Rng::with_seed(8);
        let words: [&[u8]; 6] = [b"rh,0,", b"wh,", b"wh,0,4", b"\n", b"rh,1,zz\n", b"rh,0,c3f\n"];
        for _ in 0..100_000 {
            let mut bytes: Vec<u8> = (0..random.usize(..40)).map(|_| random.u8(..)).collect();
            bytes.extend(words[random.usize(..words.len())]);
            bytes.extend((0..random.usize(..8)).map(|_| random.u8(b' '..b'g')));
            bytes.push(b'\n');
            for letters in [b"rh", b"wh"] {
                if let Some(report) = answer(&bytes, letters) {
                    report.number();
                    report.text();
                }
            }
        }
    }
}
