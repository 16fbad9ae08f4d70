//! The bias check of a saved calibration at the start of the console, for a sensor with and without a moved bias.

use std::{path::Path, process::Command};

use nima_machine::{config::RigConfig, teleop::Calibrations};
use nima_recording::store::Store;
use nima_simulation::{SimulationPlan, scene::Scene};
use nima_tests::gravity::gravity;

use crate::bench::{Console, can_press, read, shown, shows};

/// Returns a wrist without a guiding person or trocar contact, with its bias off by `step_n` along x.
fn free_scene(step_n: f64) -> Scene {
    let mut scene = Scene::load("palpation").unwrap();
    scene.trocar = None;
    scene.wrist.as_mut().unwrap().force_bias_n.x += step_n;
    scene
}

fn console(store: &Path, step_n: f64) -> Console {
    let record = gravity();
    Store::open(store).save(&record).unwrap();
    let rig = RigConfig::load("simulated").unwrap();
    let scene = free_scene(step_n);
    let calibrations = Calibrations { gravity: Some(record.model), ..Calibrations::default() };
    let calibrations = [calibrations, Calibrations::default()];
    let store = store.to_owned();
    shown(&SimulationPlan { rig, scene, calibrations, engage: false }, [1600.0, 1000.0], move |app| {
        app.with_store(&store)
    })
}

#[test]
fn a_bias_that_moved_warns_with_its_figure_and_blocks_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = console(folder.path(), 0.4);
    read(&mut console, "do not touch the tool");
    read(&mut console, "drifted by 0.4");
    read(&mut console, "its bias has drifted since the calibration");
    assert!(can_press(&console, "Engage"));
}

#[test]
fn a_bias_that_did_not_move_is_fine_with_the_time_of_the_check() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = console(folder.path(), 0.0);
    read(&mut console, "N without contact, passed");
    let lines = console.state().active().lines();
    assert!(lines.iter().any(|line| line.starts_with("Bias, checked at ") && line.contains(" UTC: 0.0")), "{lines:?}");
    assert!(!shows(&console, "its bias has drifted"));
    assert!(can_press(&console, "Engage"));
}

/// Returns the output of `nima run` about the bias check, with calibrations in this folder.
fn run(store: &Path, step_n: f64) -> String {
    Store::open(store.join("calibrations")).save(&gravity()).unwrap();
    let (scene, _) = include_str!("../../../config/scenes/palpation.toml").split_once("[trocar]").unwrap();
    let moved = format!("force_bias_n = [{},", 1.8 + step_n);
    assert!(scene.contains("force_bias_n = [1.8,"));
    let file = store.join("free.toml");
    std::fs::write(&file, scene.replace("force_bias_n = [1.8,", &moved)).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_nima"))
        .args(["run", "--virtual", "--seconds", "8", "--scene", file.to_str().unwrap()])
        .env("NIMA_DATA_DIR", store)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn a_run_without_a_screen_prints_how_the_bias_stands() {
    let folder = tempfile::tempdir().unwrap();
    let text = run(folder.path(), 0.0);
    assert!(text.contains("bias of the wrist sensor: 0.0") && text.contains("passed"), "{text}");
    let text = run(folder.path(), -0.5);
    assert!(text.contains("bias of the wrist sensor: drifted by 0.5"), "{text}");
}
