//! Screenshots for the README and the documents: every view and every panel in turn, each during a contact.

use std::{
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
    time::{Duration, Instant},
};

use nima_machine::messages::{LoopState, Tick};
use nima_panels::{
    roles::Role,
    settings::ConsoleSettings,
    tiles::{PanelId, PanelLayout},
};
use nima_screen::{live::LiveState, screenshot, stderr::print_line};

/// Time after which the traces are full.
const FILLED: Duration = Duration::from_secs(11);
/// Time after which a view has settled.
const SETTLED: Duration = Duration::from_millis(1200);
/// Longest wait for a contact.
const TIMEOUT: Duration = Duration::from_secs(6);
/// Force of the contact at which a screenshot is taken, N.
const CONTACT_N: f64 = 1.5;
/// If the loop is not engaged within this time, no screenshots are taken.
const GIVE_UP: Duration = Duration::from_secs(10);
/// Time to save the last screenshot before the window closes.
const LAST: Duration = Duration::from_millis(700);

/// File name, role, panel to bring to the front, light palette.
const SHOTS: &[(&str, Role, Option<PanelId>, bool)] = &[
    ("console", Role::Technician, None, false),
    ("safety", Role::Technician, Some(PanelId::Safety), false),
    ("devices", Role::Technician, Some(PanelId::Devices), false),
    ("tradeoff", Role::Technician, Some(PanelId::Tradeoff), false),
    ("link", Role::Technician, Some(PanelId::Link), false),
    ("calibration", Role::Technician, Some(PanelId::Calibrations), false),
    ("prediction-error", Role::Technician, Some(PanelId::Horizon), false),
    ("degrees", Role::Technician, Some(PanelId::Degrees), false),
    ("timing", Role::Technician, Some(PanelId::Timing), false),
    ("light", Role::Technician, None, true),
    ("surgeon", Role::Surgeon, None, false),
    ("demo", Role::Demo, None, false),
];

/// Folder of the screenshots, and the number of saved ones.
#[derive(Clone, Debug)]
pub struct ScreenshotFolder {
    folder: PathBuf,
    saved: Arc<AtomicUsize>,
}

impl ScreenshotFolder {
    /// The folder must exist.
    pub fn new(folder: &Path) -> Self {
        Self { folder: folder.to_path_buf(), saved: Arc::default() }
    }

    pub fn is_complete(&self) -> bool {
        self.saved.load(Ordering::Relaxed) == SHOTS.len()
    }
}

/// The next screenshot, and the time since which its view has been shown.
#[derive(Debug)]
pub(super) struct ScreenshotRun {
    album: ScreenshotFolder,
    next: usize,
    since: Instant,
    touching: bool,
}

impl ScreenshotRun {
    pub(super) fn new(album: ScreenshotFolder) -> Self {
        Self { album, next: 0, since: Instant::now(), touching: false }
    }

    /// Shows the next view and takes its screenshot when it is ready; returns true when all are taken or the loop has
    /// stopped.
    pub(super) fn step(&mut self, ctx: &egui::Context, live: &LiveState, settings: &mut ConsoleSettings) -> bool {
        let Some((name, role, front, light)) = SHOTS.get(self.next) else { return self.since.elapsed() > LAST };
        settings.role = *role;
        settings.light = *light;
        settings.layout = PanelLayout { front: front.iter().copied().collect(), ..PanelLayout::default() };
        let min = if self.next == 0 { FILLED } else { SETTLED };
        let shown = self.since.elapsed();
        let engaged = live.state() == LoopState::Engaged;
        let touches = |tick: &Tick| {
            tick.known_n().is_some_and(|force_n| force_n.norm().min(tick.rendering.rendered_n.norm()) > CONTACT_N)
        };
        let touching = live.first_tick().is_some_and(touches);
        // Taken at the start of the contact, because the screenshot follows a frame or two later.
        let before = std::mem::replace(&mut self.touching, touching);
        let contact = touching && !before;
        if shown > min + GIVE_UP {
            return true;
        }
        if !engaged || shown < min || (!contact && shown < min + TIMEOUT) {
            return false;
        }
        let path = self.album.folder.join(format!("{name}.png"));
        let saved = Arc::clone(&self.album.saved);
        ctx.request_screenshot(move |image| match screenshot::save(&path, &image) {
            Ok(()) => {
                saved.fetch_add(1, Ordering::Relaxed);
            }
            Err(error) => print_line(format_args!("{error:#}")),
        });
        self.next += 1;
        self.since = Instant::now();
        false
    }
}

#[cfg(test)]
mod tests {
    use nima_machine::config::RigConfig;
    use nima_simulation::scene::Scene;

    use super::*;

    #[test]
    fn every_panel_is_in_a_picture() {
        // In front in every layout.
        let mut shown = vec![PanelId::Field, PanelId::Feedback, PanelId::Traces, PanelId::ForceSpace];
        shown.extend(SHOTS.iter().filter_map(|(_, _, front, _)| *front));
        let missing: Vec<_> = PanelId::ALL.into_iter().filter(|panel| !shown.contains(panel)).collect();
        assert!(missing.is_empty(), "{missing:?}");
    }

    #[test]
    fn a_view_is_set_at_once_and_no_picture_is_taken_before_there_is_something_to_see() {
        let folder = tempfile::tempdir().unwrap();
        let album = ScreenshotFolder::new(folder.path());
        let mut photographer = ScreenshotRun::new(album.clone());
        let live = LiveState::new(RigConfig::load("simulated").unwrap(), Scene::load("bimanual").unwrap());
        let mut settings = ConsoleSettings { role: Role::Demo, light: true, ..ConsoleSettings::default() };
        assert!(!photographer.step(&egui::Context::default(), &live, &mut settings));
        assert_eq!((settings.role, settings.light), (SHOTS[0].1, SHOTS[0].3));
        assert_eq!(photographer.next, 0);
        photographer.since = Instant::now().checked_sub(FILLED + GIVE_UP + SETTLED).unwrap();
        assert!(photographer.step(&egui::Context::default(), &live, &mut settings), "a loop at rest is given up");
        assert!(!album.is_complete());
    }
}
