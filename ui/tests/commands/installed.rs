//! `nima` alone, as installed: copied to an otherwise empty folder.
#![cfg(target_os = "linux")]
use std::{
    fs,
    net::{TcpListener, UdpSocket},
    os::unix::fs::DirBuilderExt as _,
    path::Path,
    process::Command,
};

use nima_testing::real_time::{alone, judged};
use serde_json::Value;

/// Ports of the embedded rig.
const PORTS: [u16; 9] = [47130, 47100, 47101, 47131, 47110, 47111, 47140, 47120, 47160];

/// Returns the embedded emulated rig on ports that are free for TCP and UDP, so that it disturbs no other process.
pub(crate) fn rig() -> String {
    let mut text = include_str!("../../../config/rigs/emulated.toml").to_owned();
    // Hold all of them until the last has been chosen, so that no two are the same.
    let mut held = Vec::new();
    for port in PORTS {
        let free = loop {
            let listener = TcpListener::bind("127.0.0.1:0").unwrap();
            let free = listener.local_addr().unwrap().port();
            if let Ok(socket) = UdpSocket::bind(("127.0.0.1", free))
                && !PORTS.contains(&free)
            {
                held.push((listener, socket));
                break free;
            }
        };
        assert!(text.contains(&port.to_string()), "{port}");
        text = text.replace(&port.to_string(), &free.to_string());
    }
    text
}

/// Returns the readings of both handles and both arms during a run of three seconds, and its output.
fn run(folder: &Path) -> (Vec<u64>, String) {
    fs::write(folder.join("rig.toml"), rig()).unwrap();
    let output = Command::new(folder.join("nima"))
        .args(["run", "--rig", "rig.toml", "--seconds", "3", "--json"])
        .current_dir(folder)
        .env_remove("LD_LIBRARY_PATH")
        .env("HOME", folder)
        .env("XDG_RUNTIME_DIR", folder.join("run"))
        .output()
        .unwrap();
    let report = String::from_utf8_lossy(&output.stderr).into_owned();
    let json: Value = serde_json::from_slice(&output.stdout).unwrap_or_default();
    let readings = |name: &str| {
        let mut devices = json["devices"].as_array().into_iter().flatten();
        let device = devices.rfind(|device| device["name"] == name);
        device.and_then(|device| device["readings"].as_u64()).unwrap_or(0)
    };
    (["right handle", "left handle", "right arm", "left arm"].map(readings).to_vec(), report)
}

#[test]
fn the_emulated_rig_runs_with_nothing_beside_the_program() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    fs::copy(env!("CARGO_BIN_EXE_nima"), folder.path().join("nima")).unwrap();
    fs::DirBuilder::new().mode(0o700).create(folder.path().join("run")).unwrap();
    judged(|| {
        let (readings, report) = run(folder.path());
        println!("readings of both handles and both arms: {readings:?}\n{report}");
        // A busy machine cannot cause these; another program may have taken a port in between.
        for words in ["not installed", "cannot be used", "cannot emulate"] {
            assert!(!report.contains(words) || report.contains("in use by another program"), "{report}");
        }
        assert!(readings.iter().all(|readings| *readings > 100), "{readings:?}");
        assert!(fs::metadata(folder.path().join("run/nima-emulated")).unwrap().is_dir());
    });
}
