//! Answers of a Haply handle within arbitrary bytes.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nima_devices::haply::codec::{DeviceInfo, HaplyDecoder, HaplyState, force_of};

fuzz_target!(|bytes: &[u8]| {
    let _ = (DeviceInfo::decode(bytes), HaplyState::decode(bytes), force_of(bytes));
    let mut decoder = HaplyDecoder::default();
    for piece in bytes.chunks(40) {
        decoder.room()[..piece.len()].copy_from_slice(piece);
        decoder.filled(piece.len());
        while decoder.next().is_some() {}
    }
});
