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

use nima_testing::real_time::{alone, judged, too_busy};
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

/// Returns the code that a pairing shows.
fn code(lines: &mut impl Iterator<Item = std::io::Result<String>>) -> String {
    let line = lines.map(Result::unwrap).find(|line| line.starts_with("code to enter on the other machine"));
    line.unwrap().rsplit(": ").next().unwrap().to_owned()
}

/// Pairs the machines at this address; `enter` converts the displayed code to the one entered at the console's machine.
fn pair(follower: &Path, console: &Path, address: &str, enter: fn(&str) -> String) -> [Output; 2] {
    let mut there = at(follower, &["pair", "--offer", "--listen", address, "--wait", "20"]);
    let mut here = at(console, &["pair", address, "--wait", "20"]);
    let mut of_there = BufReader::new(there.stdout.take().unwrap()).lines();
    let mut of_here = BufReader::new(here.stdout.take().unwrap()).lines();
    let shown_there = code(&mut of_there);
    let shown_here = code(&mut of_here);
    assert_ne!(shown_there, shown_here, "the code of the same screen is refused");
    assert_eq!(shown_here.chars().filter(char::is_ascii_digit).count(), 6, "{shown_here}");
    writeln!(here.stdin.take().unwrap(), "{}", enter(&shown_there)).unwrap();
    writeln!(there.stdin.take().unwrap(), "{shown_here}").unwrap();
    [there.wait_with_output().unwrap(), here.wait_with_output().unwrap()]
}

#[test]
fn a_machine_that_is_not_paired_or_paired_with_a_wrong_code_is_refused() {
    let follower = tempfile::tempdir().unwrap();
    let console = tempfile::tempdir().unwrap();
    let address = free();
    let [there, here] = pair(follower.path(), console.path(), &address, |_| "000000".to_owned());
    assert!(there.status.success(), "{}", report(&there));
    assert!(!here.status.success(), "a wrong code was taken");
    assert!(!console.path().join("network/network.peers").exists());
    let stranger = at(console.path(), &["run", "--follower", "no-such-host.invalid", "--seconds", "1"]);
    let stranger = stranger.wait_with_output().unwrap();
    assert!(!stranger.status.success());
    assert!(report(&stranger).contains("no-such-host.invalid"), "{}", report(&stranger));
}

#[test]
fn the_handle_is_at_one_machine_and_the_arm_at_the_other() {
    let _alone = alone();
    let follower = tempfile::tempdir().unwrap();
    let console = tempfile::tempdir().unwrap();
    let address = free();
    for output in pair(follower.path(), console.path(), &address, str::to_owned) {
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
        // A machine that stalled for 0.1 s stops both.
        if json["final_state"] != "engaged" || json["link"]["open"] != true {
            too_busy();
        }
        let count = |name: &str| json["link"][name].as_f64().unwrap();
        assert!(count("delivered") > 4000.0);
        if count("lost") > 0.002 * count("delivered") {
            too_busy();
        }
        assert_eq!(json["link"]["dropped"], 0);
        // The other machine lost the connection: it stopped, and reports the cause.
        assert!(!there.status.success());
        assert!(report(&there).contains("the other machine was closed") || report(&there).contains("over the link"));
    });
}
