//! A department of three machines, simulated by three folders: an issuer of certificates, a rig, and a viewer.
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::{
    net::TcpListener,
    path::Path,
    process::{Command, Output, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};

use serde_json::Value;

fn at(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_nima"));
    command.args(arguments).env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env("NIMA_DATA_DIR", folder);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn ran(folder: &Path, arguments: &[&str]) -> String {
    let Output { status, stdout, stderr } = at(folder, arguments).output().unwrap();
    assert!(status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&stderr));
    String::from_utf8(stdout).unwrap()
}

fn refused(folder: &Path, arguments: &[&str]) -> String {
    let Output { status, stderr, .. } = at(folder, arguments).output().unwrap();
    let report = String::from_utf8(stderr).unwrap();
    assert!(!status.success(), "{arguments:?} succeeded");
    assert_eq!(report.lines().count(), 1, "{report}");
    report
}

#[test]
fn a_rig_is_found_listed_and_recorded_elsewhere_to_the_last_bit() {
    let machines = tempfile::tempdir().unwrap();
    let folder = |name: &str| machines.path().join(name);
    let [office, rig, teacher] = ["office", "rig", "teacher"].map(folder);
    let file = |name: &str| folder(name).display().to_string();
    let address = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().to_string();

    let report = refused(&teacher, &["department", "rigs"]);
    assert!(report.contains("nima department join"), "{report}");
    ran(&office, &["department", "create", "lab"]);
    ran(&office, &["department", "issue", "theatre-1", "--out", &file("rig.cert")]);
    ran(&office, &["department", "issue", "teacher", "--watcher", "--out", &file("teacher.cert")]);
    ran(&rig, &["department", "join", &file("rig.cert")]);
    assert!(
        ran(&teacher, &["department", "join", &file("teacher.cert")]).contains("watcher teacher of department lab")
    );
    let report = refused(&teacher, &["run", "--share", &address, "--seconds", "1"]);
    assert!(report.contains("joined as a watcher"), "{report}");
    let report = refused(&teacher, &["department", "rigs", "--at", &address]);
    assert!(report.contains("no rig answers"), "{report}");

    let original = file("original.mcap");
    let run = ["run", "--share", &address, "--seconds", "10", "--record", &original, "--json"];
    let shared = at(&rig, &run).spawn().unwrap();
    let began = Instant::now();
    let list = ["department", "rigs", "--at", &address, "--json"];
    let listed = loop {
        let output = at(&teacher, &list).output().unwrap();
        let listed: Value = serde_json::from_slice(&output.stdout).unwrap_or_default();
        if listed[0]["rig"].is_string() {
            break listed;
        }
        assert!(began.elapsed() < Duration::from_secs(8), "{}", String::from_utf8_lossy(&output.stderr));
        sleep(Duration::from_millis(100));
    };
    assert_eq!((&listed[0]["name"], &listed[0]["watchers"]), (&Value::from("theatre-1"), &Value::from(0)));
    let copies = file("copies");
    let report = ran(&teacher, &["department", "record", "--at", &address, "--into", &copies, "--seconds", "14"]);
    let output = shared.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(report.contains("recorded") && report.contains(".mcap"), "{report}");
    let files: Vec<_> = std::fs::read_dir(&copies).unwrap().map(|file| file.unwrap().path()).collect();
    assert_eq!(files.len(), 1, "{files:?}");
    let replay = |path: &str| -> Value { serde_json::from_str(&ran(&teacher, &["replay", path, "--json"])).unwrap() };
    let here = replay(&files[0].display().to_string());
    let there = replay(&original);
    assert_eq!((&here["identical"], &here["closed"], &here["ticks"]), (&true.into(), &true.into(), &there["ticks"]));
}

#[test]
fn every_command_of_its_page_exists() {
    let page = include_str!("../../../../docs/department.md");
    let lines = page.split(['\n', '`']).map(|line| line.split(" #").next().unwrap().trim());
    let commands: Vec<&str> = lines.filter(|line| line.starts_with("nima department ")).collect();
    assert!(commands.len() > 6, "{commands:?}");
    for command in commands {
        let words: Vec<&str> = command.split_whitespace().skip(1).collect();
        let help = ran(Path::new("unused"), &[words[0], words[1], "--help"]);
        for flag in words.iter().filter(|word| word.starts_with("--")) {
            assert!(help.contains(&format!("{flag} ")), "{command}: {flag}");
        }
    }
}
