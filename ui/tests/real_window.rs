//! The real window on a real X server without a screen: it opens, it draws, it closes.
#![cfg(target_os = "linux")]
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::{
    collections::HashMap,
    io::{BufRead as _, BufReader},
    process::{Child, Command, Stdio},
    thread,
    time::{Duration, Instant},
};

/// An X server in memory that ends with its owner.
struct Xvfb {
    server: Child,
    display: String,
}

impl Xvfb {
    /// `None`, said aloud, where the tools are not installed - unless the environment demands them.
    fn start() -> Option<Self> {
        let found = ["Xvfb", "xdotool", "import"].into_iter().all(which);
        if !found {
            assert!(std::env::var_os("NIMA_REQUIRE_WINDOW").is_none(), "Xvfb, xdotool or ImageMagick is not installed");
            eprintln!("left out: Xvfb, xdotool or ImageMagick is not installed");
            return None;
        }
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1600x1000x24", "-nolisten", "tcp"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
        Some(Self { server, display: format!(":{}", number.trim()) })
    }

    fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command.env("DISPLAY", &self.display).env_remove("WAYLAND_DISPLAY").env("LIBGL_ALWAYS_SOFTWARE", "1");
        command
    }

    fn window_is_open(&self) -> bool {
        let search = self.command("xdotool").args(["search", "--name", "NIMA Console"]).output().unwrap();
        search.status.success() && !search.stdout.is_empty()
    }
}

impl Drop for Xvfb {
    fn drop(&mut self) {
        self.server.kill().ok();
        self.server.wait().ok();
    }
}

fn which(tool: &str) -> bool {
    std::env::var_os("PATH").is_some_and(|path| std::env::split_paths(&path).any(|folder| folder.join(tool).is_file()))
}

fn wait_until(what: &str, seconds: u64, good: impl Fn() -> bool) {
    let end = Instant::now() + Duration::from_secs(seconds);
    while !good() {
        assert!(Instant::now() < end, "{what} did not happen within {seconds} s");
        thread::sleep(Duration::from_millis(100));
    }
}

#[test]
fn the_window_opens_shows_a_living_picture_and_closes() {
    let Some(x) = Xvfb::start() else { return };
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("own.png");
    let mut nima = x
        .command(env!("CARGO_BIN_EXE_nima"))
        .env("XDG_RUNTIME_DIR", folder.path())
        .env("NIMA_DATA_DIR", folder.path())
        .args(["console", "--exit-after", "8", "--screenshot"])
        .arg(&own)
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    wait_until("the window", 30, || x.window_is_open());
    thread::sleep(Duration::from_secs(4));
    let root = folder.path().join("root.png");
    assert!(x.command("import").args(["-window", "root"]).arg(&root).status().unwrap().success());
    assert!(nima.wait().unwrap().success(), "the console closes by itself with success");
    for picture in [root, own] {
        let (colours, commonest) = colours(&picture);
        println!(
            "{}: {colours} colours, the commonest on {:.0} % of the picture",
            picture.display(),
            commonest * 100.0
        );
        assert!(colours > 500 && commonest < 0.8, "{}: blank or nearly so", picture.display());
    }
}

/// How many colours a picture has, and the share of the commonest.
fn colours(path: &std::path::Path) -> (usize, f64) {
    let picture = image::open(path).unwrap().to_rgb8();
    let mut counts: HashMap<[u8; 3], u32> = HashMap::new();
    for pixel in picture.pixels() {
        *counts.entry(pixel.0).or_default() += 1;
    }
    let commonest = counts.values().copied().max().unwrap_or(0);
    (counts.len(), f64::from(commonest) / f64::from(picture.width() * picture.height()))
}
