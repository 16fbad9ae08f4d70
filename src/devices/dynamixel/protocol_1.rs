//! Recognises servos that use protocol 1.0 (AX, MX and older firmware), which this program does not support.
//!
//! Source: the ROBOTIS e-manual, "Protocol 1.0": `FF FF ID LENGTH INSTRUCTION PARAMETERS CHECKSUM`, where the checksum is
//! the complement of the sum of all bytes behind the header.

use super::opening::{REST_READS, WaitClock};
use crate::{DeviceError, transport::ByteStream};

// Instructions, and the id of all servos.
const PING: u8 = 1;
const READ: u8 = 2;
const BROADCAST: u8 = 254;
/// Header, id, length, error and checksum.
const OVERHEAD: usize = 6;

/// Returns the error for a servo that answers in protocol 1; `None` if there is none.
pub(super) fn anybody(
    line: &mut impl ByteStream,
    pace: &mut impl WaitClock,
    port: &str,
    answer_s: f64,
) -> Result<Option<DeviceError>, DeviceError> {
    let Some((id, _)) = ask(line, pace, port, answer_s, &[BROADCAST, PING])? else { return Ok(None) };
    // The model number is in the first two registers.
    let model = ask(line, pace, port, answer_s, &[id, READ, 0, 2])?;
    let model = model.and_then(|(_, data)| data.first_chunk().map(|bytes| u16::from_le_bytes(*bytes)));
    let number = model.map_or_else(String::new, |number| format!(" with model number {number}"));
    Ok(Some(DeviceError::Unsupported {
        place: format!("servo {id} on {port}"),
        found: format!("servo{number} that uses protocol 1"),
        cure: "Use a servo with protocol 2; if this model has both, set its protocol type to 2 with DYNAMIXEL Wizard."
            .to_owned(),
    }))
}

/// Sends id, instruction and parameters; returns id and data of the first answer.
fn ask(
    line: &mut impl ByteStream,
    pace: &mut impl WaitClock,
    port: &str,
    answer_s: f64,
    instruction: &[u8],
) -> Result<Option<(u8, Vec<u8>)>, DeviceError> {
    let gone = |_| DeviceError::Other { place: port.to_owned(), reason: "the connection was lost".to_owned() };
    let mut buffer = [0; 64];
    // Bytes that are still buffered could look like the answer.
    for _ in 0..REST_READS {
        if line.receive(&mut buffer).map_err(gone)? == 0 {
            break;
        }
    }
    let length = instruction.len() as u8;
    let mut packet = vec![0xFF, 0xFF, instruction[0], length];
    packet.extend_from_slice(&instruction[1..]);
    packet.push(checksum(&packet[2..]));
    line.send(&packet).map_err(gone)?;
    let begin_s = pace.now_s();
    let mut received = Vec::new();
    // At most 512 bytes, because a disturbed line may send without end.
    while pace.now_s() - begin_s <= answer_s && received.len() < 512 {
        match line.receive(&mut buffer).map_err(gone)? {
            0 => pace.nap(),
            count => received.extend_from_slice(&buffer[..count]),
        }
        if let Some(answer) = answer(&received, instruction[0]) {
            return Ok(Some(answer));
        }
    }
    Ok(None)
}

/// Finds an answer among these bytes. An adapter may also return the bytes that were sent.
fn answer(received: &[u8], to: u8) -> Option<(u8, Vec<u8>)> {
    (0..received.len()).find_map(|at| {
        let [0xFF, 0xFF, id, length, rest @ ..] = &received[at..] else { return None };
        let whole = usize::from(*length).checked_add(4)?;
        // Protocol 2 has the same first bytes, with an id of FD.
        let fits = *id < 0xFD && (to == BROADCAST || *id == to) && whole >= OVERHEAD && rest.len() + 4 >= whole;
        let packet = fits.then(|| &received[at..at + whole])?;
        let (sum, covered) = packet[2..].split_last()?;
        (checksum(covered) == *sum).then(|| (*id, packet[5..whole - 1].to_vec()))
    })
}

fn checksum(bytes: &[u8]) -> u8 {
    !bytes.iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte))
}

#[cfg(test)]
mod tests {
    use std::thread;

    use super::*;
    use crate::{dynamixel::opening::SystemClock, transport::MemoryBytes};

    #[test]
    fn a_servo_of_protocol_1_is_named_with_its_model_number() {
        let [mut here, mut there] = MemoryBytes::pair();
        let servo = thread::spawn(move || {
            // The examples of the e-manual: a ping and its answer; then the model number of an AX-12A.
            let mut asked = Vec::new();
            let mut buffer = [0; 64];
            for (question, answer) in [
                (&[0xFF, 0xFF, 0xFE, 2, 1, 0xFE][..], &[0xFF, 0xFF, 1, 2, 0, 0xFC][..]),
                (&[0xFF, 0xFF, 1, 4, 2, 0, 2, 0xF6], &[0xFF, 0xFF, 1, 4, 0, 12, 0, 0xEE]),
            ] {
                asked.clear();
                while asked.len() < question.len() {
                    let count = there.receive(&mut buffer).unwrap();
                    asked.extend_from_slice(&buffer[..count]);
                    thread::yield_now();
                }
                assert_eq!(asked, question);
                there.send(answer).unwrap();
            }
        });
        let mut clock = SystemClock(std::time::Instant::now());
        let trouble = anybody(&mut here, &mut clock, "/dev/ttyUSB0", 5.0).unwrap().expect("it answers");
        servo.join().unwrap();
        let words = trouble.to_string();
        assert!(words.contains("servo 1 on /dev/ttyUSB0") && words.contains("model number 12"), "{words}");
        assert!(words.contains("protocol 1") && words.contains("not supported"), "{words}");
    }

    #[test]
    fn answers_of_protocol_2_and_echoes_are_none_of_protocol_1() {
        let of_protocol_2 = [0xFF, 0xFF, 0xFD, 0, 1, 7, 0, 0x55, 0, 6, 4, 0x26, 0x65, 0x5D];
        let echo = [0xFF, 0xFF, 0xFE, 2, 1, 0xFE];
        for bytes in [&of_protocol_2[..], &echo, &[0xFF; 40], &[]] {
            assert_eq!(answer(bytes, BROADCAST), None);
        }
    }
}
