//! The paper's rig from unpacking to first touch, as a user types it: every calibration of both arms over the emulated
//! interfaces, then both arms engaged with all stages active.
#![cfg(target_os = "linux")]
use std::{
    fs,
    os::unix::fs::DirBuilderExt as _,
    path::Path,
    process::{Command, Output},
};

use nima_core::calibration::{RecordHead, gravity::GravityRecord};
use nima_recording::store::Store;
use nima_testing::real_time::{alone, judged, too_busy};
use nima_tests::gravity::gravity;
use serde_json::Value;

use super::installed::rig;

/// Maximum errors of the tip force compared with the true force, N: mean error per axis in motion, and mean and standard
/// deviation without contact.
const MAE_N: f64 = 0.08;
const FREE_MEAN_N: f64 = 0.03;
const FREE_SD_N: f64 = 0.04;

/// A user's folders, with this rig file.
struct Home(tempfile::TempDir);

impl Home {
    fn new(rig: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::DirBuilder::new().mode(0o700).create(folder.path().join("run")).unwrap();
        let home = Self(folder);
        home.write(rig);
        home
    }

    fn write(&self, rig: &str) {
        fs::write(self.0.path().join("rig.toml"), rig).unwrap();
    }

    fn nima(&self, arguments: &[&str]) -> Output {
        let folder = self.0.path();
        Command::new(env!("CARGO_BIN_EXE_nima"))
            .args(arguments)
            .current_dir(folder)
            .env("HOME", folder)
            .env("NIMA_DATA_DIR", folder.join("data"))
            .env("XDG_RUNTIME_DIR", folder.join("run"))
            .output()
            .unwrap()
    }

    /// Runs for some seconds; returns the results and the output.
    fn run(&self, seconds: &str) -> (Value, String) {
        let output = self.nima(&["run", "--rig", "rig.toml", "--seconds", seconds, "--json"]);
        let json = serde_json::from_slice(&output.stdout).unwrap_or_default();
        (json, String::from_utf8_lossy(&output.stderr).into_owned())
    }

    fn store(&self) -> Store {
        Store::open(self.0.path().join("data/calibrations"))
    }
}

fn record(sensor: &str, tool: &str) -> GravityRecord {
    let made = gravity();
    GravityRecord { head: RecordHead::new(sensor, tool, &made.head.date), ..made }
}

/// The rig runs idle, one line reports the missing calibrations and the command for them, and the command fails.
#[test]
fn without_calibrations_the_devices_run_and_one_line_says_what_is_missing() {
    let _alone = alone();
    let home = Home::new(&rig());
    judged(|| {
        let output = home.nima(&["run", "--rig", "rig.toml", "--seconds", "5", "--json"]);
        let figures: Value = serde_json::from_slice(&output.stdout).unwrap_or_default();
        let report = String::from_utf8_lossy(&output.stderr).into_owned();
        let lines: Vec<_> = report.lines().filter(|line| line.contains("not calibrated")).collect();
        assert!(!lines.is_empty() && figures["ticks"].as_u64().unwrap_or(0) >= 1000, "{report}");
        println!("{report}");
        // A sensor that was opened late adds its own line.
        let all = lines.last().unwrap();
        for words in ["SN000901", "SN000902", "gravity", "nima calibrate rig --rig rig.toml", "the arms stay idle"] {
            assert!(all.contains(words), "{words}: {report}");
        }
        assert_eq!(figures["final_state"], "idle", "{report}");
        let is_reason = |line: &str| line.contains("no arm was engaged: ") && line.contains("no gravity calibration");
        assert!(!output.status.success() && report.lines().any(is_reason), "{report}");
    });
}

#[test]
fn a_sensor_or_a_tool_in_anothers_place_is_told_at_the_start() {
    let _alone = alone();
    let home = Home::new(&rig());
    home.store().save(&record("SN000901", "Emulated right grasper")).unwrap();
    home.store().save(&record("SN000902", "Emulated left grasper")).unwrap();
    // Swap the sensors first, then the tools.
    let sensors = rig().replace("\"901\"", "\"9\"").replace("\"902\"", "\"901\"").replace("\"9\"", "\"902\"");
    let tools = rig().replace("right grasper", "scissors");
    let cases = [
        (sensors, ["SN000902 with \"Emulated right grasper\": gravity", "The right and left sensors, or their tools"]),
        (tools, ["SN000901 with \"Emulated scissors\": gravity", "not \"Emulated scissors\""]),
    ];
    for (rig, words) in &cases {
        home.write(rig);
        judged(|| {
            let (figures, report) = home.run("5");
            println!("{report}");
            let line = report.lines().rfind(|line| line.contains("not calibrated")).unwrap();
            assert!(line.contains("SN000901") && line.contains("SN000902"), "{line}");
            for words in words {
                assert!(line.contains(words), "{words}: {report}");
            }
            assert_eq!(figures["final_state"], "idle");
        });
    }
}

fn three(value: &Value) -> [f64; 3] {
    [0, 1, 2].map(|axis| value[axis].as_f64().unwrap())
}

/// Checks the errors of both arms; prints them for docs/results/calibration.md.
fn judge(figures: &Value) {
    let errors = figures["tip_error"].as_array().unwrap();
    for side in ["right", "left"] {
        let of = |method: &str| {
            let error = errors.iter().find(|error| error["side"] == side && error["method"] == method).unwrap();
            println!("{side:5} {error}");
            error
        };
        let [network, gravity, wrist] = ["tip force", "gravity only", "wrist only"].map(of);
        let worst = |error: &Value| three(&error["mae_n"]).into_iter().fold(0.0, f64::max);
        let free = &network["free"];
        let mean_n = three(&free["mean_n"]).into_iter().map(f64::abs).fold(0.0, f64::max);
        let sd_n = three(&free["sd_n"]).into_iter().fold(0.0, f64::max);
        assert!(worst(network) <= MAE_N, "{side}: {network}");
        assert!(mean_n <= FREE_MEAN_N && sd_n <= FREE_SD_N, "{side}: {network}");
        assert!(worst(gravity) > 2.0 * worst(network) && worst(wrist) > 2.0 * worst(gravity), "{side}");
    }
}

#[test]
#[ignore = "ten minutes in real time: `./dev walk` runs it"]
fn from_boxes_to_first_touch() {
    let _alone = alone();
    let home = Home::new(&rig());
    let commissioned = home.nima(&["calibrate", "rig", "--rig", "rig.toml"]);
    let report = String::from_utf8_lossy(&commissioned.stderr).into_owned();
    println!("{report}");
    assert!(commissioned.status.success(), "{report}");
    for sensor in ["SN000901", "SN000902"] {
        for kind in ["gravity", "correspondence"] {
            assert!(is_there(home.0.path(), &format!("{kind}-{sensor}.toml")), "{kind} of {sensor}");
        }
        assert!(is_there(home.0.path(), &format!("tip-force-{sensor}.safetensors")), "tip force of {sensor}");
    }
    is_ready(&home);
    judged(|| {
        let (figures, report) = home.run("30");
        assert!(!report.contains("not calibrated"), "{report}");
        assert_eq!(figures["final_state"], "engaged", "{report}");
        judge(&figures);
    });
}

/// Runs the ready check of the calibrated rig, with the technician at its arms.
fn is_ready(home: &Home) {
    judged(|| {
        let checked = home.nima(&["check", "rig", "--rig", "rig.toml"]);
        let report = String::from_utf8_lossy(&checked.stdout).into_owned();
        println!("{report}");
        // A delay on a busy machine looks like a faulty device.
        if report
            .lines()
            .any(|line| line.contains("FAILED") && (line.starts_with("Rates") || line.starts_with("Clocks")))
        {
            too_busy();
        }
        assert!(checked.status.success(), "{report}");
        assert!(!report.contains("skipped"), "the rig has every part: {report}");
    });
}

fn is_there(home: &Path, name: &str) -> bool {
    home.join("data/calibrations").join(name).exists()
}
