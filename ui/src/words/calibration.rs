//! Texts about calibrations: verdicts, missing data, and whether a saved calibration still holds.

use nima_core::calibration::{
    Verdict,
    correspondence::{Missing, Refusal},
    gravity::{Drift, NotChecked},
};
use nima_recording::tip_force::Lack;

use super::Words;
use crate::language::{Text, told, word};

const NO_WRIST_FORCE: Text = Text::of(
    "no gravity-free force at the wrist; connect the sensor and calibrate gravity",
    "no gravity-free force at the wrist; connect the sensor and calibrate gravity",
);
const NO_TISSUE_FORCE: Text = Text::of(
    "the sensor under the tissue sends no data; connect it",
    "the sensor under the tissue sends no data; connect it",
);
const NO_CHAIN: Text = Text::of(
    "the tracker does not see the marker, or the arm sends no data; clear the line of sight and check the arm",
    "the tracker does not see the marker, or the arm sends no data; clear the line of sight and check the arm",
);

impl Words for Verdict {
    fn words(self) -> &'static str {
        match self {
            Self::Accepted => word("Accepted", "Accepted"),
            Self::InsufficientMotion => word("Insufficient motion", "Insufficient motion"),
            Self::PoorData => word("Poor data", "Poor data"),
        }
    }
}

impl Words for Missing {
    fn words(self) -> &'static str {
        match self {
            Self::WristForce => NO_WRIST_FORCE.get(),
            Self::TissueForce => NO_TISSUE_FORCE.get(),
            Self::Chain => NO_CHAIN.get(),
            Self::Sense => word(
                "a sample is not finite or not newer than the previous one; check the sensors",
                "a sample is not finite or not newer than the previous one; check the sensors",
            ),
        }
    }
}

impl Words for Lack {
    fn words(self) -> &'static str {
        match self {
            Self::WristForce => NO_WRIST_FORCE.get(),
            Self::TissueForce => NO_TISSUE_FORCE.get(),
            Self::Chain => NO_CHAIN.get(),
            Self::Pose => word(
                "no depth through the trocar or no orientation; mount the trocar and check the arm",
                "no depth through the trocar or no orientation; mount the trocar and check the arm",
            ),
        }
    }
}

/// Why a push was not recorded, and what to do.
pub(crate) fn refusal(refusal: &Refusal) -> String {
    match refusal {
        Refusal::TooShort => word(
            "the push was too short; hold it for half a second",
            "the push was too short; hold it for half a second",
        )
        .to_owned(),
        Refusal::Moved { by_n } => {
            told!("the force varied by {by_n:.2} N; hold it still", "the force varied by {by_n:.2} N; hold it still")
        }
        Refusal::MissedTissue => word(
            "the sensor under the tissue measured nothing; push onto the tissue",
            "the sensor under the tissue measured nothing; push onto the tissue",
        )
        .to_owned(),
        Refusal::Full => {
            word("the session is full; remove a push first", "the session is full; remove a push first").to_owned()
        }
    }
}

/// Whether a saved gravity calibration still holds, and what to do.
pub(crate) fn drift(drift: Drift) -> String {
    match drift {
        Drift::Waiting => word(
            "being checked: do not touch the tool for a moment",
            "being checked: do not touch the tool for a moment",
        )
        .to_owned(),
        Drift::NotChecked(why) => {
            let why = match why {
                NotChecked::NoSample => word(
                    "no data from the sensor, or its orientation is unknown",
                    "no data from the sensor, or its orientation is unknown",
                ),
                NotChecked::Moving => word("the tool moves", "the tool moves"),
                NotChecked::Touched => word("something touches the tool", "something touches the tool"),
                NotChecked::InTrocar => word(
                    "the instrument is in the trocar; start with it outside",
                    "the instrument is in the trocar; start with it outside",
                ),
                NotChecked::Engaged => word("the loop was engaged too early", "the loop was engaged too early"),
            };
            told!("not checked: {why}", "not checked: {why}")
        }
        Drift::Fine { by_n } => told!("{by_n:.2} N without contact, good", "{by_n:.2} N without contact, good"),
        Drift::Moved { by_n } => told!(
            "drifted by {by_n:.2} N: make sure that nothing touches the tool; if this stays, calibrate gravity again",
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
