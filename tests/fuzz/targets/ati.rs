//! Records of a Net F/T sensor, and its page of settings.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nima_devices::ati::{
    AtiConfiguration,
    codec::{RdtCommand, RdtRecord},
};

fuzz_target!(|bytes: &[u8]| {
    if let Some(record) = RdtRecord::decode(bytes) {
        assert_eq!(record.encode(), bytes);
    }
    let _ = RdtCommand::decode(bytes);
    if let Ok(found) = AtiConfiguration::of_page("fuzzed", &String::from_utf8_lossy(bytes)) {
        assert!(found.counts.iter().all(|counts| counts.is_finite() && *counts > 0.0), "{:?}", found.counts);
    }
});
