//! Descriptions of arms.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nima_machine::config::urdf::{ChainEnds, chain_of};

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    match chain_of(text, ChainEnds { base_link: "b", flange_link: "f" }, 3.0) {
        Ok(chain) => assert!(!chain.joints.is_empty()),
        Err(error) => assert!(error.to_string().len() < 4000),
    }
});
