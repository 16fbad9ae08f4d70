//! Packets of servos within arbitrary bytes.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nima_devices::dynamixel::{
    codec::{IncomingPackets, blocks},
    message::Instruction,
};

fuzz_target!(|bytes: &[u8]| {
    let mut incoming = IncomingPackets::new(200);
    let mut rest = bytes;
    while !rest.is_empty() {
        let count = incoming.feed(rest);
        rest = &rest[count..];
        let mut progress = count;
        while let Some(packet) = incoming.next() {
            progress += 1;
            Instruction::decode(packet.instruction, packet.body).ok();
            blocks(packet.body, 16).into_iter().flatten().for_each(drop);
        }
        assert!(progress > 0, "stuck");
    }
});
