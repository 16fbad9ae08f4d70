//! The panels that a technician can lay out: their names, what they are for, and the least room that each needs.

use crate::console::text;
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
            Self::Field => text::desk::FIELD,
            Self::Traces => text::desk::TRACES,
            Self::ForceSpace => text::desk::FORCE_SPACE,
            Self::Feedback => text::desk::FEEDBACK,
            Self::Devices => text::desk::DEVICES,
            Self::Calibrations => text::desk::CALIBRATION,
            Self::Gates => text::desk::WHY_NO_FORCE,
            Self::Safety => text::desk::SAFETY,
            Self::Horizon => text::desk::ERROR_AT_THE_HORIZON,
            Self::Degrees => text::desk::DEGREES,
            Self::Timing => text::desk::TIMING,
            Self::Tradeoff => text::desk::TRADE_OFF,
        }
    }

    /// What it is for, in a sentence or two.
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Field => text::desk::FIELD_HOVER,
            Self::Traces => text::desk::TRACES_HOVER,
            Self::ForceSpace => text::desk::FORCE_SPACE_HOVER,
            Self::Feedback => text::desk::FEEDBACK_HOVER,
            Self::Devices => text::desk::DEVICES_HOVER,
            Self::Calibrations => text::desk::CALIBRATION_HOVER,
            Self::Gates => text::desk::WHY_NO_FORCE_HOVER,
            Self::Safety => text::desk::SAFETY_HOVER,
            Self::Horizon => text::desk::ERROR_AT_THE_HORIZON_HOVER,
            Self::Degrees => text::desk::DEGREES_HOVER,
            Self::Timing => text::desk::TIMING_HOVER,
            Self::Tradeoff => text::desk::TRADE_OFF_HOVER,
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
