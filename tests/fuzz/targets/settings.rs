//! Settings as TOML: rigs, scenes, tasks of a score, user studies, records of calibrations.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use nima_core::calibration::{CalibrationRecord as _, correspondence::CorrespondenceRecord, gravity::GravityRecord};
use nima_machine::config::RigConfig;
use nima_score::TaskFile;
use nima_simulation::scene::Scene;
use nima_user_study::StudyFile;

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let path = Path::new("fuzzed.toml");
    let errors = [
        RigConfig::parse(path, text).err().map(|error| error.to_string()),
        Scene::parse(path, text).err().map(|error| error.to_string()),
        TaskFile::from_toml(text).err().map(|error| error.to_string()),
    ];
    for error in errors.iter().flatten() {
        assert!(error.len() < 4000, "a file must not fill the screen: {error}");
    }
    if let Ok(record) = nima_files::from_toml::<GravityRecord>(text) {
        record.fault();
    }
    if let Ok(record) = nima_files::from_toml::<CorrespondenceRecord>(text) {
        record.fault();
    }
    if let Ok(file) = StudyFile::from_toml(text) {
        file.check().ok();
    }
});
