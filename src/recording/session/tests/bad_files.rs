//! Files that are cut, damaged, of another format or invented.

use std::fs;

use super::*;

/// Returns a small finished session with every kind of record.
fn small() -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    let mut writer = SessionWriter::create(&path, "nima test").unwrap();
    let channels = [writer.channel("a", json("A")).unwrap(), writer.channel("b", plain_text()).unwrap()];
    writer.metadata("session", &values()).unwrap();
    writer.attachment("rig.toml", "text/plain", 5, b"mode = \"best\"").unwrap();
    for tick in 0..30_u64 {
        writer
            .message(channels[tick as usize % 2], tick * 100_000_000, format!("{{\"tick\": {tick}}}").as_bytes())
            .unwrap();
    }
    writer.finish().unwrap();
    fs::read(path).unwrap()
}

/// Returns the same without chunks, summary and index, as other programs write it.
fn of_others() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let options = mcap::WriteOptions::new().compression(None).use_chunks(false).emit_summary_records(false);
    let mut writer = options.create(&mut bytes).unwrap();
    let channel = writer.add_channel(0, "a", "text", &BTreeMap::new()).unwrap();
    for time in 0..10 {
        let header =
            mcap::records::MessageHeader { channel_id: channel, sequence: 0, log_time: time, publish_time: time };
        writer.write_to_known_channel(&header, b"word").unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    bytes.into_inner()
}

#[test]
fn what_is_no_session_gets_one_clear_line() {
    let read = |bytes: &[u8]| SessionReader::of_bytes("x.mcap", bytes.to_vec()).err().map(|error| error.to_string());
    let whole = small();
    let mut newer = whole.clone();
    newer[5] = b'1';
    let cases: [(&[u8], &str); 6] = [
        (b"", "session x.mcap is empty: nothing was recorded"),
        (&whole[..5], "ends within its first bytes"),
        (&whole[..20], "damaged at byte 8: there is no header"),
        (b"t_s,x_m\n0.0,0.1\n", "x.mcap is not a session"),
        (b"\x89PNG\r\n\x1a\n", "x.mcap is not a session"),
        (&newer, "version 1 of the MCAP format, but only version 0 can be read"),
    ];
    for (bytes, words) in cases {
        let line = read(bytes).expect(words);
        assert!(line.contains(words) && !line.contains('\n'), "{words}: {line}");
    }
    let folder = tempfile::tempdir().unwrap();
    let none = folder.path().join("none");
    let report = std::fs::File::open(&none).unwrap_err().to_string();
    for (path, words) in [(none, report.as_str()), (folder.path().to_owned(), "a folder")] {
        let line = SessionReader::open(&path).err().unwrap().to_string();
        assert!(line.contains(words) && !line.contains('\n'), "{line}");
    }
}

#[test]
fn a_file_that_is_cut_anywhere_is_read_up_to_there() {
    let whole = small();
    let all = ours(&SessionReader::of_bytes("whole", whole.clone()).unwrap());
    assert_eq!(all.len(), 30);
    let mut max = 0;
    for length in 60..whole.len() {
        let reader = SessionReader::of_bytes("cut", whole[..length].to_vec()).unwrap();
        let read = ours(&reader);
        assert!(reader.notes()[0].starts_with("it is truncated: scanned all records"), "{:?}", reader.notes());
        assert!(read[..] == all[..read.len()] && read.len() >= max, "cut at {length}");
        max = read.len();
    }
    assert_eq!(max, 30);
}

#[test]
fn a_file_of_others_without_chunks_and_summary_is_read() {
    let reader = SessionReader::of_bytes("others", of_others()).unwrap();
    assert_eq!(reader.notes(), ["it has no summary: scanned all records instead"]);
    let read = ours(&reader);
    assert_eq!(read.len(), 10);
    assert_eq!(read[7], ("a".to_owned(), 7, b"word".to_vec()));
}

#[test]
fn every_flipped_bit_of_a_chunk_is_found_and_the_rest_is_read() {
    let whole = small();
    let reader = SessionReader::of_bytes("whole", whole.clone()).unwrap();
    let all = ours(&reader);
    let places: Vec<(u64, u64)> = reader.chunk_places().collect();
    let mut named = 0;
    let mut seen = 0;
    for (at, length) in places {
        for byte in at..at + length {
            let mut bytes = whole.clone();
            bytes[byte as usize] ^= 1 << (byte % 8);
            let reader = SessionReader::of_bytes("flipped", bytes).unwrap();
            let read: Vec<_> = reader.messages(&[], 0..u64::MAX).collect();
            let errors: Vec<_> = read.iter().filter_map(|one| one.as_ref().err()).map(ToString::to_string).collect();
            seen += 1;
            if let [error] = &errors[..] {
                assert!(error.contains(&format!("damaged at byte {at}: the chunk from")), "{error}");
                assert!(read.len() >= 25, "the other chunks are read");
                named += 1;
            } else {
                // Flags of the LZ4 frame do not affect the messages.
                assert!(errors.is_empty() && ours(&reader) == all, "byte {} of the chunk at {at}", byte - at);
            }
        }
    }
    println!("{named} of {seen} flipped bits were named");
    assert!(named * 100 > seen * 98);
}

#[test]
fn flipped_bits_in_what_is_beside_the_messages_are_found() {
    let whole = small();
    let flipped = |needle: &[u8], nth: usize| {
        let mut bytes = whole.clone();
        let found = bytes.windows(needle.len()).enumerate().filter(|(_, window)| *window == needle).nth(nth).unwrap().0;
        bytes[found] ^= 2;
        SessionReader::of_bytes("flipped", bytes).unwrap()
    };
    let reader = flipped(b"mode =", 0);
    let error = reader.attachment(&reader.attachments()[0]).unwrap_err().to_string();
    assert!(error.contains("attachment rig.toml"), "{error}");
    let reader = flipped(b"rig.toml", 1);
    assert!(reader.notes()[0].starts_with("its summary is damaged: "), "{:?}", reader.notes());
    assert_eq!(ours(&reader).len(), 30);
}

#[test]
fn what_claims_to_be_huge_takes_no_memory() {
    let whole = small();
    let reader = SessionReader::of_bytes("whole", whole.clone()).unwrap();
    let (at, _) = reader.chunk_places().next().unwrap();
    for claimed in [u64::MAX, 1 << 40, 100_000] {
        let mut bytes = whole.clone();
        // The uncompressed length follows the two times.
        bytes[at as usize + 9 + 16..][..8].copy_from_slice(&claimed.to_le_bytes());
        let reader = SessionReader::of_bytes("huge", bytes).unwrap();
        let error = reader.messages(&[], 0..u64::MAX).find_map(Result::err).unwrap().to_string();
        assert!(error.contains("longer than it can be") || error.contains("the length that it states"), "{error}");
    }
}

#[test]
fn a_chunk_that_is_named_twice_is_read_once() {
    let whole = small();
    // Store the index of the first chunk instead of that of the second.
    let mut indexes = Vec::new();
    let mut at = 8;
    while let Some((head, _)) = whole[at..].split_first_chunk::<9>() {
        let length = 9 + u64::from_le_bytes(head[1..].try_into().unwrap()) as usize;
        if head[0] == format::kind::CHUNK_INDEX {
            indexes.push(at..at + length);
        }
        if head[0] == format::kind::FOOTER {
            break;
        }
        at += length;
    }
    let mut bytes = whole.clone();
    let first = whole[indexes[1].clone()].to_vec();
    bytes[indexes[2].clone()].copy_from_slice(&first);
    let checksum = bytes.len() - 12;
    bytes[checksum..checksum + 4].fill(0);
    let reader = SessionReader::of_bytes("twice", bytes).unwrap();
    assert!(reader.notes()[0].starts_with("its summary is damaged"), "{:?}", reader.notes());
    assert_eq!(ours(&reader).len(), 30);
}

/// Calls every function of a reader.
fn ask(bytes: Vec<u8>) -> usize {
    let size = bytes.len() as u64;
    let Ok(reader) = SessionReader::of_bytes("mutated", bytes) else { return 0 };
    for attachment in reader.attachments() {
        if let Ok(data) = reader.attachment(attachment) {
            assert!(data.len() as u64 <= size);
        }
    }
    let _ = reader.metadata();
    assert!(reader.notes().iter().all(|line| !line.contains('\n')));
    reader.messages(&["a"], 0..1 << 40).count() + reader.messages(&[], 0..u64::MAX).flatten().count()
}

fn mutated(original: &[u8], random: &mut fastrand::Rng) -> Vec<u8> {
    let mut bytes = original.to_vec();
    for _ in 0..random.usize(1..6) {
        let at = random.usize(..bytes.len());
        match random.u8(..8) {
            0 => bytes.truncate(at.max(1)),
            1 => bytes[at] = [0, 1, 0x7f, 0x80, 0xff][random.usize(..5)],
            2 => bytes[at] ^= 1 << random.u8(..8),
            // Corrupt a length or a position.
            3 => {
                let value =
                    if random.bool() { random.u64(..2 * original.len() as u64) } else { u64::MAX - random.u64(..64) };
                let end = (at + 8).min(bytes.len());
                bytes[at..end].copy_from_slice(&value.to_le_bytes()[..end - at]);
            }
            4 => {
                let end = random.usize(at..=bytes.len().min(at + 100));
                let part = bytes[at..end].to_vec();
                let to = random.usize(..bytes.len());
                bytes.splice(to..to, part);
            }
            5 => drop(bytes.drain(at..(at + random.usize(..50)).min(bytes.len()))),
            6 => bytes[at] = random.u8(..16),
            _ => bytes[at] = random.u8(..),
        }
        if bytes.is_empty() {
            break;
        }
    }
    bytes
}

fn fuzz(rounds: u64, seed: u64) {
    let mut random = fastrand::Rng::with_seed(seed);
    let originals = [small(), of_others()];
    let read: usize = (0..rounds).map(|round| ask(mutated(&originals[round as usize % 2], &mut random))).sum();
    assert!(read > rounds as usize, "too few mutated files are readable: {read} of {rounds}");
}

#[test]
fn mutated_files_are_read_or_refused() {
    fuzz(5_000, 0x5e55_1011);
}

#[test]
#[ignore = "`./dev fuzz` runs it for as long as told"]
fn fuzz_sessions() {
    nima_testing::fuzz::rounds(|seed| fuzz(20_000, seed));
}
