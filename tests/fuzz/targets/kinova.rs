//! Frames of an arm, alone and within arbitrary bytes.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nima_devices::kinova::{
    faults::KinovaFaults,
    feedback::KinovaFeedback,
    frame::{KinovaFrame, PacketReader},
};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(frame) = KinovaFrame::decode(bytes)
        && let Ok(feedback) = KinovaFeedback::decode(frame.payload)
    {
        std::hint::black_box((feedback.is_finite(), KinovaFaults::of(&feedback).code()));
    }
    let mut reader = PacketReader::default();
    for piece in bytes.chunks(64) {
        let room = reader.room();
        let count = piece.len().min(room.len());
        assert!(count > 0, "the stream continues");
        room[..count].copy_from_slice(&piece[..count]);
        reader.filled(count);
        while reader.next_frame().is_some() {}
    }
});
