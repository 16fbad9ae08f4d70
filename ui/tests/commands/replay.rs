//! `nima run --record` and `nima replay`, as a user would type them.
use std::{path::Path, process::Command};

use nima_recording::session::SessionReader;
use serde_json::Value;

use crate::every_command::{json, nima};

/// Returns the one line of a command that must fail.
fn refused(arguments: &[&str]) -> String {
    let output = nima(arguments);
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && output.stdout.is_empty(), "{arguments:?} succeeded");
    assert_eq!(text.lines().count(), 1, "{text}");
    text
}

#[test]
fn a_recorded_run_replays_and_can_be_asked_what_if() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    let session = at("session.mcap");
    let out = at("out");
    let run = [
        "run",
        "--virtual",
        "--seconds",
        "8",
        "--scene",
        "bimanual",
        "--delay-ms",
        "80",
        "--record",
        &session,
        "--json",
    ];
    let ran = json(&run);
    assert_eq!((&ran["recorded"]["ticks"], &ran["recorded"]["lost"]), (&Value::from(8000), &Value::from(0)), "{ran}");
    let report = json(&["replay", &session, "--json"]);
    assert_eq!(
        (&report["ticks"], &report["identical"], &report["closed"]),
        (&Value::from(8000), &Value::from(true), &Value::from(true))
    );
    assert!(report["recorded_by"].as_str().unwrap().starts_with("nima ") && report["differs"].is_null(), "{report}");
    let words = nima(&["replay", &session]);
    let words = String::from_utf8(words.stdout).unwrap();
    assert!(words.contains("8000 ticks") && words.contains("bit by bit"), "{words}");
    let part = json(&["replay", &session, "--from", "2.5", "--to", "4", "--json"]);
    assert_eq!(
        (&part["ticks_before"], &part["ticks"], &part["identical"]),
        (&Value::from(2500), &Value::from(1500), &Value::from(true)),
        "{part}"
    );
    let words = String::from_utf8(nima(&["replay", &session, "--from", "2.5", "--to", "4"]).stdout).unwrap();
    assert!(words.contains("the 2500 ticks before it were replayed") && words.contains("not compared"), "{words}");
    assert!(!words.contains("not closed"), "{words}");
    for (given, words) in [(["3", "2"], "is not before"), (["9", "10"], "after the end"), (["0", "x"], "seconds")] {
        assert!(refused(&["replay", &session, "--from", given[0], "--to", given[1]]).contains(words));
    }
    let asked = json(&["replay", &session, "--mode", "dfr", "--delay-ms", "200", "--out", &out, "--json"]);
    assert_eq!(asked["arms"].as_array().unwrap().len(), 2, "{asked}");
    assert!(asked["arms"][0]["difference"]["mean_n"].as_f64().unwrap() > 0.01, "{asked}");
    assert!(asked["limit"].as_str().unwrap().contains("would have changed the motion of the hand"), "{asked}");
    let forces = std::fs::read_to_string(Path::new(&out).join("forces.csv")).unwrap();
    assert_eq!(forces.lines().count(), 1 + 2 * 8000);
    assert!(forces.lines().nth(5000).unwrap().split(',').count() == 13, "{}", forces.lines().nth(5000).unwrap());
    let again = refused(&run);
    assert!(again.contains("session.mcap") && again.contains("never overwritten"), "{again}");
}

#[cfg(not(feature = "live"))]
#[test]
fn without_its_feature_live_viewing_says_how_to_build_it() {
    for arguments in [&["run", "--live", "--seconds", "1"][..], &["run", "--live", "127.0.0.1:0", "--seconds", "1"]] {
        assert!(refused(arguments).contains("--features live"));
    }
}

#[test]
fn live_viewing_needs_an_address_and_the_real_clock() {
    for (arguments, words) in [
        (["run", "--live", "here", "--seconds"], "invalid socket address"),
        (["run", "--live", "--virtual", "--seconds"], "cannot be used with"),
    ] {
        let report = nima(&[&arguments[..], &["1"]].concat());
        let text = String::from_utf8(report.stderr).unwrap();
        assert!(!report.status.success() && text.contains(words), "{text}");
    }
}

#[test]
fn what_cannot_be_replayed_is_told_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    std::fs::write(at("empty.mcap"), []).unwrap();
    std::fs::write(at("foreign.mcap"), "t_s,x_m\n0,1\n").unwrap();
    for (name, words) in
        [("empty.mcap", "is empty"), ("foreign.mcap", "is not a session"), ("absent.mcap", "cannot read")]
    {
        let line = refused(&["replay", &at(name)]);
        assert!(line.contains(words) && line.contains(name), "{line}");
    }
    for (given, words) in
        [(["--delay-ms", "-1"], "0 to 1000 ms"), (["--gain", "2"], "0 to 1"), (["--mode", "magic"], "magic")]
    {
        let line = refused(&["replay", &at("empty.mcap"), given[0], given[1]]);
        assert!(line.contains(words), "{line}");
    }
    let line = refused(&["replay", &at("empty.mcap"), "--out", &at("out")]);
    assert!(line.contains("--out requires a change"), "{line}");
    let line = refused(&["run", "--virtual", "--record", &at("no/such/folder/s.mcap")]);
    assert!(line.contains("create its folder first"), "{line}");
}

/// Runs this script in a shell with a separate disk of 9 MB in the folder `disk`; `None` if users cannot mount one on this
/// system.
#[cfg(target_os = "linux")]
fn on_a_small_disk(folder: &Path, script: &str) -> Option<std::process::Output> {
    std::fs::create_dir_all(folder.join("disk")).unwrap();
    let script = format!("cd {} && mount -t tmpfs -o size=9000k none disk || exit 99; {script}", folder.display());
    let output = Command::new("unshare")
        .args(["-rm", "bash", "-c", &script, env!("CARGO_BIN_EXE_nima")])
        .env("NIMA_DATA_DIR", "/dev/null/no/such/folder")
        .output()
        .ok()?;
    let is_refused = matches!(output.status.code(), Some(1 | 99)) && output.stdout.is_empty();
    if is_refused && !String::from_utf8_lossy(&output.stderr).contains("nima") {
        nima_testing::unjudged::left_out("a small disk cannot be mounted");
        return None;
    }
    Some(output)
}

#[cfg(target_os = "linux")]
#[test]
fn a_disk_that_is_full_or_read_only_is_told_in_one_line_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    for (script, words) in [
        ("$0 run --virtual --seconds 60 --scene peg_transfer --record disk/a.mcap", "free some space"),
        (
            "mount -o remount,ro disk; $0 run --virtual --seconds 1 --record disk/a.mcap",
            "choose a folder that you may write to",
        ),
    ] {
        let Some(output) = on_a_small_disk(folder.path(), script) else { return };
        let report = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success() && report.contains(words) && report.contains("a.mcap"), "{report}");
    }
}

#[cfg(unix)]
#[test]
fn a_limit_of_file_sizes_ends_the_recording_and_not_the_program() {
    let folder = tempfile::tempdir().unwrap();
    let session = folder.path().join("limited.mcap");
    // A session begins with 16 MB of room; the limit is reached when it grows.
    let script = format!(
        "ulimit -f 50000; exec {} run --virtual --seconds 200 --record {}",
        env!("CARGO_BIN_EXE_nima"),
        session.display()
    );
    let output = Command::new("sh").args(["-c", &script]).env("NIMA_DATA_DIR", folder.path()).output().unwrap();
    let report = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{}: {report}", output.status);
    assert!(report.contains("limited.mcap"), "{report}");
    let reader = SessionReader::open(&session).unwrap();
    assert!(reader.times_ns().is_some_and(|(first_ns, last_ns)| last_ns > first_ns), "what was written can be read");
}
