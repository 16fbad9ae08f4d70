//! Follows the wizards' instructions instead of a person: the technician of an emulated rig.

use std::sync::Arc;

use nima_simulation::screen::{PersonTask, Screen};
use nima_wizards::{FrameKind, WizardKind};

/// Receives the content of the screen. Clones are the same reader.
#[derive(Clone)]
pub struct ScreenReader(Arc<dyn Fn(&Screen) + Send + Sync>);

impl ScreenReader {
    /// `reads` is called with every change of the screen.
    pub fn new(reads: impl Fn(&Screen) + Send + Sync + 'static) -> Self {
        Self(Arc::new(reads))
    }

    /// Shows the screen unless it equals the `last` one.
    pub fn show(&self, screen: Screen, last: &mut Option<Screen>) {
        if *last != Some(screen) {
            (self.0)(&screen);
            *last = Some(screen);
        }
    }
}

impl std::fmt::Debug for ScreenReader {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(std::any::type_name::<Self>())
    }
}

/// Returns the task of an open wizard for the person at the arm.
pub const fn task_of(open: Option<WizardKind>) -> PersonTask {
    match open {
        // The emulators' technician has no board.
        None | Some(WizardKind::Camera) => PersonTask::Surgery,
        // Both record poses with gravity in all directions.
        Some(WizardKind::Gravity | WizardKind::Frame(FrameKind::Mount)) => PersonTask::Gravity,
        Some(WizardKind::Correspondence) => PersonTask::Correspondence,
        Some(WizardKind::TipForce) => PersonTask::TipForce,
        Some(WizardKind::Frame(FrameKind::Tip)) => PersonTask::Tip,
        Some(WizardKind::Frame(FrameKind::HandEye)) => PersonTask::HandEye,
        Some(WizardKind::Frame(FrameKind::Table)) => PersonTask::Table,
        Some(WizardKind::Frame(FrameKind::View)) => PersonTask::View,
        Some(WizardKind::Frame(FrameKind::Trocar)) => PersonTask::Trocar,
    }
}
