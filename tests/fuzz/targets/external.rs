//! Datagrams of a user's own device program.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nima_devices::external::codec::{BYTES_MAX, Datagram};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(datagram) = Datagram::decode(bytes) {
        let mut again = [0; BYTES_MAX];
        let count = datagram.encode(&mut again);
        assert_eq!(Datagram::decode(&again[..count]), Ok(datagram));
    }
});
