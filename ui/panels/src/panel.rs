//! The panels of the Technician view: the trait [`Panel`], and the list of all panels.
//!
//! A new panel takes a file with its [`Panel`], a file with its texts, and a line in the list below.

use std::fmt::Debug;

use egui::{Ui, Vec2, vec2};
use nima_screen::{live::LiveState, outbox::Outbox, widgets::small};
use nima_wizards::active_calibrations::ActiveCalibrations;
use nima_words::language::Text;
use serde::{Deserialize, Serialize};

use crate::roles::{Panels, Wishes};

/// A panel, with the state that only it uses.
pub trait Panel: Debug + Default {
    /// Title on its tab, in the menu and on its own window.
    const NAME: Text;
    const MEANING: Text;
    const SIZE: PanelSize;
    /// Its controls act on the machine: they are disabled during playback.
    const ACTS: bool = false;

    /// Returns whether this build has the panel.
    fn is_built() -> bool {
        true
    }

    fn ui(&mut self, ui: &mut Ui, at: &mut PanelContext<'_>);
}

/// Minimum readable size; a smaller panel is scrolled.
#[derive(Clone, Copy, Debug)]
pub struct PanelSize {
    /// Width and height, points.
    min: [f32; 2],
    fills: bool,
}

impl PanelSize {
    /// A panel of settings.
    pub const KNOBS: Self = Self::list(276.0);
    /// A panel of figures.
    pub const FIGURES: Self = Self::list(308.0);

    /// Creates the size of a panel that fills the available space.
    pub const fn filling(min: [f32; 2]) -> Self {
        Self { min, fills: true }
    }

    /// Creates the size of a panel of a fixed length.
    pub const fn list(min_width: f32) -> Self {
        Self { min: [min_width, 60.0], fills: false }
    }
}

/// The data that panels show, and the receivers of their commands.
#[derive(Debug)]
pub struct PanelContext<'a> {
    pub live: &'a mut LiveState,
    /// State that several views use.
    pub panels: &'a mut Panels,
    pub active: &'a ActiveCalibrations,
    pub outbox: &'a mut Outbox,
    pub wishes: &'a mut Wishes,
    /// Another page of the window is using the machine, so the controls of the panels are disabled.
    pub is_locked: bool,
}

/// Declares the panels from one list, in the order of the menu.
macro_rules! panels {
    ($($(#[$attribute:meta])* $id:ident, $state:ident: $panel:ty;)*) => {
        /// A panel. Its name in the settings file is the variant's name in snake case.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        #[serde(rename_all = "snake_case")]
        pub enum PanelId {
            $($(#[$attribute])* $id,)*
        }

        /// The panels.
        #[derive(Debug, Default)]
        pub struct PanelSet {
            $($state: $panel,)*
        }

        impl PanelSet {
            /// Draws a panel.
            pub fn ui(&mut self, ui: &mut Ui, panel: PanelId, at: &mut PanelContext<'_>) {
                match panel {
                    $(PanelId::$id => show(ui, &mut self.$state, at),)*
                }
            }
        }

        impl PanelId {
            /// All panels, in the order of the menu.
            pub const ALL: [Self; [$(stringify!($id)),*].len()] = [$(Self::$id),*];

            const fn texts(self) -> [Text; 2] {
                match self {
                    $(Self::$id => [<$panel>::NAME, <$panel>::MEANING],)*
                }
            }

            const fn size(self) -> PanelSize {
                match self {
                    $(Self::$id => <$panel>::SIZE,)*
                }
            }

            pub(crate) fn is_built(self) -> bool {
                match self {
                    $(Self::$id => <$panel>::is_built(),)*
                }
            }
        }
    };
}

panels! {
    Field, field: crate::field::FieldPanel;
    Traces, traces: crate::traces::TracesPanel;
    ForceSpace, force_space: crate::force_space::ForceSpacePanel;
    // The gates were once a separate panel.
    #[serde(alias = "gates")]
    Safety, safety: crate::safety::SafetyState;
    Feedback, feedback: crate::feedback::FeedbackPanel;
    Calibrations, calibrations: crate::calibrations::CalibrationsPanel;
    Devices, devices: crate::devices::DevicesPanel;
    Horizon, horizon: crate::horizon::HorizonPanel;
    Degrees, degrees: crate::degrees::DegreesPanel;
    Timing, timing: crate::timing::TimingState;
    Link, link: crate::link::LinkPanel;
    Tradeoff, tradeoff: crate::tradeoff::TradeoffPanel;
}

fn show<P: Panel>(ui: &mut Ui, panel: &mut P, at: &mut PanelContext<'_>) {
    let is_past = P::ACTS && at.live.is_shown_only();
    if is_past {
        ui.label(small(at.live.of.blocked()));
    }
    let is_closed = is_past || P::ACTS && at.is_locked;
    ui.add_enabled_ui(!is_closed, |ui| panel.ui(ui, at));
}

impl PanelId {
    /// Returns the panels in this build.
    pub fn built() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(|panel| panel.is_built())
    }

    /// Returns the title on its tab and in the menu.
    pub fn title(self) -> &'static str {
        self.texts()[0].get()
    }

    pub fn meaning(self) -> &'static str {
        self.texts()[1].get()
    }

    pub(crate) const fn min_size(self) -> Vec2 {
        let [width, height] = self.size().min;
        vec2(width, height)
    }

    /// Returns whether it fills the available space; other panels have a fixed length.
    pub(crate) const fn fills(self) -> bool {
        self.size().fills
    }
}
