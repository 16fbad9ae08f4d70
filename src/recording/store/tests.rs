//! Calibration files: saved, refused, replaced and damaged.

use std::time::Duration;

use nalgebra::Vector3;
use nima_core::{
    calibration::{
        Verdict,
        correspondence::{CorrespondenceOptions, CorrespondenceRecord, CorrespondenceReport, PushPair, fit},
        gravity::GravityRecord,
    },
    frames::from_roll_pitch_yaw_deg,
    noise::Noise,
};

use super::*;

fn report(pushes: usize) -> CorrespondenceReport {
    let mut noise = Noise::new(3);
    let s1_from_s2 = from_roll_pitch_yaw_deg(&Vector3::new(20.0, -40.0, 70.0));
    let mut one = || {
        let f2_n = Vector3::from_fn(|_, _| 2.0 * noise.gaussian());
        PushPair::plain(s1_from_s2 * f2_n + Vector3::from_fn(|_, _| 0.01 * noise.gaussian()), f2_n)
    };
    let pairs: Vec<_> = (0..pushes).map(|_| one()).collect();
    fit(&pairs, &CorrespondenceOptions::default()).unwrap()
}

fn record(sensor: &str) -> CorrespondenceRecord {
    let record = CorrespondenceRecord::of(&report(20), [sensor, "grasper"], false, &utc_now()).unwrap();
    assert_eq!(record.judgement.verdict, Verdict::Accepted, "{}", record.judgement.reason);
    record
}

fn now() -> SystemTime {
    SystemTime::now()
}

#[test]
fn what_is_saved_is_loaded_digit_by_digit() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path().join("not/yet/there"));
    assert_eq!(store.load::<CorrespondenceRecord>("BFT-1", "grasper", now()).unwrap(), None);
    let saved = record("BFT-1");
    let path = store.save(&saved).unwrap();
    let loaded = store.load::<CorrespondenceRecord>("BFT-1", "grasper", now()).unwrap().unwrap();
    assert_eq!((loaded.record, loaded.age, loaded.path), (saved, CalibrationAge::Fresh, path));
}

/// A file in the format used before records had a common head.
const BEFORE: &str = include_str!("gravity-before.toml");

#[test]
fn a_file_from_before_is_read_and_written_to_the_letter() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("gravity-S1.toml");
    std::fs::write(&path, BEFORE).unwrap();
    let mut record = read::<GravityRecord>(&path).unwrap().unwrap();
    assert_eq!((record.head.sensor.as_str(), record.head.tool.as_str()), ("S1", "grasper"));
    assert_eq!((record.judgement.verdict, record.poses), (Verdict::Accepted, 16));
    write(&path, &record).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), BEFORE);
    record.judgement.override_by(" A. Technician ", Some("practice"));
    write(&path, &record).unwrap();
    assert_eq!(read::<GravityRecord>(&path).unwrap(), Some(record));
    for (key, wrong) in
        [("tool = ", "tool = 3 #"), ("verdict = ", "verdict = \"fine\" #"), ("poses = ", "colour = 3\nposes = ")]
    {
        std::fs::write(&path, BEFORE.replace(key, wrong)).unwrap();
        let message = read::<GravityRecord>(&path).unwrap_err().to_string();
        assert!(message.contains("gravity-S1.toml") && message.contains("line"), "{message}");
    }
}

#[test]
fn another_sensor_tool_or_kind_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path());
    let path = store.save(&record("A1")).unwrap();
    let message = store.load::<CorrespondenceRecord>("A1", "scissors", now()).unwrap_err().to_string();
    assert!(message.contains("is for tool \"grasper\", not \"scissors\""), "{message}");
    std::fs::copy(&path, store.path::<CorrespondenceRecord>("B2").unwrap()).unwrap();
    let message = store.load::<CorrespondenceRecord>("B2", "grasper", now()).unwrap_err().to_string();
    assert!(message.contains("is for sensor \"A1\", not \"B2\""), "{message}");
    let text = std::fs::read_to_string(&path).unwrap().replace("\"correspondence\"", "\"gravity\"");
    std::fs::write(&path, text).unwrap();
    let message = store.load::<CorrespondenceRecord>("A1", "grasper", now()).unwrap_err().to_string();
    assert!(message.contains("is for kind \"gravity\", not \"correspondence\""), "{message}");
}

#[test]
fn age_is_told_in_days() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path());
    store.save(&record("A1")).unwrap();
    let days = |days: u64| now() + Duration::from_secs(days * DAY_S + 60);
    let age = |store: &Store, now| store.load::<CorrespondenceRecord>("A1", "grasper", now).unwrap().unwrap().age;
    assert_eq!(age(&store, days(30)), CalibrationAge::Fresh);
    assert_eq!(age(&store, days(31)), CalibrationAge::Old { days: 31 });
    assert_eq!(age(&store.clone().with_max_age_days(2), days(3)), CalibrationAge::Old { days: 3 });
    assert_eq!(age(&store, now() - Duration::from_secs(3 * DAY_S)), CalibrationAge::Future);
}

#[test]
fn the_calibration_before_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path());
    let first = record("A1");
    let mut second = record("A1");
    second.head.tool = "scissors".into();
    let path = store.save(&first).unwrap();
    store.save(&second).unwrap();
    assert_eq!(read::<CorrespondenceRecord>(&path).unwrap(), Some(second));
    assert_eq!(read::<CorrespondenceRecord>(&previous(&path)).unwrap(), Some(first));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn a_calibration_of_another_kind_is_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    std::fs::write(&path, BEFORE).unwrap();
    let message = write(&path, &record("A1")).unwrap_err().to_string();
    assert!(message.contains("of kind \"gravity\", and one of kind \"correspondence\""), "{message}");
    assert_eq!((std::fs::read_to_string(&path).unwrap().as_str(), previous(&path).exists()), (BEFORE, false));
    std::fs::write(&path, "kind of a note").unwrap();
    write(&path, &record("A1")).unwrap();
    assert_eq!(std::fs::read_to_string(previous(&path)).unwrap(), "kind of a note");
}

#[test]
fn a_refused_one_is_kept_only_under_a_name() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path());
    let mut refused = CorrespondenceRecord::of(&report(4), ["A1", "grasper"], false, &utc_now()).unwrap();
    assert!(matches!(store.save(&refused), Err(StoreError::Refused { .. })));
    refused.judgement.override_by = Some("  ".into());
    assert!(matches!(store.save(&refused), Err(StoreError::Refused { .. })));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    refused.judgement.override_by = Some("A. Technician".into());
    refused.judgement.override_reason = Some("bench test".into());
    let path = store.save(&refused).unwrap();
    assert_eq!(store.load::<CorrespondenceRecord>("A1", "grasper", now()).unwrap().unwrap().record, refused);
    // Removing the name by hand must be detected.
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("override_by = \"A. Technician\""), "{text}");
    std::fs::write(&path, text.replace("override_by = \"A. Technician\"\n", "")).unwrap();
    assert!(matches!(store.load::<CorrespondenceRecord>("A1", "grasper", now()), Err(StoreError::Refused { .. })));
}

#[test]
fn every_damage_names_the_file_and_the_place() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path());
    let path = store.save(&record("A1")).unwrap();
    let good = std::fs::read_to_string(&path).unwrap();
    let damaged = |edit: &dyn Fn(&str) -> String| {
        std::fs::write(&path, edit(&good)).unwrap();
        let message = store.load::<CorrespondenceRecord>("A1", "grasper", now()).unwrap_err().to_string();
        assert!(message.contains("correspondence-A1.toml") && message.lines().count() == 1, "{message}");
        message
    };
    let message = damaged(&|good| good.replace("pairs = ", "colour = 3\npairs = "));
    assert!(message.contains("line") && message.contains("unknown field `colour`"), "{message}");
    assert!(damaged(&|good| good[..good.len() / 3].to_owned()).contains("damaged"));
    assert!(damaged(&|good| good.replace("pairs = 20", "pairs = ")).contains("line"));
    assert!(damaged(&|_| String::new()).contains("missing field"));
    let message = damaged(&|good| good.replace("rotation_wxyz = [", "rotation_wxyz = [1e9, 0.0, 0.0, 0.0]\n# ["));
    assert!(message.contains("length one"), "{message}");
    assert!(
        damaged(&|good| good.replace("uncertainty_deg = ", "uncertainty_deg = nan # ")).contains("uncertainty_deg")
    );
    let of_the_date = |good: &str| good.replace("date = \"20", "date = \"soon 20");
    assert!(damaged(&of_the_date).contains("write it like 2026-08-21T10:20:30Z"));
}

/// Reads this text once with an additional key in each of its tables, and with each of its keys misspelled.
fn no_key_passes_unknown<R: CalibrationRecord + std::fmt::Debug>(good: &str) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("edited.toml");
    let report = |lines: &[String]| {
        std::fs::write(&path, lines.join("\n")).unwrap();
        let message = read::<R>(&path).map(|_| "read").unwrap_err().to_string();
        assert!(message.contains("edited.toml") && message.lines().count() == 1, "{message}");
        message
    };
    let lines: Vec<_> = good.lines().map(str::to_owned).collect();
    let tables = lines.iter().enumerate().filter(|(_, line)| line.starts_with('[')).map(|(k, _)| k + 1);
    for at in tables.chain([0]) {
        let mut edited = lines.clone();
        edited.insert(at, "colour = 3".to_owned());
        let message = report(&edited);
        assert!(message.contains("colour"), "below line {at}: {message}");
    }
    for at in 0..lines.len() {
        let Some((key, value)) = lines[at].split_once(" = ") else { continue };
        let mut edited = lines.clone();
        edited[at] = format!("{key}x = {value}");
        let message = report(&edited);
        assert!(message.contains(key), "{key}: {message}");
    }
}

#[test]
fn an_unknown_or_misspelled_key_is_told_in_every_table() {
    let mut whole = record("A1");
    whole.judgement.override_by("A. Technician", Some("practice"));
    assert!(whole.diagnosis.is_some());
    no_key_passes_unknown::<CorrespondenceRecord>(&toml::to_string(&whole).unwrap());
    let torque = "\n[model.parameters.physical.torque]\ncom_m = [0.0, 0.0, 0.0]\nbias_nm = [0.0, 0.0, 0.0]\n";
    let residuals = BEFORE[BEFORE.find("[residuals").unwrap()..].replace("[residuals", "[torque_residuals");
    no_key_passes_unknown::<GravityRecord>(BEFORE);
    no_key_passes_unknown::<GravityRecord>(&format!("{BEFORE}{torque}\n{residuals}"));
}

#[test]
fn names_never_lead_out_of_the_folder() {
    let store = Store::open("/calibrations");
    for name in ["", "..", ".hidden", "a/b", "a\\b", "a b", &"x".repeat(65)] {
        assert!(matches!(store.path::<CorrespondenceRecord>(name), Err(StoreError::Name { .. })), "{name}");
        assert!(store.path_of("tip-force", name, "csv").is_err(), "{name}");
    }
    let path = store.path_of("tip-force", "BFT-1", "safetensors").unwrap();
    assert_eq!(path, Path::new("/calibrations/tip-force-BFT-1.safetensors"));
}

#[test]
fn the_users_folder_follows_the_environment() {
    let folder = |pairs: &'static [(&str, &str)]| {
        user_folder(&|name| pairs.iter().find(|(known, _)| *known == name).map(|(_, value)| PathBuf::from(value)))
    };
    assert_eq!(folder(&[("NIMA_DATA_DIR", "/d"), ("HOME", "/h")]), Some("/d/calibrations".into()));
    assert_eq!(folder(&[]), None);
    if cfg!(target_os = "linux") {
        let xdg = folder(&[("XDG_DATA_HOME", "/x"), ("HOME", "/h")]);
        assert_eq!(xdg, Some("/x/nima-console/calibrations".into()));
        let home = folder(&[("XDG_DATA_HOME", "relative"), ("HOME", "/h")]);
        assert_eq!(home, Some("/h/.local/share/nima-console/calibrations".into()));
    }
}

#[cfg(unix)]
#[test]
fn a_file_that_only_its_owner_may_read_stays_so_and_so_does_the_one_before() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path());
    let path = store.save(&record("A1")).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o600)).unwrap();
    store.save(&record("A1")).unwrap();
    for path in [&path, &previous(&path)] {
        assert_eq!(std::fs::metadata(path).unwrap().permissions().mode() & 0o777, 0o600, "{}", path.display());
    }
}

#[test]
fn a_message_repeats_no_more_of_a_file_than_a_line() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path());
    let path = store.save(&record("A1")).unwrap();
    let good = std::fs::read_to_string(&path).unwrap();
    let long = "x".repeat(500_000);
    for edit in ["kind = \"X", "sensor = \"X", "tool = \"X", "date = \"X", "verdict = \"X", "X = \""] {
        let key = edit.split(" =").next().unwrap();
        let edited = edit.replace('X', &long);
        let text: String = good
            .lines()
            .map(|line| if line.starts_with(key) { edited.clone() + "\"\n" } else { format!("{line}\n") })
            .collect();
        let text = if key == "X" { format!("{edited}\"\n{text}") } else { text };
        std::fs::write(&path, text).unwrap();
        let message = store.load::<CorrespondenceRecord>("A1", "grasper", now()).unwrap_err().to_string();
        assert!(message.contains("xxx") && message.len() < 1000, "{key}: {} bytes: {message:.300}", message.len());
    }
}
