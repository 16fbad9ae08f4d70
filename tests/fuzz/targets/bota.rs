//! A force sensor's frames within arbitrary bytes, and the answers about its settings.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nima_devices::bota::{
    codec::{BotaDecoder, BotaFrame},
    gen_a, gen0,
};

fuzz_target!(|bytes: &[u8]| {
    BotaFrame::decode(bytes).ok();
    let _ =
        (gen0::acknowledged(bytes, b'c'), gen0::product(bytes), gen0::BootText::of(bytes), gen_a::answer(bytes, b"sn"));
    let mut decoder = BotaDecoder::default();
    for piece in bytes.chunks(64) {
        decoder.room()[..piece.len()].copy_from_slice(piece);
        decoder.filled(piece.len());
        while decoder.next().is_some() {}
    }
    assert!(decoder.skipped() <= bytes.len() as u64);
});
