//! `nima check rig`, as a user types it: on the simulated rig with a person at the arm, and its refusals.

use std::{
    path::Path,
    process::{Command, Output},
};

use nima_recording::store::{PointOutcome, ReadyRecord, Store};
use nima_testing::real_time::{alone, judged};
use nima_tests::gravity::gravity;

fn nima(data: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_nima"));
    command.args(["check", "rig"]).args(arguments).env("NIMA_DATA_DIR", data).output().unwrap()
}

fn store(data: &Path) -> Store {
    Store::open(data.join("calibrations"))
}

/// Returns the simulated rig, whose wrist sensor's bias is off by `step_n` along x since its calibration.
fn checked(data: &Path, step_n: f64) -> (Output, ReadyRecord) {
    store(data).save(&gravity()).unwrap();
    let scene = include_str!("../../../config/scenes/correspondence.toml");
    assert!(scene.contains("force_bias_n = [1.8,"));
    let file = data.join("scene.toml");
    std::fs::write(&file, scene.replace("force_bias_n = [1.8,", &format!("force_bias_n = [{},", 1.8 + step_n)))
        .unwrap();
    let scene = file.to_str().unwrap();
    let output = nima(data, &["--rig", "simulated", "--scene", scene, "--by", "Ada Lovelace"]);
    let record = store(data).last_check("Simulated rig").unwrap();
    (output, record)
}

fn of<'a>(record: &'a ReadyRecord, check: &str) -> &'a nima_recording::store::CheckedItem {
    record.items.iter().find(|item| item.check == check).unwrap()
}

#[test]
fn a_simulated_rig_in_order_passes_and_its_record_says_what_was_measured() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    judged(|| {
        let (output, record) = checked(folder.path(), 0.0);
        let report = String::from_utf8_lossy(&output.stdout).into_owned();
        println!("{report}{}", String::from_utf8_lossy(&output.stderr));
        assert!(output.status.success() && record.passed);
        assert!(report.contains("Right arm: direction of the force: passed") && report.contains("skipped"));
        assert_eq!((record.by.as_str(), record.rig_file.as_str()), ("Ada Lovelace", "simulated"));
        assert!(record.took_s < 60.0);
        let drift = of(&record, "Right arm: drift of the bias");
        assert!(
            drift.outcome == PointOutcome::Passed && drift.value < drift.limit && drift.unit.as_deref() == Some("N")
        );
        assert!(
            record.items.iter().all(|item| matches!(item.outcome, PointOutcome::Passed | PointOutcome::LeftOut)),
            "{record:?}"
        );
        assert!(record.items.iter().filter(|item| item.check.starts_with("Watchdog")).count() == 3);
    });
}

#[test]
fn a_rig_that_is_not_ready_fails_in_one_line_and_its_record_says_why_and_what_to_do() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let (output, record) = checked(folder.path(), 0.6);
    let report = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && !record.passed, "{report}");
    let last = report.lines().last().unwrap();
    assert!(
        last.starts_with("nima: the rig is not ready: Right arm: drift of the bias") && last.contains("ready_check-")
    );
    let drift = of(&record, "Right arm: drift of the bias");
    assert_eq!(drift.outcome, PointOutcome::Failed);
    assert!(
        drift.cause.as_ref().unwrap().starts_with("0.6") && drift.cure.as_ref().unwrap().contains("calibrate gravity")
    );
    assert_eq!(of(&record, "Stop").outcome, PointOutcome::Passed, "the rest is checked too");
}

#[test]
fn a_rig_of_real_devices_is_sent_to_the_console_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    for rig in ["paper", "haply-desk"] {
        let output = nima(folder.path(), &["--rig", rig]);
        let report = String::from_utf8(output.stderr).unwrap();
        assert!(
            !output.status.success() && report.lines().count() == 1 && report.contains("run it in `nima console`"),
            "{report}"
        );
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
