//! OpenIGTLink messages: every parsed message can be written, and reads the same.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nima_bridges::igtl::{Header, Message, crc64};

fuzz_target!(|bytes: &[u8]| {
    let Some((head, body)) = bytes.split_at_checked(Header::BYTES) else { return };
    let Ok(header) = Header::read(head) else { return };
    let header = Header { body_bytes: body.len() as u64, crc: crc64(body), ..header };
    if let Ok(message) = Message::read(&header, body) {
        let written = message.encode();
        let header = Header::read(&written).unwrap();
        // Compared as bytes: NaN is not equal to itself.
        assert_eq!(Message::read(&header, &written[Header::BYTES..]).unwrap().encode(), written);
    }
});
