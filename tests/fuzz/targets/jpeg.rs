//! Images of the endoscope.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nima_endoscope::jpeg::decode;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(picture) = decode(bytes) {
        assert_eq!(picture.rgba.len(), 4 * picture.size_px[0] * picture.size_px[1]);
    }
});
