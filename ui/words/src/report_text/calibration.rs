//! Texts about calibrations: verdicts, missing data, and the validity of a saved calibration.

use nima_core::calibration::{
    Verdict,
    correspondence::{MissingInput, PushRefusal},
    gravity::{GravityDrift, NotChecked},
};
use nima_recording::tip_force::RecorderLack;

use super::ShortText;
use crate::language::{Text, text_format, word};

const NO_WRIST_FORCE: Text = Text::of(
    "no gravity-free force at the wrist; connect the sensor and calibrate gravity",
    "keine schwerkraftfreie Kraft am Handgelenk; Sensor anschließen und Schwerkraft kalibrieren",
);
const NO_TISSUE_FORCE: Text = Text::of(
    "the sensor under the tissue sends no data; connect it",
    "der Sensor unter dem Gewebe sendet keine Daten; anschließen",
);
const NO_CHAIN: Text = Text::of(
    "the tracker does not see the marker, or the arm sends no data; clear the line of sight and check the arm",
    "der Tracker sieht den Marker nicht, oder der Arm sendet keine Daten; Sichtlinie freimachen und Arm prüfen",
);

impl ShortText for Verdict {
    fn words(self) -> &'static str {
        match self {
            Self::Accepted => word("Accepted", "Angenommen"),
            Self::InsufficientMotion => word("Insufficient motion", "Zu wenig Bewegung"),
            Self::PoorData => word("Poor data", "Schlechte Daten"),
        }
    }
}

impl ShortText for MissingInput {
    fn words(self) -> &'static str {
        match self {
            Self::WristForce => NO_WRIST_FORCE.get(),
            Self::TissueForce => NO_TISSUE_FORCE.get(),
            Self::Chain => NO_CHAIN.get(),
            Self::Sense => word(
                "a sample is not finite, or not newer than the previous sample; check the sensors",
                "ein Messwert ist nicht endlich oder nicht neuer als der vorige; Sensoren prüfen",
            ),
        }
    }
}

impl ShortText for RecorderLack {
    fn words(self) -> &'static str {
        match self {
            Self::WristForce => NO_WRIST_FORCE.get(),
            Self::TissueForce => NO_TISSUE_FORCE.get(),
            Self::Chain => NO_CHAIN.get(),
            Self::Pose => word(
                "no depth through the trocar or no orientation; mount the trocar and check the arm",
                "keine Tiefe durch den Trokar oder keine Orientierung; Trokar montieren und Arm prüfen",
            ),
        }
    }
}

pub fn refusal(refusal: &PushRefusal) -> String {
    match refusal {
        PushRefusal::TooShort => word(
            "the push was too short; hold it for half a second",
            "der Druck war zu kurz; eine halbe Sekunde halten",
        )
        .to_owned(),
        PushRefusal::Moved { by_n } => {
            text_format!(
                "the force varied by {by_n:.2} N; hold it still",
                "die Kraft schwankte um {by_n:.2} N; ruhig halten"
            )
        }
        PushRefusal::MissedTissue => word(
            "the sensor under the tissue measured no force; push onto the tissue",
            "der Sensor unter dem Gewebe maß nichts; auf das Gewebe drücken",
        )
        .to_owned(),
        PushRefusal::Full => {
            word("the session is full; remove a push first", "die Sitzung ist voll; erst einen Druck entfernen")
                .to_owned()
        }
    }
}

pub fn drift(drift: GravityDrift) -> String {
    match drift {
        GravityDrift::Waiting => {
            word("being checked: do not touch the tool for a moment", "wird geprüft: Instrument kurz nicht berühren")
                .to_owned()
        }
        GravityDrift::NotChecked(why) => {
            let why = match why {
                NotChecked::NoSample => word(
                    "no data from the sensor, or its orientation is unknown",
                    "keine Daten vom Sensor, oder seine Orientierung ist unbekannt",
                ),
                NotChecked::Moving => word("the tool moves", "das Instrument bewegt sich"),
                NotChecked::Touched => word("something touches the tool", "etwas berührt das Instrument"),
                NotChecked::InTrocar => word(
                    "the instrument is in the trocar; start with the instrument outside",
                    "das Instrument steckt im Trokar; außerhalb starten",
                ),
                NotChecked::Engaged => word("the loop was engaged too early", "die Regelung wurde zu früh gekoppelt"),
            };
            text_format!("not checked: {why}", "nicht geprüft: {why}")
        }
        GravityDrift::Fine { by_n } => {
            text_format!("{by_n:.2} N without contact, passed", "{by_n:.2} N ohne Kontakt, OK")
        }
        GravityDrift::Moved { by_n } => text_format!(
            "drifted by {by_n:.2} N: make sure that nothing touches the tool; if the drift remains, calibrate \
             gravity again",
            "um {by_n:.2} N gedriftet: nichts darf das Instrument berühren; bleibt es so, Schwerkraft neu kalibrieren"
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bias_that_drifted_is_reported_with_its_size_and_what_to_do() {
        let words = drift(GravityDrift::Moved { by_n: 0.41 });
        assert!(words.contains("0.41 N") && words.contains("calibrate gravity again"), "{words}");
    }
}
