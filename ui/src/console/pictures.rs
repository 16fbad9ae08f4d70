//! Pictures for the README and the documents, taken by the program of itself: every view in turn, each in a moment of contact.

use std::{
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
    time::{Duration, Instant},
};

use nima_machine::messages::LoopState;

use super::{
    desk::{Layout, Panel},
    live::Live,
    roles::Role,
    screenshot,
    settings::Settings,
};
use crate::telling::tell;

/// The traces are full of data after this time.
const FILLED: Duration = Duration::from_secs(11);
/// A view has settled after this time.
const SETTLED: Duration = Duration::from_millis(1200);
/// A contact is waited for so long.
const TIMEOUT: Duration = Duration::from_secs(6);
/// A force worth a picture, N.
const CONTACT_N: f64 = 1.5;
/// A loop that is not engaged for so long gives no picture.
const GIVE_UP: Duration = Duration::from_secs(10);
/// Time for the last picture to be taken.
const LAST: Duration = Duration::from_millis(700);

/// Name of the file, role, the panel that is brought to the front, light.
const SHOTS: [(&str, Role, Option<Panel>, bool); 5] = [
    ("console", Role::Technician, None, false),
    ("safety", Role::Technician, Some(Panel::Safety), false),
    ("light", Role::Technician, None, true),
    ("surgeon", Role::Surgeon, None, false),
    ("demo", Role::Demo, None, false),
];

/// Where the pictures go, and how many were saved.
#[derive(Clone, Debug)]
pub struct Album {
    folder: PathBuf,
    saved: Arc<AtomicUsize>,
}

impl Album {
    /// Pictures into this folder, which must exist.
    pub fn new(folder: &Path) -> Self {
        Self { folder: folder.to_path_buf(), saved: Arc::default() }
    }

    /// All pictures were saved.
    pub fn is_complete(&self) -> bool {
        self.saved.load(Ordering::Relaxed) == SHOTS.len()
    }
}

/// Which picture is next, and since when its view is shown.
#[derive(Debug)]
pub(super) struct Photographer {
    album: Album,
    next: usize,
    since: Instant,
    touching: bool,
}

impl Photographer {
    pub(super) fn new(album: Album) -> Self {
        Self { album, next: 0, since: Instant::now(), touching: false }
    }

    /// Sets the next view, takes its picture when it is ready; true when all are taken or
    /// the loop has stopped.
    pub(super) fn step(&mut self, ctx: &egui::Context, live: &Live, settings: &mut Settings) -> bool {
        let Some((name, role, front, light)) = SHOTS.get(self.next) else { return self.since.elapsed() > LAST };
        (settings.role, settings.light) = (*role, *light);
        settings.layout = Layout { front: front.iter().copied().collect(), ..Layout::default() };
        let least = if self.next == 0 { FILLED } else { SETTLED };
        let shown = self.since.elapsed();
        let engaged = live.state() == LoopState::Engaged;
        let touching =
            live.first_tick().is_some_and(|tick| tick.measured_n.norm().min(tick.rendered_n.norm()) > CONTACT_N);
        // At its beginning: the picture itself comes a frame or two later.
        let before = std::mem::replace(&mut self.touching, touching);
        let contact = touching && !before;
        if shown > least + GIVE_UP {
            return true;
        }
        if !engaged || shown < least || (!contact && shown < least + TIMEOUT) {
            return false;
        }
        let path = self.album.folder.join(format!("{name}.png"));
        let saved = Arc::clone(&self.album.saved);
        ctx.request_screenshot(move |picture| match screenshot::save(&path, &picture) {
            Ok(()) => {
                saved.fetch_add(1, Ordering::Relaxed);
            }
            Err(error) => tell(format_args!("{error:#}")),
        });
        self.next += 1;
        self.since = Instant::now();
        false
    }
}

#[cfg(test)]
mod tests {
    use nima_machine::config::RigConfig;
    use nima_world::scene::Scene;

    use super::*;

    #[test]
    fn a_view_is_set_at_once_and_no_picture_is_taken_before_there_is_something_to_see() {
        let folder = tempfile::tempdir().unwrap();
        let album = Album::new(folder.path());
        let mut photographer = Photographer::new(album.clone());
        let live = Live::new(RigConfig::load("simulated").unwrap(), Scene::load("bimanual").unwrap());
        let mut settings = Settings { role: Role::Demo, light: true, ..Settings::default() };
        assert!(!photographer.step(&egui::Context::default(), &live, &mut settings));
        assert_eq!((settings.role, settings.light), (SHOTS[0].1, SHOTS[0].3));
        assert_eq!(photographer.next, 0);
        photographer.since = Instant::now().checked_sub(FILLED + GIVE_UP + SETTLED).unwrap();
        assert!(photographer.step(&egui::Context::default(), &live, &mut settings), "a loop at rest is given up");
        assert!(!album.is_complete());
    }
}
