//! Parses the chunks of a response (RFC 9112, section 7.1).

use httparse::{Status, parse_chunk_size};

use super::answer::HttpFault;

/// Maximum length of a line with a chunk length, bytes.
const LINE_MAX: usize = 256;
/// A chunk is followed by the end of its line.
const LINE_END: u64 = 2;

#[derive(Debug, Default)]
pub(super) struct ChunkedBody {
    line: Vec<u8>,
    /// Bytes of the chunk still to come, including the end of its line.
    left: u64,
}

impl ChunkedBody {
    /// Appends the bytes in the chunks to `out`.
    pub(super) fn take(&mut self, mut bytes: &[u8], out: &mut Vec<u8>) -> Result<(), HttpFault> {
        while let Some((&first, rest)) = bytes.split_first() {
            if self.left == 0 {
                bytes = rest;
                self.line.push(first);
                match parse_chunk_size(&self.line) {
                    Ok(Status::Complete((_, 0))) => return Err(HttpFault::Ended),
                    Ok(Status::Complete((_, length))) => {
                        self.left = length.saturating_add(LINE_END);
                        self.line.clear();
                    }
                    Ok(Status::Partial) if self.line.len() <= LINE_MAX => {}
                    _ => return Err(HttpFault::Unreadable("chunks without a length")),
                }
                continue;
            }
            let body = usize::try_from(self.left.saturating_sub(LINE_END)).unwrap_or(usize::MAX).min(bytes.len());
            out.extend_from_slice(&bytes[..body]);
            let gone = body.max(1);
            // Either bytes of the body, or one byte of its line ending.
            bytes = &bytes[gone..];
            self.left -= gone as u64;
        }
        Ok(())
    }
}
