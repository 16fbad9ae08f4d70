//! The operator's window for one running loop.
//!
//! Receives ticks and events through a [`Handle`](nima_machine::runtime::LoopHandle) and sends commands through it. Panels never
//! change the loop directly; they show the content of the ticks and put the operator's commands into an outbox. All panels
//! are plain functions of [`live::LiveState`], so they can be tested without a screen. Only `scene3d/gl.rs` uses the GPU.

pub mod app;
pub mod commands;
pub mod help;
mod keys;
mod menu;
pub mod monitor;
pub mod page;
mod palette;
pub mod reader;
pub mod screenshots;
pub(crate) mod sessions;
pub mod start;
mod top_bar;
mod undo;

use std::{path::PathBuf, sync::Arc, time::Duration};

use app::StartedLoop;
use nima_machine::config::RigConfig;
use nima_panels::{rig_choice::RigChoice, settings::SettingsStore};
use nima_recording::csv::Signals;
use nima_screen::link::{LineConnection, Reopen};
use nima_simulation::scene::Scene;
use nima_words::language::{self, Language};
use sessions::ConsoleSessions;

pub use app::ConsoleApp;

use crate::{emulators::Emulators, shutdown::Leave};

/// Options of the window, for screenshots and tests. By default it stays open until it is closed.
#[derive(Clone, Debug, Default)]
pub struct ConsoleOptions {
    pub exit_after: Option<Duration>,
    /// Save a screenshot (PNG) just before the window closes automatically (or after three seconds if it does not).
    pub screenshot: Option<PathBuf>,
    /// Take screenshots of every view, then close.
    pub images: Option<screenshots::ScreenshotFolder>,
    pub role: Option<nima_panels::roles::Role>,
    pub language: Option<Language>,
    /// Recording that is shown at the start.
    pub session: Option<PathBuf>,
    /// Its signals, if another program recorded it.
    pub signals: Option<Arc<Signals>>,
    pub wizard: Option<nima_wizards::WizardKind>,
    pub summary: Option<PathBuf>,
    pub frames: Option<PathBuf>,
    /// Initial length of the traces, s.
    pub traces_s: Option<f64>,
    /// Block the window for this time, once.
    pub stall: Option<Duration>,
    pub leave: Leave,
}

/// The state in which the console opens.
#[derive(Debug)]
pub(crate) struct InitialRun {
    pub(crate) choice: RigChoice,
    pub(crate) emulators: Option<Emulators>,
    pub(crate) started: StartedLoop,
    pub(crate) rig: RigConfig,
    pub(crate) scene: Scene,
    pub(crate) sessions: ConsoleSessions,
    /// The link to the machine with the arm, if that is another machine, and the means to reopen the link.
    pub(crate) far: Option<(Box<dyn LineConnection>, Reopen)>,
}

/// Opens the console for a running loop; returns when the window is closed and the loop has ended.
pub(crate) fn run(begun: InitialRun, options: ConsoleOptions) -> anyhow::Result<()> {
    let create: eframe::AppCreator<'_> = Box::new(move |cc| Ok(Box::new(console(cc, begun, options))));
    let ended = open_window(nima_words::text::top_bar::NIMA_CONSOLE.get(), create);
    // From here on, messages go to the terminal, in English.
    language::set(Language::English);
    ended
}

/// Opens a window; returns when it is closed.
pub(crate) fn open_window(title: &str, create: eframe::AppCreator<'_>) -> anyhow::Result<()> {
    let viewport = egui::ViewportBuilder::default()
        .with_title(title)
        .with_app_id("nima-console")
        .with_inner_size([1600.0, 1000.0])
        .with_min_inner_size([1100.0, 680.0]);
    let native = eframe::NativeOptions {
        viewport,
        renderer: eframe::Renderer::Glow,
        depth_buffer: 24,
        // Useful only for gradients, which egui does not draw here; with a software renderer it costs time for every
        // pixel.
        dithering: false,
        centered: true,
        ..Default::default()
    };
    eframe::run_native(title, native, create).map_err(|error| NoWindow::new(&error.to_string()).into())
}

/// Returns the console with the user's settings; screenshots use the defaults and do not change the settings.
fn console(cc: &eframe::CreationContext<'_>, begun: InitialRun, options: ConsoleOptions) -> ConsoleApp {
    let InitialRun { choice, emulators, started: (handle, objects), rig, scene, sessions, far } = begun;
    let settings = if options.images.is_some() { SettingsStore::default() } else { SettingsStore::of_user() };
    let app = ConsoleApp::new(cc, handle, rig, scene).with_objects(objects);
    let app = app.with_choice(choice, emulators).with_sessions(sessions).with_line(far);
    app.with_settings(settings).with_options(options)
}

/// No window could be opened: no display, or no usable OpenGL.
#[derive(Debug, thiserror::Error)]
#[error("{reason}")]
pub struct NoWindow {
    /// Message of the window system, whose error type cannot be sent between threads.
    pub reason: String,
}

impl NoWindow {
    /// Creates the message without the source position at its start.
    fn new(words: &str) -> Self {
        let after_place = words.rsplit_once(".rs:").and_then(|(_, rest)| rest.split_once(": "));
        Self { reason: after_place.map_or(words, |(_, reason)| reason).to_owned() }
    }
}

#[cfg(test)]
mod tests {
    use crate::console::NoWindow;

    #[test]
    fn a_place_in_someone_elses_source_is_left_out() {
        assert_eq!(NoWindow::new("os error at /a/b/mod.rs:765: no display is set").to_string(), "no display is set");
        assert_eq!(NoWindow::new("no OpenGL").to_string(), "no OpenGL");
    }
}
