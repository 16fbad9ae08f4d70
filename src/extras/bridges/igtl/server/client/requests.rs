//! Splits a client's data into messages.

use super::super::super::{IgtlFormatError, IgtlHeader, IgtlMessage};

/// Maximum length of a body that is parsed, bytes; a request has 36 bytes. Longer ones are skipped. The size comes from
/// the network, so it must not decide how much memory is reserved.
const LONGEST: u64 = 4096;

/// The message being received.
#[derive(Debug, Default)]
pub(super) struct Requests {
    buffer: Vec<u8>,
    /// Remaining bytes of a long body.
    passed_over: u64,
}

impl Requests {
    /// Processes the next bytes and passes the messages that they complete to `receive`, with the name of their type.
    ///
    /// # Errors
    /// [`IgtlFormatError`] if a header is invalid: the position of the next message is then unknown.
    pub(super) fn take(
        &mut self,
        mut bytes: &[u8],
        mut receive: impl FnMut(&str, Result<IgtlMessage, IgtlFormatError>),
    ) -> Result<(), IgtlFormatError> {
        loop {
            let skipped = bytes.len().min(usize::try_from(self.passed_over).unwrap_or(usize::MAX));
            self.passed_over -= skipped as u64;
            bytes = &bytes[skipped..];
            if !self.fill(&mut bytes, IgtlHeader::BYTES) {
                return Ok(());
            }
            let header = IgtlHeader::read(&self.buffer)?;
            if header.body_bytes > LONGEST {
                self.passed_over = header.body_bytes;
                self.buffer.clear();
                continue;
            }
            if !self.fill(&mut bytes, IgtlHeader::BYTES + header.body_bytes as usize) {
                return Ok(());
            }
            receive(&header.kind, IgtlMessage::read(&header, &self.buffer[IgtlHeader::BYTES..]));
            self.buffer.clear();
        }
    }

    /// Collects bytes; returns whether there are enough.
    fn fill(&mut self, bytes: &mut &[u8], length: usize) -> bool {
        let wanted = length.saturating_sub(self.buffer.len()).min(bytes.len());
        let (taken, rest) = bytes.split_at(wanted);
        self.buffer.extend(taken);
        *bytes = rest;
        self.buffer.len() >= length
    }
}

#[cfg(test)]
mod tests {
    use super::{
        super::super::super::{Content, ContentKind, ContentStream, TextContent, Verb},
        *,
    };

    fn request() -> IgtlMessage {
        let stream = ContentStream { interval_ms: 20, frame: "world".to_owned() };
        IgtlMessage::new("", 0, Content::Request(Verb::Start, ContentKind::Tracking, Some(stream)))
    }

    #[test]
    fn messages_become_whole_however_they_are_cut_and_long_ones_are_passed_over() {
        let long = IgtlMessage::new("", 0, Content::Text(TextContent::of(&"x".repeat(20_000)))).encode();
        let all = [request().encode(), long, request().encode(), request().encode()].concat();
        for size in [1, 7, 58, 59, 1024, 50_000] {
            let mut requests = Requests::default();
            let mut received = Vec::new();
            for chunk in all.chunks(size) {
                requests.take(chunk, |_, message| received.push(message)).unwrap();
                assert!(requests.buffer.len() < IgtlHeader::BYTES + LONGEST as usize);
            }
            assert_eq!(received, vec![Ok(request()); 3], "in pieces of {size}");
        }
    }

    #[test]
    fn bytes_that_are_no_header_end_the_conversation_and_a_body_that_is_wrong_does_not() {
        let mut requests = Requests::default();
        assert_eq!(requests.take(&[b'G'; 58], |_, _| panic!()), Err(IgtlFormatError::Version(0x4747)));
        let mut damaged = request().encode();
        damaged[IgtlHeader::BYTES] ^= 1;
        let mut requests = Requests::default();
        let mut received = Vec::new();
        let bytes = [damaged, request().encode()].concat();
        requests.take(&bytes, |_, message| received.push(message)).unwrap();
        assert_eq!(received, [Err(IgtlFormatError::Checksum), Ok(request())]);
    }

    #[test]
    fn a_length_that_nobody_can_send_takes_no_memory() {
        let mut head = request().encode()[..IgtlHeader::BYTES].to_vec();
        head[IgtlHeader::BYTES - 16..IgtlHeader::BYTES - 8].fill(0xFF);
        let mut requests = Requests::default();
        requests.take(&head, |_, _| panic!()).unwrap();
        for _ in 0..100 {
            requests.take(&[0; 4096], |_, _| panic!()).unwrap();
        }
        assert!(requests.buffer.capacity() < 1000);
    }
}
