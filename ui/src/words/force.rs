//! Texts: the source of the force at the tip, and why a gate reduced it.

use nima_core::{
    safety::Reason,
    tip_force::{Fallback, Unsure},
};
use nima_machine::messages::ForceSource;

use super::Words;
use crate::language::word;

impl Words for Reason {
    fn words(self) -> &'static str {
        match self {
            Self::Open => word("open", "open"),
            Self::NotPermitted => word("the loop is not engaged", "the loop is not engaged"),
            Self::RunsAway => word(
                "the handle runs away and nobody carries the force",
                "the handle runs away and nobody carries the force",
            ),
            Self::HandGone => word("the hand has let go of the handle", "the hand has let go of the handle"),
            Self::NothingAsked => word("the mode has no valid result", "the mode has no valid result"),
            Self::NotFinite => word("the mode's result is not a number", "the mode's result is not a number"),
            Self::Implausible => word(
                "the mode asks for more force than any contact can give",
                "the mode asks for more force than any contact can give",
            ),
            Self::Ageing => word("the data are late, so the force fades", "the data are late, so the force fades"),
            Self::TooOld => word("the data are too old", "the data are too old"),
            Self::HandSlow => word("the hand is slower than the dead band", "the hand is slower than the dead band"),
            Self::SpeedUnknown => word("the speed of the hand is not known", "the speed of the hand is not known"),
            Self::GainZero => word("the gain is zero", "the gain is zero"),
            Self::GainRamping => {
                word("the gain is still changing to the chosen value", "the gain is still changing to the chosen value")
            }
            Self::ChangeTooFast => word("the force would change too fast", "the force would change too fast"),
            Self::EnergySpent => word(
                "the hand would get back more energy than it put in",
                "the hand would get back more energy than it put in",
            ),
            Self::AboveCeiling => word("the force is above the ceiling", "the force is above the ceiling"),
            Self::AboveDeviceLimit => {
                word("the force is above what the device can give", "the force is above what the device can give")
            }
        }
    }
}

impl Words for ForceSource {
    fn words(self) -> &'static str {
        match self {
            Self::AtTip => word("measured at the tip", "measured at the tip"),
            Self::Wrist => word(
                "wrist force without the tool's weight, but with trocar friction",
                "wrist force without the tool's weight, but with trocar friction",
            ),
            Self::Network => word(
                "wrist force without the tool's weight and without trocar friction (network)",
                "wrist force without the tool's weight and without trocar friction (network)",
            ),
            Self::Extrapolated => word(
                "wrist force without weight and friction, outside the network's training data: less exact",
                "wrist force without weight and friction, outside the network's training data: less exact",
            ),
            Self::InDoubt { fallback: Fallback::WristForce, .. } => word(
                "network in doubt: wrist force with trocar friction is used",
                "network in doubt: wrist force with trocar friction is used",
            ),
            Self::InDoubt { unsure: Unsure::NotMoved, fallback: Fallback::HoldAndFade } => word(
                "not known before the instrument has moved: no force",
                "not known before the instrument has moved: no force",
            ),
            Self::InDoubt { fallback: Fallback::HoldAndFade, .. } => word(
                "network in doubt: the last reliable force fades out",
                "network in doubt: the last reliable force fades out",
            ),
            Self::Uncalibrated => {
                word("unknown: the wrist sensor is not calibrated", "unknown: the wrist sensor is not calibrated")
            }
            Self::NoOrientation => word(
                "unknown: the orientation of the wrist is missing",
                "unknown: the orientation of the wrist is missing",
            ),
            Self::Poisoned => word(
                "unknown: the calibration or the network gives invalid numbers",
                "unknown: the calibration or the network gives invalid numbers",
            ),
        }
    }
}

impl Words for Unsure {
    fn words(self) -> &'static str {
        match self {
            Self::OutsideTraining => {
                word("the sample is far outside the training data", "the sample is far outside the training data")
            }
            Self::NotMoved => word(
                "the direction of friction is not known yet; move the instrument in or out by 2 mm",
                "the direction of friction is not known yet; move the instrument in or out by 2 mm",
            ),
            Self::Missing => word(
                "the orientation or the depth through the trocar is missing",
                "the orientation or the depth through the trocar is missing",
            ),
        }
    }
}
