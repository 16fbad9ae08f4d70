//! Parses the chunks of a response (RFC 9112, section 7.1).

use super::answer::Wrong;

/// Maximum length of a line with a chunk length, bytes.
const LINE_MOST: usize = 256;

#[derive(Debug, Default)]
pub(super) struct Chunked {
    state: State,
    line: Vec<u8>,
}

#[derive(Clone, Copy, Debug, Default)]
enum State {
    /// In the line with a length.
    #[default]
    Length,
    /// Remaining bytes of a chunk.
    Body(usize),
    /// In the line after a chunk.
    After,
}

impl Chunked {
    /// Appends the bytes in the chunks to `out`.
    pub(super) fn take(&mut self, mut bytes: &[u8], out: &mut Vec<u8>) -> Result<(), Wrong> {
        while !bytes.is_empty() {
            if let State::Body(left) = self.state {
                let (now, rest) = bytes.split_at(left.min(bytes.len()));
                out.extend_from_slice(now);
                bytes = rest;
                self.state = if now.len() == left { State::After } else { State::Body(left - now.len()) };
                continue;
            }
            let end = bytes.iter().position(|byte| *byte == b'\n');
            let (now, rest) = bytes.split_at(end.map_or(bytes.len(), |at| at + 1));
            self.line.extend_from_slice(now);
            bytes = rest;
            if self.line.len() > LINE_MOST {
                return Err(Wrong::Unreadable("chunks without a length"));
            }
            if end.is_some() {
                self.state = match self.state {
                    State::After => State::Length,
                    _ => State::Body(self.length()?),
                };
                self.line.clear();
            }
        }
        Ok(())
    }

    fn length(&self) -> Result<usize, Wrong> {
        let text = String::from_utf8_lossy(&self.line);
        let digits = text.split(';').next().unwrap_or_default().trim();
        match usize::from_str_radix(digits, 16) {
            Ok(0) => Err(Wrong::Ended),
            Ok(length) if !digits.starts_with('+') => Ok(length),
            _ => Err(Wrong::Unreadable("chunks without a length")),
        }
    }
}
