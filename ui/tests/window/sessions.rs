//! One session of each role in the real window, by mouse and keyboard from outside: what a person does must be found in what the program
//! writes when it ends.
#![cfg(target_os = "linux")]
use std::{
    path::Path,
    process::{Child, Stdio},
    thread,
    time::Duration,
};

use crate::server::{Xvfb, wait_until};

/// Where things stand in a window of 1600 x 1000.
const STOP: (i32, i32) = (1519, 36);
const STEP: (i32, i32) = (1380, 36);
const LOWER_THE_GAIN: (i32, i32) = (873, 868);
const CALIBRATE_GRAVITY: (i32, i32) = (150, 621);
const BACK_TO_THE_MONITOR: (i32, i32) = (150, 302);
const TIMING: (i32, i32) = (1283, 691);
const BESIDE_TRADEOFF: (i32, i32) = (1430, 377);
const PAUSE: (i32, i32) = (888, 614);

/// A console at work, and a hand at its mouse and keyboard.
struct Session<'a> {
    x: &'a Xvfb,
    console: Child,
    folder: tempfile::TempDir,
}

impl<'a> Session<'a> {
    fn begin(x: &'a Xvfb, role: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("console.json"), r#"{"toured":true}"#).unwrap();
        let console = x
            .command(env!("CARGO_BIN_EXE_nima"))
            .env("XDG_RUNTIME_DIR", folder.path())
            .env("NIMA_DATA_DIR", folder.path())
            .args(["console", "--role", role, "--summary"])
            .arg(folder.path().join("summary.json"))
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        wait_until("the window", 30, || x.window_is_open());
        let session = Self { x, console, folder };
        thread::sleep(Duration::from_millis(1500));
        // No window manager gives the keyboard to the window.
        session.tool(&["search", "--name", "NIMA Console", "windowfocus"]);
        session
    }

    fn tool(&self, arguments: &[&str]) {
        assert!(self.x.command("xdotool").args(arguments).status().unwrap().success(), "{arguments:?}");
        thread::sleep(Duration::from_millis(500));
    }

    fn click(&self, (x, y): (i32, i32)) {
        self.tool(&["mousemove", &x.to_string(), &y.to_string(), "sleep", "0.2", "click", "1"]);
    }

    fn key(&self, key: &str) {
        self.tool(&["key", key]);
    }

    /// Presses, moves in steps as a hand does, and lets go.
    fn drag(&self, from: (i32, i32), to: (i32, i32)) {
        self.tool(&["mousemove", &from.0.to_string(), &from.1.to_string(), "sleep", "0.2", "mousedown", "1"]);
        for step in 1..=6 {
            let at = |from: i32, to: i32| (from + (to - from) * step / 6).to_string();
            self.tool(&["mousemove", &at(from.0, to.0), &at(from.1, to.1)]);
        }
        self.tool(&["mouseup", "1"]);
    }

    /// Asks the program to end, when the last action is done; what it wrote: the loop's figures and the settings.
    fn end(mut self) -> [serde_json::Value; 2] {
        thread::sleep(Duration::from_millis(1200));
        assert!(self.x.command("kill").arg(self.console.id().to_string()).status().unwrap().success());
        assert!(self.console.wait().unwrap().success(), "the console closes with success");
        let told = ["summary.json", "console.json"].map(|file| read(&self.folder.path().join(file)));
        // Everything is simulated here: only a loop that this machine held up ends in a fault.
        if states(&told[0]).contains(&"Fault") {
            nima_testing::real_time::too_busy();
        }
        told
    }
}

impl Drop for Session<'_> {
    fn drop(&mut self) {
        self.console.kill().ok();
        self.console.wait().ok();
    }
}

fn read(path: &Path) -> serde_json::Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn states(summary: &serde_json::Value) -> Vec<&str> {
    let states = summary["screen"]["states"].as_array().unwrap();
    states.iter().map(|state| state.as_str().unwrap()).collect()
}

fn surgeon(x: &Xvfb) {
    let session = Session::begin(x, "surgeon");
    session.click(LOWER_THE_GAIN);
    session.click(LOWER_THE_GAIN);
    thread::sleep(Duration::from_millis(700));
    session.click(STOP);
    thread::sleep(Duration::from_millis(1200));
    session.click(STEP);
    let [summary, settings] = session.end();
    assert!(states(&summary).ends_with(&["Engaged", "Stopped", "Idle"]), "{:?}", states(&summary));
    assert!((summary["screen"]["gain"].as_f64().unwrap() - 0.8).abs() < 1e-6, "{}", summary["screen"]);
    assert_eq!(settings["role"], "surgeon");
}

fn technician(x: &Xvfb) {
    let session = Session::begin(x, "technician");
    session.click(CALIBRATE_GRAVITY);
    thread::sleep(Duration::from_millis(800));
    session.click(BACK_TO_THE_MONITOR);
    thread::sleep(Duration::from_millis(800));
    session.drag(TIMING, BESIDE_TRADEOFF);
    session.key("e");
    session.key("e");
    session.click(PAUSE);
    let [summary, settings] = session.end();
    let screen = &summary["screen"];
    assert_eq!(states(&summary).last(), Some(&"Idle"), "the wizard set the loop to idle, and nothing engages it again");
    assert!(!states(&summary).contains(&"Stopped"));
    assert_eq!((screen["marks"].as_u64(), screen["paused"].as_bool()), (Some(2), Some(true)), "{screen}");
    let places = settings["layout"]["places"].to_string();
    let together = places.split("\"tabs\":").any(|group| {
        let group = group.split(']').next().unwrap_or_default();
        group.contains("timing") && group.contains("degrees")
    });
    assert!(together, "{places}");
}

fn demo(x: &Xvfb) {
    let session = Session::begin(x, "demo");
    session.key("m");
    thread::sleep(Duration::from_millis(700));
    session.key("Page_Down");
    session.key("m");
    session.key("F2");
    let [summary, settings] = session.end();
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
