//! The operator's window on one running loop.
//!
//! Takes a [`Handle`]: ticks and events come out of it, commands go in. Panels never change the machine; they show what
//! comes back in the ticks and put what the operator asks into an outbox. All panels are plain functions over
//! [`live::Live`], so they can be driven in tests without a screen. Only `scene3d/gl.rs` talks to the GPU.

pub mod alarms;
pub mod app;
pub mod canvas;
pub mod cloud;
pub mod deadlines;
pub mod desk;
pub mod diary;
pub mod door;
pub mod frames;
pub mod help;
pub mod history;
pub mod in_force;
mod keys;
pub mod live;
mod menu;
pub mod outbox;
pub mod panels;
pub mod pictures;
pub mod readings;
pub mod roles;
pub mod rolling;
pub mod scene3d;
pub mod screenshot;
pub mod settings;
pub mod stiffness;
pub mod text;
pub mod theme;
pub mod widgets;
pub mod wizards;

use std::{path::PathBuf, time::Duration};

use nima_machine::{config::RigConfig, runtime::Handle};
use nima_world::scene::Scene;
use settings::Kept;

pub use app::ConsoleApp;

use crate::leaving::Leave;

/// What may be asked of the window from outside, for pictures and tests. The default opens it until it is closed.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Close the window by itself after this time.
    pub exit_after: Option<Duration>,
    /// Save the window as PNG here just before it closes by itself (or after three seconds if it does not).
    pub screenshot: Option<PathBuf>,
    /// Take pictures of every view, then close.
    pub pictures: Option<pictures::Album>,
    /// Begin in this role instead of the last one.
    pub role: Option<roles::Role>,
    /// Begin with this wizard.
    pub wizard: Option<wizards::Which>,
    /// Write the loop's figures here when the window is closed.
    pub summary: Option<PathBuf>,
    /// Write what the screen costs here when the window is closed.
    pub frames: Option<PathBuf>,
    /// Length of the traces at first, s.
    pub traces_s: Option<f64>,
    /// Hold the window up for so long, once.
    pub stall: Option<Duration>,
    /// What asks the console to end from outside.
    pub leave: Leave,
}

/// Opens the console on a running loop; returns when the window is closed and the loop has ended.
pub fn run(handle: Handle, rig: RigConfig, scene: Scene, options: Options) -> anyhow::Result<()> {
    let viewport = egui::ViewportBuilder::default()
        .with_title(text::top_bar::NIMA_CONSOLE)
        .with_app_id("nima-console")
        .with_inner_size([1600.0, 1000.0])
        .with_min_inner_size([1100.0, 680.0]);
    let native = eframe::NativeOptions {
        viewport,
        renderer: eframe::Renderer::Glow,
        depth_buffer: 24,
        // For gradients, of which egui draws none here; in software it costs a part of every point.
        dithering: false,
        centered: true,
        ..Default::default()
    };
    let create: eframe::AppCreator<'_> = Box::new(move |cc| Ok(Box::new(console(cc, handle, rig, scene, options))));
    eframe::run_native(text::top_bar::NIMA_CONSOLE, native, create)
        .map_err(|error| NoWindow::new(&error.to_string()).into())
}

/// The console with the user's settings; pictures are taken with the defaults and leave the settings alone.
fn console(
    cc: &eframe::CreationContext<'_>,
    handle: Handle,
    rig: RigConfig,
    scene: Scene,
    options: Options,
) -> ConsoleApp {
    let settings = if options.pictures.is_some() { Kept::default() } else { Kept::of_user() };
    ConsoleApp::new(cc, handle, rig, scene).with_settings(settings).with_options(options)
}

/// No window could be opened: there is no display, or it has no usable OpenGL.
#[derive(Debug, thiserror::Error)]
#[error("{reason}")]
pub struct NoWindow {
    /// What the window system said (its own error cannot cross threads; its words are what matters).
    pub reason: String,
}

impl NoWindow {
    /// The window system's words without the place in its source that they may begin with.
    fn new(words: &str) -> Self {
        let after_place = words.rsplit_once(".rs:").and_then(|(_, rest)| rest.split_once(": "));
        Self { reason: after_place.map_or(words, |(_, reason)| reason).to_owned() }
    }
}

#[cfg(test)]
mod tests {
    use super::NoWindow;

    #[test]
    fn a_place_in_someone_elses_source_is_left_out() {
        assert_eq!(NoWindow::new("os error at /a/b/mod.rs:765: no display is set").to_string(), "no display is set");
        assert_eq!(NoWindow::new("no OpenGL").to_string(), "no OpenGL");
    }
}
