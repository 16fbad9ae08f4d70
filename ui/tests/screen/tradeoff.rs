//! The trade-off study as a command and as a panel: measured, cancelled and applied by accessible names.
use std::{
    fmt::Write as _,
    path::{Path, PathBuf},
    process::{Command, Output},
    time::Duration,
};

use egui::accesskit::Role;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use nima_machine::messages::LoopState;
use nima_panels::tiles::PanelId;
use nima_tests::plan;
use serde_json::Value;

use crate::bench::{Console, comes, pick, shown, shows, until, wait};

fn nima(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_nima")).args(["study", "tradeoff"]).args(arguments).output().unwrap()
}

/// Returns a recording of a hand that presses a soft spring twice per second, at 500 Hz, as a lever would give it.
fn recording(folder: &Path, rows: usize) -> PathBuf {
    let mut text = String::from("t_s,angle,torque\n");
    for i in 0..rows {
        let t = i as f64 * 2e-3;
        let x = 0.01 * (std::f64::consts::TAU * 2.0 * t).sin() + 0.002 * (41.0 * t).sin();
        let f = if x > 0.0 { 300.0 * x.powf(1.3) } else { 0.0 };
        writeln!(text, "{t},{x},{f}").unwrap();
    }
    let path = folder.join("press, soft.csv");
    std::fs::write(&path, text).unwrap();
    path
}

#[test]
fn the_command_prints_json_and_writes_every_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = recording(folder.path(), 3000);
    let out = folder.path().join("new/figures");
    let arguments = ["--recording", path.to_str().unwrap(), "--map", "x=angle", "--map", "fx=torque", "--quick"];
    let arguments =
        [&arguments[..], &["--delay-ms", "20", "--delay-ms", "50", "--json", "--out", out.to_str().unwrap()]];
    let output = nima(&arguments.concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let study: Value = serde_json::from_slice(&output.stdout).unwrap();
    let source = &study["sources"][0];
    assert_eq!((source["source"].as_str(), source["unit"].as_str()), (Some("press, soft"), Some("recorded unit")));
    let points = source["points"].as_array().unwrap();
    for point in points {
        assert!(point["cost_us"]["p50"].is_f64() && point["error"].is_f64() && point["ratio"].is_f64(), "{point}");
    }
    for delay in [20.0, 50.0] {
        let front = |point: &&Value| point["pareto"] == true && point["delay_ms"] == delay;
        assert!(points.iter().any(|point| front(&point) && point["method"] == "dfr"), "DFR is the cheapest");
        assert!(points.iter().filter(front).count() >= 2);
    }
    let files: Vec<String> =
        std::fs::read_dir(&out).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap()).collect();
    for name in ["tradeoff.json", "tradeoff.csv", "tradeoff-press-soft.svg"] {
        assert!(files.iter().any(|file| file == name), "{name} is not in {files:?}");
    }
    let csv = std::fs::read_to_string(out.join("tradeoff.csv")).unwrap();
    assert_eq!(csv.lines().count(), points.len() + 1);
    assert!(csv.lines().nth(1).unwrap().starts_with("\"press, soft\",recorded unit,best,"), "{csv}");
    for file in files.iter().filter(|file| Path::new(file).extension().is_some_and(|kind| kind == "svg")) {
        let svg = std::fs::read_to_string(out.join(file)).unwrap();
        assert!(svg.trim_start().starts_with("<svg") || svg.trim_start().starts_with("<?xml"), "{file}");
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{file}");
    }
}

#[test]
fn without_json_it_prints_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let path = recording(folder.path(), 3000);
    let output = nima(&["--recording", path.to_str().unwrap(), "--map", "x=angle", "--map", "fx=torque", "--quick"]);
    let text = String::from_utf8(output.stdout).unwrap();
    for words in ["press, soft: 3000 samples at 500 Hz", "degree (literal)", "front", "ratio"] {
        assert!(text.contains(words), "\"{words}\" is not in {text}");
    }
}

#[test]
fn bad_input_is_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let short = recording(folder.path(), 60);
    let short = ["--recording", short.to_str().unwrap(), "--map", "x=angle", "--map", "fx=torque", "--quick"];
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    let blocked = file.join("figures");
    let cases: [(&[&str], &str); 8] = [
        (&["--recording", "nowhere.csv"], "nowhere.csv"),
        (&["--recording", "nowhere.csv", "--map", "x"], "NAME=COLUMN"),
        (&["--map", "x=angle"], "--recording"),
        (&["--scene", "no_such_scene"], "peg_transfer"),
        (&["--delay-ms", "-5"], "0 to 1000 ms"),
        (&["--delay-ms", "soon"], "soon"),
        (&short, "no point of the plan"),
        (&["--quick", "--out", blocked.to_str().unwrap()], "cannot create the folder"),
    ];
    for (arguments, words) in cases {
        let output = nima(arguments);
        let text = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success() && output.stdout.is_empty(), "{arguments:?}");
        assert_eq!(text.lines().count(), 1, "{text}");
        assert!(text.contains(words) && !text.contains("panicked"), "\"{words}\" is not in: {text}");
    }
}

/// Creates a console: in free motion a mode with degrees is on the front (degree 1 costs little); in contact none is.
fn console() -> Console {
    let mut plan = plan("free_motion");
    plan.rig.identification.rest_n = 0.0;
    let mut harness = shown(&plan, [1600.0, 2400.0], |app| app);
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
    harness.run_steps(3);
    // Its tile is behind others.
    pick(&mut harness, PanelId::Tradeoff.title());
    harness
}

#[test]
fn a_measurement_can_be_cancelled() {
    let mut harness = console();
    assert!(harness.query_by_role_and_label(Role::Button, "Cancel").is_none());
    pick(&mut harness, "Measure on this machine…");
    assert!(harness.query_by_label_contains("Trade-off measured:").is_some());
    pick(&mut harness, "Cancel");
    let stopped = comes(&mut harness, Duration::from_secs(10), |harness| shows(harness, "Cancelled"));
    assert!(stopped, "it did not stop");
    assert!(!harness.state().is_tradeoff_measured());
    harness.get_by_role_and_label(Role::Button, "Measure on this machine…");
    assert_eq!(harness.state().tick().unwrap().state, LoopState::Engaged, "the loop kept running");
}

/// Clicks a point with a degree that the running loop cannot change to, and returns its degree. Measured times decide which
/// points are on the front.
fn choose_another(harness: &Console) -> usize {
    let points = harness.get_all_by_label_contains(", N = ");
    let another = |label: &str| !label.contains("N = 5, 300 ms");
    let point = points.into_iter().find(|node| node.accesskit_node().label().is_some_and(|l| another(&l))).unwrap();
    point.click_accesskit();
    let label = point.accesskit_node().label().unwrap();
    label.split_once("N = ").unwrap().1[..1].parse().unwrap()
}

#[test]
fn a_measured_point_is_applied_and_a_restart_comes_back_idle() {
    let mut harness = console();
    pick(&mut harness, "Measure on this machine…");
    wait(&mut harness, "measured", |harness| harness.state().is_tradeoff_measured());
    harness.step();
    harness.check_accessibility();
    harness.get_by_label_contains("Trade-off plot:");
    // The fastest of all is direct reflection, and the running loop changes to it.
    harness
        .get_by(|node| node.role() == Role::Button && node.label().is_some_and(|l| l.starts_with("Direct (DFR): ")))
        .click_accesskit();
    harness.step();
    pick(&mut harness, "Apply");
    until(&mut harness, "direct", |tick| tick.mode == nima_core::impedance::Mode::Dfr);
    assert_eq!(harness.state().tick().unwrap().state, LoopState::Engaged);
    // For another degree or window, the loop restarts and waits for the operator.
    let degree = choose_another(&harness);
    harness.step();
    pick(&mut harness, "Apply");
    assert_eq!(harness.state().rig().identification.max_degree, degree);
    until(&mut harness, "idle", |tick| tick.state == LoopState::Idle);
    assert_ne!(harness.state().tick().unwrap().mode, nima_core::impedance::Mode::Dfr);
    harness.get_by_label_contains("is idle: press Engage");
    pick(&mut harness, "Engage");
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
}

#[test]
fn a_restart_is_no_way_out_of_a_stop() {
    let mut harness = console();
    pick(&mut harness, "Measure on this machine…");
    wait(&mut harness, "measured", |harness| harness.state().is_tradeoff_measured());
    harness.step();
    choose_another(&harness);
    harness.step();
    pick(&mut harness, "Stop");
    until(&mut harness, "stopped", |tick| tick.state == LoopState::Stopped);
    harness.step();
    let apply = harness.get_by_role_and_label(Role::Button, "Apply");
    assert!(apply.accesskit_node().is_disabled());
}
