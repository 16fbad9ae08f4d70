//! Responses of a camera that sends motion JPEG over HTTP, and files with a sequence of images.
#![no_main]

use std::collections::VecDeque;

use libfuzzer_sys::fuzz_target;

// The parsers are private to their crate, so they are compiled here again.
#[path = "../../../src/endoscope/http"]
mod http {
    mod answer;
    mod chunked;
    mod head;

    pub(crate) fn take(bytes: &[u8], piece: usize, parts: &mut super::VecDeque<usize>) {
        let mut answer = answer::HttpAnswer::default();
        let mut images = super::VecDeque::new();
        for piece in bytes.chunks(piece) {
            if answer.take(piece, &mut images).is_err() {
                return;
            }
            parts.extend(images.drain(..).map(|image| image.body.len()));
        }
    }
}
#[path = "../../../src/endoscope/jpeg/split.rs"]
mod split;

fuzz_target!(|bytes: &[u8]| {
    for piece in [1, 7, 64 << 10] {
        let mut parts = VecDeque::new();
        http::take(bytes, piece, &mut parts);
        assert!(parts.iter().sum::<usize>() <= bytes.len());
        let mut splitter = split::JpegSplitter::default();
        let mut found = 0;
        for piece in bytes.chunks(piece) {
            splitter.take(piece);
            while let Some(image) = splitter.next() {
                found += image.len();
            }
        }
        assert!(found <= bytes.len());
    }
});
