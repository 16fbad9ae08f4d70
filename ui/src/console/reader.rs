//! Follows the wizards' instructions instead of a person: the technician of an emulated rig.

use std::sync::Arc;

use nima_simulation::screen::{Screen, Task};

use super::wizards::{Kind, Which};

/// Receives the content of the screen. Clones are the same reader.
#[derive(Clone)]
pub struct Reader(Arc<dyn Fn(&Screen) + Send + Sync>);

impl Reader {
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

impl std::fmt::Debug for Reader {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(std::any::type_name::<Self>())
    }
}

/// Task of an open wizard for the person at the arm.
pub const fn task_of(open: Option<Which>) -> Task {
    match open {
        // The emulators' technician has no board.
        None | Some(Which::Camera) => Task::Surgery,
        // Both record poses in all directions of gravity.
        Some(Which::Gravity | Which::Frame(Kind::Mount)) => Task::Gravity,
        Some(Which::Correspondence) => Task::Correspondence,
        Some(Which::TipForce) => Task::TipForce,
        Some(Which::Frame(Kind::Tip)) => Task::Tip,
        Some(Which::Frame(Kind::HandEye)) => Task::HandEye,
        Some(Which::Frame(Kind::Table)) => Task::Table,
        Some(Which::Frame(Kind::View)) => Task::View,
        Some(Which::Frame(Kind::Trocar)) => Task::Trocar,
    }
}
