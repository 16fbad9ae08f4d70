//! Recorded sessions.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nima_recording::session::SessionReader;

fuzz_target!(|bytes: &[u8]| {
    let Ok(reader) = SessionReader::of_bytes("fuzzed", bytes.to_vec()) else { return };
    for attachment in reader.attachments() {
        assert!(reader.attachment(attachment).map_or(0, |data| data.len()) <= bytes.len());
    }
    reader.metadata().ok();
    reader.messages(&[], 0..u64::MAX).for_each(drop);
});
