//! Datagrams of a user's own device program.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nima_devices::external::codec::{BYTES_MAX, Datagram};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(datagram) = Datagram::decode(bytes) {
        let [mut once, mut twice] = [[0; BYTES_MAX]; 2];
        let count = datagram.encode(&mut once);
        let again = Datagram::decode(&once[..count]).unwrap();
        // Compare the bytes, because NaN is not equal to itself.
        assert_eq!(again.encode(&mut twice), count);
        assert_eq!(twice, once);
    }
});
