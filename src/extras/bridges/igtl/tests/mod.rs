//! The codec against bytes of the reference library, damaged and random messages.

use super::{message::CRC, *};

mod fixtures;

fn bytes(hex: &str) -> Vec<u8> {
    let digits: Vec<u8> = hex.bytes().filter(u8::is_ascii_hexdigit).collect();
    let byte = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).unwrap(), 16).unwrap();
    digits.chunks(2).map(byte).collect()
}

fn read(message: &[u8]) -> Result<IgtlMessage, IgtlFormatError> {
    let (head, body) = message.split_at_checked(IgtlHeader::BYTES).ok_or(IgtlFormatError::Short)?;
    IgtlMessage::read(&IgtlHeader::read(head)?, body)
}

/// Returns a message of this type with this content and a correct checksum.
fn framed(kind: &str, version: u16, body: &[u8]) -> Vec<u8> {
    let mut message = IgtlMessage::new("Device", 0, Content::Other(kind.to_owned())).encode();
    message[..2].copy_from_slice(&version.to_be_bytes());
    message[IgtlHeader::BYTES - 16..IgtlHeader::BYTES - 8].copy_from_slice(&(body.len() as u64).to_be_bytes());
    message[IgtlHeader::BYTES - 8..].copy_from_slice(&CRC.checksum(body).to_be_bytes());
    message.extend(body);
    message
}

/// The pose in the reference library's examples, column after column.
const POSE: PoseMatrix = PoseMatrix([
    [-0.954_892, 0.196_632, -0.222_525],
    [-0.196_632, 0.142_857, 0.970_014],
    [0.222_525, 0.970_014, -0.097_749_1],
    [46.0531, 19.4709, 46.0531],
]);

#[test]
fn units_are_packed_as_the_protocol_says() {
    assert_eq!(IgtlUnit::NEWTON, IgtlUnit(0x02C4_0000_0000_0000));
    // m/s^2, as in the reference library's test.
    assert_eq!(IgtlUnit::of(0, &[(1, 1), (3, -2)]), IgtlUnit(0x0044_3E00_0000_0000));
    assert_eq!(IgtlUnit::of(0xB, &[(1, 1)]).0 >> 60, 0xB);
}

#[test]
fn bytes_of_the_reference_library_are_read_and_written_again() {
    for (name, hex) in fixtures::ALL {
        let wire = bytes(hex);
        let message = read(&wire).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!((message.device.as_str(), message.time_ns), ("DeviceName", 287_445_237), "{name}");
        assert!(!matches!(message.content, Content::Other(_)), "{name}");
        if wire[1] == 1 {
            // The time stamp, from byte 34, has fractions of a nanosecond.
            let again = message.encode();
            assert_eq!((&again[..34], &again[42..]), (&wire[..34], &wire[42..]), "{name}");
        }
    }
}

#[test]
fn what_the_reference_library_meant_is_what_is_read() {
    let of = |wanted: &str| {
        let (_, hex) = fixtures::ALL.iter().find(|(name, _)| *name == wanted).unwrap();
        read(&bytes(hex)).unwrap().content
    };
    for name in ["transform", "transform, version 3"] {
        assert_eq!(of(name), Content::Transform(POSE), "{name}");
    }
    for name in ["tdata", "tdata, version 3"] {
        let Content::Tracking(tools) = of(name) else { panic!("{name}") };
        assert_eq!(
            tools.iter().map(|tool| tool.name.as_str()).collect::<Vec<_>>(),
            ["Tracker0", "Tracker1", "Tracker2"]
        );
        assert!(tools.iter().all(|tool| tool.kind == ToolKind::SixD && tool.pose == POSE));
    }
    let Content::Position(Position { place_mm, turn: Some([.., scalar]) }) = of("position") else { panic!() };
    assert!(
        place_mm.map(f32::to_bits) == POSE.0[3].map(f32::to_bits) && (scalar - 1.0 / 3.0).abs() < 1e-6,
        "the scalar of a quaternion is its last number"
    );
    let Content::Sensor(SensorContent { unit, values, .. }) = of("sensor") else { panic!() };
    assert_eq!((unit, values.len()), (IgtlUnit::of(0, &[(1, 1), (3, -2)]), 6));
    assert!((values[0] - 123_456.78).abs() < 1e-9);
    let Content::Status(status) = of("status") else { panic!() };
    assert_eq!((status.code, status.subcode, status.name.as_str()), (StatusCode(15), 10, "ACTUATOR_DISABLED"));
    assert_eq!(status.text, "Actuator A is disabled.");
    assert_eq!(of("string"), Content::Text(TextContent::of("Welcome to OpenIGTLink")));
    let types = ["IMAGE", "GET_IMAGE", "TRANSFORM", "GET_TRANS"].map(str::to_owned);
    assert_eq!(of("capability"), Content::Capability(types.to_vec()));
}

fn every_kind() -> Vec<IgtlMessage> {
    let stream = ContentStream { interval_ms: 16, frame: "world".to_owned() };
    let image = Image { size_px: [3, 2], colours: 3, pixels: (0..18).collect() };
    let contents = [
        Content::Transform(POSE),
        Content::Position(Position { place_mm: [1.0, 2.0, 3.0], turn: Some([0.0, 0.6, 0.0, 0.8]) }),
        Content::Position(Position { place_mm: [1.0, 2.0, 3.0], turn: None }),
        Content::Tracking(vec![]),
        Content::Tracking(vec![TrackingTool { name: "right.tip".to_owned(), kind: ToolKind::FiveD, pose: POSE }; 4]),
        Content::Turned(vec![QuaternionTool {
            name: "left.tip".to_owned(),
            kind: ToolKind::Tracker,
            place_mm: [-1.0, 0.5, 1e6],
            turn: [0.0, 0.0, 0.0, 1.0],
        }]),
        Content::Sensor(SensorContent { status: 0, unit: IgtlUnit::NEWTON, values: vec![0.25, -3.5, 1e-9] }),
        Content::Status(ContentStatus {
            code: StatusCode::HARDWARE,
            subcode: -6,
            name: "Fault".to_owned(),
            text: "The rig sent nothing".to_owned(),
        }),
        Content::Text(TextContent::of("{\"t_s\": 1.5}")),
        Content::Text(TextContent::of("5 µm")),
        Content::Image(image),
        Content::Capability(vec!["TDATA".to_owned(), "STT_TDATA".to_owned()]),
        Content::Request(Verb::Start, ContentKind::Tracking, Some(stream)),
        Content::Request(Verb::Start, ContentKind::Image, None),
        Content::Request(Verb::Get, ContentKind::Transform, None),
        Content::Request(Verb::Stop, ContentKind::Turned, None),
        Content::Request(Verb::Get, ContentKind::Capability, None),
        Content::Answer(ContentKind::Tracking, 1),
        Content::Other("POLYDATA".to_owned()),
    ];
    contents.into_iter().map(|content| IgtlMessage::new("right.tip", 1_764_123_456_123_456_789, content)).collect()
}

#[test]
fn every_kind_of_message_comes_back() {
    for message in every_kind() {
        let wire = message.encode();
        assert_eq!(read(&wire), Ok(message.clone()), "{message:?}");
        assert!(message.content.kind().len() <= 12, "{}", message.content.kind());
    }
    let sizes = [48, 28, 12, 0, 4 * 70, 50, 10 + 8 * 3];
    assert!(every_kind().iter().zip(sizes).all(|(message, size)| message.encode().len() == IgtlHeader::BYTES + size));
}

#[test]
fn a_message_of_version_3_is_read_without_its_metadata() {
    let content = &every_kind()[6].encode()[IgtlHeader::BYTES..];
    // Length of the extended header; of the list of metadata; of their text; number of the message.
    let body = |extended: u16, index: u16, values: u32, rest: &[u8]| {
        let mut body = [extended.to_be_bytes(), index.to_be_bytes()].concat();
        body.extend(values.to_be_bytes());
        body.extend([0, 0, 0, 7]);
        body.extend(content);
        body.extend(rest);
        framed("SENSOR", 2, &body)
    };
    let list = [&[0, 1, 0, 2, 0, 3, 0, 0, 0, 3][..], b"ab123"].concat();
    for good in [body(12, 0, 0, &[]), body(12, 2, 0, &[0, 0]), body(12, 10, 5, &list)] {
        assert_eq!(read(&good).unwrap().content, every_kind()[6].content);
    }
    for bad in [
        body(11, 0, 0, &[]),
        body(4000, 0, 0, &[]),
        body(12, 10, 5, &list[..12]),
        body(12, 2, 5, &list),
        body(12, u16::MAX, 0, &list),
        body(12, 2, u32::MAX, &list),
        body(12, 10, 4, &list),
    ] {
        assert!(read(&bad).is_err());
    }
}

#[test]
fn what_does_not_fit_its_own_counts_is_refused() {
    let sensor = |count: u8, values: usize| [vec![count, 0], vec![0; 8 * (values + 1)]].concat();
    let text = |length: u16, bytes: usize| [&[0, 3][..], &length.to_be_bytes(), &vec![b'a'; bytes]].concat();
    let image = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut body = every_kind()[10].encode().split_off(IgtlHeader::BYTES);
        change(&mut body);
        body
    };
    for (kind, body) in [
        ("TRANSFORM", vec![0; 47]),
        ("TRANSFORM", vec![0; 49]),
        ("POSITION", vec![0; 20]),
        ("POSITION", vec![0; 32]),
        ("TDATA", vec![0; 71]),
        ("TDATA", vec![0; 70]),
        ("QTDATA", vec![0; 51]),
        ("SENSOR", sensor(3, 2)),
        ("SENSOR", sensor(2, 3)),
        ("SENSOR", vec![0]),
        ("STRING", text(5, 4)),
        ("STRING", text(u16::MAX, 4)),
        ("STATUS", vec![0; 29]),
        ("CAPABILITY", vec![b'A'; 13]),
        ("STT_TDATA", vec![0; 8]),
        ("RTS_TDATA", vec![]),
        ("IMAGE", vec![]),
        ("IMAGE", image(&|body| body.truncate(body.len() - 1))),
        ("IMAGE", image(&|body| body[3] = 11)),
        ("IMAGE", image(&|body| body[6..12].fill(0xFF))),
        ("IMAGE", image(&|body| body[60] = 1)),
    ] {
        assert!(read(&framed(kind, 1, &body)).is_err(), "{kind} of {} bytes", body.len());
    }
}

#[test]
fn damage_is_noticed() {
    let good = every_kind()[0].encode();
    for (place, change) in
        [(0, 9), (1, 0), (1, 3), (IgtlHeader::BYTES, 1), (IgtlHeader::BYTES - 1, 0), (IgtlHeader::BYTES - 9, 7)]
    {
        let mut bad = good.clone();
        bad[place] = change;
        assert!(read(&bad).is_err(), "byte {place}");
    }
    assert_eq!(read(&good[..good.len() - 1]), Err(IgtlFormatError::Short));
    assert_eq!(read(&good[..57]), Err(IgtlFormatError::Short));
    // An impossible length.
    let mut huge = good[..IgtlHeader::BYTES].to_vec();
    huge[IgtlHeader::BYTES - 16..IgtlHeader::BYTES - 8].fill(0xFF);
    let header = IgtlHeader::read(&huge).unwrap();
    assert_eq!(header.body_bytes, u64::MAX);
    assert_eq!(IgtlMessage::read(&header, &good[IgtlHeader::BYTES..]), Err(IgtlFormatError::Short));
}

#[test]
fn names_that_are_too_long_are_cut_between_characters() {
    let message = IgtlMessage::new("nineteen charactersä", 0, Content::Text(TextContent::of("x")));
    assert_eq!(read(&message.encode()).unwrap().device, "nineteen characters");
    let long = Content::Text(TextContent::of(&"ä".repeat(40_000)));
    let Content::Text(text) = read(&IgtlMessage::new("", 0, long).encode()).unwrap().content else { panic!() };
    assert_eq!((text.bytes.len(), text.encoding), (65_534, 106));
}

/// Random bytes, and damaged messages with a matching checksum: every parsed message can be written and reads the same.
fn attack(rounds: u32, seed: u64) {
    let mut random = fastrand::Rng::with_seed(seed);
    let good: Vec<Vec<u8>> =
        every_kind().iter().map(IgtlMessage::encode).chain(fixtures::ALL.iter().map(|(_, hex)| bytes(hex))).collect();
    for _ in 0..rounds {
        let mut wire = good[random.usize(..good.len())].clone();
        for _ in 0..random.usize(..6) {
            let place = random.usize(..wire.len());
            match random.u8(..4) {
                0 => wire[place] = random.u8(..),
                1 => wire.truncate(place.max(IgtlHeader::BYTES)),
                2 => wire.extend(std::iter::repeat_n(random.u8(..), random.usize(..100))),
                _ => wire[place] ^= 1 << random.u8(..8),
            }
        }
        let body = wire.split_off(IgtlHeader::BYTES);
        let Ok(header) = IgtlHeader::read(&wire) else { continue };
        let header = IgtlHeader { body_bytes: body.len() as u64, crc: CRC.checksum(&body), ..header };
        let Ok(message) = IgtlMessage::read(&header, &body) else { continue };
        let again = read(&message.encode()).unwrap();
        // NaN is not equal to itself; the bytes are.
        assert_eq!(again.encode(), message.encode(), "NIMA_FUZZ_SEED={seed}");
    }
}

#[test]
fn nothing_that_comes_makes_the_codec_fail() {
    attack(20_000, 1);
}

#[test]
#[ignore = "random loops"]
fn fuzz_openigtlink() {
    nima_testing::fuzz::rounds(|seed| attack(20_000, seed));
}
