//! Texts: the source of the force at the tip, and why a gate reduced it.

use nima_core::{
    safety::Reason,
    tip_force::{Fallback, Unsure},
};
use nima_machine::messages::ForceSource;

use super::Words;

impl Words for Reason {
    fn words(self) -> &'static str {
        match self {
            Self::Open => "open",
            Self::NotPermitted => "the loop is not engaged",
            Self::RunsAway => "the handle runs away and nobody carries the force",
            Self::HandGone => "the hand has let go of the handle",
            Self::NothingAsked => "the mode has no valid result",
            Self::NotFinite => "the mode's result is not a number",
            Self::Implausible => "the mode asks for more force than any contact can give",
            Self::Ageing => "the data are late, so the force fades",
            Self::TooOld => "the data are too old",
            Self::HandSlow => "the hand is slower than the dead band",
            Self::SpeedUnknown => "the speed of the hand is not known",
            Self::GainZero => "the gain is zero",
            Self::GainRamping => "the gain is still changing to the chosen value",
            Self::ChangeTooFast => "the force would change too fast",
            Self::EnergySpent => "the hand would get back more energy than it put in",
            Self::AboveCeiling => "the force is above the ceiling",
            Self::AboveDeviceLimit => "the force is above what the device can give",
        }
    }
}

impl Words for ForceSource {
    fn words(self) -> &'static str {
        match self {
            Self::AtTip => "measured at the tip",
            Self::Wrist => "wrist force without the tool's weight, but with trocar friction",
            Self::Network => "wrist force without the tool's weight and without trocar friction (network)",
            Self::Extrapolated => {
                "wrist force without weight and friction, outside the network's training data: less exact"
            }
            Self::InDoubt { fallback: Fallback::WristForce, .. } => {
                "network in doubt: wrist force with trocar friction is used"
            }
            Self::InDoubt { unsure: Unsure::NotMoved, fallback: Fallback::HoldAndFade } => {
                "not known before the instrument has moved: no force"
            }
            Self::InDoubt { fallback: Fallback::HoldAndFade, .. } => {
                "network in doubt: the last reliable force fades out"
            }
            Self::Uncalibrated => "unknown: the wrist sensor is not calibrated",
            Self::NoOrientation => "unknown: the orientation of the wrist is missing",
            Self::Poisoned => "unknown: the calibration or the network gives invalid numbers",
        }
    }
}

impl Words for Unsure {
    fn words(self) -> &'static str {
        match self {
            Self::OutsideTraining => "the sample is far outside the training data",
            Self::NotMoved => "the direction of friction is not known yet; move the instrument in or out by 2 mm",
            Self::Missing => "the orientation or the depth through the trocar is missing",
        }
    }
}
