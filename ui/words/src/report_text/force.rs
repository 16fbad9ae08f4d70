//! Texts: the source of the force at the tip.

use nima_core::tip_force::{Fallback, Unsure};
use nima_machine::messages::ForceSource;

use super::ShortText;
use crate::language::word;

impl ShortText for ForceSource {
    fn words(self) -> &'static str {
        match self {
            Self::AtTip => word("measured at the tip", "an der Spitze gemessen"),
            Self::Wrist => word(
                "wrist force without the tool's weight, but with trocar friction",
                "Handgelenkkraft ohne Instrumentengewicht, aber mit Trokarreibung",
            ),
            Self::Network => word(
                "wrist force without the tool's weight and without trocar friction (network)",
                "Handgelenkkraft ohne Instrumentengewicht und ohne Trokarreibung (neuronales Netz)",
            ),
            Self::Extrapolated => word(
                "wrist force without weight and friction, outside the network's training data: less accurate",
                "Handgelenkkraft ohne Gewicht und Reibung, außerhalb der Trainingsdaten des Netzes: ungenauer",
            ),
            Self::InDoubt { fallback: Fallback::WristForce, .. } => word(
                "network uncertain: wrist force with trocar friction is used",
                "Netz unsicher: Handgelenkkraft mit Trokarreibung wird benutzt",
            ),
            Self::InDoubt { unsure: Unsure::NotMoved, fallback: Fallback::HoldAndFade } => word(
                "unknown until the instrument has moved: no force",
                "unbekannt, bis das Instrument sich bewegt hat: keine Kraft",
            ),
            Self::InDoubt { fallback: Fallback::HoldAndFade, .. } => word(
                "network uncertain: the last reliable force fades out",
                "Netz unsicher: die letzte zuverlässige Kraft wird ausgeblendet",
            ),
            Self::Uncalibrated => word(
                "unknown: the wrist sensor is not calibrated",
                "unbekannt: der Handgelenksensor ist nicht \
                 kalibriert",
            ),
            Self::NoOrientation => word(
                "unknown: the orientation of the wrist is missing",
                "unbekannt: die Orientierung des Handgelenks fehlt",
            ),
            Self::Poisoned => word(
                "unknown: the calibration or the network produces invalid numbers",
                "unbekannt: Kalibrierung oder Netz liefert ungültige Zahlen",
            ),
            Self::NoSample => {
                word("unknown: the devices send no measurement", "unbekannt: die Geräte senden keine Messung")
            }
            Self::Unidentified => word(
                "unknown: the wrist sensor was reconnected and has not reported its serial number",
                "unbekannt: der Handgelenksensor hat seit dem Verbinden keine Seriennummer genannt",
            ),
        }
    }
}

/// Returns the remedy for a tip force that is unknown, a clause without a full stop.
pub(super) fn cure_of_unknown(source: ForceSource) -> &'static str {
    match source {
        ForceSource::Uncalibrated => word(
            "calibrate gravity for this sensor and tool",
            "Schwerkraft für diesen Sensor und dieses Instrument kalibrieren",
        ),
        ForceSource::NoOrientation => word(
            "check that the arm and the sensor's accelerometer send data",
            "prüfen, ob der Arm und der Beschleunigungssensor im Kraftsensor Daten senden",
        ),
        ForceSource::Poisoned => word(
            "calibrate gravity again, then train the network again",
            "Schwerkraft neu kalibrieren, dann das Netz neu trainieren",
        ),
        ForceSource::Unidentified => word(
            "wait a moment; if it stays unknown, disconnect and reconnect the wrist sensor",
            "kurz warten; falls es bleibt, Handgelenksensor trennen und neu verbinden",
        ),
        ForceSource::NoSample
        | ForceSource::AtTip
        | ForceSource::Wrist
        | ForceSource::Network
        | ForceSource::Extrapolated
        | ForceSource::InDoubt { .. } => word(
            "see the Devices panel (F2) for the device that sends no data and the cause",
            "siehe Panel Geräte (F2): welches Gerät nichts sendet und warum",
        ),
    }
}

impl ShortText for Unsure {
    fn words(self) -> &'static str {
        match self {
            Self::OutsideTraining => word(
                "the sample is far outside the training data",
                "der Messwert liegt weit außerhalb der \
                 Trainingsdaten",
            ),
            Self::NotMoved => word(
                "the direction of friction is still unknown; move the instrument in or out by 2 mm",
                "die Richtung der Reibung ist noch unbekannt; Instrument um 2 mm hinein- oder herausbewegen",
            ),
            Self::Missing => word(
                "the orientation or the depth through the trocar is missing",
                "die Orientierung oder die Tiefe durch den Trokar fehlt",
            ),
        }
    }
}
