//! Panels of the Technician view: names, purposes, and minimum sizes.

use egui::{Vec2, vec2};
use serde::{Deserialize, Serialize};

use crate::{
    console::text,
    extras::{self, Extra},
};

/// A panel. Its name in the settings file is the variant's name in lower case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Panel {
    Field,
    Traces,
    ForceSpace,
    Feedback,
    Devices,
    Calibrations,
    Gates,
    Safety,
    Horizon,
    Degrees,
    Timing,
    Link,
    Tradeoff,
}

impl Panel {
    /// All panels, in the order of the menu.
    pub const ALL: [Self; 13] = [
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
        Self::Link,
        Self::Tradeoff,
    ];

    /// Panels of this build.
    pub fn built() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(|panel| panel.is_built())
    }

    pub(super) fn is_built(self) -> bool {
        match self {
            Self::Link => extras::part(Extra::way).is_some(),
            Self::Tradeoff => extras::part(Extra::tradeoff).is_some(),
            _ => true,
        }
    }

    /// Title on its tab and in the menu.
    pub fn title(self) -> &'static str {
        match self {
            Self::Field => text::desk::FIELD.get(),
            Self::Traces => text::desk::TRACES.get(),
            Self::ForceSpace => text::desk::FORCE_SPACE.get(),
            Self::Feedback => text::desk::FEEDBACK.get(),
            Self::Devices => text::desk::DEVICES.get(),
            Self::Calibrations => text::desk::CALIBRATION.get(),
            Self::Gates => text::desk::WHY_NO_FORCE.get(),
            Self::Safety => text::desk::SAFETY.get(),
            Self::Horizon => text::desk::ERROR_AT_THE_HORIZON.get(),
            Self::Degrees => text::desk::DEGREES.get(),
            Self::Timing => text::desk::TIMING.get(),
            Self::Link => text::desk::LINK.get(),
            Self::Tradeoff => text::desk::TRADE_OFF.get(),
        }
    }

    pub fn meaning(self) -> &'static str {
        match self {
            Self::Field => text::desk::FIELD_HOVER.get(),
            Self::Traces => text::desk::TRACES_HOVER.get(),
            Self::ForceSpace => text::desk::FORCE_SPACE_HOVER.get(),
            Self::Feedback => text::desk::FEEDBACK_HOVER.get(),
            Self::Devices => text::desk::DEVICES_HOVER.get(),
            Self::Calibrations => text::desk::CALIBRATION_HOVER.get(),
            Self::Gates => text::desk::WHY_NO_FORCE_HOVER.get(),
            Self::Safety => text::desk::SAFETY_HOVER.get(),
            Self::Horizon => text::desk::ERROR_AT_THE_HORIZON_HOVER.get(),
            Self::Degrees => text::desk::DEGREES_HOVER.get(),
            Self::Timing => text::desk::TIMING_HOVER.get(),
            Self::Link => text::desk::LINK_HOVER.get(),
            Self::Tradeoff => text::desk::TRADE_OFF_HOVER.get(),
        }
    }

    /// Minimum readable size, points; a smaller panel is scrolled.
    pub(super) const fn least(self) -> Vec2 {
        match self {
            Self::Field => vec2(160.0, 120.0),
            Self::Traces => vec2(480.0, 250.0),
            Self::ForceSpace => vec2(200.0, 180.0),
            Self::Safety => vec2(560.0, 120.0),
            Self::Feedback | Self::Devices | Self::Calibrations | Self::Gates => vec2(276.0, 60.0),
            Self::Horizon | Self::Degrees | Self::Timing | Self::Link | Self::Tradeoff => vec2(308.0, 60.0),
        }
    }

    /// Whether it fills the available space; other panels have a fixed length.
    pub(super) const fn fills(self) -> bool {
        matches!(self, Self::Field | Self::Traces | Self::ForceSpace | Self::Safety)
    }
}
