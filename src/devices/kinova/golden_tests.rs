//! Byte-exact frames of the manufacturer's client, encoded and decoded; answers encoded by Google's protobuf library;
//! and invalid bytes.

use prost::Message as _;

use super::{
    faults::KinovaFaults,
    feedback::KinovaFeedback,
    frame::{KinovaFrame, KinovaHeader, MARK, PACKET_MAX, PacketReader, REQUEST, RESPONSE, encode, encode_packet},
    messages::{
        ActuatorCommand, ArmState, CreateSessionInfo, ErrorInfo, KinovaCommand, KinovaNumber, KinovaTwist, Rpc,
        TwistCommand, sub,
    },
};

const CREATE_SESSION: &str = "07784574526f4b070000002d0a140d0000001115010000001d0100011025150000001215\
    0a0561646d696e10e0d4031a0561646d696e20d00f";
const KEEP_ALIVE: &str = "0a0f0d0000001115020007001d03000110";
const REFRESH_FEEDBACK: &str = "0a0f0d0000001115050007001d03000310";
const SEND_TWIST: &str = "0a140d0000001115030007001d79000210250e000000120e0802120a1dcdcc4c3d2500002041";
const REFRESH: &str = "0a140d0000001115040007001d01000310251600000012160d05000000120f0d0500000015010000001d00002841";
/// Answer to `REFRESH` with 40 base fields, two actuators and an interconnect; written by Google's protobuf 6.
const FEEDBACK: &str = "0a140d0000001315040007001d01000310255701000012d7020d0500000012cf01080310061d0000604025000090402d0000b040350000\
    d0403d0000f04045000008414d0000184155000028415d0000384165000048416d0000584175000068417d000078418501000084418d01\
    00008c419501000094419d0100009c41a5010000a441ad010000ac41b5010000b441bd010000bc41c5010000c441cd010000cc41d50100\
    00d441dd010000dc41e5010000e441ed010000ec41f5010000f441fd01100000008d02200000009d0200000e42a50200001242ad020000\
    1642b50200001a42bd0200001e42c502000022421a320d0500000015200800001d0c0000002500c0b3432d0000a0bf35000020403d0000\
    003f450000c0414d00000c4255000020421a3c0d0500000015200800001d0c000000250040b3432d0000a0bf35000020403d0000003f45\
    0000c0414d00000c4255000020425d010040007507000000220c0a050d090000001501000000";
/// Refusal of `REFRESH` outside low-level servoing.
const REFUSED: &str =
    "0a140d4b30001315040007001d01000310251900000012190803104b1a1357726f6e6720736572766f696e67206d6f6465";

fn bytes(hex: &str) -> Vec<u8> {
    hex.as_bytes().chunks(2).map(|two| u8::from_str_radix(std::str::from_utf8(two).unwrap(), 16).unwrap()).collect()
}

fn request(session: u16, message: u16, rpc: Rpc) -> KinovaHeader {
    let Rpc { service, function } = rpc;
    KinovaHeader { kind: REQUEST, session, message, service, function, ..KinovaHeader::default() }
}

fn twist() -> TwistCommand {
    let twist = KinovaTwist { linear_z: 0.05, angular_x: 10.0, ..KinovaTwist::default() };
    TwistCommand { reference_frame: 2, twist: Some(twist), duration: 0 }
}

fn refresh() -> KinovaCommand {
    let actuator = ActuatorCommand { command_id: 5, flags: 1, position_deg: 10.5, ..ActuatorCommand::default() };
    KinovaCommand { frame_id: 5, actuators: vec![actuator] }
}

fn login() -> CreateSessionInfo {
    CreateSessionInfo {
        username: "admin".to_owned(),
        session_inactivity_ms: 60_000,
        password: "admin".to_owned(),
        connection_inactivity_ms: 2_000,
    }
}

/// Checks that encoding gives the bytes and decoding gives header and message.
fn both_ways<M: prost::Message + Default + PartialEq + std::fmt::Debug>(hex: &str, header: KinovaHeader, message: &M) {
    let mut out = Vec::new();
    encode(&header, message, &mut out);
    assert_eq!(out, bytes(hex), "{hex}");
    let frame = KinovaFrame::decode(&out).unwrap();
    assert_eq!(frame.header, header);
    assert_eq!(M::decode(frame.payload).unwrap(), *message);
}

#[test]
fn requests_are_the_bytes_of_the_manufacturers_client_both_ways() {
    both_ways(KEEP_ALIVE, request(7, 2, Rpc::KEEP_ALIVE), &());
    both_ways(REFRESH_FEEDBACK, request(7, 5, Rpc::REFRESH_FEEDBACK), &());
    both_ways(SEND_TWIST, request(7, 3, Rpc::SEND_TWIST), &twist());
    both_ways(REFRESH, request(7, 4, Rpc::REFRESH), &refresh());
    let mut packet = Vec::new();
    encode_packet(&request(0, 1, Rpc::CREATE_SESSION), &login(), &mut packet);
    assert_eq!(packet, bytes(CREATE_SESSION));
    let mut reader = PacketReader::default();
    reader.room()[..packet.len()].copy_from_slice(&packet);
    reader.filled(packet.len());
    let frame = reader.next_frame().unwrap();
    assert_eq!(frame.header, request(0, 1, Rpc::CREATE_SESSION));
    assert_eq!(CreateSessionInfo::decode(frame.payload).unwrap(), login());
}

#[test]
fn an_answer_with_every_field_is_read() {
    let whole = bytes(FEEDBACK);
    let frame = KinovaFrame::decode(&whole).unwrap();
    assert_eq!(frame.header, KinovaHeader { kind: RESPONSE, ..request(7, 4, Rpc::REFRESH) });
    let report = KinovaFeedback::decode(frame.payload).unwrap();
    assert_eq!((report.frame_id, report.state, report.count), (5, ArmState::SERVOING_LOW_LEVEL, 2));
    // Field n of the base has the value n + 0.5; doubled, the values are integers.
    let doubled = |numbers: [f32; 6]| numbers.map(|x| (2.0 * x) as i32);
    assert_eq!(doubled(report.tool_pose), [27, 29, 31, 33, 35, 37]);
    assert_eq!(doubled(report.tool_twist), [39, 41, 43, 45, 47, 49]);
    assert_eq!(doubled(report.tool_wrench), [51, 53, 55, 57, 59, 61]);
    assert_eq!((report.banks.fault, report.banks.warning), ([0x10, 0], [0x20, 0]));
    let [first, second] = [report.actuators[0], report.actuators[1]];
    assert_eq!((first.command_id, first.status, first.position_deg), (5, 0x820, 359.5));
    assert_eq!((first.velocity_deg_s, first.torque_nm, first.current_a), (-1.25, 2.5, 0.5));
    assert!(!first.banks.is_faulty());
    assert_eq!((second.position_deg, second.banks.fault, second.banks.warning), (358.5, [0x0040_0001, 0], [0, 7]));
    let faults = KinovaFaults::of(&report);
    assert_eq!(
        faults.to_string(),
        "base: fault of a joint (0x10), joint 2: following error (0x1), joint 2: cyclic command missed (0x400000)"
    );
    assert_eq!(faults.code(), 0x0040_0001);
}

#[test]
fn a_refusal_is_read() {
    let whole = bytes(REFUSED);
    let frame = KinovaFrame::decode(&whole).unwrap();
    assert_eq!((frame.header.error, frame.header.sub_error), (3, sub::WRONG_SERVOING_MODE));
    let report = ErrorInfo::decode(frame.payload).unwrap();
    assert_eq!((report.code, report.sub_code, report.text.as_str()), (3, 75, "Wrong servoing mode"));
}

#[test]
fn headers_go_round_with_every_bit() {
    let mut random = fastrand::Rng::with_seed(1);
    for _ in 0..2000 {
        let header = KinovaHeader {
            kind: random.u8(..16),
            device: random.u8(..),
            error: random.u8(..16),
            sub_error: random.u16(..4096),
            session: random.u16(..),
            message: random.u16(..),
            service: random.u16(..4096),
            function: random.u16(..),
        };
        let mut out = Vec::new();
        encode(&header, &KinovaNumber { value: random.u32(..) }, &mut out);
        assert_eq!(KinovaFrame::decode(&out).unwrap().header, header);
    }
}

#[test]
fn a_dirty_stream_is_taken_up_again_and_counted() {
    let mut random = fastrand::Rng::with_seed(5);
    let packet = |message: u16| {
        let mut out = Vec::new();
        encode_packet(&request(7, message, Rpc::SEND_TWIST), &twist(), &mut out);
        out
    };
    let mut stream = Vec::new();
    let mut noise = 0;
    for message in 0..200 {
        for _ in 0..random.usize(..30) {
            // Include the first byte of a mark, so that incomplete marks occur.
            stream.push(if random.bool() { MARK[0] } else { random.u8(128..) });
            noise += 1;
        }
        stream.extend(packet(message));
    }
    // A packet with too large a length, and one that is not a frame.
    stream.extend(MARK);
    stream.extend((PACKET_MAX as u32).to_be_bytes());
    stream.extend(MARK);
    stream.extend([0, 0, 0, 3, 0xff, 0xff, 0xff]);
    stream.extend(packet(200));
    let mut reader = PacketReader::default();
    let mut next = 0;
    let mut rest = stream.as_slice();
    while !rest.is_empty() {
        let count = random.usize(1..50).min(rest.len()).min(reader.room().len());
        reader.room()[..count].copy_from_slice(&rest[..count]);
        reader.filled(count);
        rest = &rest[count..];
        while let Some(frame) = reader.next_frame() {
            assert_eq!(frame.header.message, next);
            next += 1;
        }
    }
    assert_eq!((next, reader.damaged), (201, 2));
    assert_eq!(reader.skipped, noise + 4 + 7);
}

/// Random input never causes a panic, and decoded frames equal the encoded ones.
fn storm(frames: u32, seed: u64) {
    let mut random = fastrand::Rng::with_seed(seed);
    let known = [KEEP_ALIVE, SEND_TWIST, REFRESH, FEEDBACK, REFUSED, CREATE_SESSION].map(bytes);
    let mut reader = PacketReader::default();
    let mut decoded = 0_u64;
    let mut packets = 0_u64;
    for _ in 0..frames {
        let mut frame = if random.u8(..4) == 0 {
            (0..random.usize(..64)).map(|_| random.u8(..)).collect()
        } else {
            random.choice(&known).cloned().unwrap_or_default()
        };
        for _ in 0..random.usize(..4) {
            let at = random.usize(..frame.len().max(1));
            match (random.u8(..4), at < frame.len()) {
                (0, true) => frame[at] ^= 1 << random.u8(..8),
                (1, true) => frame[at] = random.u8(..),
                (2, true) => frame.truncate(at),
                _ => frame.insert(at.min(frame.len()), random.u8(..)),
            }
        }
        if let Ok(report) = KinovaFrame::decode(&frame) {
            decoded += 1;
            if let Ok(feedback) = KinovaFeedback::decode(report.payload) {
                std::hint::black_box((feedback.is_finite(), KinovaFaults::of(&feedback).code()));
            }
        }
        let room = reader.room();
        let count = frame.len().min(room.len());
        room[..count].copy_from_slice(&frame[..count]);
        reader.filled(count);
        while reader.next_frame().is_some() {
            packets += 1;
        }
        assert!(!reader.room().is_empty(), "the stream continues");
    }
    assert!(decoded > u64::from(frames) / 10 && packets > u64::from(frames) / 100, "{decoded} and {packets}");
}

#[test]
fn a_storm_of_random_and_mutated_frames_does_no_harm() {
    storm(150_000, 11);
}

#[test]
#[ignore = "`./dev fuzz` runs it for as long as told"]
fn fuzz_frames() {
    nima_testing::fuzz::rounds(|seed| storm(500_000, seed));
}
