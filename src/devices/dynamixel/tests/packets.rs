//! Checksums, stuffing, resynchronisation, and robustness against arbitrary bytes.

use super::super::{
    codec::{self, BROADCAST, IncomingPackets, OutgoingPackets, STATUS},
    message::{Instruction, ServoRefusal},
};

pub(super) fn hex(text: &str) -> Vec<u8> {
    text.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect()
}

/// Returns id, instruction and body of every packet in `bytes`, and the counters of refused data.
fn packets(incoming: &mut IncomingPackets, bytes: &[u8]) -> Vec<(u8, u8, Vec<u8>)> {
    let mut found = Vec::new();
    let mut taken = 0;
    while taken < bytes.len() {
        taken += incoming.feed(&bytes[taken..]);
        while let Some(packet) = incoming.next() {
            found.push((packet.id, packet.instruction, packet.body.to_vec()));
        }
    }
    found
}

#[test]
fn stuffing_goes_in_and_comes_out() {
    for (wire, data) in [
        ("FF FF FD 00 01 0A 00 03 E0 00 FF FF FD FD 01 67 7A", "E0 00 FF FF FD 01"),
        ("FF FF FD 00 01 0D 00 03 E0 00 FF FF FD FD FF FF FD FD ED B2", "E0 00 FF FF FD FF FF FD"),
    ] {
        let mut out = OutgoingPackets::new(64);
        out.begin(1, 3).put(&hex(data)).end();
        assert_eq!(out.bytes(), hex(wire));
        assert_eq!(packets(&mut IncomingPackets::new(64), &hex(wire)), [(1, 3, hex(data))]);
    }
    // Sent without byte stuffing, as a known client does.
    let bare = "FF FF FD 00 01 09 00 03 E2 00 FF FF FD 05 4B 97";
    assert_eq!(packets(&mut IncomingPackets::new(64), &hex(bare)), [(1, 3, hex("E2 00 FF FF FD 05"))]);
}

#[test]
fn any_parameters_survive_the_wire() {
    let mut random = fastrand::Rng::with_seed(1);
    let mut out = OutgoingPackets::new(256);
    let mut incoming = IncomingPackets::new(256);
    for _ in 0..100_000 {
        // Use few byte values, so that marks are frequent, also across two calls of `put`.
        let data: Vec<u8> = (0..random.usize(0..40)).map(|_| *random.choice(&[0xFF, 0xFD, 0x00]).unwrap()).collect();
        let (head, tail) = data.split_at(random.usize(0..=data.len()));
        out.clear();
        out.begin(7, 3).put(head).put(tail).end();
        assert_eq!(packets(&mut incoming, out.bytes()), [(7, 3, data)]);
    }
    assert_eq!(incoming.refused(), codec::RefusedCounts::default());
}

#[test]
fn a_packet_is_found_behind_noise_and_behind_a_damaged_one() {
    let good = hex("FF FF FD 00 01 03 00 01 19 4E");
    let mut bad = good.clone();
    bad[9] ^= 1;
    let mut incoming = IncomingPackets::new(64);
    // An oversized length that would swallow the rest, an incomplete header, and a damaged packet.
    let stream = [hex("00 FF FF FD 00 01 FF 7F 55 FF FF FF"), bad, good.clone(), vec![0xFF; 5], good].concat();
    for byte in &stream[..stream.len() - 10] {
        packets(&mut incoming, &[*byte]);
    }
    assert_eq!(packets(&mut incoming, &stream[stream.len() - 10..]), [(1, 1, vec![])]);
    assert_eq!(incoming.refused().damaged, 2);
}

#[test]
fn a_fast_answer_carries_a_running_checksum_in_every_block() {
    let wire = hex("FF FF FD 00 FE 11 00 55 00 01 D0 07 00 00 0C 83 00 02 09 00 00 00 11 40");
    let mut out = OutgoingPackets::new(64);
    out.begin_fast(16).put_block(0, 1, &hex("D0 07 00 00")).put_block(0, 2, &hex("09 00 00 00"));
    assert_eq!(out.bytes(), wire);
    let found = packets(&mut IncomingPackets::new(64), &wire);
    assert_eq!((found[0].0, found[0].1), (BROADCAST, STATUS));
    let blocks: Vec<_> =
        codec::blocks(&found[0].2, 4).unwrap().map(|block| (block.error, block.id, block.data.to_vec())).collect();
    assert_eq!(blocks, [(0, 1, hex("D0 07 00 00")), (0, 2, hex("09 00 00 00"))]);
    assert!(codec::blocks(&found[0].2, 5).is_none() && codec::blocks(&[], 4).is_none());
}

/// Random bytes, mutated packets, and packets cut and joined anywhere.
fn fuzz(rounds: u64, seed: u64) {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut incoming = IncomingPackets::new(200);
    let mut out = OutgoingPackets::new(512);
    let mut given = 0_u64;
    let mut found = 0_u64;
    let mut whole = 0_u64;
    for _ in 0..rounds {
        out.clear();
        let data: Vec<u8> = (0..random.usize(0..24)).map(|_| random.u8(..)).collect();
        out.begin(random.u8(..0xFF), random.u8(..)).put(&data).end();
        let mut bytes = out.bytes().to_vec();
        match random.u8(0..4) {
            0 => bytes.iter_mut().for_each(|byte| *byte = random.u8(..)),
            1 => {
                let at = random.usize(..bytes.len());
                bytes[at] ^= 1 << random.u8(0..8);
            }
            2 => bytes.truncate(random.usize(..bytes.len())),
            _ => whole += 1,
        }
        given += bytes.len() as u64;
        let mut taken = 0;
        while taken < bytes.len() {
            let count = incoming.feed(&bytes[taken..]);
            taken += count;
            let mut progress = count;
            while let Some(packet) = incoming.next() {
                progress += 1;
                found += 1;
                assert!(packet.wire_bytes <= 200);
                if let Err(refusal) = Instruction::decode(packet.instruction, packet.body) {
                    assert_ne!(refusal, ServoRefusal::Checksum);
                }
                let _any: usize = codec::blocks(packet.body, 16).into_iter().flatten().map(|b| b.data.len()).sum();
            }
            assert!(progress > 0, "stuck");
        }
    }
    assert!(found <= given / 10);
    // Only a damaged length can swallow a good packet, and the search within the damaged packet recovers most of them.
    assert!(found as f64 > 0.95 * whole as f64, "{found} of {whole}");
}

#[test]
fn no_bytes_do_harm() {
    fuzz(100_000, 2);
}

#[test]
#[ignore = "`./dev fuzz` runs it for as long as told"]
fn fuzz_packets() {
    nima_testing::fuzz::rounds(|seed| fuzz(500_000, seed));
}
