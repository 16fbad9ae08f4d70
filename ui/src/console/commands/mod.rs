//! The table of the window's commands: menus, keys, the list of keys, the palette and `docs/reference/commands.md` are generated from it.
//!
//! Name, keys, place and meaning of a command are defined here; its availability and its effect are defined once each, for
//! all callers, in `app/availability.rs` and `app/dispatch.rs`.

mod keys;
mod table;

use nima_panels::{
    roles::Role,
    tiles::{Arrangement, PanelId},
};
use nima_screen::scene3d::extras::MenuSwitch;
use nima_wizards::WizardKind;
use nima_words::{language::Language, text};

pub(in crate::console) use self::keys::{SIZE, UNDO};
pub use self::{
    keys::{KeyModifiers, Stroke},
    table::table,
};

/// Sizes in the menu, percent.
pub const SIZES_PERCENT: [u16; 5] = [100, 125, 150, 175, 200];

/// Action of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    Stop,
    /// The step from idle to engaged.
    Engage,
    /// The step from a stop or a fault to idle.
    Release,
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
    Tour,
    /// Opens or closes the palette.
    Palette,
    Acknowledge,
    Mark,
    /// Keeps the session, or stops keeping it.
    Keep,
    Undo,
    Redo,
    /// Chooses the light or the dark palette.
    Light(bool),
    /// Switches the colours for colour-blind users.
    ColourBlind,
    /// Switches the controls for touch.
    Touch,
    Language(Language),
    Larger,
    Smaller,
    /// Percent.
    Size(u16),
    /// Switches alarm sounds.
    Sound,
    /// Switches between current forces and those of the image's time.
    ForcesOfNow,
    /// Shows the unmodified image.
    PlainPicture,
    /// Switches the recording of the image.
    RecordsPicture,
    /// Opens or closes a panel.
    Panel(PanelId),
    /// Opens a panel in a separate window, or closes that window.
    Window(PanelId),
    /// Chooses a built-in layout.
    Arrange(Arrangement),
    ResetLayout,
    Check,
    Calibrations,
    Calibrate(WizardKind),
    /// Leaves the page of a wizard, of the check or of the list.
    CloseWizard,
    /// Pauses or resumes the traces.
    Pause,
    LastTenSeconds,
    /// Switches a part of the field view.
    Draws(MenuSwitch),
    /// Starts or stops mouse control.
    Drive,
    /// Drives the other instrument.
    OtherHand,
    Jaws,
    MarkPlace,
    /// Ends the trial of a palpation.
    EndTrial,
    BeginTrial,
    /// Shows or hides the forces in the image.
    HideForces,
    Lens,
    /// Leaves the recorded session.
    LeavePast,
    /// Plays or pauses the recorded session.
    Play,
    /// Moves by this time in the recorded session, ms.
    Step(i32),
}

impl Action {
    /// Returns whether the part of the window concerned reads the key itself: from elsewhere the key press is
    /// simulated.
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

    /// Returns whether a participant may use it in a trial of a study.
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

    /// Returns whether it leads towards motion and force: the palette then asks for confirmation.
    pub const fn leads_to_force(self) -> bool {
        matches!(self, Self::Engage | Self::Release)
    }

    /// Returns whether holding the key repeats it.
    pub(in crate::console) const fn repeats(self) -> bool {
        matches!(self, Self::Larger | Self::Smaller | Self::Step(_) | Self::Undo | Self::Redo)
    }
}

/// Place of a command, in addition to the palette.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommandPlace {
    Bar,
    ViewMenu,
    Alarms,
    Calibration,
    Traces,
    Field,
    Picture,
    /// The frame around a recorded session.
    Past,
    /// Only a key.
    Keys,
}

impl CommandPlace {
    pub fn name(self) -> &'static str {
        match self {
            Self::Bar => text::commands::AT_BAR.get(),
            Self::ViewMenu => text::commands::AT_VIEW_MENU.get(),
            Self::Alarms => text::commands::AT_ALARMS.get(),
            Self::Calibration => text::commands::AT_CALIBRATION.get(),
            Self::Traces => text::commands::AT_TRACES.get(),
            Self::Field => text::commands::AT_FIELD.get(),
            Self::Picture => text::commands::AT_IMAGE.get(),
            Self::Past => text::commands::AT_PAST.get(),
            Self::Keys => text::commands::AT_KEYS.get(),
        }
    }
}

#[derive(Clone, Debug)]
pub struct CommandEntry {
    pub action: Action,
    pub title: String,
    /// English name, which finds the command in every language, because the documentation uses it.
    pub english: String,
    pub does: &'static str,
    pub keys: &'static [Stroke],
    pub place: CommandPlace,
}

impl CommandEntry {
    pub(in crate::console) fn of(action: Action) -> Option<&'static Self> {
        table().iter().find(|entry| entry.action == action)
    }

    /// Returns the text of its keys; empty if it has none.
    pub fn keys_text(&self) -> String {
        self.keys.iter().map(|stroke| stroke.name()).collect::<Vec<_>>().join(", ")
    }

    /// Returns the name, with its keys in brackets if it has any.
    pub(in crate::console) fn with_keys(&self) -> String {
        match self.keys {
            [] => self.title.clone(),
            _ => text::commands::with_keys(&self.title, &self.keys_text()),
        }
    }
}

/// Availability of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Availability {
    Can,
    /// On the screen but not possible, for this reason.
    Cannot(&'static str),
    /// Not on this person's screen.
    Absent,
}

impl Availability {
    /// Returns unavailable with this reason, if there is one.
    pub(in crate::console) const fn unless(reason: Option<&'static str>) -> Self {
        match reason {
            Some(reason) => Self::Cannot(reason),
            None => Self::Can,
        }
    }

    /// Removes the entry unless `holds`.
    pub(in crate::console) const fn only_if(self, holds: bool) -> Self {
        if holds { self } else { Self::Absent }
    }
}
