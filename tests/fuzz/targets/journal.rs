//! Messages of a session's journal, with the right checksum, which random changes never hit; and moments for monitors.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nima_session::{
    journal::{VERSION, decode, outline},
    monitor_stream,
    remote_copy::{Bundle, SessionHead},
};

fuzz_target!(|bytes: &[u8]| {
    let version = VERSION.to_le_bytes();
    let message = [b"NIMJ", &version[..], &crc32fast::hash(bytes).to_le_bytes(), bytes].concat();
    if decode(&message).is_ok() {
        assert!(outline(&message).is_ok());
    }
    decode(bytes).ok();
    monitor_stream::read(bytes).ok();
    if let Ok(bundle) = Bundle::read(bytes) {
        bundle.parts().for_each(|part| drop(part.clone()));
    }
    SessionHead::read(bytes).ok();
});
