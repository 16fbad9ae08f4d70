//! Datagrams between two machines, before and after decryption.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nima_network::wire::{DatagramHead, kind, open_outer, record, token};

fuzz_target!(|bytes: &[u8]| {
    let _ = (kind(bytes), token(bytes), open_outer(bytes));
    let Some((_, mut rest)) = DatagramHead::from_bytes(bytes) else { return };
    while let Some((_, more)) = record(rest) {
        assert!(more.len() < rest.len(), "stuck");
        rest = more;
    }
});
