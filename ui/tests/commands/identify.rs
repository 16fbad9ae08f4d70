//! `nima identify` over several recordings, over three axes named at once, and with the leader's own motion.

use std::{
    fmt::Write as _,
    path::{Path, PathBuf},
};

use serde_json::Value;

use crate::{
    every_command::{json, nima},
    one_line,
};

/// Returns a hand that presses a spring of this stiffness (N/m) on three axes, in mm and N with another program's
/// column names; `h` is the leader, 20 ms ahead.
fn recording(folder: &Path, name: &str, stiffness_n_m: f64) -> PathBuf {
    let sine_m = |i: usize| [7.0, 4.4, 12.0].map(|rad_s: f64| 0.01 * (rad_s * i as f64 * 1e-3).sin());
    let mut text = String::from("t_s,px,py,pz,a,b,c,hx,hy,hz\n");
    for i in 0..1500 {
        let position_m = sine_m(i);
        let columns = [
            position_m.map(|x| x * 1e3),
            position_m.map(|x| stiffness_n_m * x.max(0.0)),
            sine_m(i + 20).map(|x| x * 1e3),
        ];
        let columns: Vec<String> = columns.as_flattened().iter().map(f64::to_string).collect();
        writeln!(text, "{},{}", i as f64 * 1e-3, columns.join(",")).unwrap();
    }
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

const MAPPED: [&str; 6] = ["--map", "xyz=px,py,pz*0.001", "--map", "fxyz=a,b,c", "--delay-ms", "40"];

fn with<'a>(recordings: &[&'a str], more: &[&'a str]) -> Vec<&'a str> {
    ["identify"].iter().chain(recordings).chain(&MAPPED).chain(more).copied().collect()
}

#[test]
fn several_recordings_are_those_of_each_and_a_summary() {
    let folder = tempfile::tempdir().unwrap();
    let [soft, stiff] = [("soft.csv", 100.0), ("stiff.csv", 400.0)].map(|(name, k)| recording(folder.path(), name, k));
    let names = [soft.to_str().unwrap(), stiff.to_str().unwrap()];
    let both = json(&with(&names, &["--json"]));
    let recordings = both["recordings"].as_array().unwrap();
    for (figures, name) in recordings.iter().zip(names) {
        let mut alone = json(&with(&[name], &["--json"]));
        let mut figures = figures.clone();
        assert_eq!(figures["recording"], name);
        figures.as_object_mut().unwrap().remove("recording");
        // Only the computing time of a tick differs between runs.
        for figures in [&mut alone, &mut figures] {
            figures.as_object_mut().unwrap().remove("tick_us").unwrap();
        }
        assert_eq!(figures, alone, "{name}");
    }
    let summary = &both["summary"];
    assert_eq!((summary["recordings"].as_u64(), summary["samples"].as_u64()), (Some(2), Some(3000)));
    let mae = |figures: &Value| figures["error"]["mae"].as_f64().unwrap();
    let mean = 0.5 * (mae(&recordings[0]) + mae(&recordings[1]));
    assert!((summary["error_mae"].as_f64().unwrap() - mean).abs() < 1e-12, "of the same length: {summary}");
    assert!(summary["ratio"].as_f64().unwrap() < 1.0 && names.contains(&summary["worst"].as_str().unwrap()));

    let text = String::from_utf8(nima(&with(&names, &[])).stdout).unwrap();
    assert!(text.contains("soft.csv") && text.contains("all 2") && text.contains("ratio: median"), "{text}");
}

#[test]
fn the_leaders_own_motion_makes_another_force_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = recording(folder.path(), "led.csv", 300.0);
    let name = path.to_str().unwrap();
    let leader = ["--map", "lxyz=hx,hy,hz*0.001"];
    let error = |mode: &str, more: &[&str]| {
        let figures = json(&with(&[name], &[&["--mode", mode, "--json"], more].concat()));
        (figures["error"]["mae"].as_f64().unwrap(), figures["own_motion"].as_str().unwrap().to_owned())
    };
    for mode in ["anchored", "matched", "best"] {
        let (alone, follower) = error(mode, &[]);
        let (led, handle) = error(mode, &leader);
        assert!((alone - led).abs() > 1e-6, "{mode}: {alone} and {led}");
        assert_eq!((follower.as_str(), handle.as_str()), ("follower", "handle"));
    }
    assert!((error("dfr", &[]).0 - error("dfr", &leader).0).abs() <= 0.0, "reflection knows no motion");
    let text = String::from_utf8(nima(&with(&[name], &leader)).stdout).unwrap();
    assert!(text.contains("force from the leader's own motion"), "{text}");
}

#[test]
fn what_cannot_be_mapped_or_written_is_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = recording(folder.path(), "led.csv", 300.0);
    let name = path.to_str().unwrap();
    let out = folder.path().join("trace.csv");
    let study = ["study", "baselines", "--recording", name, "--map", "lx=hx", "--out", folder.path().to_str().unwrap()];
    for (arguments, words) in [
        (with(&[name, name], &["--out", out.to_str().unwrap()]), "--out writes the samples of a single recording"),
        (
            vec!["identify", name, "--map", "xyz=px,py"],
            "\"xyz\" takes 3 columns, not 2; write, for example, xyz=A,B,C*0.001",
        ),
        (vec!["identify", name, "--map", "uvw=a,b,c"], "there is no quantity \"uvw\""),
        (with(&[name], &["--map", "lx=hx"]), "no column \"ly_m\" for leader's motion"),
        (with(&[name, "none.csv"], &["--json"]), "none.csv"),
        (study.to_vec(), "only nima identify uses"),
    ] {
        let line = one_line(&nima(&arguments));
        assert!(line.contains(words), "{arguments:?}: {line}");
    }
    assert!(!out.exists());
}
