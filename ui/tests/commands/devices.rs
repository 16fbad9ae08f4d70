//! `nima devices`, as a user would type it.
use std::process::{Command, Output};

use serde_json::Value;

fn nima(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_nima")).arg("devices").args(arguments).output().unwrap()
}

fn text(arguments: &[&str]) -> String {
    let output = nima(arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn a_port_that_is_not_there_and_a_port_where_nobody_listens_are_told_with_their_cures() {
    let output = nima(&["--probe", "serial=/dev/no-such-port@460800", "--probe", "tcp=127.0.0.1:1"]);
    let refused = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && refused.contains("2 of 2 devices cannot be used"), "{refused}");
    let report = String::from_utf8(output.stdout).unwrap();
    for words in ["Plugged in", "/dev/no-such-port was not found", "Plug it in", "no response from 127.0.0.1:1"] {
        assert!(report.contains(words), "\"{words}\" is not in:\n{report}");
    }
    let output = nima(&["--json", "--probe", "serial=/dev/no-such-port@460800"]);
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    let device = &json["devices"][0];
    assert_eq!(device["name"], "serial=/dev/no-such-port@460800");
    assert_eq!((&device["state"], &device["trouble"]), (&"trouble".into(), &"absent".into()));
    assert!(device["cure"].is_string() && device["took_s"].is_f64() && json["plugged"]["serial"].is_array(), "{json}");
    assert!(json["cameras"].is_array(), "{json}");
}

#[test]
fn the_handle_that_leads_a_simulated_rig_is_tested_and_keeps_the_real_clock() {
    let folder = tempfile::tempdir().unwrap();
    let rig = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../config/rigs/haply-desk.toml")).unwrap();
    let path = folder.path().join("my-handle.toml");
    std::fs::write(&path, rig.replace("/dev/ttyACM0", "/dev/no-such-port")).unwrap();
    let output = nima(&["--rig", path.to_str().unwrap()]);
    let report = String::from_utf8(output.stdout).unwrap();
    assert!(!output.status.success() && report.contains("right handle"), "{report}");
    assert!(report.contains("/dev/no-such-port was not found"), "{report}");
    let mut run = Command::new(env!("CARGO_BIN_EXE_nima"));
    run.args(["run", "--virtual", "--seconds", "1", "--rig"]).arg(&path);
    let refused = run.env("NIMA_DATA_DIR", folder.path()).output().unwrap();
    let why = String::from_utf8(refused.stderr).unwrap();
    assert!(!refused.status.success() && why.contains("omit --virtual"), "{why}");
}

#[test]
fn the_rules_and_the_command_that_installs_them_are_printed() {
    assert!(text(&["--udev-rules"]).contains("1451"));
    let command = text(&["--udev"]);
    assert_eq!(command.lines().count(), 1, "{command}");
    assert!(command.contains("devices --udev-rules | sudo tee /etc/udev/rules.d/70-nima.rules"), "{command}");
}

#[test]
fn an_unknown_kind_names_the_known_ones_in_one_line() {
    let output = nima(&["--probe", "thing"]);
    let report = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && report.lines().count() == 1 && report.contains("serial=PORT@BAUD"), "{report}");
}

/// The test of an emulated rig without running emulators must not suggest checking plugs.
#[cfg(target_os = "linux")]
#[test]
fn an_emulated_rig_that_nobody_serves_names_the_command_that_does() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("rig.toml"), crate::installed::rig()).unwrap();
    let report = |rig: &str| {
        let output = Command::new(env!("CARGO_BIN_EXE_nima"))
            .args(["devices", "--rig", rig])
            .current_dir(folder.path())
            .env("XDG_RUNTIME_DIR", folder.path())
            .output()
            .unwrap();
        String::from_utf8(output.stdout).unwrap()
    };
    let emulated = report("rig.toml");
    assert!(emulated.contains("right arm") && emulated.contains("`nima emulate rig --rig rig.toml`"), "{emulated}");
    let rig = crate::installed::rig().replace("emulated = true", "emulated = false");
    let real: Vec<_> = rig.lines().filter(|line| !line.starts_with("emulator = ")).collect();
    std::fs::write(folder.path().join("real.toml"), real.join("\n")).unwrap();
    let real = report("real.toml");
    assert!(real.contains("right arm") && !real.contains("nima emulate rig"), "{real}");
}
