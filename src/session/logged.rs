//! The content of a log line as a value.
//!
//! A session stores it in addition to the English text, so that other texts, without names or in another language, can
//! be built from it.

use nima_core::task::TaskEvent as Happening;
use nima_machine::{messages::Event, runtime::Operation};

use crate::codec::{CodecError, FromWords, ToWords, WordSink, WordSource, choice, number, take_number};

/// The value of a line. It never contains a name that a person gave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LogValue {
    /// An event reported by the loop.
    Event(Event),
    /// An operation on the loop.
    Operation(Operation),
    /// An event of the scene's objects.
    Happening(Happening),
    /// A text of the screen that cannot contain a name.
    Screen,
}

choice!(LogValue {
    0 => Event { 0: event: Event },
    1 => Operation { 0: operation: Operation },
    2 => Happening { 0: happening: Happening },
    3 => Screen {},
});

/// First word of a value: version of the encoding that follows.
const VERSION: u64 = 1;

impl LogValue {
    /// Returns its bytes for a session.
    pub(crate) fn encode(&self) -> Vec<u8> {
        let mut words = vec![VERSION];
        self.put(&mut words);
        let mut bytes = Vec::new();
        for word in words {
            number(&mut bytes, word);
        }
        bytes
    }

    /// Decodes a value; `None` for a value that this program does not support.
    pub(crate) fn decode(mut bytes: &[u8]) -> Option<Self> {
        let mut words = Vec::new();
        while !bytes.is_empty() {
            words.push(take_number(&mut bytes).ok()?);
        }
        let mut words = words.into_iter();
        let value = if words.next()? == VERSION { Self::take(&mut words).ok()? } else { return None };
        words.next().is_none().then_some(value)
    }
}

#[cfg(test)]
mod tests {
    use nima_core::Side;
    use nima_machine::messages::{Command, Fault};

    use super::*;

    #[test]
    fn a_value_survives_its_bytes_and_no_other_bytes_are_one() {
        let fault = Fault::LoopStalled { periods: 3 };
        for value in [
            LogValue::Event(Event::FaultRaised { t_s: 0.25, side: Side::Left, fault }),
            LogValue::Operation(Operation::Command { command: Command::SetGain(0.35), t_s: 1.0 }),
            LogValue::Happening(Happening::RingDropped { ring: 3, side: Side::Left, in_view: false }),
            LogValue::Happening(Happening::LumpMarked { side: Side::Right, lump: None }),
            LogValue::Screen,
        ] {
            let bytes = value.encode();
            assert_eq!(LogValue::decode(&bytes), Some(value));
            assert_eq!(LogValue::decode(&bytes[..bytes.len() - 1]), None, "cut off");
            assert_eq!(LogValue::decode(&[&*bytes, &[0]].concat()), None, "longer");
        }
        assert_eq!(LogValue::decode(b"a name"), None);
        assert_eq!(LogValue::decode(b""), None);
    }
}
