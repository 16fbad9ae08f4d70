//! The paper's rig where none of its devices is there, in a network namespace that this test makes: nothing is sent to an address outside.
#![cfg(target_os = "linux")]
use std::process::{Command, Output};

const DEVICES: [&str; 10] = [
    "right handle",
    "right arm",
    "right sensor",
    "right servos",
    "left handle",
    "left arm",
    "left sensor",
    "tissue sensor",
    "tracker",
    "pedal",
];

/// The program with these arguments in a namespace without any network; `None`, said aloud, where none may be made.
fn alone(arguments: &[&str]) -> Option<Output> {
    let inside = |program: &str, arguments: &[&str], folder: &std::path::Path| {
        let mut command = Command::new("unshare");
        command.args(["--map-root-user", "--net", program]).args(arguments).env("NIMA_DATA_DIR", folder);
        command.env("XDG_RUNTIME_DIR", folder).env_remove("FDSDK").output()
    };
    let folder = tempfile::tempdir().unwrap();
    if !inside("true", &[], folder.path()).is_ok_and(|tried| tried.status.success()) {
        eprintln!("left out: no network namespace can be made here");
        return None;
    }
    Some(inside(env!("CARGO_BIN_EXE_nima"), arguments, folder.path()).unwrap())
}

#[test]
fn every_device_that_is_not_there_has_its_cause_and_its_cure() {
    let Some(tested) = alone(&["devices", "--rig", "paper"]) else { return };
    let told = String::from_utf8(tested.stdout).unwrap();
    let refused = String::from_utf8(tested.stderr).unwrap();
    assert!(!tested.status.success() && refused.contains("10 of 10 devices cannot be used"), "{refused}");
    let lines: Vec<_> = told.lines().collect();
    for device in DEVICES {
        let at = lines.iter().position(|line| line.trim_start().starts_with(device));
        let at = at.unwrap_or_else(|| panic!("{device} is not in:\n{told}"));
        assert!(lines[at].contains("problem: "), "{}", lines[at]);
        assert!(
            lines[at + 1].starts_with("      ") && lines[at + 1].trim().len() > 20,
            "{device} has no cure:\n{told}"
        );
    }
    let cause = |device: &str| lines.iter().find(|line| line.trim_start().starts_with(device)).unwrap();
    assert!(cause("right arm").contains("192.168.1.10:10000 cannot be reached"), "{told}");
    assert!(cause("tracker").contains("tools[0] = right-instrument.rom: the tool definition cannot be read"), "{told}");
}

#[test]
fn a_run_names_the_first_device_and_ends_with_its_cause() {
    let Some(run) = alone(&["run", "--rig", "paper", "--seconds", "1"]) else { return };
    let (told, refused) = (String::from_utf8(run.stdout).unwrap(), String::from_utf8(run.stderr).unwrap());
    assert!(!run.status.success(), "{told}");
    let last = refused.lines().last().unwrap();
    assert!(last.contains("right handle: the Force Dimension SDK") && last.contains("is not installed"), "{refused}");
    assert!(told.contains("right arm ended: No device") && !told.contains("error of each mode"), "{told}");
    for device in DEVICES {
        assert!(refused.contains(&format!("{device}: ")), "{device} is not in:\n{refused}");
    }
}
