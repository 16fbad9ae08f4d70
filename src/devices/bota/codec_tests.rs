use super::*;

fn bytes_of(hex: &str) -> Vec<u8> {
    let digits: Vec<u8> = hex.bytes().filter(|byte| !byte.is_ascii_whitespace()).collect();
    digits.chunks(2).map(|pair| u8::from_str_radix(std::str::from_utf8(pair).unwrap(), 16).unwrap()).collect()
}

/// Returns the examples of the reference, section 1.1.
fn golden() -> [(BotaFrame, Vec<u8>); 2] {
    let wrench = BotaFrame {
        status: 0,
        force_n: [1.0, -2.0, 3.5],
        torque_nm: [0.125, -0.25, 0.5],
        timestamp_us: 1_000_000,
        temperature_c: 25.5,
        inertial: None,
    };
    let inertial = Inertial { acceleration_m_s2: [0.25, -0.5, -9.75], angular_velocity_rad_s: [0.0625, -0.125, 0.5] };
    let with = BotaFrame { status: 2, timestamp_us: u32::MAX, inertial: Some(inertial), ..wrench };
    [
        (wrench, bytes_of("aa 0000 0000803f 000000c0 00006040 0000003e 000080be 0000003f 40420f00 0000cc41 3447")),
        (
            with,
            bytes_of(
                "ab 0200 0000803f 000000c0 00006040 0000003e 000080be 0000003f ffffffff 0000cc41 0000803e 000000bf \
                 00001cc1 0000803d 000000be 0000003f 6475",
            ),
        ),
    ]
}

fn random_frame(random: &mut fastrand::Rng) -> BotaFrame {
    let mut three = || [(); 3].map(|()| (random.f32() - 0.5) * 200.0);
    let force_n = three();
    let torque_nm = three();
    let inertial = Inertial { acceleration_m_s2: three(), angular_velocity_rad_s: three() };
    BotaFrame {
        status: random.u16(..) & STATUS_BITS,
        force_n,
        torque_nm,
        timestamp_us: random.u32(..),
        temperature_c: random.f32() * 60.0,
        inertial: random.bool().then_some(inertial),
    }
}

fn encoded(frame: &BotaFrame) -> Vec<u8> {
    let mut buffer = [0; INERTIAL_BYTES];
    let length = frame.encode(&mut buffer);
    buffer[..length].to_vec()
}

/// Decodes a stream that arrives in pieces of random length.
fn decoded(decoder: &mut BotaDecoder, mut stream: &[u8], random: &mut fastrand::Rng) -> Vec<BotaFrame> {
    let mut frames = Vec::new();
    while !stream.is_empty() {
        let room = decoder.room();
        let count = random.usize(1..=stream.len().min(room.len()).min(100));
        room[..count].copy_from_slice(&stream[..count]);
        decoder.filled(count);
        stream = &stream[count..];
        while let Some(frame) = decoder.next() {
            frames.push(frame);
        }
    }
    frames
}

#[test]
fn golden_frames_are_written_and_read() {
    for (frame, bytes) in golden() {
        assert_eq!(encoded(&frame), bytes);
        assert_eq!(BotaFrame::decode(&bytes), Ok(frame));
    }
}

#[test]
fn a_frame_comes_back_as_it_was_sent() {
    let mut random = fastrand::Rng::with_seed(1);
    for _ in 0..10_000 {
        let frame = random_frame(&mut random);
        assert_eq!(BotaFrame::decode(&encoded(&frame)), Ok(frame));
    }
}

#[test]
fn every_single_damaged_bit_is_found() {
    for (_, bytes) in golden() {
        for bit in 0..bytes.len() * 8 {
            let mut damaged = bytes.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert!(BotaFrame::decode(&damaged).is_err(), "bit {bit}");
        }
        assert_eq!(BotaFrame::decode(&bytes[..bytes.len() - 1]), Err(NoFrame::Shape));
        assert_eq!(BotaFrame::decode(&[bytes.as_slice(), &[0]].concat()), Err(NoFrame::Shape));
    }
}

#[test]
fn a_clean_stream_is_read_whole_in_pieces_of_any_length() {
    let mut random = fastrand::Rng::with_seed(2);
    let sent: Vec<BotaFrame> = (0..5000).map(|_| random_frame(&mut random)).collect();
    let stream: Vec<u8> = sent.iter().flat_map(encoded).collect();
    let mut decoder = BotaDecoder::default();
    assert_eq!(decoded(&mut decoder, &stream, &mut random), sent);
    assert_eq!((decoder.damaged(), decoder.skipped()), (0, 0));
}

#[test]
fn damaged_frames_are_counted_one_by_one_and_the_others_kept() {
    let mut random = fastrand::Rng::with_seed(3);
    let mut kept = Vec::new();
    let mut stream = Vec::new();
    let mut damaged = 0;
    for _ in 0..5000 {
        let frame = BotaFrame { inertial: None, ..random_frame(&mut random) };
        let mut bytes = encoded(&frame);
        if random.u8(..) < 40 {
            *bytes.last_mut().unwrap() ^= 0x55;
            damaged += 1;
        } else {
            kept.push(frame);
        }
        stream.extend(bytes);
    }
    // A false header near the end makes the decoder wait for more bytes.
    let last = BotaFrame::default();
    stream.extend([encoded(&last), encoded(&last), encoded(&last)].concat());
    let mut decoder = BotaDecoder::default();
    let found = decoded(&mut decoder, &stream, &mut random);
    assert_eq!(found[..kept.len()], kept[..]);
    assert_eq!(decoder.skipped(), damaged * WRENCH_BYTES as u64);
    assert_eq!(decoder.damaged(), damaged);
}

#[test]
fn a_payload_full_of_headers_is_not_locked_onto() {
    let word = f32::from_le_bytes([HEADER_WRENCH; 4]);
    let full = BotaFrame { force_n: [word; 3], torque_nm: [word; 3], ..BotaFrame::default() };
    for skip in 1..WRENCH_BYTES {
        let stream: Vec<u8> =
            (0..50).flat_map(|k| encoded(&BotaFrame { timestamp_us: k, ..full })).skip(skip).collect();
        let found = decoded(&mut BotaDecoder::default(), &stream, &mut fastrand::Rng::with_seed(5));
        assert_eq!(found.len(), 49, "joined {skip} bytes late");
        assert!(found.iter().zip(1..).all(|(frame, k)| frame.timestamp_us == k));
    }
}

/// Random bytes, damaged frames, and good ones in between: no panic, bounded work, and no frame that was not sent.
fn fuzz(rounds: u64, seed: u64) {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut decoder = BotaDecoder::default();
    let mut sent = 0_u64;
    let mut found = 0_u64;
    let mut fed = 0_u64;
    for round in 0..rounds {
        let mut bytes = if random.u8(..) < 128 {
            sent += 1;
            let mut bytes = encoded(&random_frame(&mut random));
            let at = random.usize(..bytes.len());
            if random.bool() {
                bytes[at] ^= random.u8(1..);
                sent -= 1;
            }
            bytes
        } else {
            (0..random.usize(..70)).map(|_| random.u8(..)).collect()
        };
        if random.u8(..) < 30 {
            bytes.insert(0, [HEADER_WRENCH, HEADER_INERTIAL][usize::from(random.bool())]);
        }
        BotaFrame::decode(&bytes).ok();
        fed += bytes.len() as u64;
        let room = decoder.room();
        assert!(room.len() >= bytes.len(), "what is held stays short");
        room[..bytes.len()].copy_from_slice(&bytes);
        decoder.filled(bytes.len());
        while decoder.next().is_some() {
            found += 1;
        }
        if round % 1000 == 999 {
            decoder.clear();
        }
    }
    assert!(decoder.skipped() <= fed);
    // With a 16-bit checksum, one false header in 65536 passes; it may hide a frame or look like one.
    let off = found.abs_diff(sent) as f64 / sent as f64;
    assert!(off < 2e-3, "{found} frames found of {sent} sent among {fed} bytes");
}

#[test]
fn a_dirty_stream_gives_the_good_frames() {
    fuzz(200_000, 11);
}

#[test]
#[ignore = "`./dev fuzz` runs it for as long as told"]
fn fuzz_stream() {
    nima_testing::fuzz::rounds(|seed| fuzz(1_000_000, seed));
}
