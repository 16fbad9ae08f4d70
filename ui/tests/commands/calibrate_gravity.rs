//! `nima calibrate gravity` with good and with bad files.
use std::{
    fmt::Write as _,
    path::Path,
    process::{Command, Output},
};

fn nima(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_nima")).args(["calibrate", "gravity"]).args(arguments).output().unwrap()
}

/// Twelve still poses of a 0.4 kg tool on a straight mount, without noise.
fn poses(folder: &Path, count: usize, sign: f64) -> String {
    let mut text = String::from("fx_n,fy_n,fz_n,ax,ay,az\n");
    for i in 0..count {
        let z = 1.0 - (2.0 * i as f64 + 1.0) / count as f64;
        let r = (1.0 - z * z).sqrt();
        let turn = 2.4 * i as f64;
        let down = [r * turn.cos(), r * turn.sin(), z].map(|d| d * 9.80665);
        let [fx, fy, fz] = down.map(|d| 0.4 * d + 1.0);
        let [ax, ay, az] = down.map(|d| -d * sign);
        writeln!(text, "{fx},{fy},{fz},{ax},{ay},{az}").unwrap();
    }
    let path = folder.join("poses.csv");
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

fn refused(arguments: &[&str], words: &str) {
    let output = nima(arguments);
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && text.lines().count() == 1, "{text}");
    assert!(text.contains(words), "\"{words}\" is not in: {text}");
}

#[test]
fn good_poses_are_accepted_and_written() {
    let folder = tempfile::tempdir().unwrap();
    let file = poses(folder.path(), 12, 1.0);
    let out = folder.path().join("g.toml");
    let output = nima(&[&file, "--json", "--sensor", "FT1", "--out", out.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["verdict"], "accepted");
    assert!((report["mass_kg"].as_f64().unwrap() - 0.4).abs() < 1e-9);
    let text = std::fs::read_to_string(out).unwrap();
    assert!(text.contains("kind = \"gravity\"") && text.contains("sensor = \"FT1\""), "{text}");
}

#[test]
fn a_wrong_sign_is_named_and_written_only_under_a_name() {
    let folder = tempfile::tempdir().unwrap();
    let file = poses(folder.path(), 12, -1.0);
    let out = folder.path().join("g.toml");
    let out = out.to_str().unwrap();
    refused(&[&file, "--out", out], "Poor data: the accelerometer reads opposite");
    assert!(!Path::new(out).exists());
    refused(&[&file, "--out", out, "--override", "Ada"], "Poor data");
    assert!(std::fs::read_to_string(out).unwrap().contains("override_by = \"Ada\""));
    assert!(nima(&[&file, "--flip-imu"]).status.success());
}

#[test]
fn bad_files_are_refused_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    refused(&[&poses(folder.path(), 4, 1.0)], "Insufficient motion: only 4 poses are usable");
    let path = folder.path().join("bad.csv");
    let with = |text: &str, words: &str| {
        std::fs::write(&path, text).unwrap();
        refused(&[path.to_str().unwrap()], words);
    };
    with("fx_n,fy_n,fz_n,ax,ay\n", "no column \"az\"");
    with("fx_n,fy_n,fz_n,ax,ay,az\n1,2,nan,0,0,9.8\n", "line 2, column \"fz_n\"");
    with("fx_n,fy_n,fz_n,qw,qx,qy,qz\n1,2,3,1,0,0,0\n1,2,3,1,1,0,0\n", "line 3: the quaternion has length 1.414");
    with("fx_n,fy_n,fz_n,ax,ay,az\n", "no poses were given");
}

#[test]
fn the_weighed_mass_confirms_the_units_or_names_the_wrong_one() {
    let folder = tempfile::tempdir().unwrap();
    let file = poses(folder.path(), 12, 1.0);
    let out = folder.path().join("g.toml");
    let [file, out] = [file.as_str(), out.to_str().unwrap()];
    for mass_kg in ["0", "-0.4", "nan", "400"] {
        let weighed = format!("--mass-kg={mass_kg}");
        refused(&[file, &weighed, "--out", out], "enter the mass in kg, above 0 and at most 10");
    }
    // The forces as a sensor that is set to pounds would send them.
    let pounds = "fxyz=fx_n,fy_n,fz_n*0.22481";
    assert!(nima(&[file, "--map", pounds]).status.success(), "without a mass, another unit is another tool");
    refused(
        &[file, "--map", pounds, "--mass-kg", "0.4", "--out", out],
        "the fitted mass is 0.090 kg, but the tool weighs 0.400 kg; the forces are probably in pounds (lbf)",
    );
    refused(&[file, "--mass-kg", "0.5", "--out", out], "the fitted mass is 0.400 kg, but the tool weighs 0.500 kg");
    assert!(!Path::new(out).exists());
    let output = nima(&[file, "--mass-kg", "0.41", "--out", out]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(Path::new(out).exists());
}
