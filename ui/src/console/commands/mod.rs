//! The one table of the commands of the window: menus, keys, the list of keys, the palette and `docs/reference/commands.md` are made from it.
//!
//! A command has a name, keys, a place and a meaning here; whether it is possible now, and what it does, is decided in
//! one place too (`app/reaching.rs`, `app/acting.rs`), whoever asks for it.

mod keys;
mod table;

use super::{desk::Panel, roles::Role, scene3d::extras::Switch, text, wizards::Which};
use crate::language::Language;

pub(in crate::console) use self::keys::{SIZE, UNDO};
pub use self::{
    keys::{Stroke, With},
    table::table,
};

/// Sizes in the menu, percent.
pub const SIZES_PERCENT: [u16; 5] = [100, 125, 150, 175, 200];

/// What a command does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Stops.
    Stop,
    /// The step from idle to engaged.
    Engage,
    /// The step from a stop or a fault to idle.
    Release,
    /// Shows a view.
    View(Role),
    /// Opens or closes the page of rigs and scenes.
    Rig,
    /// Opens or closes the list of sessions.
    Sessions,
    /// Opens or closes the page of user studies.
    Studies,
    /// Opens or closes the list of alarms.
    Alarms,
    /// Opens or closes the list of keys and terms.
    Glossary,
    /// Begins the tour.
    Tour,
    /// Opens or closes the palette.
    Palette,
    /// Acknowledges the alarms.
    Acknowledge,
    /// Marks the present moment.
    Mark,
    /// Keeps the session, or no longer.
    Keep,
    /// Takes back a change of the screen.
    Undo,
    /// Makes it again.
    Redo,
    /// Chooses the light or the dark palette.
    Light(bool),
    /// Chooses the language of the window.
    Language(Language),
    /// One step larger.
    Larger,
    /// One step smaller.
    Smaller,
    /// This size, percent.
    Size(u16),
    /// Switches alarm sounds.
    Sound,
    /// Switches the moment for which forces are drawn into the picture.
    ForcesOfNow,
    /// Shows the picture as it comes.
    PlainPicture,
    /// Switches the recording of the picture.
    RecordsPicture,
    /// Opens or closes a panel.
    Panel(Panel),
    /// Every panel at its original place.
    ResetLayout,
    /// Opens the ready check.
    Check,
    /// Opens the list of calibrations.
    Calibrations,
    /// Opens a wizard.
    Calibrate(Which),
    /// Leaves the page of a wizard, of the check or of the list.
    CloseWizard,
    /// Holds the traces, or goes on.
    Pause,
    /// Shows the last ten seconds.
    LastTenSeconds,
    /// Switches what is drawn in the field.
    Draws(Switch),
    /// Leads the instrument, or lets it go.
    Drive,
    /// Leads the other instrument.
    OtherHand,
    /// Opens or closes the jaws.
    Jaws,
    /// Marks the place under the tip.
    MarkPlace,
    /// Ends the trial of a palpation.
    EndTrial,
    /// Begins the trial anew.
    BeginTrial,
    /// Hides the forces in the picture, or draws them.
    HideForces,
    /// Shows the other lens.
    Lens,
    /// Leaves the past.
    LeavePast,
    /// Plays the past, or holds it.
    Play,
    /// Moves so far in the past, ms.
    Step(i32),
}

impl Action {
    /// The part of the window that it acts on reads its key itself: from elsewhere its key is pressed for it.
    pub(in crate::console) const fn is_of_part(self) -> bool {
        matches!(
            self,
            Self::Drive
                | Self::OtherHand
                | Self::Jaws
                | Self::MarkPlace
                | Self::EndTrial
                | Self::BeginTrial
                | Self::HideForces
                | Self::Lens
        )
    }

    /// What a participant can do in a trial of a study.
    pub(in crate::console) const fn is_of_participant(self) -> bool {
        matches!(
            self,
            Self::Stop
                | Self::Engage
                | Self::Release
                | Self::Alarms
                | Self::Acknowledge
                | Self::Mark
                | Self::Larger
                | Self::Smaller
                | Self::Palette
                | Self::OtherHand
                | Self::Jaws
                | Self::MarkPlace
                | Self::EndTrial
        )
    }

    /// It leads towards motion and force: the palette asks once more.
    pub const fn leads_to_force(self) -> bool {
        matches!(self, Self::Engage | Self::Release)
    }

    /// A key that is held down repeats it.
    pub(in crate::console) const fn repeats(self) -> bool {
        matches!(self, Self::Larger | Self::Smaller | Self::Step(_) | Self::Undo | Self::Redo)
    }
}

/// Where a command is, besides the palette.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The top bar.
    Bar,
    /// The View menu.
    ViewMenu,
    /// The strip of alarms.
    Alarms,
    /// The panel of calibrations.
    Calibration,
    /// The panel of traces.
    Traces,
    /// The operating field.
    Field,
    /// The endoscope's picture.
    Picture,
    /// The frame around the past.
    Past,
    /// Only a key.
    Keys,
}

impl Place {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bar => text::commands::AT_BAR.get(),
            Self::ViewMenu => text::commands::AT_VIEW_MENU.get(),
            Self::Alarms => text::commands::AT_ALARMS.get(),
            Self::Calibration => text::commands::AT_CALIBRATION.get(),
            Self::Traces => text::commands::AT_TRACES.get(),
            Self::Field => text::commands::AT_FIELD.get(),
            Self::Picture => text::commands::AT_PICTURE.get(),
            Self::Past => text::commands::AT_PAST.get(),
            Self::Keys => text::commands::AT_KEYS.get(),
        }
    }
}

/// A command.
#[derive(Clone, Debug)]
pub struct Entry {
    /// What it does.
    pub action: Action,
    /// Its name.
    pub title: String,
    /// Its name in English, by which it is found in every language: the documents have it.
    pub english: String,
    /// Its meaning.
    pub does: &'static str,
    /// Its keys.
    pub keys: &'static [Stroke],
    /// Where it is.
    pub place: Place,
}

impl Entry {
    /// The command of this action.
    pub(in crate::console) fn of(action: Action) -> Option<&'static Self> {
        table().iter().find(|entry| entry.action == action)
    }

    /// Its keys in words; empty if it has none.
    pub fn keys_told(&self) -> String {
        self.keys.iter().map(|stroke| stroke.name()).collect::<Vec<_>>().join(", ")
    }

    /// Its name, with its keys in brackets if it has any.
    pub(in crate::console) fn with_keys(&self) -> String {
        match self.keys {
            [] => self.title.clone(),
            _ => text::commands::with_keys(&self.title, &self.keys_told()),
        }
    }
}

/// Whether a command can be done now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// It can.
    Can,
    /// It is on the screen, but not possible; why.
    Cannot(&'static str),
    /// Who sits before this screen does not have it.
    Absent,
}

impl Reach {
    /// Not possible for this reason, if there is one.
    pub(in crate::console) const fn unless(reason: Option<&'static str>) -> Self {
        match reason {
            Some(reason) => Self::Cannot(reason),
            None => Self::Can,
        }
    }

    /// Absent unless this holds.
    pub(in crate::console) const fn only_if(self, holds: bool) -> Self {
        if holds { self } else { Self::Absent }
    }
}
