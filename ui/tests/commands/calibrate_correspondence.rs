//! `nima calibrate correspondence` with good and with bad files, as a user would type it.
use std::{
    fmt::Write as _,
    path::{Path, PathBuf},
    process::{Command, Output},
    time::SystemTime,
};

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::{calibration::correspondence::CorrespondenceRecord, frames::from_roll_pitch_yaw_deg, noise::Noise};
use nima_recording::store;
use serde_json::Value;

use crate::one_line;

fn calibrate(pairs: &Path, more: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_nima"))
        .args(["calibrate", "correspondence", pairs.to_str().unwrap()])
        .args(more)
        .output()
        .unwrap()
}

fn truth() -> UnitQuaternion<f64> {
    from_roll_pitch_yaw_deg(&Vector3::new(25.0, -40.0, 130.0))
}

/// Returns a file of 20 pushes, shaped by `shape`, with turned wrist and a little noise.
fn pairs(folder: &Path, shape: impl Fn(Vector3<f64>) -> Vector3<f64>) -> PathBuf {
    let mut noise = Noise::new(11);
    let mut text = String::from("f1x_n,f1y_n,f1z_n,f2x_n,f2y_n,f2z_n,qw,qx,qy,qz\n");
    for _ in 0..20 {
        let mut vector = |scale: f64| Vector3::from_fn(|_, _| scale * noise.gaussian());
        let f2 = shape(vector(1.0)).normalize() * 2.5;
        let q = from_roll_pitch_yaw_deg(&vector(60.0));
        let f1 = q * (truth() * f2) + vector(0.005);
        writeln!(text, "{},{},{},{},{},{},{},{},{},{}", f1.x, f1.y, f1.z, f2.x, f2.y, f2.z, q.w, q.i, q.j, q.k)
            .unwrap();
    }
    let path = folder.join("pairs.csv");
    std::fs::write(&path, text).unwrap();
    path
}

#[test]
fn a_good_file_gives_the_rotation_and_a_calibration_that_loads() {
    let folder = tempfile::tempdir().unwrap();
    let path = pairs(folder.path(), |v| v);
    let out = folder.path().join("c.toml");
    let output =
        calibrate(&path, &["--json", "--out", out.to_str().unwrap(), "--sensor", "BFT-7", "--tool", "grasper"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["verdict"], "accepted");
    assert!(!report["reason"].as_str().unwrap().is_empty());
    assert_eq!(report["solution"]["target"], "c_from_s2");
    for part in ["fitted", "held_out"] {
        for field in ["mae", "sd", "max"] {
            let axes = report["solution"]["agreement"]["residuals"][part][field].as_array().unwrap();
            assert!(axes.len() == 3 && axes.iter().all(|x| x.as_f64().unwrap() < 0.05), "{part} {field}");
        }
    }
    let record: CorrespondenceRecord = store::read(&out).unwrap().unwrap();
    assert!(record.rotation().angle_to(&truth()).to_degrees() < 0.2);
    assert_eq!(
        (record.head.sensor.as_str(), record.head.tool.as_str(), record.judgement.override_by),
        ("BFT-7", "grasper", None)
    );
    std::fs::rename(&out, folder.path().join("correspondence-BFT-7.toml")).unwrap();
    let store = store::Store::open(folder.path());
    let loaded = store.load::<CorrespondenceRecord>("BFT-7", "grasper", SystemTime::now()).unwrap().unwrap();
    assert_eq!(loaded.age, store::CalibrationAge::Fresh);
}

#[test]
fn the_text_begins_with_the_verdict() {
    let folder = tempfile::tempdir().unwrap();
    let output = calibrate(&pairs(folder.path(), |v| v), &[]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && text.starts_with("Accepted: 20 pushes agree"), "{text}");
    assert!(text.contains("held out") && text.contains("pitch -40.0"), "{text}");
}

#[test]
fn degenerate_files_print_their_report_fail_and_write_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("c.toml");
    for (shape, word) in [
        ((|v: Vector3<f64>| Vector3::x() * v.x) as fn(Vector3<f64>) -> Vector3<f64>, "one line"),
        (|v| Vector3::new(v.x, v.y, 0.0), "one plane"),
    ] {
        let output = calibrate(&pairs(folder.path(), shape), &["--json", "--out", out.to_str().unwrap()]);
        let line = one_line(&output);
        assert!(line.contains("Insufficient motion") && line.contains(word), "{line}");
        let report: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(report["verdict"], "insufficient_motion");
        assert!(!out.exists());
    }
}

#[test]
fn a_refused_set_is_written_only_under_a_name_and_still_fails() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("c.toml");
    let path = pairs(folder.path(), |v| Vector3::new(v.x, v.y, 0.0));
    let with = |name: &str| {
        let more = ["--out", out.to_str().unwrap(), "--override", name, "--override-reason", "bench only"];
        one_line(&calibrate(&path, &more))
    };
    assert!(with(" ").contains("--override requires the name"));
    assert!(!out.exists());
    assert!(with("A. Technician").contains("Insufficient motion"));
    let record: CorrespondenceRecord = store::read(&out).unwrap().unwrap();
    assert_eq!(record.judgement.override_by.as_deref(), Some("A. Technician"));
    assert_eq!(record.judgement.override_reason.as_deref(), Some("bench only"));
}

#[test]
fn a_wrong_sign_is_named_and_cured_by_the_right_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = pairs(folder.path(), |v| v);
    // The file contains the force on the instrument, so changing its sign is the mistake here.
    assert!(one_line(&calibrate(&path, &["--flip-s2"])).contains("opposite forces"));
    assert!(calibrate(&path, &[]).status.success());
}

#[test]
fn bad_files_are_refused_with_their_place_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let good = pairs(folder.path(), |v| v);
    let text = std::fs::read_to_string(&good).unwrap();
    let out = folder.path().join("c.toml");
    let refused = |text: &str, words: &[&str]| {
        let path = folder.path().join("bad.csv");
        std::fs::write(&path, text).unwrap();
        let output = calibrate(&path, &["--out", out.to_str().unwrap()]);
        let line = one_line(&output);
        assert!(output.stdout.is_empty() && words.iter().all(|word| line.contains(word)), "{line}");
        assert!(!out.exists());
    };
    refused(&text.replace("f2z_n", "oops"), &["no column \"f2z_n\""]);
    refused(&format!("{text}1,2,3,4,5,nan,1,0,0,0\n"), &["line 22", "f2z_n"]);
    refused(&format!("{text}1,2,3,4,5,6,0.2,0,0,0\n"), &["line 22", "length 0.2"]);
    refused(&format!("{text}1,2,3\n"), &["line"]);
    refused(&format!("{text}1e30,2,3,4,5,6,1,0,0,0\n"), &["pair 20", "check the units"]);
    let missing = one_line(&calibrate(&folder.path().join("none.csv"), &[]));
    assert!(missing.contains("none.csv"), "{missing}");
    let itself = one_line(&calibrate(&good, &["--out", good.to_str().unwrap()]));
    assert!(itself.contains("itself") && std::fs::read_to_string(&good).unwrap() == text);
    let nowhere = folder.path().join("no/such/folder/c.toml");
    let line = one_line(&calibrate(&good, &["--out", nowhere.to_str().unwrap()]));
    assert!(line.contains("cannot write"), "{line}");
}

#[test]
fn columns_of_other_names_are_mapped_and_a_bad_mapping_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = pairs(folder.path(), |v| v);
    let text = std::fs::read_to_string(&path).unwrap();
    let (_, rows) = text.split_once('\n').unwrap();
    std::fs::write(&path, format!("wrist_x,wrist_y,wrist_z,tissue_x,tissue_y,tissue_z,a,b,c,d\n{rows}")).unwrap();
    let out = folder.path().join("c.toml");
    let mapped = |maps: &[&str]| {
        let maps = maps.iter().flat_map(|map| ["--map", *map]);
        calibrate(&path, &maps.chain(["--out", out.to_str().unwrap()]).collect::<Vec<_>>())
    };
    let wrist = "f1xyz=wrist_x,wrist_y,wrist_z";
    let tissue = "f2xyz=tissue_x,tissue_y,tissue_z";
    let turned = "qwxyz=a,b,c,d";
    let refused: [(&[&str], &str); 7] = [
        (&[], "no column \"f1x_n\""),
        (&[wrist, tissue, "f2x=tissue_x"], "\"f2x\" is mapped twice"),
        (&[wrist, "f2xyz=tissue_x,tissue_y"], "\"f2xyz\" takes 3 columns, not 2"),
        (&[wrist, "f2xyz=tissue_x,tissue_y,depth"], "no column \"depth\""),
        (&["xyz=wrist_x,wrist_y,wrist_z"], "there is no quantity \"xyz\"; use one of f1x, f1y"),
        (&[wrist, "f2xyz=tissue_x,tissue_y,tissue_z*0"], "the scale \"0\" must be a number other than zero"),
        (&[wrist, "f2xyz=tissue_x,tissue_y,tissue_z*-1", turned], "opposite forces"),
    ];
    for (maps, words) in refused {
        let line = one_line(&mapped(maps));
        assert!(line.contains(words), "\"{words}\" is not in: {line}");
        assert!(!out.exists());
    }
    let output = mapped(&[wrist, tissue, turned]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let record: CorrespondenceRecord = store::read(&out).unwrap().unwrap();
    assert!(record.rotation().angle_to(&truth()).to_degrees() < 0.2);
}
