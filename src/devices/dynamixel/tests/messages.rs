//! Every instruction and the status packet, encoded and decoded, compared with the test vectors of the reference.

use super::{
    super::{
        codec::{BROADCAST, IncomingPackets, OutgoingPackets},
        message::{self, Instruction, Keep, ServoRefusal},
    },
    packets::hex,
};

fn both_ways(id: u8, instruction: &Instruction<'_>, wire: Option<&str>) {
    let mut out = OutgoingPackets::new(256);
    instruction.encode(id, &mut out);
    if let Some(wire) = wire {
        assert_eq!(out.bytes(), hex(wire), "{instruction:?}");
    }
    let mut incoming = IncomingPackets::new(256);
    incoming.feed(out.bytes());
    let packet = incoming.next().unwrap();
    assert_eq!(packet.id, id);
    assert_eq!(Instruction::decode(packet.instruction, packet.body).as_ref(), Ok(instruction));
}

#[test]
fn instructions_are_those_of_the_reference() {
    use Instruction as I;
    let all = BROADCAST;
    let sync = hex("01 96 00 00 00 02 AA 00 00 00");
    let bulk_read = hex("01 90 00 02 00 02 92 00 01 00");
    let bulk_write = hex("01 20 00 02 00 A0 00 02 1F 00 01 00 50");
    let data = [0, 2, 0, 0];
    let slow = [200, 0, 0, 0];
    for (id, instruction, wire) in [
        (1, I::Ping, "FF FF FD 00 01 03 00 01 19 4E"),
        (all, I::Ping, "FF FF FD 00 FE 03 00 01 31 42"),
        (1, I::Read { address: 132, count: 4 }, "FF FF FD 00 01 07 00 02 84 00 04 00 1D 15"),
        (1, I::Write { address: 116, data: &data }, "FF FF FD 00 01 09 00 03 74 00 00 02 00 00 CA 89"),
        (1, I::Action, "FF FF FD 00 01 03 00 05 02 CE"),
        (1, I::RegWrite { address: 104, data: &slow }, "FF FF FD 00 01 09 00 04 68 00 C8 00 00 00 AE 8E"),
        (1, I::Reboot, "FF FF FD 00 01 03 00 08 2F 4E"),
        (1, I::FactoryReset { keep: Keep::Id }, "FF FF FD 00 01 04 00 06 01 A1 E6"),
        (1, I::ClearTurns, "FF FF FD 00 01 08 00 10 01 44 58 4C 22 B1 DC"),
        (
            all,
            I::SyncRead { address: 132, count: 4, ids: &[1, 2], fast: false },
            "FF FF FD 00 FE 09 00 82 84 00 04 00 01 02 CE FA",
        ),
        (
            all,
            I::SyncRead { address: 580, count: 4, ids: &[1, 2], fast: true },
            "FF FF FD 00 FE 09 00 8A 44 02 04 00 01 02 72 F2",
        ),
        (
            all,
            I::SyncWrite { address: 116, count: 4, items: &sync },
            "FF FF FD 00 FE 11 00 83 74 00 04 00 01 96 00 00 00 02 AA 00 00 00 82 87",
        ),
        (
            all,
            I::BulkRead { items: &bulk_read, fast: false },
            "FF FF FD 00 FE 0D 00 92 01 90 00 02 00 02 92 00 01 00 1A 05",
        ),
        (
            all,
            I::BulkWrite { items: &bulk_write },
            "FF FF FD 00 FE 10 00 93 01 20 00 02 00 A0 00 02 1F 00 01 00 50 B7 68",
        ),
    ] {
        both_ways(id, &instruction, Some(wire));
    }
    // Instructions for which the reference has no vector: encode and decode.
    for instruction in [
        I::BulkRead { items: &bulk_read, fast: true },
        I::Backup { restore: false },
        I::Backup { restore: true },
        I::FactoryReset { keep: Keep::Nothing },
        I::FactoryReset { keep: Keep::IdAndBaud },
    ] {
        both_ways(3, &instruction, None);
    }
    assert_eq!(message::sync_items(&sync, 4).collect::<Vec<_>>(), [(1, &[150, 0, 0, 0][..]), (2, &[170, 0, 0, 0][..])]);
    assert_eq!(message::bulk_reads(&bulk_read).collect::<Vec<_>>(), [(1, 144, 2), (2, 146, 1)]);
    assert_eq!(message::bulk_writes(&bulk_write).collect::<Vec<_>>(), [(1, 32, &[160, 0][..]), (2, 31, &[80][..])]);
}

#[test]
fn status_packets_are_those_of_the_reference() {
    for (parameters, wire) in [
        ("06 04 26", "FF FF FD 00 01 07 00 55 00 06 04 26 65 5D"),
        ("A6 00 00 00", "FF FF FD 00 01 08 00 55 00 A6 00 00 00 8C C0"),
        ("", "FF FF FD 00 01 04 00 55 00 A1 0C"),
    ] {
        let mut out = OutgoingPackets::new(64);
        message::encode_status(1, 0, &hex(parameters), &mut out);
        assert_eq!(out.bytes(), hex(wire));
        let mut incoming = IncomingPackets::new(64);
        incoming.feed(out.bytes());
        assert_eq!(incoming.next().unwrap().body, [vec![0], hex(parameters)].concat());
    }
}

#[test]
fn wrong_lengths_and_keys_are_refused_by_name() {
    for (instruction, body, refusal) in [
        (0x01, "00", ServoRefusal::Length),
        (0x02, "84 00 04", ServoRefusal::Length),
        (0x03, "84", ServoRefusal::Length),
        (0x06, "07", ServoRefusal::Range),
        (0x10, "01 44 58 4C 23", ServoRefusal::Range),
        (0x83, "74 00 04 00 01 96 00 00", ServoRefusal::Length),
        (0x92, "01 90 00 02", ServoRefusal::Length),
        (0x93, "01 20 00 02 00 A0", ServoRefusal::Length),
        (0x77, "", ServoRefusal::Instruction),
    ] {
        assert_eq!(Instruction::decode(instruction, &hex(body)), Err(refusal), "{instruction:#x} {body}");
    }
    for code in 0..=255 {
        match ServoRefusal::of(code) {
            Ok(None) => assert_eq!(code & 0x7F, 0),
            Ok(Some(refusal)) => assert_eq!(refusal as u8, code & 0x7F),
            Err(unknown) => assert!(unknown > 7 && unknown == code & 0x7F),
        }
    }
}
