//! `sensor_msgs/msg/JointState`: named numbers, encoded as CDR (little endian, XCDR1).

use crate::session::Encoding;

/// Definition of the message in the language of ROS 2: first the message itself, then the messages that it contains.
const SCHEMA: &str = "\
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";

/// Little-endian CDR without options. Alignment is counted from the end of this header.
pub(super) const REPRESENTATION: [u8; 4] = [0, 1, 0, 0];
/// Offset of the time.
const STAMP: usize = REPRESENTATION.len();

/// Encodes the messages of one channel. Their names never change, so they are encoded once.
///
/// ```
/// use nima_recording::messages::JointStateEncoder;
///
/// let mut forces = JointStateEncoder::new("world", &["right.force.x_n", "right.force.y_n"]);
/// let message = forces.encode(1_500_000_000, &[], &[], &[0.25, -0.5])?;
/// assert_eq!(message[..12], [0, 1, 0, 0, 1, 0, 0, 0, 0x00, 0x65, 0xcd, 0x1d], "1 s and 500 000 000 ns");
/// assert!(forces.encode(0, &[], &[], &[0.25]).is_err(), "one value for two names");
/// # Ok::<(), nima_recording::messages::WrongLength>(())
/// ```
#[derive(Clone, Debug)]
pub struct JointStateEncoder {
    /// The current message; the part after `fixed` is rebuilt for every message.
    message: Vec<u8>,
    fixed: usize,
    names: usize,
}

/// A list of values whose length differs from the number of names and is not zero.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[error("JointState message has {values} values for {names} names; send one value per name, or none")]
pub struct WrongLength {
    pub values: usize,
    pub names: usize,
}

impl JointStateEncoder {
    /// Creates an encoder for values of these names, in the coordinates of `frame`.
    pub fn new(frame: &str, names: &[&str]) -> Self {
        let mut message = REPRESENTATION.to_vec();
        message.extend_from_slice(&[0; 8]);
        put_text(&mut message, frame);
        put_count(&mut message, names.len());
        for name in names {
            put_text(&mut message, name);
        }
        Self { fixed: message.len(), message, names: names.len() }
    }

    /// Returns the encoding of the channel, for its readers.
    pub fn encoding() -> Encoding {
        Encoding {
            schema: "sensor_msgs/msg/JointState".into(),
            schema_encoding: "ros2msg".into(),
            schema_data: SCHEMA.into(),
            message_encoding: "cdr".into(),
        }
    }

    /// Encodes a message of this time. Each list has one value for each name, or is empty. The bytes are valid until
    /// the next call.
    ///
    /// # Errors
    /// [`WrongLength`] for a list of another length.
    pub fn encode(
        &mut self,
        time_ns: u64,
        position: &[f64],
        velocity: &[f64],
        effort: &[f64],
    ) -> Result<&[u8], WrongLength> {
        let lists = [position, velocity, effort];
        if let Some(list) = lists.iter().find(|list| !list.is_empty() && list.len() != self.names) {
            return Err(WrongLength { values: list.len(), names: self.names });
        }
        let second = 1_000_000_000;
        // The format's signed 32-bit seconds end in 2038.
        let seconds = i32::try_from(time_ns / second).unwrap_or(i32::MAX);
        self.message[STAMP..STAMP + 4].copy_from_slice(&seconds.to_le_bytes());
        self.message[STAMP + 4..STAMP + 8].copy_from_slice(&((time_ns % second) as u32).to_le_bytes());
        self.message.truncate(self.fixed);
        for list in lists {
            put_count(&mut self.message, list.len());
            if !list.is_empty() {
                align(&mut self.message, 8);
            }
            for value in list {
                self.message.extend_from_slice(&value.to_le_bytes());
            }
        }
        Ok(&self.message)
    }
}

fn align(message: &mut Vec<u8>, to: usize) {
    let length = (message.len() - REPRESENTATION.len()).next_multiple_of(to);
    message.resize(REPRESENTATION.len() + length, 0);
}

fn put_count(message: &mut Vec<u8>, count: usize) {
    align(message, 4);
    message.extend_from_slice(&(count as u32).to_le_bytes());
}

/// Appends a text with its terminating zero byte, which counts towards its length.
fn put_text(message: &mut Vec<u8>, text: &str) {
    put_count(message, text.len() + 1);
    message.extend_from_slice(text.as_bytes());
    message.push(0);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_laid_out_as_the_standard_says() {
        let mut encoder = JointStateEncoder::new("world", &["a", "force"]);
        let message = encoder.encode(3_000_000_004, &[], &[], &[1.0, -2.0]).unwrap().to_vec();
        #[rustfmt::skip]
        let expected: Vec<u8> = [
            &[0, 1, 0, 0][..],
            &[3, 0, 0, 0], &[4, 0, 0, 0],
            &[6, 0, 0, 0], b"world\0", &[0, 0],
            &[2, 0, 0, 0],
            &[2, 0, 0, 0], b"a\0", &[0, 0],
            &[6, 0, 0, 0], b"force\0", &[0, 0],
            &[0; 4], &[0; 4],
            // 52 bytes so far: pad by four to a multiple of eight, counted from the end of the first four.
            &[2, 0, 0, 0],
            &1_f64.to_le_bytes(), &(-2_f64).to_le_bytes(),
        ].concat();
        assert_eq!(message, expected);
        let again = encoder.encode(3_000_000_004, &[], &[], &[1.0, -2.0]).unwrap();
        assert_eq!(again, expected, "nothing is left of the message before");
    }

    #[test]
    fn lists_of_another_length_are_refused() {
        let mut encoder = JointStateEncoder::new("", &["a", "b"]);
        assert_eq!(encoder.encode(0, &[], &[1.0], &[]).unwrap_err(), WrongLength { values: 1, names: 2 });
        assert!(encoder.encode(u64::MAX, &[1.0; 2], &[1.0; 2], &[1.0; 2]).is_ok());
        assert_eq!(
            JointStateEncoder::new("", &[]).encode(0, &[], &[], &[]).unwrap().len(),
            4 + 8 + (4 + 1 + 3) + 4 + 3 * 4
        );
    }
}
