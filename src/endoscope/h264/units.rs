//! NAL units and access units of a stream.

/// Maximum size of a frame, bytes.
const UNIT_MAX: usize = 8 << 20;

/// NAL unit type of a key frame.
const KEY: u8 = 5;

/// Returns the type of a NAL unit: 1 to 5 are parts of a frame, 7 and 8 parameters.
pub fn kind(nal: &[u8]) -> u8 {
    nal.first().map_or(0, |head| head & 0x1f)
}

/// Returns the NAL units of a frame, without their start codes.
pub fn nal_units(unit: &[u8]) -> impl Iterator<Item = &[u8]> {
    let mut rest = start(unit, 0).map_or(&[][..], |at| &unit[at + 3..]);
    std::iter::from_fn(move || {
        if rest.is_empty() {
            return None;
        }
        let next = start(rest, 0);
        let nal = &rest[..next.unwrap_or(rest.len())];
        rest = next.map_or(&[][..], |at| &rest[at + 3..]);
        // Zeros before a start code belong to the start code; a NAL unit never ends with a zero.
        let end = nal.iter().rposition(|byte| *byte != 0).map_or(0, |at| at + 1);
        Some(&nal[..end])
    })
    .filter(|nal| !nal.is_empty())
}

/// Returns whether a decoder can begin with this frame.
pub fn is_key(unit: &[u8]) -> bool {
    nal_units(unit).any(|nal| kind(nal) == KEY)
}

/// Returns the position of the next start code, from this byte on.
fn start(bytes: &[u8], from: usize) -> Option<usize> {
    bytes.get(from..)?.windows(3).position(|three| three == [0, 0, 1]).map(|at| from + at)
}

/// Splits bytes, as they are read, into whole frames.
#[derive(Debug, Default)]
pub(crate) struct H264Splitter {
    held: Vec<u8>,
    /// Bytes that have been searched.
    searched: usize,
    has_image: bool,
}

impl H264Splitter {
    pub(crate) fn take(&mut self, bytes: &[u8]) {
        self.held.extend_from_slice(bytes);
    }

    /// Returns the next whole frame: a frame is complete when the next one begins.
    pub(crate) fn next(&mut self) -> Option<Vec<u8>> {
        loop {
            if self.held.len() > UNIT_MAX && self.searched > UNIT_MAX {
                *self = Self::default();
            }
            let Some(at) = start(&self.held, self.searched) else {
                // The first bytes of a start code may be here already.
                self.searched = self.searched.max(self.held.len().saturating_sub(2));
                return None;
            };
            // The NAL header, and the byte after it.
            let Some([head, first]) = self.held.get(at + 3..at + 5) else {
                self.searched = at;
                return None;
            };
            let kind = head & 0x1f;
            let is_part = (1..=5).contains(&kind);
            // Parameter sets, or the first slice of a frame (its first macroblock has number 0, coded as one bit).
            let begins = (6..=9).contains(&kind) || is_part && first & 0x80 != 0;
            if self.has_image && begins {
                let cut = if at > 0 && self.held[at - 1] == 0 { at - 1 } else { at };
                let rest = self.held.split_off(cut);
                self.searched = 0;
                self.has_image = false;
                return Some(std::mem::replace(&mut self.held, rest));
            }
            self.has_image |= is_part;
            self.searched = at + 3;
        }
    }

    /// Returns the remainder at the end of a stream: its last frame.
    pub(crate) fn rest(&mut self) -> Option<Vec<u8>> {
        let last = std::mem::take(self);
        last.has_image.then_some(last.held)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Returns the parameters and slices of some frames, with two slices each.
    fn stream(images: usize) -> Vec<Vec<u8>> {
        let image = |number: usize| {
            let mut unit = Vec::new();
            if number.is_multiple_of(3) {
                unit.extend_from_slice(&[0, 0, 0, 1, 0x67, 0x42, 7, 0, 0, 0, 1, 0x68, 0xce]);
            }
            let head = if number.is_multiple_of(3) { 0x65 } else { 0x41 };
            unit.extend_from_slice(&[0, 0, 0, 1, head, 0x88, number as u8 + 1, 9]);
            unit.extend_from_slice(&[0, 0, 1, head, 0x42, number as u8 + 1, 0, 0, 3, 1]);
            unit
        };
        (0..images).map(image).collect()
    }

    proptest! {
        #[test]
        fn all_pictures_are_found_however_the_stream_is_read(images in 1_usize..8, chunk in 1_usize..40) {
            let stream = stream(images);
            let mut splitter = H264Splitter::default();
            let mut found = Vec::new();
            for chunk in stream.concat().chunks(chunk) {
                splitter.take(chunk);
                found.extend(std::iter::from_fn(|| splitter.next()));
            }
            found.extend(splitter.rest());
            prop_assert_eq!(found, stream);
        }

        #[test]
        fn any_bytes_are_borne(bytes in prop::collection::vec(0_u8..4, 0..300), chunk in 1_usize..50) {
            let mut splitter = H264Splitter::default();
            for chunk in bytes.chunks(chunk) {
                splitter.take(chunk);
                while splitter.next().is_some() {}
            }
            prop_assert!(nal_units(&bytes).all(|nal| !nal.is_empty()));
        }
    }

    #[test]
    fn nal_units_are_told_apart() {
        let stream = stream(2);
        let kinds = |unit: &[u8]| nal_units(unit).map(kind).collect::<Vec<_>>();
        assert_eq!((kinds(&stream[0]), kinds(&stream[1])), (vec![7, 8, 5, 5], vec![1, 1]));
        assert!(is_key(&stream[0]) && !is_key(&stream[1]) && !is_key(b"no stream"));
        assert_eq!(nal_units(&stream[0]).next(), Some(&[0x67, 0x42, 7][..]));
    }
}
