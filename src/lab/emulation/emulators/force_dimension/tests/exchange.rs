//! Tests of encoding and decoding the datagrams of the exchange; only intact ones are accepted.

use drd::wire::{ClientOrder, DeviceReply, DeviceRequest, FRESH, REPLY_BYTES, REQUEST_BYTES, SATURATED};

fn request(random: &mut fastrand::Rng) -> DeviceRequest {
    let orders = [
        ClientOrder::Hello,
        ClientOrder::Open,
        ClientOrder::Read,
        ClientOrder::Force,
        ClientOrder::EnableForce,
        ClientOrder::Brakes,
    ];
    let others = [ClientOrder::Watchdog, ClientOrder::VelocityThreshold, ClientOrder::Button, ClientOrder::Close];
    DeviceRequest {
        client: random.u64(..),
        sequence: random.u32(..),
        order: *[&orders[..], &others[..]].concat().get(random.usize(..10)).unwrap(),
        argument: random.u32(..),
        values: std::array::from_fn(|_| (random.f64() - 0.5) * 1e3),
    }
}

fn reply(random: &mut fastrand::Rng) -> DeviceReply {
    DeviceReply {
        client: random.u64(..),
        sequence: random.u32(..),
        error: random.u32(..23),
        flags: FRESH | SATURATED,
        serial: random.u32(..),
        kind: 35,
        buttons: random.u32(..),
        velocity_threshold: random.u32(..),
        watchdog: random.u32(..256),
        status: std::array::from_fn(|_| random.u32(..7)),
        firmware: random.f64(),
        position_m: std::array::from_fn(|_| random.f64()),
        frame: std::array::from_fn(|_| random.f64()),
        gripper_rad: random.f64(),
    }
}

#[test]
fn the_bytes_of_a_request_are_those_of_the_contract() {
    let values = [1.0, -2.0, 0.5, 0.25];
    let bytes = DeviceRequest { client: 2, sequence: 3, order: ClientOrder::Force, argument: 4, values }.encode();
    assert_eq!(&bytes[..24], b"NIMQ\x02\0\0\0\0\0\0\0\x03\0\0\0\x03\0\0\0\x04\0\0\0");
    assert_eq!(&bytes[24..32], &1.0_f64.to_le_bytes());
    assert_eq!(&bytes[48..56], &0.25_f64.to_le_bytes());
    // FNV-1a over all preceding bytes.
    let mut sum = 2_166_136_261_u64;
    for byte in &bytes[..56] {
        sum = ((sum ^ u64::from(*byte)) * 16_777_619) & 0xffff_ffff;
    }
    assert_eq!(u64::from(u32::from_le_bytes(bytes[56..60].try_into().unwrap())), sum);
}

#[test]
fn datagrams_come_back_as_they_went_in() {
    let mut random = fastrand::Rng::with_seed(1);
    for _ in 0..1000 {
        let request = request(&mut random);
        let reply = reply(&mut random);
        assert_eq!(DeviceRequest::decode(&request.encode()), Some(request));
        assert_eq!(DeviceReply::decode(&reply.encode()), Some(reply));
    }
}

/// Sends random and mutated datagrams; returns how many were accepted although they had been changed.
fn fuzz(rounds: u32, seed: u64) -> u32 {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut wrong = 0;
    let mut bytes = [0_u8; 300];
    for round in 0..rounds {
        let length = if round % 2 == 0 {
            let length = random.usize(..bytes.len());
            bytes[..length].fill_with(|| random.u8(..));
            length
        } else {
            let length = if round % 4 == 1 {
                bytes[..REQUEST_BYTES].copy_from_slice(&request(&mut random).encode());
                REQUEST_BYTES
            } else {
                bytes[..REPLY_BYTES].copy_from_slice(&reply(&mut random).encode());
                REPLY_BYTES
            };
            for _ in 0..random.usize(1..4) {
                bytes[random.usize(..length)] ^= random.u8(1..);
            }
            if random.u8(..) < 32 { random.usize(..length) } else { length }
        };
        wrong += u32::from(
            DeviceRequest::decode(&bytes[..length]).is_some() || DeviceReply::decode(&bytes[..length]).is_some(),
        );
    }
    wrong
}

#[test]
fn damaged_datagrams_are_refused() {
    // Very rarely, the same byte is changed and changed back, so that the datagram is intact.
    assert!(fuzz(200_000, 2) < 20);
}

#[test]
#[ignore = "`./dev fuzz` runs it for as long as told"]
fn fuzz_datagrams() {
    nima_testing::fuzz::rounds(|seed| assert!(fuzz(1_000_000, seed) < 100));
}
