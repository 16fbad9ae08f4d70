//! Known bytes of the reference, encoded and decoded; round trips; and invalid bytes.

use super::*;
use crate::ndi::crc::write_hex;

/// `BX` example of the reference: handle 0A valid, frame 7.
const BLOCK: &str =
    "c4a52d003043010a010000803f0000000000000000000000000000c03f000020c000007ac40000803e3100000007000000000047ee";
/// `TX` example of the reference, the same tool.
const TEXT: &[u8] = b"010A+10000+00000+00000+00000+000150-000250-100000+025000000003100000007\n0000D46A\r";
const OPTIONS: u16 = TRANSFORMS | OUTSIDE_TOO;

fn bytes_of(hex: &str) -> Vec<u8> {
    hex.as_bytes().chunks(2).map(|pair| super::crc::read_hex(pair).unwrap() as u8).collect()
}

fn example() -> TrackingReply {
    let at = Transform { quaternion: [1.0, 0.0, 0.0, 0.0], translation_mm: [1.5, -2.5, -1000.0], error_mm: 0.25 };
    let one = HandleFrame { handle: 0x0A, sight: ToolVisibility::Valid(at), status: PortStatus(0x31), frame: 7 };
    TrackingReply::new(&[one], SystemStatus(0))
}

fn arrivals(bytes: &[u8], expected: ExpectedReply) -> Vec<Vec<u8>> {
    let mut inbox = Inbox::new();
    let mut whole = Vec::new();
    for piece in bytes.chunks(7) {
        inbox.room()[..piece.len()].copy_from_slice(piece);
        inbox.filled(piece.len());
        while let Some(arrival) = inbox.next(expected) {
            match arrival {
                NdiArrival::Line(text) | NdiArrival::Block(text) => whole.push(text.to_vec()),
                NdiArrival::Damaged => whole.push(b"damaged".to_vec()),
            }
        }
    }
    whole
}

#[test]
fn the_published_tracking_replies_are_read_and_written_byte_by_byte() {
    let block = bytes_of(BLOCK);
    let bodies = arrivals(&block, ExpectedReply::Block);
    assert_eq!(bodies.len(), 1);
    assert_eq!(TrackingReply::of_block(&bodies[0], OPTIONS), Ok(example()));
    let mut body = Vec::new();
    example().write_block(OPTIONS, &mut body);
    assert_eq!(block_of(&body), block);

    let texts = arrivals(TEXT, ExpectedReply::Line);
    assert_eq!(TrackingReply::of_text(&texts[0], OPTIONS), Ok(example()));
    let mut text = Vec::new();
    example().write_text(OPTIONS, &mut text);
    finish_line(&mut text);
    assert_eq!(text, TEXT);
}

#[test]
fn missing_disabled_and_unoccupied_handles_are_read() {
    let text = b"040AMISSING0000007100000007\n0BDISABLED\n0CUNOCCUPIED\n0DDISABLED0000000100000007\n0040";
    let frames = TrackingReply::of_text(text, OPTIONS).unwrap();
    let report: Vec<_> = frames.handles().iter().map(|one| (one.handle, one.sight, one.status.0)).collect();
    assert_eq!(
        report,
        [
            (0x0A, ToolVisibility::Missing, 0x71),
            (0x0B, ToolVisibility::Disabled, 0),
            (0x0D, ToolVisibility::Disabled, 0)
        ]
    );
    assert_eq!(frames.system.0, SystemStatus::TOOL_CAME);

    let body = bytes_of("030a0271000000070000000b040c0231000000070000004000");
    let frames = TrackingReply::of_block(&body, OPTIONS).unwrap();
    assert_eq!(frames.handles().len(), 3);
    assert!(frames.handles()[0].status.has(PortStatus::OUT_OF_VOLUME));
    assert_eq!((frames.handles()[1].sight, frames.handles()[2].frame), (ToolVisibility::Disabled, 7));
}

#[test]
fn strays_are_skipped() {
    let mut body = bytes_of("00");
    body.push(9);
    body.extend_from_slice(&[0; 2 + 9 * 12]);
    body.extend_from_slice(&[8, 0]);
    assert_eq!(TrackingReply::of_block(&body, OPTIONS | STRAYS).unwrap().system.0, 8);
    let text = [b"0005".as_slice(), b"00", &[b'0'; 5 * 21], b"0008"].concat();
    assert_eq!(TrackingReply::of_text(&text, OPTIONS | STRAYS).unwrap().system.0, 8);
}

fn random_frames(random: &mut fastrand::Rng) -> TrackingReply {
    let handles: Vec<_> = (0..random.usize(..=6))
        .map(|k| {
            let mut part = |scale: f64, limit: i32| f64::from(random.i32(-limit..=limit)) / scale;
            let quaternion = std::array::from_fn(|_| part(1e4, 10_000));
            let translation_mm = std::array::from_fn(|_| part(1e2, 999_999));
            let at = Transform { quaternion, translation_mm, error_mm: part(1e4, 99_999) };
            let sight =
                [ToolVisibility::Valid(at), ToolVisibility::Missing, ToolVisibility::Disabled][random.usize(..3)];
            let disabled = sight == ToolVisibility::Disabled;
            let (status, frame) = if disabled { (0, 0) } else { (random.u32(..), random.u32(..)) };
            HandleFrame { handle: 10 + k as u8, sight, status: PortStatus(status), frame }
        })
        .collect();
    TrackingReply::new(&handles, SystemStatus(random.u16(..)))
}

#[test]
fn every_tracking_reply_comes_back_as_it_was_sent() {
    let mut random = fastrand::Rng::with_seed(1);
    for _ in 0..5000 {
        let frames = random_frames(&mut random);
        let options = OPTIONS | if random.bool() { STRAYS } else { 0 };
        let mut text = Vec::new();
        frames.write_text(options, &mut text);
        assert_eq!(TrackingReply::of_text(&text, options), Ok(frames));
        let mut body = Vec::new();
        frames.write_block(options, &mut body);
        let back = TrackingReply::of_block(&body, options).unwrap();
        let mut again = Vec::new();
        back.write_block(options, &mut again);
        assert_eq!(body, again, "floats of 32 bits come back exactly");
        assert_eq!(back.handles().len(), frames.handles().len());
    }
}

fn every_command() -> Vec<NdiCommand<'static>> {
    let mut data = [0; CHUNK];
    data.iter_mut().enumerate().for_each(|(k, byte)| *byte = (k * 37) as u8);
    let mut commands = vec![
        NdiCommand::Init,
        NdiCommand::Reset,
        NdiCommand::ApiRevision,
        NdiCommand::Version(0),
        NdiCommand::GetInfo("Features.Firmware.Version"),
        NdiCommand::Get("Info.Timeout.PINIT"),
        NdiCommand::Set("Param.X=1"),
        NdiCommand::Echo("hello, unit"),
        NdiCommand::Beep(9),
        NdiCommand::Request(WIRELESS),
        NdiCommand::Write { handle: 0xAB, address: 0x03C0, data },
        NdiCommand::Initialise(10),
        NdiCommand::Enable(10, NdiPriority::Static),
        NdiCommand::Enable(10, NdiPriority::Dynamic),
        NdiCommand::Enable(10, NdiPriority::Buttons),
        NdiCommand::Disable(10),
        NdiCommand::Free(255),
        NdiCommand::Information { handle: 1, options: 0x7F },
        NdiCommand::Start { anew: false },
        NdiCommand::Start { anew: true },
        NdiCommand::Stop,
        NdiCommand::Track(ReplyForm::Text, OPTIONS),
        NdiCommand::Track(ReplyForm::Binary, OPTIONS | STRAYS),
    ];
    commands.extend(
        [Filter::All, Filter::ToFree, Filter::ToInitialise, Filter::ToEnable, Filter::Enabled].map(NdiCommand::Handles),
    );
    let speeds = [9600, 14_400, 19_200, 38_400, 57_600, 115_200, 921_600, 1_228_739, 230_400];
    commands.extend(speeds.map(|baud| NdiCommand::Comm { baud }));
    commands
}

#[test]
fn every_command_is_understood_in_both_forms() {
    for command in every_command() {
        for line in [command.encode(), command.encode_unchecked()] {
            let text = line.as_bytes().strip_suffix(b"\r").unwrap();
            assert_eq!(NdiCommand::parse(text), Ok(command), "{}", String::from_utf8_lossy(text));
        }
    }
    assert_eq!(NdiCommand::Init.encode().as_bytes(), b"INIT:E3A5\r");
    assert_eq!(NdiCommand::Track(ReplyForm::Binary, 0x0801).encode().as_bytes(), b"BX:080100EC\r");
    assert_eq!(NdiCommand::Comm { baud: 115_200 }.encode().as_bytes(), b"COMM:500000048\r");
    assert_eq!(NdiCommand::Handles(Filter::ToFree).encode().as_bytes(), b"PHSR:01E03E\r");
    assert_eq!(NdiCommand::parse(b"TX"), Ok(NdiCommand::Track(ReplyForm::Text, TRANSFORMS)));
}

#[test]
fn what_is_no_command_is_refused_with_the_code_for_it() {
    for (line, code) in [
        (&b"NONSENSE "[..], ErrorCode::INVALID_COMMAND),
        (b"", ErrorCode::INVALID_COMMAND),
        (b"init:", ErrorCode::INVALID_COMMAND),
        (b"INIT:", ErrorCode::TOO_SHORT),
        (b"INIT:E3A6", ErrorCode::BAD_CRC),
        (b"PINIT ", ErrorCode::PARAMETER_COUNT),
        (b"PINIT 0X", ErrorCode::OUT_OF_RANGE),
        (b"PENA 0AQ", ErrorCode::INVALID_PRIORITY),
        (b"PHSR 09", ErrorCode::OUT_OF_RANGE),
        (b"COMM 90000", ErrorCode::COMM_PARAMETERS),
        (b"PVWR 0A0000", ErrorCode::PARAMETER_COUNT),
        (b"BEEP 0", ErrorCode::OUT_OF_RANGE),
    ] {
        assert_eq!(NdiCommand::parse(line), Err(code), "{}", String::from_utf8_lossy(line));
    }
}

#[test]
fn replies_are_found_again_in_dirt() {
    let block = bytes_of(BLOCK);
    let mut spoilt = block.clone();
    spoilt[20] ^= 1;
    let dirt = [&b"\xC4\xA5\xFF\xFF\x00\x00ER"[..], &block, b"\xC4", &spoilt, &block, b"ERROR0C4E42\r", b"RESETBE6F\r"]
        .concat();
    let found = arrivals(&dirt, ExpectedReply::Block);
    let kinds: Vec<_> = found.iter().map(|one| &one[..one.len().min(7)]).collect();
    let body = &block[6..13];
    assert_eq!(kinds, [body, b"damaged", body, b"ERROR0C", b"RESET"]);
    assert_eq!(arrivals(b"xx\rOKAYA896\rOKAYA897\rOKAY", ExpectedReply::Line), [&b"damaged"[..], b"OKAY", b"damaged"]);
}

#[test]
fn a_flood_without_an_end_is_thrown_away() {
    for expected in [ExpectedReply::Line, ExpectedReply::Block] {
        let mut inbox = Inbox::new();
        for _ in 0..10 {
            let room = inbox.room();
            let count = room.len();
            assert!(count > 0);
            room.fill(b'x');
            inbox.filled(count);
            assert_eq!(inbox.next(expected), None);
        }
        inbox.clear();
        assert_eq!(inbox.take_skipped(), 10 * REPLY_MAX as u64);
    }
}

/// Changes a reply or command, or leaves it intact, or replaces it by random bytes.
fn mutated(random: &mut fastrand::Rng, bytes: &mut Vec<u8>) {
    for _ in 0..random.usize(..4) {
        match random.u8(..4) {
            0 if !bytes.is_empty() => {
                let place = random.usize(..bytes.len());
                bytes[place] = random.u8(..);
            }
            1 => bytes.truncate(random.usize(..=bytes.len())),
            2 => bytes.insert(random.usize(..=bytes.len()), random.u8(..)),
            _ => (0..random.usize(..12)).for_each(|_| bytes.push(random.u8(..))),
        }
    }
}

/// Feeds `count` random and altered frames to everything that parses bytes. Returns the number of valid ones.
fn fuzz(count: u32, seed: u64) -> u32 {
    let mut random = fastrand::Rng::with_seed(seed);
    let commands = every_command();
    let mut inbox = Inbox::new();
    let mut whole = 0;
    for _ in 0..count {
        let mut bytes = Vec::new();
        let options = OPTIONS | if random.bool() { STRAYS } else { 0 };
        match random.u8(..4) {
            0 => random_frames(&mut random).write_block(options, &mut bytes),
            1 => random_frames(&mut random).write_text(options, &mut bytes),
            2 => bytes.extend_from_slice(commands[random.usize(..commands.len())].encode().as_bytes()),
            _ => (0..random.usize(..80)).for_each(|_| bytes.push(random.u8(..))),
        }
        mutated(&mut random, &mut bytes);
        // Reply bodies go directly to the parsers, as after a correct checksum; lines and blocks also go through as a
        // stream.
        let read = [TrackingReply::of_block(&bytes, options), TrackingReply::of_text(&bytes, options)];
        whole += read.iter().flatten().count() as u32;
        NdiCommand::parse(&bytes).ok();
        identity_of(&String::from_utf8_lossy(&bytes));
        let mut wire = if random.bool() { block_of(&bytes) } else { [&bytes[..], b"\r"].concat() };
        mutated(&mut random, &mut wire);
        let room = inbox.room();
        let taken = wire.len().min(room.len());
        room[..taken].copy_from_slice(&wire[..taken]);
        inbox.filled(taken);
        let expected = if random.bool() { ExpectedReply::Line } else { ExpectedReply::Block };
        let mut turns = 0;
        while inbox.next(expected).is_some() {
            turns += 1;
            assert!(turns <= REPLY_MAX, "bounded");
        }
    }
    whole
}

#[test]
fn a_hundred_thousand_random_and_changed_frames_do_no_harm() {
    assert!(fuzz(100_000, 7) > 10_000, "some stay whole, so the parsers are reached");
}

#[test]
#[ignore = "`./dev fuzz` runs it for as long as told"]
fn fuzz_replies() {
    nima_testing::fuzz::rounds(|seed| assert!(fuzz(500_000, seed) > 50_000));
}

#[test]
fn hexadecimal_digits_are_cut_to_their_number() {
    let mut digits = [0; 2];
    write_hex(&mut digits, 0x123);
    assert_eq!(&digits, b"23");
}
