//! Texts about calibrations: verdicts, missing data, and whether a saved calibration still holds.

use nima_core::calibration::{
    Verdict,
    correspondence::{Missing, Refusal},
    gravity::{Drift, NotChecked},
};
use nima_recording::tip_force::Lack;

use super::Words;

const NO_WRIST_FORCE: &str = "no gravity-free force at the wrist; connect the sensor and calibrate gravity";
const NO_TISSUE_FORCE: &str = "the sensor under the tissue sends no data; connect it";
const NO_CHAIN: &str =
    "the tracker does not see the marker, or the arm sends no data; clear the line of sight and check the arm";

impl Words for Verdict {
    fn words(self) -> &'static str {
        match self {
            Self::Accepted => "Accepted",
            Self::InsufficientMotion => "Insufficient motion",
            Self::PoorData => "Poor data",
        }
    }
}

impl Words for Missing {
    fn words(self) -> &'static str {
        match self {
            Self::WristForce => NO_WRIST_FORCE,
            Self::TissueForce => NO_TISSUE_FORCE,
            Self::Chain => NO_CHAIN,
            Self::Sense => "a sample is not finite or not newer than the previous one; check the sensors",
        }
    }
}

impl Words for Lack {
    fn words(self) -> &'static str {
        match self {
            Self::WristForce => NO_WRIST_FORCE,
            Self::TissueForce => NO_TISSUE_FORCE,
            Self::Chain => NO_CHAIN,
            Self::Pose => "no depth through the trocar or no orientation; mount the trocar and check the arm",
        }
    }
}

/// Why a push was not recorded, and what to do.
pub(crate) fn refusal(refusal: &Refusal) -> String {
    match refusal {
        Refusal::TooShort => "the push was too short; hold it for half a second".to_owned(),
        Refusal::Moved { by_n } => format!("the force varied by {by_n:.2} N; hold it still"),
        Refusal::MissedTissue => "the sensor under the tissue measured nothing; push onto the tissue".to_owned(),
        Refusal::Full => "the session is full; remove a push first".to_owned(),
    }
}

/// Whether a saved gravity calibration still holds, and what to do.
pub(crate) fn drift(drift: Drift) -> String {
    match drift {
        Drift::Waiting => "being checked: do not touch the tool for a moment".to_owned(),
        Drift::NotChecked(why) => {
            let why = match why {
                NotChecked::NoSample => "no data from the sensor, or its orientation is unknown",
                NotChecked::Moving => "the tool moves",
                NotChecked::Touched => "something touches the tool",
                NotChecked::InTrocar => "the instrument is in the trocar; start with it outside",
                NotChecked::Engaged => "the loop was engaged too early",
            };
            format!("not checked: {why}")
        }
        Drift::Fine { by_n } => format!("{by_n:.2} N without contact, good"),
        Drift::Moved { by_n } => format!(
            "drifted by {by_n:.2} N: make sure that nothing touches the tool; if this stays, calibrate gravity again"
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bias_that_drifted_is_reported_with_its_size_and_what_to_do() {
        let words = drift(Drift::Moved { by_n: 0.41 });
        assert!(words.contains("0.41 N") && words.contains("calibrate gravity again"), "{words}");
    }
}
