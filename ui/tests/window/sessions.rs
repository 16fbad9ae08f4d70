//! One session of each role in the real window, by simulated mouse and keyboard: the actions must appear in the files that
//! the program writes at its end.
#![cfg(target_os = "linux")]
use std::{path::Path, thread, time::Duration};

use nima_recording::{messages::foxglove::Log, session::SessionReader};
use nima_tests::emulated;
use prost::Message as _;

use crate::{
    console::{Console, read},
    same_window::SameWindow,
    server::Xvfb,
};

/// The scene of a console that is started without one.
const SCENE: &str = "peg_transfer";

fn begin<'a>(x: &'a Xvfb, role: &str) -> Console<'a> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("console.json"), r#"{"toured":true}"#).unwrap();
    Console::begin(x, folder, &["--role", role])
}

/// Ends the program after the last action; returns the loop's results, the settings, and the marks in its sessions.
fn end(mut console: Console) -> [serde_json::Value; 3] {
    thread::sleep(Duration::from_millis(1200));
    let summary = console.end();
    let settings = read(&console.folder.path().join("console.json"));
    // Everything is simulated here: only a loop that this machine delays ends in a fault.
    assert!(!states(&summary).contains(&"Fault"), "{summary:#}");
    [summary, settings, marks(console.folder.path())]
}

/// Returns the lines of the marks in all sessions in this folder of a user.
fn marks(folder: &Path) -> serde_json::Value {
    let mut words = Vec::new();
    for entry in std::fs::read_dir(folder.join("sessions")).unwrap() {
        let path = entry.unwrap().path();
        let reader = SessionReader::open(&path).unwrap();
        let lines = reader.messages(&["log"], 0..u64::MAX).map(|line| Log::decode(line.unwrap().data()).unwrap());
        words.extend(lines.filter(|line| line.name == "mark").map(|line| line.message));
    }
    words.into()
}

fn states(summary: &serde_json::Value) -> Vec<&str> {
    let states = summary["screen"]["states"].as_array().unwrap();
    states.iter().map(|state| state.as_str().unwrap()).collect()
}

fn surgeon(x: &Xvfb) {
    let mut same = SameWindow::open(SCENE, "surgeon", |app| app);
    let [lower_gain, stop] = ["Lower the gain", "Stop"].map(|label| same.button(label));
    let release = same.next_step();
    drop(same);
    let session = begin(x, "surgeon");
    session.click(lower_gain);
    session.click(lower_gain);
    thread::sleep(Duration::from_millis(700));
    session.click(stop);
    thread::sleep(Duration::from_millis(1200));
    session.click(release);
    let [summary, settings, _] = end(session);
    assert!(states(&summary).ends_with(&["Engaged", "Stopped", "Idle"]), "{:?}", states(&summary));
    assert!((summary["screen"]["gain"].as_f64().unwrap() - 0.8).abs() < 1e-6, "{}", summary["screen"]);
    assert_eq!(settings["role"], "surgeon");
}

fn technician(x: &Xvfb) {
    let mut same = SameWindow::open(SCENE, "technician", |app| app);
    let [gravity, timing, pause] = ["Calibrate gravity…", "Timing", "Pause"].map(|label| same.button(label));
    let (x_beside, y_beside) = same.button("Trade-off");
    same.press("Calibrate gravity…");
    let back = same.button("Back to the monitor");
    drop(same);
    let session = begin(x, "technician");
    session.click(gravity);
    thread::sleep(Duration::from_millis(800));
    session.click(back);
    thread::sleep(Duration::from_millis(800));
    session.drag(timing, (x_beside + 100, y_beside));
    session.key("e");
    session.key("e");
    session.click(pause);
    let [summary, settings, marks] = end(session);
    let screen = &summary["screen"];
    assert_eq!(states(&summary).last(), Some(&"Idle"), "the wizard set the loop to idle, and nothing engages it again");
    assert!(!states(&summary).contains(&"Stopped"));
    assert_eq!((screen["marks"].as_u64(), screen["paused"].as_bool()), (Some(2), Some(true)), "{screen}");
    assert_eq!(marks, serde_json::json!(["mark 1", "mark 2"]), "in the recorded session too");
    let places = settings["layout"]["places"].to_string();
    let together = places.split("\"tabs\":").any(|group| {
        let group = group.split(']').next().unwrap_or_default();
        group.contains("timing") && group.contains("degrees")
    });
    assert!(together, "{places}");
}

fn demo(x: &Xvfb) {
    let session = begin(x, "demo");
    session.key("m");
    thread::sleep(Duration::from_millis(700));
    session.key("Page_Down");
    session.key("m");
    session.key("F2");
    let [summary, settings, _] = end(session);
    let led = summary["screen"]["led_ticks"].as_u64().unwrap();
    let ticks = summary["ticks"].as_u64().unwrap();
    assert!((300..ticks / 2).contains(&led), "led for {led} of {ticks} ticks");
    assert_eq!((states(&summary).last(), &settings["role"]), (Some(&"Engaged"), &"technician".into()));
}

#[test]
fn each_role_does_its_work_by_mouse_and_keyboard() {
    let _alone = nima_testing::real_time::alone();
    let Some(x) = Xvfb::start() else { return };
    nima_testing::real_time::judged(|| surgeon(&x));
    nima_testing::real_time::judged(|| technician(&x));
    nima_testing::real_time::judged(|| demo(&x));
}

/// Returns the states of the loop in a window without input.
fn left_alone(x: &Xvfb, folder: tempfile::TempDir, options: &[&str]) -> serde_json::Value {
    std::fs::write(folder.path().join("console.json"), r#"{"toured":true}"#).unwrap();
    let mut console = Console::begin(x, folder, options);
    thread::sleep(Duration::from_secs(6));
    console.end()
}

#[test]
fn the_built_in_rig_engages_by_itself_and_a_rig_file_waits_for_a_person() {
    let _alone = nima_testing::real_time::alone();
    let Some(x) = Xvfb::start() else { return };
    // Under load, an emulated device is occasionally lost.
    nima_testing::real_time::judged(|| engages_or_waits(&x));
}

fn engages_or_waits(x: &Xvfb) {
    let built_in = left_alone(x, tempfile::tempdir().unwrap(), &[]);
    assert!(states(&built_in).contains(&"Engaged"), "{:?}", states(&built_in));
    // Nothing is missing: the sensors at the tips need no calibration.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("finished.toml");
    let mut file = emulated::rig_file(&emulated::elsewhere(folder.path()));
    for side in ["right", "left"] {
        file.set(&format!("devices.{side}.sensor_at"), "tip");
    }
    file.save(&path).unwrap();
    let path = path.display().to_string();
    let finished = left_alone(x, folder, &["--rig", &path]);
    assert_eq!(states(&finished).last(), Some(&"Idle"), "{:?}", states(&finished));
    assert!(!states(&finished).contains(&"Ready"), "{:?}", states(&finished));
}
