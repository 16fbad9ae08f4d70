//! Age of the endoscope image on the screen: the time code is read from the X server's memory; and the cost of showing and
//! recording it for the loop.
#![cfg(target_os = "linux")]
use std::{
    fs::File,
    io::{BufRead as _, BufReader},
    os::unix::fs::FileExt as _,
    path::Path,
    process::{Child, Command, Stdio},
    thread,
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};

use nima_endoscope::time_code;

use crate::{console::Console, server::Xvfb};

/// Side of the squares in the camera image, px, and its size.
const SQUARE_PX: usize = 16;
const IMAGE_PX: [f64; 2] = [1280.0, 720.0];
/// Height above and below the image in the Surgeon view, points.
const ABOVE: f64 = 72.0;
const BELOW: f64 = 176.0;
/// Maximum shift of the image by the strip of an alarm above it, points.
const LOWER_MAX: usize = 90;
/// Distance of the button Engage from the right edge, points.
const ENGAGE_FROM_RIGHT: i32 = 220;
const LOOK_EVERY: Duration = Duration::from_millis(1);
/// An image without a successor for this time is a stall.
const STALL: Duration = Duration::from_millis(500);

/// The memory in which the X server keeps the screen (the format of `xwd`).
struct Screen {
    file: File,
    begin: u64,
    row_bytes: u64,
    size_px: [usize; 2],
}

impl Screen {
    fn open(folder: &Path) -> Self {
        let file = File::open(folder.join("Xvfb_screen0")).unwrap();
        let mut head = [0; 100];
        file.read_exact_at(&mut head, 0).unwrap();
        let word = |number: usize| u64::from(u32::from_be_bytes(head[4 * number..4 * number + 4].try_into().unwrap()));
        assert_eq!(word(11), 32, "bits of a pixel");
        let begin = word(0) + 12 * word(19);
        Self { file, begin, row_bytes: word(12), size_px: [word(4) as usize, word(5) as usize] }
    }

    /// Returns the green part of some rows.
    fn rows(&self, from: usize, count: usize) -> Vec<u8> {
        let mut bytes = vec![0; count * self.row_bytes as usize];
        let from = self.begin + from as u64 * self.row_bytes;
        self.file.read_exact_at(&mut bytes, from).unwrap();
        bytes
    }

    /// Returns the time code of the image, at this shift.
    fn code_us(&self, lower: usize) -> Option<u64> {
        let [width, height] = self.size_px.map(|side| side as f64);
        let top = ABOVE + lower as f64;
        let room = [width, height - BELOW - top];
        let scale = (room[0] / IMAGE_PX[0]).min(room[1] / IMAGE_PX[1]);
        let left = 0.5 * (room[0] - scale * IMAGE_PX[0]);
        let top = top + 0.5 * (room[1] - scale * IMAGE_PX[1]);
        let first = top as usize;
        let rows = self.rows(first, (scale * time_code::size_px(SQUARE_PX)[1] as f64) as usize + 2);
        time_code::read(SQUARE_PX, |x, y| {
            let x = (left + scale * (x as f64 + 0.5)) as usize;
            let y = (top + scale * (y as f64 + 0.5)) as usize - first;
            rows[y * self.row_bytes as usize + 4 * x + 1]
        })
    }
}

/// The emulated endoscope in a separate process, which ends with this.
struct Camera {
    process: Child,
    url: String,
}

impl Camera {
    fn start() -> Self {
        let mut process = Command::new(env!("CARGO_BIN_EXE_nima"))
            .args(["emulate", "endoscope", "--set", "port=0"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(process.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let report: serde_json::Value = serde_json::from_str(&line).unwrap();
        Self { process, url: report["endpoint"].as_str().unwrap().to_owned() }
    }
}

impl Drop for Camera {
    fn drop(&mut self) {
        self.process.kill().ok();
        self.process.wait().ok();
    }
}

fn now_us() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_micros() as u64
}

/// Observed images.
#[derive(Debug, Default)]
struct ImageObservations {
    /// Age of each image when it was first visible, ms.
    ages_ms: Vec<f64>,
    stalls: usize,
    longest: Duration,
}

impl ImageObservations {
    fn watch(screen: &Screen, time: Duration) -> Self {
        let mut seen = Self::default();
        let mut last_us = 0;
        let mut lower = None;
        let mut at = None::<Instant>;
        let begin = Instant::now();
        while begin.elapsed() < time {
            thread::sleep(LOOK_EVERY);
            let found = |lower: &usize| screen.code_us(*lower).is_some();
            let place = lower.filter(found).or_else(|| (0..LOWER_MAX).find(found));
            let Some(code_us) = place.and_then(|place| screen.code_us(place)) else { continue };
            lower = place;
            if code_us == last_us {
                continue;
            }
            let now = Instant::now();
            if let Some(at) = at {
                let gap = now.duration_since(at);
                seen.longest = seen.longest.max(gap);
                seen.stalls += usize::from(gap > STALL);
                seen.ages_ms.push((now_us() as f64 - code_us as f64) * 1e-3);
            }
            last_us = code_us;
            at = Some(now);
        }
        seen
    }

    fn report(&mut self) -> String {
        self.ages_ms.sort_by(f64::total_cmp);
        let at = |fraction: f64| self.ages_ms.get(((self.ages_ms.len() as f64 - 1.0) * fraction) as usize).copied();
        let [p50, p90, p99, max] = [0.5, 0.9, 0.99, 1.0].map(|fraction| at(fraction).unwrap_or(f64::NAN));
        format!(
            "{} pictures; code to pixel p50 {p50:.1} ms, p90 {p90:.1}, p99 {p99:.1}, max {max:.1}; {} stalls above {} ms, longest {:.0} ms",
            self.ages_ms.len(),
            self.stalls,
            STALL.as_millis(),
            self.longest.as_secs_f64() * 1e3
        )
    }
}

/// Runs the simulated rig in the Surgeon view, with `endoscope` in its rig file.
fn run(size: &str, endoscope: &str, time: Duration) -> (ImageObservations, serde_json::Value) {
    let folder = tempfile::tempdir().unwrap();
    let memory = tempfile::tempdir().unwrap();
    let Some(x) = Xvfb::of(size, Some(memory.path())) else { return Default::default() };
    let rig = include_str!("../../../config/rigs/simulated.toml").to_owned() + endoscope;
    std::fs::write(folder.path().join("console.json"), r#"{"toured":true}"#).unwrap();
    std::fs::write(folder.path().join("rig.toml"), rig).unwrap();
    let rig = folder.path().join("rig.toml").display().to_string();
    let mut console = Console::begin(&x, folder, &["--rig", &rig, "--scene", "bimanual", "--role", "surgeon"]);
    let (width, height) = size.split_once('x').unwrap();
    let moved = x
        .command("xdotool")
        .args(["search", "--name", "NIMA Console", "windowsize", width, height, "windowmove", "0", "0"])
        .status();
    assert!(moved.unwrap().success());
    thread::sleep(Duration::from_secs(1));
    // With a rig file, the console does not engage automatically.
    console.click((width.parse::<i32>().unwrap() - ENGAGE_FROM_RIGHT, 36));
    thread::sleep(Duration::from_secs(3));
    let seen = ImageObservations::watch(&Screen::open(memory.path()), time);
    if let Some(path) = std::env::var_os("NIMA_PICTURE") {
        assert!(x.command("import").args(["-window", "root"]).arg(path).status().unwrap().success());
    }
    (seen, console.end())
}

fn report(figures: &serde_json::Value) -> String {
    let [ticks, missed] = ["ticks", "missed"].map(|key| figures[key].clone());
    format!("loop: {ticks} ticks, {missed} missed, wake-up us {}", figures["wake_us"])
}

/// Returns the duration of each run in seconds: `NIMA_SECONDS`, or 20.
fn seconds() -> Duration {
    let report = std::env::var("NIMA_SECONDS").ok().and_then(|text| text.parse().ok());
    Duration::from_secs(report.unwrap_or(20))
}

/// Prints the age of the image on the screen.
#[test]
#[ignore = "figures: cargo test -p nima-console --test window figures_of_code_to_pixel -- --ignored --nocapture"]
fn figures_of_code_to_pixel() {
    let _alone = nima_testing::real_time::alone();
    let sizes = std::env::var("NIMA_SCREEN").unwrap_or_else(|_| "1280x720 1920x1080".to_owned());
    for size in sizes.split(' ') {
        let camera = Camera::start();
        let endoscope = format!("\n[endoscope]\nurl = \"{}\"\n", camera.url);
        let (mut seen, figures) = run(size, &endoscope, seconds());
        println!("{size}: {}\n{}", seen.report(), report(&figures));
        assert!(seen.ages_ms.len() > 20, "{seen:?}");
    }
}

/// Prints the loop's results without an image, with it, and with recording, in turn.
#[test]
#[ignore = "figures: cargo test -p nima-console --test window figures_of_the_loop_beside_the_picture -- --ignored --nocapture"]
fn figures_of_the_loop_beside_the_picture() {
    let _alone = nima_testing::real_time::alone();
    let rounds = std::env::var("NIMA_ROUNDS").ok().and_then(|text| text.parse().ok()).unwrap_or(3);
    for _ in 0..rounds {
        for (what, record) in [("no picture", None), ("shown", Some(false)), ("shown and recorded", Some(true))] {
            let camera = record.map(|_| Camera::start());
            let endoscope = camera
                .iter()
                .zip(record)
                .map(|(camera, record)| format!("\n[endoscope]\nurl = \"{}\"\nrecord = {record}\n", camera.url));
            let (mut seen, figures) = run("1280x720", &endoscope.collect::<String>(), seconds());
            println!("{what}: {}", report(&figures));
            if camera.is_some() {
                println!("  {}", seen.report());
            }
        }
    }
}
