//! Received images that are not decoded yet: the newest of independent images, or all frames of a stream since a key
//! frame.

use std::collections::VecDeque;

use crate::{CompressedFrame, Format};

/// Maximum number of waiting frames, two seconds of a stream: a decoder that is further behind starts again at a key
/// frame.
const MAX: usize = 60;

#[derive(Debug)]
pub(crate) struct WaitingFrames {
    queue: VecDeque<CompressedFrame>,
    /// Set until a key frame arrives.
    skips: bool,
}

impl Default for WaitingFrames {
    fn default() -> Self {
        Self { queue: VecDeque::new(), skips: true }
    }
}

impl WaitingFrames {
    pub(crate) fn push(&mut self, compressed: CompressedFrame) {
        match compressed.format {
            Format::Jpeg | Format::Raw(_) | Format::H264 { is_key: true } => {
                // A newer image that needs no other makes all earlier ones unnecessary.
                self.queue.clear();
                self.skips = false;
            }
            Format::H264 { is_key: false } if self.skips => return,
            Format::H264 { is_key: false } => {}
        }
        if self.queue.len() >= MAX {
            self.queue.clear();
            self.skips = true;
            return;
        }
        self.queue.push_back(compressed);
    }

    pub(crate) fn pop(&mut self) -> Option<CompressedFrame> {
        self.queue.pop_front()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.queue.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;

    fn of(format: Format, number: u8) -> CompressedFrame {
        CompressedFrame { format, ..CompressedFrame::jpeg(vec![number], Instant::now(), None) }
    }

    fn left(waiting: &mut WaitingFrames) -> Vec<u8> {
        std::iter::from_fn(|| waiting.pop()).map(|compressed| compressed.bytes[0]).collect()
    }

    #[test]
    fn of_pictures_that_stand_alone_the_newest_is_kept_and_of_a_stream_all_since_a_key() {
        let mut waiting = WaitingFrames::default();
        (0..3).for_each(|number| waiting.push(of(Format::Jpeg, number)));
        assert_eq!(left(&mut waiting), [2]);
        let mut waiting = WaitingFrames::default();
        for (number, is_key) in [(0, false), (1, true), (2, false), (3, true), (4, false), (5, false)] {
            waiting.push(of(Format::H264 { is_key }, number));
        }
        assert_eq!(left(&mut waiting), [3, 4, 5]);
    }

    #[test]
    fn a_decoder_that_is_far_behind_begins_again_with_a_key() {
        let mut waiting = WaitingFrames::default();
        (0..=60).for_each(|number| waiting.push(of(Format::H264 { is_key: number == 0 }, number)));
        assert!(waiting.is_empty());
        waiting.push(of(Format::H264 { is_key: false }, 61));
        assert!(waiting.is_empty(), "it refers to what was dropped");
        waiting.push(of(Format::H264 { is_key: true }, 62));
        assert_eq!(left(&mut waiting), [62]);
    }
}
