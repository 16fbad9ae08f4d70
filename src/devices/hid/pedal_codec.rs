//! Decodes and encodes the reports of foot pedals. No clock, no allocation.
//!
//! `PCsensor`: a boot keyboard, 8 bytes: modifiers, 0, six key codes (HID usage page 7); all zero when released. VEC Infinity: 2 bytes, the
//! lowest three bits of the first are left, centre and right.
//!
//! Source: published descriptions (reference `hid.md`), because the manufacturers publish none.

use super::cap_codec::BadReport;

/// Number of keys that can be distinguished.
pub const KEYS_MAX: usize = 8;
/// A boot keyboard's report: modifiers, a reserved byte, six keys (HID 1.11, appendix B.1).
pub const LENGTH_MAX: usize = 8;

/// Maximum place of a switch in a report: byte and bit.
pub const PLACE_MAX: [u8; 2] = [LENGTH_MAX as u8 - 1, 7];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PedalLayout {
    /// Boot keyboard; switch `i` is the key with code `keys[i]`, or 0 for none.
    Keyboard {
        /// HID key codes.
        keys: [u8; KEYS_MAX],
    },
    /// One bit per switch.
    Switches,
    /// One bit per switch, at places that the rig file names: byte and bit, or `None` for no switch.
    Bits { places: [Option<[u8; 2]>; KEYS_MAX] },
}

/// Bits of the switches of a [`PedalLayout::Switches`] pedal.
const SWITCHES: u8 = 0b111;
/// See [`LENGTH_MAX`].
const KEYBOARD_LENGTH: usize = 8;
/// One byte of switches and one unused (VEC Infinity IN-USB-2).
const SWITCHES_LENGTH: usize = 2;
/// Codes 1 to 3 are error codes of a keyboard that cannot determine which keys are pressed.
const FIRST_KEY: u8 = 4;

impl PedalLayout {
    /// Returns the pressed switches in a report, one per bit, the first switch in the lowest bit.
    ///
    /// # Errors
    /// [`BadReport`] if length or content do not belong to a pedal's report.
    pub fn decode(&self, report: &[u8]) -> Result<u32, BadReport> {
        match self {
            Self::Keyboard { keys } => {
                let [_, 0, codes @ ..] = report else { return Err(BadReport::Shape) };
                if report.len() != KEYBOARD_LENGTH {
                    return Err(BadReport::Shape);
                }
                if codes.iter().any(|code| (1..FIRST_KEY).contains(code)) {
                    return Err(BadReport::Content);
                }
                let down = |key: &u8| *key != 0 && codes.contains(key);
                Ok(keys.iter().enumerate().filter(|(_, key)| down(key)).fold(0, |bits, (i, _)| bits | 1 << i))
            }
            Self::Bits { places } => {
                let mut pressed = 0;
                for (switch, place) in places.iter().enumerate() {
                    let Some([byte, bit]) = *place else { continue };
                    let byte = report.get(usize::from(byte)).ok_or(BadReport::Shape)?;
                    pressed |= u32::from(byte >> bit & 1) << switch;
                }
                Ok(pressed)
            }
            Self::Switches => match report {
                [bits, _] if bits & !SWITCHES == 0 => Ok(u32::from(*bits)),
                [_, _] => Err(BadReport::Content),
                _ => Err(BadReport::Shape),
            },
        }
    }

    /// Writes the report for these switches; returns its length. A keyboard report has room for six keys.
    pub fn encode(&self, pressed: u32, buffer: &mut [u8; LENGTH_MAX]) -> usize {
        *buffer = [0; LENGTH_MAX];
        match self {
            Self::Keyboard { keys } => {
                let down = keys.iter().enumerate().filter(|(i, key)| **key != 0 && pressed >> i & 1 == 1);
                buffer[2..].iter_mut().zip(down).for_each(|(code, (_, key))| *code = *key);
                KEYBOARD_LENGTH
            }
            Self::Bits { places } => {
                let mut length = 0;
                for (switch, [byte, bit]) in places.iter().enumerate().filter_map(|(i, place)| Some((i, (*place)?))) {
                    let at = usize::from(byte).min(LENGTH_MAX - 1);
                    buffer[at] |= ((pressed >> switch & 1) as u8) << bit;
                    length = length.max(at + 1);
                }
                length
            }
            Self::Switches => {
                buffer[0] = pressed as u8 & SWITCHES;
                SWITCHES_LENGTH
            }
        }
    }
}
