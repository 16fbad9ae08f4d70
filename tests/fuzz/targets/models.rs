//! Networks of the tip force, and tables to train them.
#![no_main]

use std::path::PathBuf;

use libfuzzer_sys::fuzz_target;
use nima_recording::tip_force::{DataSet, Selection, model_from_bytes};

fuzz_target!(|bytes: &[u8]| {
    model_from_bytes(bytes).ok();
    if let Ok(set) = DataSet::parse(&[(PathBuf::from("fuzzed.csv"), bytes.to_vec())], &Selection::default()) {
        assert!(set.rows() > 0 && set.x.len() == set.rows() * set.inputs.len());
        assert!(set.x.iter().chain(&set.y).all(|number| number.is_finite()));
    }
});
