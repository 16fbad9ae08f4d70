//! The content below the top bar. One value owns it, so two pages can never be open at once.

use std::time::Instant;

use nima_playback::Playback;
use nima_wizards::WizardKind;

use super::{ConsoleApp, setting_up::SetupPage};

#[derive(Debug, Default)]
pub(super) enum ShownPage {
    /// The views of the machine.
    #[default]
    Monitor,
    /// A recorded session instead of the machine.
    Past(Box<Playback>),
    /// The list of recorded sessions.
    Sessions,
    /// The ready check, open since this time.
    Check(Instant),
    Setup(Box<SetupPage>),
    Wizard(WizardKind),
    Start,
    /// The page of an extra, or its run.
    OfExtra,
}

/// Page to which a wizard or the ready check returns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum WayBack {
    #[default]
    Monitor,
    Setup,
}

impl ShownPage {
    pub(super) fn past(&self) -> Option<&Playback> {
        if let Self::Past(past) = self { Some(past) } else { None }
    }

    pub(super) fn past_mut(&mut self) -> Option<&mut Playback> {
        if let Self::Past(past) = self { Some(past) } else { None }
    }

    pub(super) const fn is_past(&self) -> bool {
        matches!(self, Self::Past(_))
    }

    pub(super) const fn wizard(&self) -> Option<WizardKind> {
        if let Self::Wizard(which) = self { Some(*which) } else { None }
    }

    /// A wizard or the ready check: a person is at the arm.
    pub(super) const fn guides_a_person(&self) -> bool {
        matches!(self, Self::Wizard(_) | Self::Check(_))
    }
}

impl ConsoleApp {
    /// Leaves the page: for the views of the machine, or the page of an extra that reserves the machine.
    pub(super) fn leave_page(&mut self) {
        self.shown = if self.is_held() { ShownPage::OfExtra } else { ShownPage::Monitor };
    }
}
