//! Serial commands of the first generation: single letters, and their acknowledgements (reference `bota.md`, 1.2).
//!
//! The text may be in the middle of a stream of binary frames, so all received bytes are searched for it.

use nima_files::quoted;

/// Enters configuration: the stream stops.
pub const CONFIG: &[u8] = b"C\n";
/// Enters measurement: the stream starts.
pub const RUN: &[u8] = b"R\n";
/// Restarts the firmware, which can fix a calibration matrix that was not loaded.
pub const INIT: &[u8] = b"I\n";
// Only the manufacturer's driver documents this command; a sensor without it is identified by its boot text.
pub const PRODUCT: &[u8] = b"p?\n";
/// Sets the offsets that are saved in the sensor to zero.
pub const NO_OFFSET: &[u8] = b"b,0.000000,0.000000,0.000000,0.000000,0.000000,0.000000\n";
/// Size of the sensor's receive buffer, bytes.
pub const COMMAND_BYTES: usize = 64;
/// Line speeds in the order of their index in the `c` command, bit/s.
pub const BAUDS: [u32; 6] = [9_600, 57_600, 115_200, 230_400, 460_800, 921_600];
/// Averaging lengths that the sensor accepts.
pub const SINC: std::ops::RangeInclusive<u16> = 64..=2047;

/// Returns the rate with this averaging length, Hz.
pub fn rate_hz(sinc: u16) -> f64 {
    // The sensor samples 51.2 kHz (1 / 19.53125 us) and averages `sinc` samples (manufacturer's driver).
    51_200.0 / f64::from(sinc)
}

/// Returns the command for no temperature compensation, the calibration matrix, binary frames, and line speed
/// `baud_index` of [`BAUDS`].
pub fn communication(baud_index: usize) -> String {
    // Temperature compensation off, calibration matrix on, binary frames: the manufacturer's driver sends the same.
    format!("c,0,1,0,{baud_index}\n")
}

/// Returns the command for averaging over `sinc` samples, without chopping, fast mode and second filter.
pub fn filter(sinc: u16) -> String {
    // Chopping off, fast mode off, FIR filter off: the averaging alone is the filter.
    format!("f,{sinc},0,0,1\n")
}

/// Returns the code of the newest acknowledgement `r,0,<letter>,<code>` of this command in `bytes`; 0 is success.
pub fn acknowledged(bytes: &[u8], letter: u8) -> Option<u32> {
    let head = [b'r', b',', b'0', b',', letter, b','];
    // Searched backwards in everything received, because measurement frames may surround the answer.
    bytes.windows(head.len()).enumerate().rev().filter(|(_, window)| *window == head).find_map(|(at, _)| {
        let digits = &bytes[at + head.len()..];
        let count = digits.iter().take_while(|byte| byte.is_ascii_digit()).count();
        // Require the end of the line; a longer code would otherwise be cut off.
        let ended = digits.get(count).is_some_and(|byte| matches!(byte, b'\r' | b'\n'));
        (ended && (1..=4).contains(&count)).then(|| number(&digits[..count]))
    })
}

fn number(digits: &[u8]) -> u32 {
    digits.iter().fold(0, |sum, digit| sum * 10 + u32::from(digit - b'0'))
}

/// Returns serial number and product name from the answer `p,0,<serial>,<x>,<x>,<product>` to [`PRODUCT`].
pub fn product(bytes: &[u8]) -> Option<(String, String)> {
    let text = String::from_utf8_lossy(bytes);
    let begin = text.rfind("p,0,")?;
    let line = text[begin..].lines().next()?;
    let fields: Vec<&str> = line.split(',').collect();
    match fields[..] {
        [_, _, serial, _, _, product] => Some((quoted(serial.trim()), quoted(product.trim()))),
        _ => None,
    }
}

/// The text that a sensor sends at start.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BootText {
    /// Whether `App Init` was received.
    pub started: bool,
    pub product: Option<String>,
    pub serial: Option<String>,
    /// Firmware version; the last line of the text.
    pub firmware: Option<String>,
}

impl BootText {
    /// Searches for the text among other bytes.
    pub fn of(bytes: &[u8]) -> Self {
        let text = String::from_utf8_lossy(bytes);
        let line = |key: &str| {
            let rest = text[text.rfind(key)? + key.len()..].trim_start_matches(' ');
            let end = rest.find(['\r', '\n'])?;
            Some(quoted(rest[..end].trim()))
        };
        Self {
            started: text.contains("App Init"),
            product: line("name:"),
            serial: line("S/N:"),
            firmware: line("FW version:"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_as_the_official_driver_sends_them() {
        assert_eq!(communication(4), "c,0,1,0,4\n");
        assert_eq!(filter(512), "f,512,0,0,1\n");
        assert!(NO_OFFSET.len() <= COMMAND_BYTES && communication(5).len() <= COMMAND_BYTES);
        assert!((rate_hz(64) - 800.0).abs() < 1e-12 && (rate_hz(512) - 100.0).abs() < 1e-12);
    }

    #[test]
    fn an_acknowledgement_is_found_within_frames_and_only_when_it_is_whole() {
        let mut bytes = vec![0xAA, b'r', b',', 0, 1];
        bytes.extend(b"r,0,C,0");
        assert_eq!(acknowledged(&bytes, b'C'), None);
        bytes.extend(b"\r\n\xAA\x01");
        assert_eq!(acknowledged(&bytes, b'C'), Some(0));
        assert_eq!(acknowledged(&bytes, b'R'), None);
        assert_eq!(acknowledged(b"r,0,f,17\r\n", b'f'), Some(17));
        assert_eq!(acknowledged(b"r,0,f,99999999999999\r\n", b'f'), None);
    }

    #[test]
    fn product_and_boot_text_are_read() {
        let report = product(b"\xAA\x00p,0,853,1,2,BFT-SENS-SER-M8\r\nr,0,p,0\r\n").unwrap();
        assert_eq!(report, ("853".to_owned(), "BFT-SENS-SER-M8".to_owned()));
        assert_eq!(product(b"p,0,853\r\n"), None);
        let boot = BootText::of(b"\xfe\x00App Init\r\nname: BFT-SENS-SER-M8\r\nS/N: 853\r\nFW version: 1.0.9\r\n\xAA");
        assert!(boot.started);
        assert_eq!(boot.product.as_deref(), Some("BFT-SENS-SER-M8"));
        assert_eq!(boot.serial.as_deref(), Some("853"));
        assert_eq!(boot.firmware.as_deref(), Some("1.0.9"));
        assert_eq!(BootText::of(b"App Init\r\nFW version: 1.0"), BootText { started: true, ..BootText::default() });
    }

    #[test]
    fn no_bytes_make_the_readers_fail() {
        let mut random = fastrand::Rng::with_seed(7);
        let words: [&[u8]; 6] = [b"r,0,C,", b"p,0,", b"App Init", b"S/N:", b"\r\n", b"name: \xc3"];
        for _ in 0..100_000 {
            let mut bytes: Vec<u8> = (0..random.usize(..40)).map(|_| random.u8(..)).collect();
            bytes.extend(words[random.usize(..words.len())]);
            bytes.extend((0..random.usize(..20)).map(|_| random.u8(..)));
            acknowledged(&bytes, b'C');
            product(&bytes);
            BootText::of(&bytes);
        }
    }
}
