//! `nima run --igtl` and `--lsl`, as a user would type them.
use std::{
    io::{BufRead as _, BufReader, Read as _},
    net::TcpStream,
    process::{Command, Stdio},
    time::Duration,
};

use nima_bridges::igtl::{Content, IgtlHeader, IgtlMessage};

use crate::{
    every_command::{json, nima},
    one_line,
};

/// Reads the messages of a run until its JSON text reports that the arm is engaged, and checks which devices they name.
#[test]
fn a_run_tells_its_poses_and_forces_over_openigtlink() {
    let mut run = Command::new(env!("CARGO_BIN_EXE_nima"))
        .args(["run", "--igtl", "127.0.0.1:0", "--seconds", "60"])
        .env("NIMA_DATA_DIR", "/dev/null/no/such/folder")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(run.stderr.take().unwrap()).lines();
    let address = lines.find_map(|line| {
        let (_, rest) = line.as_ref().ok()?.split_once("OpenIGTLink at ")?;
        Some(rest.split_once(": connect")?.0.to_owned())
    });
    let address = address.expect("it does not say where it listens");
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
    let mut devices = Vec::new();
    loop {
        let mut head = [0; IgtlHeader::BYTES];
        stream.read_exact(&mut head).unwrap();
        let header = IgtlHeader::read(&head).unwrap();
        let mut body = vec![0; header.body_bytes as usize];
        stream.read_exact(&mut body).unwrap();
        let IgtlMessage { device, content, .. } = IgtlMessage::read(&header, &body).unwrap();
        devices.push(format!("{} {device}", content.kind()));
        let Content::Text(text) = content else { continue };
        let report: serde_json::Value = serde_json::from_slice(&text.bytes).unwrap();
        if report["right"]["state"] == "Engaged" {
            break;
        }
    }
    run.kill().unwrap();
    run.wait().unwrap();
    for expected in [
        "TRANSFORM right.tip",
        "TRANSFORM right.leader",
        "TDATA nima",
        "SENSOR right.measured",
        "SENSOR right.rendered",
        "STATUS right.state",
    ] {
        assert!(devices.iter().any(|device| device == expected), "{expected}: {devices:?}");
    }
}

#[test]
fn a_bridge_needs_the_real_clock_and_an_address() {
    for (arguments, words) in [
        (["run", "--igtl", "here", "--seconds"], "invalid socket address"),
        (["run", "--igtl", "--virtual", "--seconds"], "cannot be used with"),
        (["run", "--lsl", "--virtual", "--seconds"], "cannot be used with"),
    ] {
        let report = nima(&[&arguments[..], &["1"]].concat());
        let text = String::from_utf8(report.stderr).unwrap();
        assert!(!report.status.success() && text.contains(words), "{text}");
    }
}

#[test]
fn what_cannot_be_offered_is_told_in_one_line_with_its_cure() {
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = taken.local_addr().unwrap().to_string();
    let line = one_line(&nima(&["run", "--igtl", &address, "--seconds", "1"]));
    assert!(line.contains(&address) && line.contains("choose another port"), "{line}");
    let line = one_line(&nima(&["run", "--lsl", "/no/such/liblsl.so", "--seconds", "1"]));
    assert!(line.contains("/no/such/liblsl.so") && line.contains("--lsl FILE"), "{line}");
}

#[test]
fn a_run_beside_a_bridge_that_nobody_reads_is_a_run_like_any_other() {
    let ran = json(&["run", "--igtl", "127.0.0.1:0", "--seconds", "1", "--json"]);
    assert!(ran["ticks"].as_u64().unwrap() > 500, "{ran}");
}
