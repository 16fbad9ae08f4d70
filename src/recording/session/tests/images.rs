//! Images are stored unchanged in their own chunks.

use std::{collections::BTreeMap, fs};

use prost::Message as _;

use super::*;
use crate::messages::foxglove::{CompressedImage, encoding};

/// Returns noise in the place of compressed image data.
fn image(number: u64) -> Vec<u8> {
    let mut random = fastrand::Rng::with_seed(number);
    let data = (0..20_000).map(|_| random.u8(..)).collect();
    CompressedImage { data, format: "jpeg".to_owned(), frame_id: "endoscope".to_owned(), timestamp: None }
        .encode_to_vec()
}

#[test]
fn pictures_have_chunks_of_their_own_and_are_read_by_us_and_by_others() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    let mut writer = SessionWriter::create(&path, "nima test").unwrap();
    let numbers = writer.channel("numbers", json("Number")).unwrap();
    let images = writer.channel("pictures", encoding::<CompressedImage>()).unwrap();
    let mut expected = Vec::new();
    for tick in 0..3_000_u64 {
        let time_ns = tick * 1_000_000;
        writer.message(numbers, time_ns, b"{}").unwrap();
        expected.push(("numbers".to_owned(), time_ns, b"{}".to_vec()));
        if tick % 40 == 7 {
            writer.message(images, time_ns, &image(tick)).unwrap();
            expected.push(("pictures".to_owned(), time_ns, image(tick)));
        }
    }
    let statistics = writer.finish().unwrap();
    let chunks = statistics.chunks;
    assert!((12..=14).contains(&chunks), "both are closed twice a second: {chunks}");

    let reader = SessionReader::open(&path).unwrap();
    assert_eq!(reader.notes(), [""; 0]);
    // Sort by time; the order of equal times is arbitrary.
    let sorted = |mut report: peer::PeerMessage| {
        report.sort_by(|a, b| (a.1, &a.0).cmp(&(b.1, &b.0)));
        report
    };
    assert!(sorted(ours(&reader)) == expected);
    let bytes = fs::read(&path).unwrap();
    assert!(sorted(peer::indexed(&bytes).unwrap()) == expected);
    assert!(sorted(peer::linear(&bytes).unwrap()) == expected);

    let summary = mcap::read::Summary::read(&bytes).unwrap().unwrap();
    let mut compressions: BTreeMap<&str, usize> = BTreeMap::new();
    for chunk in &summary.chunk_indexes {
        let topics: Vec<&str> =
            chunk.message_index_offsets.keys().map(|id| summary.channels[id].topic.as_str()).collect();
        assert_eq!(topics.len(), 1, "{topics:?}");
        assert_eq!(chunk.compression.is_empty(), topics == ["pictures"]);
        *compressions.entry(chunk.compression.as_str()).or_default() += 1;
    }
    assert_eq!(compressions.len(), 2, "{compressions:?}");
}

#[test]
fn pictures_that_stop_are_not_left_in_memory() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    let mut writer = SessionWriter::create(&path, "nima test").unwrap();
    let numbers = writer.channel("numbers", json("Number")).unwrap();
    let images = writer.channel("pictures", encoding::<CompressedImage>()).unwrap();
    writer.message(images, 0, &image(1)).unwrap();
    for tick in 0..600_u64 {
        writer.message(numbers, tick * 1_000_000, b"{}").unwrap();
    }
    // The file is in the state in which a killed process leaves it.
    let reader = SessionReader::open(&path).unwrap();
    assert_eq!(reader.messages(&["pictures"], 0..u64::MAX).count(), 1);
}
