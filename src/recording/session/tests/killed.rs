//! Kills a writing process at random moments.
#![cfg(unix)]

use std::{
    fs,
    os::unix::fs::FileExt as _,
    path::Path,
    process::{Child, Command, Stdio},
    time::{Duration, Instant},
};

use super::*;

/// Environment variable with the folder of the process that is killed.
const FOLDER: &str = "NIMA_TEST_SESSION_FOLDER";
const CHANNELS: u64 = 8;
const TICK_NS: u64 = 1_000_000;
/// Maximum loss, ns.
const LOST_NS: u64 = 600_000_000;

/// Writes ticks of a millisecond as fast as it can and reports its progress in a second file. It writes in 40 ms what a
/// rig writes in seconds, so that a kill often hits a write.
#[test]
#[ignore = "run by the other tests, which kill it"]
fn the_writer_of_another_process() {
    let Ok(folder) = std::env::var(FOLDER) else { return };
    let folder = Path::new(&folder);
    let report = fs::File::create(folder.join("told")).unwrap();
    let mut random = fastrand::Rng::with_seed(7);
    let noise: Vec<u8> = std::iter::repeat_with(|| random.u8(..)).take(1 << 20).collect();
    let mut writer = SessionWriter::create(&folder.join("session.mcap"), "nima test").unwrap();
    let channels: Vec<_> =
        (0..CHANNELS).map(|number| writer.channel(&number.to_string(), json("Any")).unwrap()).collect();
    for tick in 0_u64.. {
        for (number, &channel) in channels.iter().enumerate() {
            let at = (tick as usize * 1_789 + number * 211) % (noise.len() - 200);
            writer.message(channel, tick * TICK_NS, &noise[at..at + 200]).unwrap();
        }
        report.write_all_at(&(tick + 1).to_le_bytes(), 0).unwrap();
        match tick % 3_000 {
            700 => writer.attachment(&format!("at {tick}"), "text/plain", tick * TICK_NS, &noise[..50_000]).unwrap(),
            1_400 => writer.metadata(&format!("at {tick}"), &values()).unwrap(),
            2_100 => drop(writer.channel(&format!("at {tick}"), plain_text()).unwrap()),
            _ => {}
        }
    }
}

struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        self.0.kill().ok();
        self.0.wait().ok();
    }
}

/// State after one kill.
struct Left {
    lost_ns: u64,
    recorded_ns: u64,
    /// A sequential reader meets a complete end before the end of the file: killed between the two writes of a growth.
    early_end: bool,
    bytes: usize,
}

fn kill_one(random: &mut fastrand::Rng) -> Left {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    let name = format!("{}::the_writer_of_another_process", module_path!().split_once("::").unwrap().1);
    let mut running = Running(
        Command::new(std::env::current_exe().unwrap())
            .args([name.as_str(), "--exact", "--ignored"])
            .env(FOLDER, folder.path())
            .stdout(Stdio::null())
            .spawn()
            .unwrap(),
    );
    let begin = Instant::now();
    while !path.exists() {
        assert!(begin.elapsed() < Duration::from_mins(2), "it does not begin");
        std::thread::sleep(Duration::from_micros(100));
    }
    std::thread::sleep(Duration::from_micros(random.u64(..200_000)));
    running.0.kill().unwrap();
    running.0.wait().unwrap();

    let report = fs::read(folder.path().join("told")).unwrap();
    let report = report.try_into().map_or(0, u64::from_le_bytes);
    let bytes = fs::read(&path).unwrap();
    let reader = SessionReader::open(&path).unwrap();
    assert_eq!(reader.notes(), [""; 0]);
    let read = ours(&reader);
    assert!(peer::indexed(&bytes).unwrap() == read, "by the index");
    let early_end = match peer::linear(&bytes) {
        Ok(linear) => {
            assert!(linear.len() >= read.len() && linear[..read.len()] == read[..]);
            false
        }
        Err(error) => {
            assert!(error.to_string().contains("after end"), "{error}");
            true
        }
    };
    for (number, (topic, time_ns, _)) in read.iter().enumerate() {
        let number = number as u64;
        assert_eq!((topic.parse(), *time_ns), (Ok(number % CHANNELS), number / CHANNELS * TICK_NS), "a gap");
    }
    let recorded_ns = read.len() as u64 / CHANNELS * TICK_NS;
    let lost_ns = (report * TICK_NS).saturating_sub(recorded_ns);
    assert!(lost_ns <= LOST_NS, "{} ms lost", lost_ns / 1_000_000);
    Left { lost_ns, recorded_ns, early_end, bytes: bytes.len() }
}

fn kill(count: usize, seed: u64) {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut left: Vec<Left> = (0..count).map(|_| kill_one(&mut random)).collect();
    left.sort_by_key(|one| one.lost_ns);
    let early = left.iter().filter(|one| one.early_end).count();
    let middle = left[count / 2].lost_ns / 1_000_000;
    let max = left[count - 1].lost_ns / 1_000_000;
    let grown = left.iter().filter(|one| one.bytes > 17 << 20).count();
    let longest_s = left.iter().map(|one| one.recorded_ns).max().unwrap_or_default() / 1_000_000_000;
    println!("{count} processes killed, all files open; lost: median {middle} ms, most {max} ms");
    println!(
        "up to {longest_s} s recorded, {grown} files had grown; early end for who does not use the index: {early}"
    );
}

#[test]
fn a_killed_process_leaves_a_file_that_opens() {
    kill(6, 8);
}

#[test]
#[ignore = "takes minutes: `./dev figures` runs it"]
fn a_thousand_killed_processes_leave_files_that_open() {
    kill(1_000, fastrand::u64(..));
}
