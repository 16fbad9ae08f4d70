//! The paper's rig with all devices missing, in a network namespace of this test: nothing is sent to an outside address.
#![cfg(target_os = "linux")]
use std::{
    path::Path,
    process::{Command, Output},
};

use nima_machine::config::RigFile;
use nima_simulation::scene::Scene;
use nima_testing::{
    real_time::{alone as one_rig_at_a_time, judged, too_busy},
    unjudged,
};
use nima_tests::emulated::{DEVICES, elsewhere, rig_file, started_in};

/// Returns the ten of the paper's rig.
fn devices() -> impl Iterator<Item = &'static str> {
    DEVICES.into_iter().filter(|device| *device != "left servos")
}

/// Returns the program with these arguments in a namespace without any network; `None`, with a message, if no namespace
/// can be created.
fn alone(arguments: &[&str]) -> Option<Output> {
    let inside = |program: &str, arguments: &[&str], folder: &std::path::Path| {
        let mut command = Command::new("unshare");
        command.args(["--map-root-user", "--net", program]).args(arguments).env("NIMA_DATA_DIR", folder);
        command.env("XDG_RUNTIME_DIR", folder).env_remove("FDSDK").output()
    };
    let ports = ["/dev/ttyACM", "/dev/ttyUSB"];
    if ports.iter().any(|port| (0..4).any(|number| Path::new(&format!("{port}{number}")).exists())) {
        unjudged::left_out("this computer has serial devices, which the rig would open");
        return None;
    }
    let folder = tempfile::tempdir().unwrap();
    if !inside("true", &[], folder.path()).is_ok_and(|tried| tried.status.success()) {
        unjudged::left_out("no network namespace can be made");
        return None;
    }
    Some(inside(env!("CARGO_BIN_EXE_nima"), arguments, folder.path()).unwrap())
}

#[test]
fn every_device_that_is_not_there_has_its_cause_and_its_cure() {
    let Some(tested) = alone(&["devices", "--rig", "paper"]) else { return };
    let report = String::from_utf8(tested.stdout).unwrap();
    let refused = String::from_utf8(tested.stderr).unwrap();
    assert!(!tested.status.success() && refused.contains("10 of 10 devices cannot be used"), "{refused}");
    let lines: Vec<_> = report.lines().collect();
    for device in devices() {
        let at = lines.iter().position(|line| line.trim_start().starts_with(device));
        let at = at.unwrap_or_else(|| panic!("{device} is not in:\n{report}"));
        assert!(lines[at].contains("problem: "), "{}", lines[at]);
        assert!(
            lines[at + 1].starts_with("      ") && lines[at + 1].trim().len() > 20,
            "{device} has no remedy:\n{report}"
        );
    }
    let cause = |device: &str| lines.iter().find(|line| line.trim_start().starts_with(device)).unwrap();
    assert!(cause("right arm").contains("192.0.2.10:10000 is only an example"), "{report}");
    assert!(cause("tracker").contains("tools[0] = right-instrument.rom: the file cannot be read"), "{report}");
}

#[test]
fn a_run_names_the_first_device_and_ends_with_its_cause() {
    let Some(run) = alone(&["run", "--rig", "paper", "--seconds", "1"]) else { return };
    let report = String::from_utf8(run.stdout).unwrap();
    let refused = String::from_utf8(run.stderr).unwrap();
    assert!(!run.status.success(), "{report}");
    let last = refused.lines().last().unwrap();
    assert!(last.contains("right handle: the Force Dimension SDK") && last.contains("is not installed"), "{refused}");
    assert!(report.contains("right arm ended: No device") && !report.contains("error of each mode"), "{report}");
    for device in devices() {
        assert!(refused.contains(&format!("{device}: ")), "{device} is not in:\n{refused}");
    }
}

/// Returns the changes this device of the rig to an address without a device; `None` for a name outside the list above.
fn take_away(file: &mut RigFile, device: &str, folder: &Path) -> Option<()> {
    let nowhere = folder.join("ttyACM-nothing-here").display().to_string();
    // Bind and close again, so that nothing listens on the port.
    let closed = || std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let (side, part) = device.split_once(' ').unwrap_or(("", device));
    match part {
        "handle" => file.set(&format!("devices.{side}.handle.emulator"), closed().to_string()),
        "arm" => file.set(&format!("devices.{side}.arm.tcp_port"), i64::from(closed().port())),
        "sensor" if side == "tissue" => file.set("devices.tissue_sensor.port", &nowhere),
        "sensor" if device == "left sensor" => file.set("devices.left.sensor.port", closed().to_string()),
        "sensor" | "servos" => file.set(&format!("devices.{side}.{part}.port"), &nowhere),
        "tracker" => file.set("devices.tracker.address", closed().to_string()),
        "pedal" => file.set("devices.pedal.source", format!("emulated:{nowhere}")),
        _ => return None,
    }
    Some(())
}

/// All other devices are present, on their interfaces.
#[test]
#[ignore = "opens a rig of ten devices ten times: `./dev walk` runs it"]
fn the_one_device_that_is_missing_is_the_one_that_is_named() {
    let _alone = one_rig_at_a_time();
    let folder = tempfile::tempdir().unwrap();
    let devices = elsewhere(folder.path());
    let _emulated = started_in(&Scene::load("bimanual").unwrap(), &devices);
    let rig = folder.path().join("rig.toml");
    let tested = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_nima"));
        let output = command.args(["devices", "--rig"]).arg(&rig).env("NIMA_DATA_DIR", folder.path()).output().unwrap();
        let [report, refused] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        (output.status.success(), report, refused)
    };
    judged(|| {
        std::fs::write(&rig, rig_file(&devices).text()).unwrap();
        assert!(tested().0, "{}", tested().1);
        for device in DEVICES {
            let mut file = rig_file(&devices);
            take_away(&mut file, device, folder.path()).unwrap();
            std::fs::write(&rig, file.text()).unwrap();
            let (all_there, report, refused) = tested();
            assert!(!all_there && !report.is_empty(), "{device}:\n{report}{refused}");
            let lines: Vec<_> = report.lines().collect();
            let troubled: Vec<_> = (0..lines.len()).filter(|at| lines[*at].contains("problem: ")).collect();
            let [at] = troubled[..] else {
                assert!(troubled.iter().any(|at| lines[*at].trim_start().starts_with(device)), "{device}:\n{report}");
                too_busy()
            };
            assert!(lines[at].trim_start().starts_with(device), "{device} is missing:\n{report}");
            assert!(refused.contains("1 of 11 devices cannot be used"), "{refused}");
            println!("{}\n{}", lines[at].trim(), lines[at + 1].trim());
        }
    });
}
