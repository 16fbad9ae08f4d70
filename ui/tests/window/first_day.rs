//! The first day of the paper's rig, emulated, in the real window: from an empty data folder to both arms engaged with the networks in
//! force. Mouse and keyboard from outside do what a person does who follows the one button that stands out.
#![cfg(target_os = "linux")]
use std::{
    cell::Cell,
    path::PathBuf,
    process::{Child, Stdio},
    thread,
    time::{Duration, Instant},
};

use crate::server::{Xvfb, wait_until};

/// Where things stand in a window of 1600 x 1000.
const EMULATED_RIG: (i32, i32) = (270, 268);
const ENGAGE: (i32, i32) = (1380, 36);
const NOTHING: (i32, i32) = (1300, 970);
const WIDTH: usize = 1600;
/// Colour of the button that stands out (`theme::Palette::primary`), and fewer pixels of it than any such button has.
const NEXT: [u8; 3] = [0x24, 0x62, 0xc8];
const PIXELS_MIN: usize = 600;
/// A step that nothing follows for so long has failed.
const PATIENCE: Duration = Duration::from_mins(4);

struct Day<'a> {
    x: &'a Xvfb,
    console: Child,
    folder: tempfile::TempDir,
    clicks: Cell<u32>,
}

impl<'a> Day<'a> {
    fn begin(x: &'a Xvfb) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let console = x
            .command(env!("CARGO_BIN_EXE_nima"))
            .env("XDG_RUNTIME_DIR", folder.path())
            .env("NIMA_DATA_DIR", folder.path())
            .args(["console", "--summary"])
            .arg(folder.path().join("summary.json"))
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        wait_until("the window", 30, || x.window_is_open());
        thread::sleep(Duration::from_millis(1500));
        let day = Self { x, console, folder, clicks: Cell::new(0) };
        // No window manager gives the keyboard to the window.
        day.tool(&["search", "--name", "NIMA Console", "windowfocus"]);
        day
    }

    fn tool(&self, arguments: &[&str]) {
        assert!(self.x.command("xdotool").args(arguments).status().unwrap().success(), "{arguments:?}");
        thread::sleep(Duration::from_millis(500));
    }

    fn click(&self, (x, y): (i32, i32)) {
        self.clicks.set(self.clicks.get() + 1);
        self.tool(&["mousemove", &x.to_string(), &y.to_string(), "sleep", "0.2", "click", "1"]);
        self.tool(&["mousemove", &NOTHING.0.to_string(), &NOTHING.1.to_string()]);
    }

    /// The middle of the button that stands out.
    fn next(&self) -> Option<(i32, i32)> {
        let picture =
            self.x.command("import").args(["-window", "root", "-depth", "8", "rgb:-"]).output().unwrap().stdout;
        let places = picture.chunks_exact(3).enumerate().filter(|(_, pixel)| *pixel == NEXT);
        let places: Vec<_> = places.map(|(place, _)| (place % WIDTH, place / WIDTH)).collect();
        if places.len() < PIXELS_MIN {
            return None;
        }
        let [left, right] = [places.iter().map(|(x, _)| *x).min()?, places.iter().map(|(x, _)| *x).max()?];
        let [top, bottom] = [places.iter().map(|(_, y)| *y).min()?, places.iter().map(|(_, y)| *y).max()?];
        Some((i32::try_from(usize::midpoint(left, right)).ok()?, i32::try_from(usize::midpoint(top, bottom)).ok()?))
    }

    /// Follows the button until `good`.
    fn follow(&self, what: &str, good: impl Fn(&Self) -> bool) {
        let mut last = Instant::now();
        while !good(self) {
            if let Some(place) = self.next() {
                self.click(place);
                last = Instant::now();
            }
            if last.elapsed() > PATIENCE {
                println!("{what}: nothing stands out any more; there are {:?}", self.files("calibrations"));
                nima_testing::real_time::too_busy();
            }
            thread::sleep(Duration::from_millis(300));
        }
    }

    fn files(&self, folder: &str) -> Vec<PathBuf> {
        let entries = std::fs::read_dir(self.folder.path().join(folder));
        entries.into_iter().flatten().flatten().map(|entry| entry.path()).collect()
    }

    fn has_all_calibrations(&self) -> bool {
        let names: Vec<_> = self.files("calibrations").iter().map(|path| path.display().to_string()).collect();
        let kinds =
            ["sensor_mount", "tip", "hand_eye", "table", "view", "view_handle", "trocar", "gravity", "correspondence"];
        ["SN000901", "SN000902"].iter().all(|serial| {
            let kept = |kind: &&str| names.iter().any(|name| name.ends_with(&format!("/{kind}-{serial}.toml")));
            kinds.iter().all(kept)
                && names.iter().any(|name| name.ends_with(&format!("/tip-force-{serial}.safetensors")))
        })
    }

    /// Ends the console as a service manager does; gives what it writes.
    fn end(mut self) -> serde_json::Value {
        self.x.command("kill").args(["-TERM", &self.console.id().to_string()]).status().unwrap();
        assert!(self.console.wait().unwrap().success(), "the console closes with success");
        serde_json::from_slice(&std::fs::read(self.folder.path().join("summary.json")).unwrap()).unwrap()
    }
}

impl Drop for Day<'_> {
    fn drop(&mut self) {
        self.console.kill().ok();
        self.console.wait().ok();
    }
}

#[test]
#[ignore = "a quarter of an hour in real time: `./dev walk` runs it"]
fn from_an_empty_folder_to_both_arms_engaged() {
    let _alone = nima_testing::real_time::alone();
    let Some(x) = Xvfb::start() else { return };
    nima_testing::real_time::judged(|| {
        let began = Instant::now();
        let day = Day::begin(&x);
        // The tour, which ends in the monitor.
        day.follow("the tour", |day| day.next().is_none());
        day.tool(&["key", "F6"]);
        day.click(EMULATED_RIG);
        day.follow("the calibrations", Day::has_all_calibrations);
        println!("calibrated after {:.0} s and {} clicks", began.elapsed().as_secs_f64(), day.clicks.get());
        // From the last page straight to the ready check and through it: its stop and its releases stand out too.
        day.follow("the ready check", |day| !day.files("checks").is_empty());
        let record = std::fs::read_to_string(&day.files("checks")[0]).unwrap();
        // A machine that is too busy for the rates does not pass, and is not judged.
        if !record.contains("passed = true") {
            println!("{record}");
            nima_testing::real_time::too_busy();
        }
        day.follow("the monitor", |day| day.next().is_none());
        day.click(ENGAGE);
        thread::sleep(Duration::from_secs(8));
        println!("engaged after {:.0} s and {} clicks", began.elapsed().as_secs_f64(), day.clicks.get());
        let summary = day.end();
        assert_eq!(summary["final_state"], "engaged", "{summary}");
    });
}
