//! Tables: recordings, pairs of pushes, poses of the gravity calibration.
#![no_main]

use std::{fs, process};

use libfuzzer_sys::fuzz_target;
use nima_recording::csv::{ColumnMapping, CsvRecording, read_pairs, read_poses};

fuzz_target!(|bytes: &[u8]| {
    let path = std::env::temp_dir().join(format!("nima-fuzz-{}.csv", process::id()));
    fs::write(&path, bytes).expect("the folder for temporary files can be written");
    CsvRecording::read(&path, &ColumnMapping::default()).ok();
    read_pairs(&path).ok();
    read_poses(&path).ok();
});
