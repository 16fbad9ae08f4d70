//! A full disk: a process limit that cuts writes short, and a real file system.
#![cfg(target_os = "linux")]

use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

use nima_testing::unjudged;

use super::*;

/// Environment variable with the file of the process that fills the disk.
const FILE: &str = "NIMA_TEST_SMALL_DISK";
/// Bytes of a message, 25 of them in half a second.
const MESSAGE: usize = 50_000;

#[test]
#[ignore = "run by the tests below in its own process"]
fn of_a_process_with_a_small_disk() {
    let Ok(path) = std::env::var(FILE) else { return };
    let mut writer = match SessionWriter::create(path.as_ref(), "") {
        Ok(writer) => writer,
        Err(error) => return println!("{error}"),
    };
    let channel = writer.channel("a", plain_text()).unwrap();
    let mut random = fastrand::Rng::with_seed(5);
    let mut taken = 0_u64;
    let error = loop {
        let noise: Vec<u8> = std::iter::repeat_with(|| random.u8(..)).take(MESSAGE).collect();
        if let Err(error) = writer.message(channel, taken * 20_000_000, &noise) {
            break error;
        }
        taken += 1;
    };
    println!("taken {taken}: {error}");
    let again = writer.flush().unwrap_err();
    assert_eq!(again.kind(), error.kind(), "it keeps failing");
    let ended = writer.finish().unwrap_err();
    assert_eq!(ended.kind(), error.kind());
}

/// Runs this program in a shell: `$0` is the program, `$@` its arguments.
fn filled(script: &str, path: &Path) -> Output {
    let name = format!("{}::of_a_process_with_a_small_disk", module_path!().split_once("::").unwrap().1);
    Command::new("bash")
        .args(["-c", script])
        .arg(std::env::current_exe().unwrap())
        .args([name.as_str(), "--exact", "--ignored", "--nocapture"])
        .env(FILE, path)
        .output()
        .unwrap()
}

fn text(output: &Output) -> String {
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// All accepted messages are in the file, except the last half second.
fn check(report: &str, path: &Path) {
    assert!(report.contains("the part already written stays readable"), "{report}");
    let taken: usize = report.split("taken ").nth(1).unwrap().split(':').next().unwrap().parse().unwrap();
    let read = ours(&SessionReader::open(path).unwrap());
    println!("{taken} taken, {} read", read.len());
    assert!(taken > 100 && read.len() + 26 > taken, "half a second is missing at most: {} of {taken}", read.len());
    let bytes = fs::read(path).unwrap();
    assert!(peer::indexed(&bytes).unwrap() == read && peer::linear(&bytes).unwrap() == read);
}

#[test]
fn a_file_that_may_not_grow_stays_readable() {
    let folder = tempfile::tempdir().unwrap();
    // The shell's limit is in KiB; the signal that accompanies it is ignored.
    let run =
        |kib: u32, path: &Path| text(&filled(&format!("trap '' XFSZ; ulimit -f {kib}; exec \"$0\" \"$@\""), path));
    assert!(run(10_000, &folder.path().join("none.mcap")).contains("cannot create session"));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is left behind");
    for kib in [17_000, 33_000, 40_001] {
        let path = folder.path().join(format!("{kib}.mcap"));
        check(&run(kib, &path), &path);
    }
}

#[test]
fn a_file_on_a_full_disk_stays_readable() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("disk/session.mcap");
    let kept = folder.path().join("kept.mcap");
    for kib in [9_000, 17_001, 30_000, 30_002] {
        // A private file system of this size that exists while the shell runs.
        let disk = path.parent().unwrap();
        let copy = kept.display();
        fs::create_dir_all(disk).unwrap();
        let script = format!(
            "mount -t tmpfs -o size={kib}k none {disk} || exit 99; \"$0\" \"$@\" && cp {disk}/session.mcap {copy}",
            disk = disk.display()
        );
        let output = filled(&format!("exec unshare -rm bash -c '{script}' \"$0\" \"$@\""), &path);
        if matches!(output.status.code(), Some(1 | 99 | 127)) && output.stdout.is_empty() {
            unjudged::left_out("a small disk cannot be mounted");
            return;
        }
        let report = text(&output);
        assert!(report.contains("No space left on device") && report.contains("record to another disk"), "{report}");
        check(&report, &kept);
    }
}
