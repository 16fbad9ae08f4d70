//! Images of the endoscope.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nima_endoscope::jpeg::decode;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(image) = decode(bytes) {
        assert_eq!(image.rgba.len(), 4 * image.size_px[0] * image.size_px[1]);
    }
});
