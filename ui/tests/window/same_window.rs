//! The same window without a screen: it says where a control lies in the real one.
#![cfg(target_os = "linux")]

use std::time::{Duration, Instant};

use eframe::App as _;
use egui::{Rect, accesskit::Role};
use egui_kittest::{Harness, kittest::Queryable as _};
use nima_console::console::ConsoleApp;
use nima_panels::settings::SettingsStore;
use nima_simulation::start_watched;

/// The real window fills the screen of [`crate::server::Xvfb::start`].
pub(crate) const WINDOW: [f32; 2] = [1600.0, 1000.0];
const TIMEOUT: Duration = Duration::from_secs(30);

pub(crate) struct SameWindow {
    window: Harness<'static, ConsoleApp>,
    _folder: tempfile::TempDir,
}

impl SameWindow {
    /// The window of the simulated rig in this scene and role, prepared by `prepare`.
    pub(crate) fn open(scene: &str, role: &str, prepare: impl FnOnce(ConsoleApp) -> ConsoleApp + 'static) -> Self {
        let plan = nima_tests::plan(scene);
        let (handle, objects) = start_watched(&plan, 1.0).unwrap();
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("console.json"), format!(r#"{{"toured":true,"role":"{role}"}}"#)).unwrap();
        let settings = SettingsStore::open(folder.path());
        let mut window = Harness::builder().with_size(WINDOW).build_eframe(move |cc| {
            let app = ConsoleApp::new(cc, handle, plan.rig, plan.scene).with_objects(objects);
            prepare(app.with_simulated_time(1.0).with_settings(settings))
        });
        window.run_steps(4);
        Self { window, _folder: folder }
    }

    /// Returns the rectangle of the control with this name.
    pub(crate) fn rect(&self, label: &str) -> Rect {
        self.window.get_by_label(label).rect()
    }

    /// Returns the middle of a button.
    pub(crate) fn button(&mut self, label: &str) -> (i32, i32) {
        self.control(Role::Button, label)
    }

    /// Returns the middle of a control, waiting until it is shown.
    pub(crate) fn control(&mut self, role: Role, label: &str) -> (i32, i32) {
        let began = Instant::now();
        while self.window.query_by_role_and_label(role, label).is_none() {
            assert!(began.elapsed() < TIMEOUT, "no control is called {label}");
            self.window.run_steps(2);
        }
        let middle = self.window.get_by_role_and_label(role, label).rect().center().round();
        (middle.x as i32, middle.y as i32)
    }

    pub(crate) fn press(&mut self, label: &str) {
        self.button(label);
        self.window.get_by_role_and_label(Role::Button, label).click_accesskit();
        self.window.run_steps(3);
    }

    /// Returns the middle of the button that releases a stop, which is where Engage is when the loop is idle.
    pub(crate) fn next_step(&mut self) -> (i32, i32) {
        self.press("Stop");
        self.button("Release stop")
    }
}

impl Drop for SameWindow {
    fn drop(&mut self) {
        self.window.state_mut().on_exit(None);
    }
}
