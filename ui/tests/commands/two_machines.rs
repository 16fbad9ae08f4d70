//! Two machines, simulated by two folders: paired by their codes, the handle at one, the arm at the other.
#![cfg(target_os = "linux")]
use std::{
    io::{BufRead as _, BufReader, Write as _},
    net::UdpSocket,
    path::Path,
    process::{Child, Command, Output, Stdio},
    thread::sleep,
    time::Duration,
};

use nima_testing::real_time::{alone, judged};
use serde_json::Value;

/// Returns an address of this machine that is free.
fn free() -> String {
    UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().to_string()
}

/// Returns a command of the machine whose files are in this folder.
fn at(folder: &Path, arguments: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_nima"))
        .args(arguments)
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env("NIMA_DATA_DIR", folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn report(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Returns the code that an offer shows.
fn code(offer: &mut Child) -> String {
    let mut lines = BufReader::new(offer.stdout.take().unwrap()).lines().map(Result::unwrap);
    let line = lines.find(|line| line.starts_with("code to enter on the console's machine")).unwrap();
    let code = line.rsplit(": ").next().unwrap();
    assert_eq!(code.chars().filter(char::is_ascii_digit).count(), 9, "{code}");
    code.to_owned()
}

/// Enters a code at the console's machine.
fn entered(console: &Path, address: &str, code: &str) -> Output {
    let mut here = at(console, &["pair", address, "--wait", "20"]);
    // A console that refuses does not read it.
    writeln!(here.stdin.take().unwrap(), "{code}").ok();
    here.wait_with_output().unwrap()
}

/// Pairs the machines at this address.
fn pair(follower: &Path, console: &Path, address: &str) -> [Output; 2] {
    let mut there = at(follower, &["pair", "--offer", "--listen", address, "--wait", "20"]);
    let code = code(&mut there);
    let here = entered(console, address, &code);
    [there.wait_with_output().unwrap(), here]
}

#[test]
fn a_machine_that_is_not_paired_or_paired_with_a_wrong_code_is_refused() {
    let follower = tempfile::tempdir().unwrap();
    let console = tempfile::tempdir().unwrap();
    let address = free();
    let mut there = at(follower.path(), &["pair", "--offer", "--listen", &address, "--wait", "60"]);
    let code = code(&mut there);
    let wrong = if code.starts_with('1') { "2" } else { "1" }.to_owned() + &code[1..];
    for attempt in 0..3 {
        let here = entered(console.path(), &address, &wrong);
        assert!(!here.status.success() && report(&here).contains("wrong code;"), "{attempt}: {}", report(&here));
    }
    for code in [&wrong, &code] {
        let here = entered(console.path(), &address, code);
        assert!(report(&here).contains("too many wrong codes; wait "), "{}", report(&here));
    }
    assert!(!console.path().join("network/network.peers").exists());
    // The wrong codes of one console do not end the offer for others.
    let other = tempfile::tempdir().unwrap();
    let here = entered(other.path(), &address, &code);
    assert!(here.status.success(), "{}", report(&here));
    assert!(there.wait().unwrap().success());
    let stranger = at(console.path(), &["run", "--follower", "no-such-host.invalid", "--seconds", "1"]);
    let stranger = stranger.wait_with_output().unwrap();
    assert!(!stranger.status.success());
    assert!(report(&stranger).contains("no-such-host.invalid"), "{}", report(&stranger));
}

#[test]
fn a_pairing_that_would_wait_too_long_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (wait, words) in [("601", "at most 600 seconds"), ("1e9", "at most 600 seconds"), ("-1", "seconds above 0")] {
        let refused = at(folder.path(), &["pair", "--offer", "--wait", wait]).wait_with_output().unwrap();
        assert!(!refused.status.success() && report(&refused).contains(words), "{wait}: {}", report(&refused));
    }
    assert!(std::fs::read_dir(folder.path()).unwrap().next().is_none(), "no key was created");
}

#[test]
fn the_handle_is_at_one_machine_and_the_arm_at_the_other() {
    let _alone = alone();
    let follower = tempfile::tempdir().unwrap();
    let console = tempfile::tempdir().unwrap();
    let address = free();
    for output in pair(follower.path(), console.path(), &address) {
        assert!(output.status.success(), "{}", report(&output));
    }
    judged(|| {
        let there = at(follower.path(), &["follower", "--listen", &address, "--seconds", "12", "--json"]);
        sleep(Duration::from_millis(300));
        let here = at(console.path(), &["run", "--follower", &address, "--seconds", "6", "--json"]);
        let here = here.wait_with_output().unwrap();
        let there = there.wait_with_output().unwrap();
        let json: Value = serde_json::from_slice(&here.stdout).unwrap_or_default();
        println!("{json:#}\n{}\n{}", report(&here), report(&there));
        assert!(json["final_state"] == "engaged" && json["link"]["open"] == true, "{json:#}");
        let count = |name: &str| json["link"][name].as_f64().unwrap();
        assert!(count("delivered") > 4000.0);
        assert!(count("lost") <= 0.002 * count("delivered"), "{json:#}");
        assert_eq!(json["link"]["dropped"], 0);
        // The other machine lost the connection: it stopped, and reports the cause.
        assert!(!there.status.success());
        assert!(report(&there).contains("the other machine was closed") || report(&there).contains("over the link"));
    });
}
