//! Reports of foot pedals: bytes in, switches out, and back. No clock, no allocation.
//!
//! `PCsensor`: a boot keyboard, 8 bytes: modifiers, 0, six key codes (HID usage page 7); all zero when released. VEC Infinity: 2 bytes, the
//! lowest three bits of the first are left, centre and right.

use super::cap_codec::BadReport;

/// Key codes that can be told apart.
pub const KEYS_MAX: usize = 8;
/// The longest report.
pub const LENGTH_MAX: usize = 8;

/// How a pedal reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// Boot keyboard; switch `i` is the key with code `keys[i]`, 0 for none.
    Keyboard {
        /// HID key codes.
        keys: [u8; KEYS_MAX],
    },
    /// One bit per switch.
    Switches,
}

/// Switches of a [`Layout::Switches`] pedal.
const SWITCHES: u8 = 0b111;
const KEYBOARD_LENGTH: usize = 8;
const SWITCHES_LENGTH: usize = 2;
/// A keyboard that cannot tell which keys are down says one of 1 to 3 instead of a key.
const FIRST_KEY: u8 = 4;

impl Layout {
    /// The pressed switches of one report, first in the lowest bit.
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
            Self::Switches => match report {
                [bits, _] if bits & !SWITCHES == 0 => Ok(u32::from(*bits)),
                [_, _] => Err(BadReport::Content),
                _ => Err(BadReport::Shape),
            },
        }
    }

    /// The report of these switches, and its length. A keyboard has room for six keys.
    pub fn encode(&self, pressed: u32, buffer: &mut [u8; LENGTH_MAX]) -> usize {
        *buffer = [0; LENGTH_MAX];
        match self {
            Self::Keyboard { keys } => {
                let down = keys.iter().enumerate().filter(|(i, key)| **key != 0 && pressed >> i & 1 == 1);
                buffer[2..].iter_mut().zip(down).for_each(|(code, (_, key))| *code = *key);
                KEYBOARD_LENGTH
            }
            Self::Switches => {
                buffer[0] = pressed as u8 & SWITCHES;
                SWITCHES_LENGTH
            }
        }
    }
}
