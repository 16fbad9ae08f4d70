//! A real X server without a screen, for tests of the real window.

use std::{
    ffi::OsStr,
    io::{BufRead as _, BufReader},
    path::Path,
    process::{Child, Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use nima_testing::unjudged;

/// An X server in memory that ends with its owner.
pub(crate) struct Xvfb {
    server: Child,
    display: String,
}

impl Xvfb {
    /// Starts the server; `None`, with a message, if the tools are not installed, unless the environment requires them.
    pub(crate) fn start() -> Option<Self> {
        Self::of("1600x1000", None)
    }

    /// Starts a server with a screen of this size (`1600x1000`), whose memory is a file in this folder.
    pub(crate) fn of(size: &str, memory: Option<&Path>) -> Option<Self> {
        let found = ["Xvfb", "xdotool", "import"].into_iter().all(which);
        if !found {
            assert!(std::env::var_os("NIMA_REQUIRE_WINDOW").is_none(), "Xvfb, xdotool or ImageMagick is not installed");
            unjudged::left_out("Xvfb, xdotool or ImageMagick is not installed");
            return None;
        }
        // Without -noreset, the server restarts when a window closes, and the next window may open in between.
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", &format!("{size}x24"), "-nolisten", "tcp", "-noreset"])
            .args(memory.into_iter().flat_map(|folder| [OsStr::new("-fbdir"), folder.as_os_str()]))
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
        Some(Self { server, display: format!(":{}", number.trim()) })
    }

    pub(crate) fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command.env("DISPLAY", &self.display).env_remove("WAYLAND_DISPLAY").env("LIBGL_ALWAYS_SOFTWARE", "1");
        command
    }

    pub(crate) fn window_is_open(&self) -> bool {
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

/// Far longer than any step takes, even on a busy machine.
const TIMEOUT: Duration = Duration::from_mins(3);

pub(crate) fn wait_until(what: &str, good: impl Fn() -> bool) {
    let began = Instant::now();
    while !good() {
        assert!(began.elapsed() < TIMEOUT, "{what} did not happen within {} s", TIMEOUT.as_secs());
        thread::sleep(Duration::from_millis(100));
    }
}
