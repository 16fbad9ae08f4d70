//! The panels that a technician can lay out: their names, what they are for, and the least room that each needs.

use egui::{Vec2, vec2};
use serde::{Deserialize, Serialize};

/// One panel. Its name in the settings' file is the variant's in small letters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Panel {
    /// The operating field in three dimensions.
    Field,
    /// Forces over time.
    Traces,
    /// Forces against each other.
    ForceSpace,
    /// Mode, gain, delay, dead band.
    Feedback,
    /// What the rig is made of.
    Devices,
    /// Calibrations in force, and the way to the wizards.
    Calibrations,
    /// Why there is no force.
    Gates,
    /// Interlock and gates of each arm.
    Safety,
    /// Error of each mode at the horizon.
    Horizon,
    /// Degrees that were chosen.
    Degrees,
    /// Whether the loop keeps its time.
    Timing,
    /// Speed against accuracy.
    Tradeoff,
}

impl Panel {
    /// All of them, in the order of the menu.
    pub const ALL: [Self; 12] = [
        Self::Field,
        Self::Traces,
        Self::ForceSpace,
        Self::Safety,
        Self::Feedback,
        Self::Gates,
        Self::Calibrations,
        Self::Devices,
        Self::Horizon,
        Self::Degrees,
        Self::Timing,
        Self::Tradeoff,
    ];

    /// On its tab and in the menu.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Field => "Field",
            Self::Traces => "Traces",
            Self::ForceSpace => "Force space",
            Self::Feedback => "Feedback",
            Self::Devices => "Devices",
            Self::Calibrations => "Calibration",
            Self::Gates => "Why no force?",
            Self::Safety => "Safety",
            Self::Horizon => "Error at the horizon",
            Self::Degrees => "Degrees",
            Self::Timing => "Timing",
            Self::Tradeoff => "Trade-off",
        }
    }

    /// What it is for, in a sentence or two.
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Field => "The operating field in three dimensions, with the forces as arrows.",
            Self::Traces => "Force over time along x, y and z, measured and rendered.",
            Self::ForceSpace => "Measured against rendered force, the last seconds, seen in three dimensions.",
            Self::Feedback => "How the force measured at the instrument becomes the force in the hand.",
            Self::Devices => "What the rig is made of. Connected never means engaged.",
            Self::Calibrations => "Where the force at the tip comes from, and what was calibrated for it.",
            Self::Gates => {
                "Why is there no force? A force passes these gates in this order. A closed gate stops it, a limiting gate makes it \
                 smaller."
            }
            Self::Safety => "What stands between a model and a hand: the interlock and the gates of each arm.",
            Self::Horizon => {
                "Mean distance (N, 3-D) between the force each mode would render now and the force measured now, though it only \
                 knows data as old as the link's delay. Mean over the last four seconds, before the gates. All four modes are \
                 computed all the time."
            }
            Self::Degrees => {
                "Degree N of the polynomial f = M X between motion and force, chosen anew each tick on the last 300 ms."
            }
            Self::Timing => {
                "The loop's own clock: how late it wakes for each period and how long it works in it, since the console opened."
            }
            Self::Tradeoff => {
                "Time of one tick of identification (us, on this computer) against mean error at the horizon (N): every mode, \
                 degree and window on this scene, recorded open-loop, at the rig's rate and the link's delay."
            }
        }
    }

    /// The least room in which it can be read, points; with less it is scrolled.
    pub(super) const fn least(self) -> Vec2 {
        match self {
            Self::Field => vec2(160.0, 120.0),
            Self::Traces => vec2(480.0, 250.0),
            Self::ForceSpace => vec2(200.0, 180.0),
            Self::Safety => vec2(560.0, 120.0),
            Self::Feedback | Self::Devices | Self::Calibrations | Self::Gates => vec2(276.0, 60.0),
            Self::Horizon | Self::Degrees | Self::Timing | Self::Tradeoff => vec2(308.0, 60.0),
        }
    }

    /// It takes all the room there is; the others are as long as they are.
    pub(super) const fn fills(self) -> bool {
        matches!(self, Self::Field | Self::Traces | Self::ForceSpace | Self::Safety)
    }
}
