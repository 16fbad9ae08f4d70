//! Tests: written data can be read back by our reader and by the crate `mcap`; disks that refuse writes.

use std::fs;

use super::*;

#[test]
fn everything_written_is_read_by_us_and_by_others_before_and_after_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    let mut writer = SessionWriter::create(&path, "nima test").unwrap();
    let forces = writer.channel("forces", json("Force")).unwrap();
    let poses = writer.channel("poses", json("Pose")).unwrap();
    assert_eq!(writer.channel("forces", json("Force")).unwrap(), forces, "the same again");
    writer.metadata("session", &values()).unwrap();
    writer.attachment("rig.toml", "text/plain", 5, b"mode = \"best\"").unwrap();
    let mut expected = Vec::new();
    for tick in 0..5_000_u64 {
        // Noise in the middle keeps the data from compressing too well.
        let data = format!("{{\"force_n\": {}}}", tick.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11);
        for (channel, topic) in [(forces, "forces"), (poses, "poses")] {
            writer.message(channel, tick * 1_000_000, data.as_bytes()).unwrap();
            expected.push((topic.to_owned(), tick * 1_000_000, data.clone().into_bytes()));
        }
    }
    writer.flush().unwrap();
    writer.sync_handle().unwrap().sync_data().unwrap();
    let later = writer.channel("alarms", plain_text()).unwrap();
    writer.message(later, 5_000_000_000, b"late").unwrap();
    expected.push(("alarms".to_owned(), 5_000_000_000, b"late".to_vec()));
    writer.flush().unwrap();

    let check = |sound_summary: bool| {
        let reader = SessionReader::open(&path).unwrap();
        assert_eq!(reader.notes(), [""; 0]);
        assert_eq!((reader.library(), reader.times_ns()), ("nima test", Some((0, 5_000_000_000))));
        assert_eq!(reader.channels()[1].encoding, json("Pose"));
        assert_eq!(reader.channels()[0].messages, Some(5_000));
        assert_eq!(reader.metadata().unwrap(), [("session".to_owned(), values())]);
        assert_eq!(reader.attachment(&reader.attachments()[0]).unwrap(), b"mode = \"best\"");
        assert!(ours(&reader) == expected, "ours");
        let bytes = fs::read(&path).unwrap();
        assert!(peer::indexed(&bytes).unwrap() == expected, "by the index");
        assert!(peer::linear(&bytes).unwrap() == expected, "one after the other");
        let footer = &bytes[bytes.len() - 12..];
        assert_eq!(footer[..4] != [0; 4], sound_summary, "a finished file has a checksum");
        bytes.len()
    };
    let running = check(false);
    let statistics = writer.finish().unwrap();
    assert_eq!((statistics.messages, statistics.chunks, statistics.channels), (10_001, 11, 3));
    let finished = check(true);
    assert!(finished < 1 << 20 && running > 16 << 20, "the room is cut off: {running}, {finished}");
}

#[test]
fn a_range_of_one_topic_is_read_in_order_also_where_chunks_overlap() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    let mut writer = SessionWriter::create(&path, "nima test").unwrap();
    let channels = ["a", "b"].map(|topic| writer.channel(topic, plain_text()).unwrap());
    let mut random = fastrand::Rng::with_seed(3);
    let mut times: Vec<u64> = (0..2_000).map(|_| random.u64(0..3_000_000_000)).collect();
    for (number, &time) in times.iter().enumerate() {
        writer.message(channels[number % 2], time, &number.to_le_bytes()).unwrap();
    }
    assert!(writer.finish().unwrap().chunks > 100, "times that jump close chunks");
    times = times.into_iter().step_by(2).filter(|time| (1_000_000_000..1_500_000_000).contains(time)).collect();
    times.sort_unstable();
    let reader = SessionReader::open(&path).unwrap();
    let read: Vec<u64> =
        reader.messages(&["a"], 1_000_000_000..1_500_000_000).map(|message| message.unwrap().log_time_ns()).collect();
    assert_eq!(read, times);
    assert_eq!(reader.messages(&["none"], 0..u64::MAX).count(), 0);
}

#[test]
fn a_long_session_with_many_growths_keeps_what_makes_it_valid_small() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    let mut writer = SessionWriter::create(&path, "nima test").unwrap();
    let channels: Vec<_> =
        (0..20).map(|number| writer.channel(&format!("topic {number}"), json("Any")).unwrap()).collect();
    let mut random = fastrand::Rng::with_seed(4);
    let noise: Vec<u8> = std::iter::repeat_with(|| random.u8(..)).take(80_000).collect();
    // Twenty minutes in chunks of 80 kB.
    for chunk in 0..2_400_u64 {
        for (&channel, part) in channels.iter().zip(noise.chunks(4_000)) {
            writer.message(channel, chunk * 500_000_000, part).unwrap();
        }
    }
    assert_eq!(writer.held(), 0, "the memory does not grow with the session");
    let (written, data) = writer.bytes();
    println!("{written} bytes written for {data} bytes of data");
    assert!(data > 150 << 20 && (written as f64) < 1.08 * data as f64, "{written} of {data}");
    let reader = SessionReader::open(&path).unwrap();
    assert_eq!(reader.statistics().chunks, 2_399, "all but the open one");
    let last = 2_398 * 500_000_000;
    assert_eq!(reader.messages(&["topic 7"], last..u64::MAX).count(), 1);
    assert_eq!(writer.finish().unwrap().chunks, 2_400);
    assert_eq!(SessionReader::open(&path).unwrap().notes(), [""; 0]);
}

#[test]
fn an_index_that_another_program_has_changed_is_not_lost_in_silence() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    let mut writer = SessionWriter::create(&path, "nima test").unwrap();
    let channel = writer.channel("a", plain_text()).unwrap();
    for chunk in 0..5 {
        writer.message(channel, chunk * 500_000_000, b"a").unwrap();
    }
    // The whole summary, to which the footer points.
    let bytes = fs::read(&path).unwrap();
    let footer = bytes.len() - 28;
    let begin = u64::from_le_bytes(bytes[footer..footer + 8].try_into().unwrap()) as usize;
    let mut changed = bytes.clone();
    changed[begin..footer - 9].fill(0);
    let write = |bytes: &[u8]| {
        use std::io::Write as _;
        fs::OpenOptions::new().write(true).open(&path).unwrap().write_all(bytes).unwrap();
    };
    write(&changed);
    let error = writer.metadata("session", &values()).unwrap_err().to_string();
    assert!(error.contains("another program has changed"), "{error}");
    write(&bytes);
    writer.metadata("session", &values()).unwrap();
    assert_eq!(writer.finish().unwrap().chunks, 5);
}

#[test]
fn who_writes_is_seen_and_who_reads_is_not() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    assert!(is_being_written(&path).is_err(), "no such file");
    let writer = SessionWriter::create(&path, "").unwrap();
    let reader = fs::File::open(&path).unwrap();
    assert!(is_being_written(&path).unwrap() && is_being_written(&path).unwrap());
    writer.finish().unwrap();
    // A program started by another test inherits the lock until it has been loaded.
    let free = (0..500).any(|_| {
        std::thread::sleep(std::time::Duration::from_millis(10));
        !is_being_written(&path).unwrap()
    });
    assert!(free);
    drop(reader);
    fs::remove_file(&path).unwrap();
}

#[test]
fn what_cannot_be_created_or_goes_away_is_told_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    let refused = |path: &std::path::Path| SessionWriter::create(path, "").err().unwrap().to_string();
    let mut writer = SessionWriter::create(&path, "").unwrap();
    assert!(refused(&path).contains("never overwritten"));
    assert!(refused(&folder.path().join("none/a.mcap")).contains("create its folder first"));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing else is left behind");
    let channel = writer.channel("a", plain_text()).unwrap();
    writer.message(channel, 0, b"a").unwrap();
    let foreign = writer.message(ChannelId(1), 0, b"a").unwrap_err().to_string();
    assert!(
        foreign.ends_with("session.mcap has no channel 1: the channel belongs to another file; use one of this file"),
        "{foreign}"
    );
    if cfg!(windows) {
        fs::remove_file(&path).unwrap_err();
        writer.flush().unwrap();
    } else {
        fs::remove_file(&path).unwrap();
        let error = writer.flush().unwrap_err();
        assert!(error.to_string().contains("deleted") && error.kind() == Some(std::io::ErrorKind::NotFound), "{error}");
    }
    #[cfg(target_os = "linux")]
    assert!(refused(std::path::Path::new("/proc/a.mcap")).starts_with("cannot create session /proc/a.mcap: "));
}
