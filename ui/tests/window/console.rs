//! The console in a real window, with simulated mouse and keyboard.

use std::{
    path::Path,
    process::{Child, Stdio},
    thread,
    time::Duration,
};

use crate::server::{Xvfb, wait_until};

pub(crate) struct Console<'a> {
    pub(crate) x: &'a Xvfb,
    /// Data folder.
    pub(crate) folder: tempfile::TempDir,
    process: Child,
}

impl<'a> Console<'a> {
    pub(crate) fn begin(x: &'a Xvfb, folder: tempfile::TempDir, arguments: &[&str]) -> Self {
        let process = x
            .command(env!("CARGO_BIN_EXE_nima"))
            .env("XDG_RUNTIME_DIR", folder.path())
            .env("NIMA_DATA_DIR", folder.path())
            .args(["console", "--summary"])
            .arg(folder.path().join("summary.json"))
            .args(arguments)
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        let console = Self { x, folder, process };
        wait_until("the window", || x.window_is_open());
        thread::sleep(Duration::from_millis(1500));
        // Without a window manager the window does not get keyboard focus. On a busy machine it cannot take it at once.
        let focus = ["search", "--name", "NIMA Console", "windowfocus"];
        wait_until("the focus", || console.x.command("xdotool").args(focus).status().unwrap().success());
        thread::sleep(Duration::from_millis(500));
        console
    }

    fn tool(&self, arguments: &[&str]) {
        assert!(self.x.command("xdotool").args(arguments).status().unwrap().success(), "{arguments:?}");
        thread::sleep(Duration::from_millis(500));
    }

    pub(crate) fn move_to(&self, (x, y): (i32, i32)) {
        self.tool(&["mousemove", &x.to_string(), &y.to_string()]);
    }

    pub(crate) fn click(&self, (x, y): (i32, i32)) {
        self.tool(&["mousemove", &x.to_string(), &y.to_string(), "sleep", "0.2", "click", "1"]);
    }

    pub(crate) fn key(&self, key: &str) {
        self.tool(&["key", key]);
    }

    /// Presses, moves in steps as a hand does, and releases.
    pub(crate) fn drag(&self, from: (i32, i32), to: (i32, i32)) {
        self.tool(&["mousemove", &from.0.to_string(), &from.1.to_string(), "sleep", "0.2", "mousedown", "1"]);
        for step in 1..=6 {
            let at = |from: i32, to: i32| from + (to - from) * step / 6;
            self.move_to((at(from.0, to.0), at(from.1, to.1)));
        }
        self.tool(&["mouseup", "1"]);
    }

    /// Saves the window as an image, for the pages and for debugging, if `NIMA_PICTURES` names a folder.
    pub(crate) fn keep_image(&self, name: &str) {
        if let Some(folder) = std::env::var_os("NIMA_PICTURES") {
            let path = Path::new(&folder).join(name).with_extension("png");
            self.x.command("import").args(["-window", "root"]).arg(path).status().unwrap();
        }
    }

    /// Ends the program as a service manager does; returns the loop's results that it writes.
    pub(crate) fn end(&mut self) -> serde_json::Value {
        assert!(self.x.command("kill").args(["-TERM", &self.process.id().to_string()]).status().unwrap().success());
        assert!(self.process.wait().unwrap().success(), "the console closes with success");
        read(&self.folder.path().join("summary.json"))
    }
}

impl Drop for Console<'_> {
    fn drop(&mut self) {
        self.process.kill().ok();
        self.process.wait().ok();
    }
}

pub(crate) fn read(path: &Path) -> serde_json::Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}
