//! Reads `sensor_msgs/msg/JointState` as written by [`JointStateEncoder`](super::JointStateEncoder).

use super::joint_state::REPRESENTATION;

/// Offset of the frame and the names, after the representation header and the time.
const FIXED: usize = 12;

/// Reads the messages of one channel. The names are parsed only when they change.
///
/// ```
/// use nima_recording::messages::{JointStateDecoder, JointStateEncoder};
///
/// let mut encoder = JointStateEncoder::new("world", &["right.force.x_n", "right.force.y_n"]);
/// let mut decoder = JointStateDecoder::default();
/// assert!(decoder.decode(encoder.encode(7, &[], &[], &[0.25, -0.5])?));
/// assert_eq!((decoder.names(), decoder.values()), (&["right.force.x_n".to_owned(), "right.force.y_n".to_owned()][..], &[0.25, -0.5][..]));
/// assert!(!decoder.decode(b"something else"));
/// # Ok::<(), nima_recording::messages::WrongLength>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct JointStateDecoder {
    /// Frame and names as bytes.
    known: Vec<u8>,
    names: Vec<String>,
    values: Vec<f64>,
}

impl JointStateDecoder {
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Returns the values of the last message, one for each name: its positions, or its efforts if it has no positions.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Returns the index of the value with this name.
    pub fn place(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|known| known == name)
    }

    /// Reads a message. Returns false, and leaves the values empty, if the bytes are not a message or have other lists
    /// than this program writes.
    pub fn decode(&mut self, message: &[u8]) -> bool {
        self.values.clear();
        self.read(message).is_some()
    }

    fn read(&mut self, message: &[u8]) -> Option<()> {
        if message.get(..REPRESENTATION.len())? != REPRESENTATION {
            return None;
        }
        let is_known = !self.known.is_empty() && message.get(FIXED..)?.starts_with(&self.known);
        if !is_known {
            self.read_names(message)?;
        }
        let mut cursor = JointStateCursor { message, at: FIXED + self.known.len() };
        for _ in ["position", "velocity", "effort"] {
            let count = cursor.count()?;
            if count == 0 {
                continue;
            }
            if count != self.names.len() || !self.values.is_empty() {
                self.values.clear();
                return None;
            }
            cursor.align(8);
            let bytes = cursor.bytes(8 * count)?;
            self.values
                .extend(bytes.chunks_exact(8).map(|value| value.try_into().map_or(f64::NAN, f64::from_le_bytes)));
        }
        (self.values.len() == self.names.len() && cursor.at == message.len()).then_some(())
    }

    fn read_names(&mut self, message: &[u8]) -> Option<()> {
        self.known.clear();
        self.names.clear();
        let mut cursor = JointStateCursor { message, at: FIXED };
        cursor.text()?;
        let count = cursor.count()?;
        for _ in 0..count {
            self.names.push(cursor.text()?);
        }
        self.known.extend_from_slice(message.get(FIXED..cursor.at)?);
        Some(())
    }
}

struct JointStateCursor<'a> {
    message: &'a [u8],
    at: usize,
}

impl<'a> JointStateCursor<'a> {
    fn align(&mut self, to: usize) {
        self.at = REPRESENTATION.len() + (self.at - REPRESENTATION.len()).next_multiple_of(to);
    }

    fn bytes(&mut self, count: usize) -> Option<&'a [u8]> {
        let bytes = self.message.get(self.at..self.at.checked_add(count)?)?;
        self.at += count;
        Some(bytes)
    }

    fn count(&mut self) -> Option<usize> {
        self.align(4);
        Some(u32::from_le_bytes(self.bytes(4)?.try_into().ok()?) as usize)
    }

    fn text(&mut self) -> Option<String> {
        let length = self.count()?;
        let (_zero, text) = self.bytes(length)?.split_last()?;
        String::from_utf8(text.to_vec()).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::messages::JointStateEncoder;

    #[test]
    fn what_was_written_is_read_and_no_cut_message_is() {
        let mut encoder = JointStateEncoder::new("world", &["a", "force"]);
        let mut decoder = JointStateDecoder::default();
        for values in [[1.0, -2.0], [f64::INFINITY, 1e-300]] {
            let message = encoder.encode(5, &values, &[], &[]).unwrap().to_vec();
            assert!(decoder.decode(&message) && decoder.values() == values, "{decoder:?}");
            assert!(!JointStateDecoder::default().decode(&[&*message, &[0]].concat()), "a byte more");
            for length in 0..message.len() {
                let read = JointStateDecoder::default().decode(&message[..length]);
                assert!(!read, "{length} of {} bytes", message.len());
            }
        }
        assert_eq!((decoder.place("force"), decoder.place("b")), (Some(1), None));
        let other = JointStateEncoder::new("world", &["b"]).encode(5, &[], &[], &[3.0]).unwrap().to_vec();
        assert!(decoder.decode(&other) && decoder.values() == [3.0] && decoder.names() == ["b"], "other names");
        let without = encoder.encode(5, &[], &[], &[]).unwrap().to_vec();
        assert!(!decoder.decode(&without), "no values");
    }

    #[test]
    fn absurd_counts_take_no_memory() {
        let mut message = REPRESENTATION.to_vec();
        message.extend([0; 8]);
        message.extend([255; 64]);
        assert!(!JointStateDecoder::default().decode(&message));
        let mut names = REPRESENTATION.to_vec();
        names.extend([0; 8]);
        names.extend([1, 0, 0, 0, 0, 0, 0, 0, 255, 255, 255, 255]);
        assert!(!JointStateDecoder::default().decode(&names));
    }
}
