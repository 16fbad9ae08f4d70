//! Stops the process at every possible moment: between any two writes, and at every page within a write.

use std::cell::RefCell;

use super::*;

const PAGE: usize = 4096;
const CHUNKS: u64 = 80;

/// The bytes that a stopped process leaves behind, built from its writes.
struct Disk(Vec<u8>);

impl Disk {
    fn write(&mut self, at: u64, bytes: &[u8]) {
        let end = at as usize + bytes.len();
        if self.0.len() < end {
            self.0.resize(end, 0);
        }
        self.0[at as usize..end].copy_from_slice(bytes);
    }
}

/// Results of reading at all moments.
#[derive(Debug, Default)]
struct Moments {
    all: usize,
    /// Number of moments at which a sequential reader meets a complete end before the end of the file.
    early_end: usize,
}

/// Returns the writes of a session with every kind of change to the file: chunks, channels, attachments, growth.
fn script() -> Vec<(u64, Vec<u8>)> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    let mut writer = SessionWriter::create_growing_by(&path, "nima test", 256 << 10).unwrap();
    let mut random = fastrand::Rng::with_seed(6);
    let channel = writer.channel("a", json("Any")).unwrap();
    for chunk in 0..CHUNKS {
        match chunk {
            5 => writer.metadata("session", &values()).unwrap(),
            10 => writer.attachment("large", "text/plain", 0, &vec![b'x'; 100 << 10]).unwrap(),
            20 => writer.attachment("larger", "text/plain", 0, &vec![b'y'; 400 << 10]).unwrap(),
            30 => drop(writer.channel("b", json("Other")).unwrap()),
            _ => {}
        }
        let length = random.usize(10..15_000);
        let noise: Vec<u8> = std::iter::repeat_with(|| random.u8(..)).take(length).collect();
        writer.message(channel, chunk * 500_000_000, &noise).unwrap();
        writer.flush().unwrap();
    }
    writer.layout().log.clone()
}

/// Checks that the file is valid, and contains at least these messages and at most one chunk more.
fn check(disk: &Disk, before: usize, moments: &RefCell<Moments>) -> usize {
    let reader = SessionReader::of_bytes("torn", disk.0.clone()).unwrap();
    assert_eq!(reader.notes(), [""; 0]);
    let read = ours(&reader);
    assert!((before..=before + 1).contains(&read.len()), "{} after {before}", read.len());
    assert!(peer::indexed(&disk.0).unwrap() == read, "by the index");
    let mut moments = moments.borrow_mut();
    moments.all += 1;
    match peer::linear(&disk.0) {
        // A chunk may be in the data before it is in the index.
        Ok(linear) => assert!(linear.len() >= read.len() && linear[..read.len()] == read[..]),
        Err(error) => {
            assert!(error.to_string().contains("after end"), "{error}");
            moments.early_end += 1;
        }
    }
    read.len()
}

#[test]
fn a_file_is_valid_at_every_moment() {
    let moments = RefCell::new(Moments::default());
    let mut disk = Disk(Vec::new());
    let mut read = 0;
    let log = script();
    // The first writes lay out the file before it gets its name.
    let begin = log.iter().position(|(_, bytes)| bytes.ends_with(b"\x89MCAP0\r\n")).unwrap();
    for (number, (at, bytes)) in log.iter().enumerate() {
        // Large writes of one kind are cut only at a selection of pages.
        let pages = bytes.len() / PAGE;
        let cuts: Vec<usize> = match pages {
            0..6 => (1..=pages).collect(),
            _ => vec![1, pages / 2, pages],
        };
        for cut in cuts.into_iter().map(|page| page * PAGE - *at as usize % PAGE) {
            if number > begin && cut < bytes.len() {
                disk.write(*at, &bytes[..cut]);
                read = check(&disk, read, &moments);
            }
        }
        disk.write(*at, bytes);
        if number >= begin {
            read = check(&disk, read, &moments);
        }
    }
    assert_eq!(read, CHUNKS as usize);
    let Moments { all, early_end } = moments.into_inner();
    println!("{all} moments of {} writes; early end for who does not use the index: {early_end}", log.len());
    // These are the moments between writing a new footer and writing the head that points to it.
    assert!((2..=8).contains(&early_end), "{early_end} of {all}");
}

/// Returns the power loss: every page written since the last sync has any of its versions, and so has the length of the
/// file.
fn without_power(log: &[(u64, Vec<u8>)], synced: usize, end: usize, random: &mut fastrand::Rng) -> Vec<u8> {
    let mut disk = Disk(Vec::new());
    for (at, bytes) in &log[..synced] {
        disk.write(*at, bytes);
    }
    let mut sizes = vec![disk.0.len()];
    let mut last_version = std::collections::BTreeMap::new();
    let mut versions = disk;
    for (number, (at, bytes)) in log[synced..end].iter().enumerate() {
        let mut at = *at;
        let mut bytes = &bytes[..];
        while !bytes.is_empty() {
            let (part, rest) = bytes.split_at(bytes.len().min(PAGE - at as usize % PAGE));
            // Last write whose version of this page reached the disk.
            let reached = *last_version.entry(at / PAGE as u64).or_insert_with(|| random.usize(..=end - synced));
            if number < reached {
                versions.write(at, part);
            }
            sizes.push(sizes[sizes.len() - 1].max(at as usize + part.len()));
            at += part.len() as u64;
            bytes = rest;
        }
    }
    let size = sizes[random.usize(..sizes.len())];
    versions.0.resize(size, 0);
    versions.0
}

#[test]
fn after_a_power_failure_what_was_waited_for_is_read() {
    let log = script();
    let begin = log.iter().position(|(_, bytes)| bytes.ends_with(b"\x89MCAP0\r\n")).unwrap() + 1;
    let mut random = fastrand::Rng::with_seed(9);
    let mut sound = 0;
    let mut scanned = 0;
    let mut missing = 0;
    for _ in 0..600 {
        // Up to a second is not yet synced: two chunks, in eight writes or a few more.
        let synced = random.usize(begin..log.len() - 20);
        let end = synced + random.usize(1..20);
        let mut disk = Disk(Vec::new());
        log[..synced].iter().for_each(|(at, bytes)| disk.write(*at, bytes));
        let before = ours(&SessionReader::of_bytes("before", disk.0).unwrap()).len();
        let reader = SessionReader::of_bytes("after", without_power(&log, synced, end, &mut random)).unwrap();
        let read = reader.messages(&[], 0..u64::MAX).flatten().count();
        if reader.notes().is_empty() {
            sound += 1;
        } else {
            scanned += 1;
        }
        missing += usize::from(read < before);
    }
    println!("{sound} open by their index, {scanned} by their records; {missing} lack something");
    assert_eq!(missing, 0);
}
