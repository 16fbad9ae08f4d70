//! OpenIGTLink messages: every parsed message can be written, and reads the same.
#![no_main]

use crc::{CRC_64_ECMA_182, Crc};
use libfuzzer_sys::fuzz_target;
use nima_bridges::igtl::{IgtlHeader, IgtlMessage};

const CRC: Crc<u64> = Crc::<u64>::new(&CRC_64_ECMA_182);

fuzz_target!(|bytes: &[u8]| {
    let Some((head, body)) = bytes.split_at_checked(IgtlHeader::BYTES) else { return };
    let Ok(header) = IgtlHeader::read(head) else { return };
    let header = IgtlHeader { body_bytes: body.len() as u64, crc: CRC.checksum(body), ..header };
    if let Ok(message) = IgtlMessage::read(&header, body) {
        let written = message.encode();
        let header = IgtlHeader::read(&written).unwrap();
        // Compare the bytes, because NaN is not equal to itself.
        assert_eq!(IgtlMessage::read(&header, &written[IgtlHeader::BYTES..]).unwrap().encode(), written);
    }
});
