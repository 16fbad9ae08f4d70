//! Panels of the Technician view: names, purposes, and minimum sizes.

use egui::{Vec2, vec2};
use nima_words::{language::Text, text::tiles as text};
use serde::{Deserialize, Serialize};

use crate::PanelExtras;

/// Smallest width of a panel of settings, and of one of figures, points.
const KNOBS: f32 = 276.0;
const FIGURES: f32 = 308.0;
/// Smallest width of the table of devices.
const DEVICES: f32 = 590.0;

/// A kind of panel.
#[derive(Clone, Copy)]
struct Kind {
    title: &'static Text,
    meaning: &'static Text,
    /// Width and height, points.
    min: [f32; 2],
    fills: bool,
}

impl Kind {
    /// One that fills the available space.
    const fn filling(title: &'static Text, meaning: &'static Text, min: [f32; 2]) -> Self {
        Self { title, meaning, min, fills: true }
    }

    /// Creates a panel of a fixed length.
    const fn list(title: &'static Text, meaning: &'static Text, least_width: f32) -> Self {
        Self { title, meaning, min: [least_width, 60.0], fills: false }
    }
}

/// Declares the panels from one list, in the order of the menu.
macro_rules! panels {
    ($(#[$attribute:meta])* enum Panel { $($(#[$of_panel:meta])* $panel:ident: $kind:expr,)* }) => {
        $(#[$attribute])*
        pub enum Panel {
            $($(#[$of_panel])* $panel,)*
        }

        impl Panel {
            /// All panels, in the order of the menu.
            pub const ALL: [Self; [$(stringify!($panel)),*].len()] = [$(Self::$panel),*];

            const fn kind(self) -> Kind {
                match self {
                    $(Self::$panel => $kind,)*
                }
            }
        }
    };
}

panels! {
    /// A panel. Its name in the settings file is the variant's name in lower case.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
    #[serde(rename_all = "snake_case")]
    enum Panel {
        /// The operating field in three dimensions.
        Field: Kind::filling(&text::FIELD, &text::FIELD_HOVER, [160.0, 120.0]),
        /// Forces over time.
        Traces: Kind::filling(&text::TRACES, &text::TRACES_HOVER, [220.0, 200.0]),
        /// Measured against rendered force in three dimensions.
        ForceSpace: Kind::filling(&text::FORCE_SPACE, &text::FORCE_SPACE_HOVER, [200.0, 180.0]),
        /// Interlock and gates of each arm, and the reason for a missing force.
        #[serde(alias = "gates")]
        Safety: Kind::list(&text::SAFETY, &text::SAFETY_HOVER, KNOBS),
        /// Mode, gain, delay, dead band.
        Feedback: Kind::list(&text::FEEDBACK, &text::FEEDBACK_HOVER, KNOBS),
        /// Active calibrations, and buttons for the wizards.
        Calibrations: Kind::list(&text::CALIBRATION, &text::CALIBRATION_HOVER, KNOBS),
        /// The devices of the rig.
        Devices: Kind::list(&text::DEVICES, &text::DEVICES_HOVER, DEVICES),
        /// Error of each mode at the horizon.
        Horizon: Kind::list(&text::HORIZON, &text::HORIZON_HOVER, FIGURES),
        /// Chosen polynomial degrees.
        Degrees: Kind::list(&text::DEGREES, &text::DEGREES_HOVER, FIGURES),
        /// Timing of the loop.
        Timing: Kind::list(&text::TIMING, &text::TIMING_HOVER, FIGURES),
        /// The link to the follower's machine.
        Link: Kind::list(&text::LINK, &text::LINK_HOVER, FIGURES),
        /// Computing time against accuracy.
        Tradeoff: Kind::list(&text::TRADEOFF, &text::TRADEOFF_HOVER, FIGURES),
    }
}

impl Panel {
    /// Returns the panels in this build.
    pub fn built() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(|panel| panel.is_built())
    }

    pub(super) fn is_built(self) -> bool {
        match self {
            Self::Link => PanelExtras::offered().has_link,
            Self::Tradeoff => PanelExtras::offered().tradeoff.is_some(),
            _ => true,
        }
    }

    /// Returns the title on its tab and in the menu.
    pub fn title(self) -> &'static str {
        self.kind().title.get()
    }

    pub fn meaning(self) -> &'static str {
        self.kind().meaning.get()
    }

    /// Returns the minimum readable size, points; a smaller panel is scrolled.
    pub(super) const fn min_size(self) -> Vec2 {
        let [width, height] = self.kind().min;
        vec2(width, height)
    }

    /// Returns whether it fills the available space; other panels have a fixed length.
    pub(super) const fn fills(self) -> bool {
        self.kind().fills
    }
}
