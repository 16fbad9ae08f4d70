//! Causes and remedies of faults.

use nima_core::safety::Implausible;
use nima_devices::Loss;
use nima_machine::messages::{FarStop, Fault, ForceSource};

use super::Remedy;
use crate::language::word;

fn unknown_because(source: ForceSource) -> &'static str {
    match source {
        ForceSource::Uncalibrated => word(
            "The force at the tip is unknown: the wrist sensor is not calibrated for this tool",
            "Die Kraft an der Spitze ist unbekannt: Handgelenksensor nicht für dieses Instrument kalibriert",
        ),
        ForceSource::NoOrientation => word(
            "The force at the tip is unknown: the orientation of the wrist is missing",
            "Die Kraft an der Spitze ist unbekannt: die Orientierung des Handgelenks fehlt",
        ),
        ForceSource::Poisoned => word(
            "The force at the tip is unknown: the calibration or the network produces invalid numbers",
            "Die Kraft an der Spitze ist unbekannt: Kalibrierung oder Netz liefert ungültige Zahlen",
        ),
        ForceSource::Unidentified => word(
            "The force at the tip is unknown: the wrist sensor was reconnected",
            "Die Kraft an der Spitze ist unbekannt: der Handgelenksensor wurde neu verbunden",
        ),
        ForceSource::NoSample
        | ForceSource::AtTip
        | ForceSource::Wrist
        | ForceSource::Network
        | ForceSource::Extrapolated
        | ForceSource::InDoubt { .. } => word(
            "The force at the tip is unknown: the devices send no measurement",
            "Die Kraft an der Spitze ist unbekannt: die Geräte senden keine Messung",
        ),
    }
}

impl Remedy for Fault {
    fn cause(self) -> &'static str {
        match self {
            Self::SourceSilent => word(
                "The rig sent no valid data for 20 ms",
                "Der Aufbau sandte 20 ms lang keine \
             gültigen Daten",
            ),
            Self::LoopStalled { .. } => word(
                "The control loop was blocked: drives and force were switched off",
                "Die Regelung war blockiert: Antriebe und Kraft abgeschaltet",
            ),
            Self::ForceUnknown { source } => unknown_because(source),
            Self::DeviceLost { loss, .. } => match loss {
                Loss::Disconnected => word(
                    "A device was lost: its connection was interrupted",
                    "Ein Gerät ist ausgefallen: Verbindung getrennt",
                ),
                Loss::Silent => word(
                    "A device was lost: it sends no data",
                    "Ein Gerät ist ausgefallen: es sendet \
                 keine Daten",
                ),
                Loss::Corrupt => word(
                    "A device was lost: its data are damaged",
                    "Ein Gerät ist ausgefallen: seine Daten sind \
                     beschädigt",
                ),
                Loss::Implausible => word(
                    "A device was lost: it sends impossible values",
                    "Ein Gerät ist ausgefallen: es sendet unmögliche Werte",
                ),
                Loss::Device { .. } => {
                    word("A device was lost: it reports a fault", "Ein Gerät ist ausgefallen: es meldet eine Störung")
                }
            },
            Self::DrivesOff => word(
                "The arm does not follow its commands, or the handle has switched its motors off",
                "Der Arm folgt seinen Befehlen nicht, oder das Handgerät hat seine Motoren abgeschaltet",
            ),
            Self::OtherArm => word("The other arm has a fault", "Der andere Arm hat eine Störung"),
            Self::SamplesLost => word(
                "Too many samples of the rig are lost or damaged",
                "Zu viele Messwerte des Aufbaus sind verloren oder beschädigt",
            ),
            Self::LinkSilent => word(
                "No data arrived over the link for 0.1 s",
                "Über die Verbindung kamen 0.1 s lang \
             keine Daten",
            ),
            Self::ClockJumped => {
                word("The clock of the control loop jumped or stopped", "Die Uhr der Regelung sprang oder blieb stehen")
            }
            Self::Implausible { what } => what.cause(),
            Self::FarEnd { stop } => stop.cause(),
        }
    }

    fn cure(self) -> &'static str {
        match self {
            Self::SourceSilent => word(
                "Check the force sensor and the handle, then release the stop and engage again",
                "Kraftsensor und Handgerät prüfen, dann Halt lösen und neu koppeln",
            ),
            Self::LoopStalled { .. } => word(
                "Close other programs or grant real-time priority, then engage again",
                "Andere Programme schließen oder Echtzeitpriorität gewähren, dann neu koppeln",
            ),
            Self::ForceUnknown { source: ForceSource::Uncalibrated | ForceSource::Poisoned } => word(
                "Calibrate gravity (Calibration panel, F2), then release the stop and engage again",
                "Schwerkraft kalibrieren (Panel Kalibrierung, F2), dann Halt lösen und neu koppeln",
            ),
            Self::ForceUnknown { .. } => word(
                "Check the wrist sensor and the arm in Devices, then release the stop and engage again",
                "Handgelenksensor und Arm unter Geräte prüfen, dann Halt lösen und neu koppeln",
            ),
            Self::DeviceLost { .. } => word(
                "See Devices: the device reconnects automatically; then release the stop and engage again",
                "Siehe Geräte: das Gerät verbindet sich selbst wieder; dann Halt lösen und neu koppeln",
            ),
            Self::DrivesOff => word(
                "Check the lights and buttons on the arm and on the handle, then release the stop and engage again",
                "Lampen und Tasten an Arm und Handgerät prüfen, dann Halt lösen und neu koppeln",
            ),
            Self::OtherArm => word(
                "Clear the other arm's fault, then release the stop and engage again",
                "Störung des anderen Arms beheben, dann Halt lösen und neu koppeln",
            ),
            Self::SamplesLost => word(
                "Check the counts of lost samples in Devices, and the cables; then release the stop and engage \
                 again",
                "Zahl verlorener Messwerte unter Geräte und Kabel prüfen; dann Halt lösen und neu koppeln",
            ),
            Self::LinkSilent => word(
                "Check the link to the follower, then release the stop and engage again",
                "Verbindung zum Folgearm prüfen, dann Halt lösen und neu koppeln",
            ),
            Self::ClockJumped => word(
                "Find out what sets this computer's clock, then release the stop and engage again",
                "Klären, was die Uhr dieses Rechners verstellt, dann Halt lösen und neu koppeln",
            ),
            Self::Implausible { what } => what.cure(),
            Self::FarEnd { stop } => stop.cure(),
        }
    }
}

impl Remedy for FarStop {
    fn cause(self) -> &'static str {
        match self {
            Self::Stopped => word(
                "An operator stopped the follower's machine",
                "Ein Bediener hat am Rechner des Folgearms angehalten",
            ),
            Self::SourceSilent => word(
                "The follower's machine receives no data from its devices or from this machine",
                "Der Rechner des Folgearms erhält keine Daten, von seinen Geräten oder von hier",
            ),
            Self::LoopStalled => word(
                "The control loop of the follower's machine was blocked",
                "Die Regelung am Rechner des Folgearms war blockiert",
            ),
            Self::ForceUnknown => word(
                "The follower's machine reports that the force at the tip is unknown",
                "Der Rechner des Folgearms meldet: Kraft an der Spitze unbekannt",
            ),
            Self::DeviceLost => word(
                "A device of the follower's machine was lost",
                "Ein Gerät am Rechner des Folgearms ist \
                 ausgefallen",
            ),
            Self::DrivesOff => word(
                "The arm on the follower's machine does not follow its commands",
                "Der Arm am Rechner des Folgearms folgt seinen Befehlen nicht",
            ),
            Self::SamplesLost => word(
                "The follower's machine loses too many samples from its devices, or too much data from this \
                 machine",
                "Der Rechner des Folgearms verliert zu viele Messwerte seiner Geräte oder zu viele Daten von hier",
            ),
            Self::LinkSilent => word(
                "No data arrived over a link within the follower's machine",
                "Über eine Verbindung im Rechner des Folgearms kamen keine Daten",
            ),
            Self::ClockJumped => word(
                "The clock of the follower's machine jumped or stopped",
                "Die Uhr am Rechner des Folgearms sprang oder blieb stehen",
            ),
            Self::Implausible => word(
                "A measurement on the follower's machine is not plausible",
                "Eine Messung am Rechner des Folgearms ist nicht plausibel",
            ),
            Self::Other => word(
                "The other arm of the follower's machine has a fault",
                "Der andere Arm am Rechner des Folgearms hat eine Störung",
            ),
        }
    }

    fn cure(self) -> &'static str {
        match self {
            Self::Stopped => word(
                "Ask the operator there whether it is safe, then release the stop and engage again",
                "Den Bediener dort fragen, ob es sicher ist, dann Halt lösen und neu koppeln",
            ),
            _ => word(
                "See the screen or output of the follower's machine for the cause; then release the stop and \
                 engage again",
                "Bildschirm oder Ausgabe des Rechners am Folgearm nennt die Ursache; dann Halt lösen und neu koppeln",
            ),
        }
    }
}

impl Remedy for Implausible {
    fn cause(self) -> &'static str {
        match self {
            Self::ForceFrozen => word(
                "The force sensor repeats one reading, or is at the end of its range",
                "Der Kraftsensor wiederholt einen Messwert oder ist am Ende seines Messbereichs",
            ),
            Self::ForceSaturated => word(
                "The readings of the force sensor are cut off at the end of its range",
                "Die Messwerte des Kraftsensors sind am Ende seines Messbereichs abgeschnitten",
            ),
            Self::ForceRepeats => word(
                "The force sensor repeats the same block of readings",
                "Der Kraftsensor wiederholt dieselbe Folge von Messwerten",
            ),
            Self::ForceJumped => word(
                "The measured force jumped by more than any contact can cause",
                "Die gemessene Kraft sprang stärker, als ein Kontakt bewirken kann",
            ),
            Self::ForceAlong => word(
                "The measured force pulls the tip into the tissue: its sign or its frame is wrong",
                "Die gemessene Kraft zieht die Spitze ins Gewebe: Vorzeichen oder Koordinaten falsch",
            ),
            Self::LinkFrozen => word(
                "The link repeats one message with new time stamps",
                "Die Verbindung wiederholt eine Nachricht mit neuen Zeitstempeln",
            ),
            Self::HandleJumped => word(
                "The handle's position jumped by more than a hand can move it",
                "Die Position des Handgeräts sprang weiter, als eine Hand es bewegen kann",
            ),
            Self::HandleFrozen => word(
                "The handle's position does not change although its force does",
                "Die Position des Handgeräts ändert sich nicht, seine Kraft aber doch",
            ),
            Self::HandleRepeats => word(
                "The handle repeats the same block of positions",
                "Das Handgerät wiederholt dieselbe Folge von Positionen",
            ),
            Self::ArmRepeats => word(
                "The arm repeats the same block of joint readings",
                "Der Arm wiederholt dieselbe Folge von Gelenkwerten",
            ),
            Self::TipJumped => word(
                "The arm's position jumped by more than the arm can move",
                "Die Position des Arms sprang weiter, als der Arm sich bewegen kann",
            ),
            Self::ArmAstray => word("The arm does not follow its command", "Der Arm folgt seinem Befehl nicht"),
        }
    }

    fn cure(self) -> &'static str {
        match self {
            Self::ForceFrozen | Self::ForceSaturated | Self::ForceRepeats => word(
                "Unload the force sensor, or switch it off and on; then release the stop and engage again",
                "Kraftsensor entlasten oder aus- und einschalten; dann Halt lösen und neu koppeln",
            ),
            Self::ForceJumped => word(
                "Check whether something hit the instrument, and check the sensor's plug and zero; then release the \
                 stop and engage again",
                "Prüfen: Stoß ans Instrument, Stecker und Nullpunkt des Sensors; dann Halt lösen und neu koppeln",
            ),
            Self::ForceAlong => word(
                "Calibrate gravity and the correspondence of the force sensor again, then release the stop and engage \
                 again",
                "Schwerkraft und Korrespondenz des Kraftsensors neu kalibrieren, dann Halt lösen und neu koppeln",
            ),
            Self::LinkFrozen => word(
                "Check the follower's computer and the link, then release the stop and engage again",
                "Rechner des Folgearms und Verbindung prüfen, dann Halt lösen und neu koppeln",
            ),
            Self::HandleJumped | Self::HandleFrozen | Self::HandleRepeats => word(
                "Put the handle in its rest position and calibrate it (button on the device), then release the stop \
                 and engage again",
                "Handgerät in Ruhestellung bringen und kalibrieren (Taste am Gerät), dann Halt lösen und neu koppeln",
            ),
            Self::TipJumped | Self::ArmRepeats => word(
                "Check the arm's connection and its joint readings, then release the stop and engage again",
                "Anschluss und Gelenkwerte des Arms prüfen, dann Halt lösen und neu koppeln",
            ),
            Self::ArmAstray => word(
                "Check whether the arm is blocked or at the end of its reach, and check its lights; then release \
                 the stop and engage again",
                "Prüfen, ob der Arm blockiert oder am Ende seiner Reichweite ist, und seine Lampen prüfen; dann \
                 Halt lösen und neu koppeln",
            ),
        }
    }
}
