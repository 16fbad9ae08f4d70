//! Finds whole JPEGs in a file that contains a sequence of them.

/// Maximum size of an image in a file, bytes.
const JPEG_MAX: usize = 8 << 20;

/// Splits bytes, as they are read, into whole images. Other data are skipped; an image that is too long is dropped.
#[derive(Debug, Default)]
pub(crate) struct JpegSplitter {
    held: Vec<u8>,
    /// Parsed bytes of the image at the beginning of `held`.
    followed: usize,
    state: SplitState,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum SplitState {
    /// Before the beginning of an image.
    #[default]
    Before,
    /// Between segments of known length.
    Segments,
    /// In the entropy-coded image data, which end at a marker.
    Coded,
}

impl JpegSplitter {
    pub(crate) fn take(&mut self, bytes: &[u8]) {
        self.held.extend_from_slice(bytes);
    }

    /// Returns the next whole image, if it is complete.
    pub(crate) fn next(&mut self) -> Option<Vec<u8>> {
        loop {
            match self.state {
                SplitState::Before => {
                    let begin = self.held.windows(2).position(|two| two == [0xff, 0xd8]);
                    // The last byte may be the first half of a start marker.
                    let until = begin.unwrap_or(self.held.len().saturating_sub(1));
                    self.held.drain(..until);
                    begin?;
                    self.followed = 2;
                    self.state = SplitState::Segments;
                }
                SplitState::Segments => {
                    let head = self.held.get(self.followed..self.followed + 4)?;
                    let length = usize::from(u16::from_be_bytes([head[2], head[3]]));
                    match head[1] {
                        _ if head[0] != 0xff || self.followed > JPEG_MAX => self.give_up(),
                        0xff => self.followed += 1,
                        0xd9 => return Some(self.cut()),
                        0xd8 => self.give_up(),
                        marker => {
                            self.followed += 2 + length.max(2);
                            if marker == 0xda {
                                self.state = SplitState::Coded;
                            }
                        }
                    }
                }
                SplitState::Coded => {
                    if self.followed > JPEG_MAX {
                        self.give_up();
                        continue;
                    }
                    let rest = self.held.get(self.followed..)?;
                    let is_marker = |two: &[u8]| two[0] == 0xff && !matches!(two[1], 0x00 | 0xd0..=0xd7 | 0xff);
                    let Some(at) = rest.windows(2).position(is_marker) else {
                        self.followed += rest.len().saturating_sub(1);
                        return None;
                    };
                    self.followed += at;
                    if rest[at + 1] == 0xd9 {
                        return Some(self.cut());
                    }
                    self.state = SplitState::Segments;
                }
            }
        }
    }

    /// Removes the image that ends with the marker after `followed`.
    fn cut(&mut self) -> Vec<u8> {
        let rest = self.held.split_off(self.followed + 2);
        self.state = SplitState::Before;
        std::mem::replace(&mut self.held, rest)
    }

    /// Drops a false start and searches for the next one.
    fn give_up(&mut self) {
        self.held.drain(..2);
        self.state = SplitState::Before;
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::jpeg::{encode, tests::pattern};

    fn all(bytes: &[u8], chunk: usize) -> Vec<Vec<u8>> {
        let mut splitter = JpegSplitter::default();
        let mut found = Vec::new();
        for chunk in bytes.chunks(chunk) {
            splitter.take(chunk);
            found.extend(std::iter::from_fn(|| splitter.next()));
        }
        found
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn all_pictures_are_found_however_the_file_is_read(
            between in prop::collection::vec(prop::collection::vec(0_u8..0xff, 0..50), 1..4), chunk in 1_usize..5000,
        ) {
            let images: Vec<Vec<u8>> = (0..between.len()).map(|i| encode(&pattern([40 + 8 * i, 30]), [40 + 8 * i, 30], 80)).collect();
            let file: Vec<u8> = between.iter().zip(&images).flat_map(|(junk, jpeg)| [&junk[..], jpeg].concat()).collect();
            prop_assert_eq!(all(&file, chunk), images);
        }

        #[test]
        fn any_bytes_are_passed_over(bytes in prop::collection::vec(any::<u8>(), 0..3000), chunk in 1_usize..500) {
            all(&bytes, chunk);
        }
    }

    #[test]
    fn a_thumbnail_in_a_picture_is_no_picture() {
        let small = encode(&pattern([16, 16]), [16, 16], 80);
        let mut jpeg = encode(&pattern([64, 64]), [64, 64], 80);
        let mut segment = vec![0xff, 0xe1];
        segment.extend_from_slice(&(2 + small.len() as u16).to_be_bytes());
        segment.extend_from_slice(&small);
        jpeg.splice(2..2, segment);
        assert_eq!(all(&[jpeg.clone(), jpeg.clone()].concat(), 333), vec![jpeg.clone(), jpeg]);
    }
}
