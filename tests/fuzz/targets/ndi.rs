//! Replies and commands of a tracker.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nima_devices::ndi::{
    ExpectedReply, Inbox, NdiCommand, OUTSIDE_TOO, STRAYS, TRANSFORMS, TrackingReply, identity_of,
};

fuzz_target!(|bytes: &[u8]| {
    for options in [TRANSFORMS | OUTSIDE_TOO, TRANSFORMS | OUTSIDE_TOO | STRAYS] {
        let _ = (TrackingReply::of_block(bytes, options), TrackingReply::of_text(bytes, options));
    }
    NdiCommand::parse(bytes).ok();
    identity_of(&String::from_utf8_lossy(bytes));
    for expected in [ExpectedReply::Line, ExpectedReply::Block] {
        let mut inbox = Inbox::new();
        for piece in bytes.chunks(64) {
            let room = inbox.room();
            let count = piece.len().min(room.len());
            room[..count].copy_from_slice(&piece[..count]);
            inbox.filled(count);
            while inbox.next(expected).is_some() {}
        }
    }
});
