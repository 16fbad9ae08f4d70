//! Recorded sessions: their reader, the list of missing data, and the data in their topics.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use nima_recording::session::SessionReader;
use nima_score::{TaskFile, trial_score};
use nima_session::{completeness, objects, plot_channels};

fuzz_target!(|bytes: &[u8]| {
    let Ok(reader) = SessionReader::of_bytes("fuzzed", bytes.to_vec()) else { return };
    for attachment in reader.attachments() {
        assert!(reader.attachment(attachment).map_or(0, |data| data.len()) <= bytes.len());
    }
    reader.metadata().ok();
    reader.messages(&[], 0..u64::MAX).for_each(drop);
    completeness::missing(&reader);
    objects::happenings(&reader, 0..u64::MAX).ok();
    let path = Path::new("fuzzed");
    for side in plot_channels::arms(&reader) {
        plot_channels::each_tick(&reader, path, side, 0..u64::MAX, |_| Ok::<_, plot_channels::PlottedError>(())).ok();
    }
    let task = TaskFile::from_toml("name = 'Free'\nkind = 'free'\ntime_limit_s = 1200.0").expect("a valid task");
    trial_score::score(&reader, path, &(0..u64::MAX), &task).ok();
});
