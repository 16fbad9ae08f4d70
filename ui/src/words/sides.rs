//! Texts: what the ready check finds when the instrument or the handle of one side is moved or pushed.

use nima_machine::rig::Exchange;

use super::{
    exchange_words,
    ready::{capital, with},
};
use crate::language::{told, word};

/// Right and left are exchanged: what, and what to do.
pub(super) fn exchanged(exchange: Exchange) -> [String; 2] {
    let cure = match exchange {
        Exchange::Handles => word(
            "Exchange Handles in the panel Devices, or put each handle in its place",
            "Handgeräte im Panel Geräte tauschen, oder jedes Handgerät an seinen Platz stellen",
        ),
        Exchange::Arms => word(
            "Exchange the arms' cables, or Arms in the panel Devices; see the mounts in the rig file",
            "Kabel der Arme tauschen, oder Arme im Panel Geräte; siehe Montage in der Aufbaudatei",
        ),
        Exchange::Sensors => word(
            "Exchange the sensors' cables, or Sensors in the panel Devices, then calibrate",
            "Kabel der Sensoren tauschen, oder Sensoren im Panel Geräte, dann kalibrieren",
        ),
        Exchange::Servos => word(
            "Exchange the servos' cables, or Servos in the panel Devices",
            "Kabel der Servos tauschen, oder Servos im Panel Geräte",
        ),
        Exchange::Markers => word(
            "Put each marker on its instrument, or exchange the first two tools of [devices.tracker] in the rig file",
            "Jeden Marker an sein Instrument setzen, oder die ersten beiden Tools von [devices.tracker] in der \
             Aufbaudatei tauschen",
        ),
        Exchange::Trocars => word(
            "Put each instrument through its own trocar; if it is, exchange the two [devices.*.rcm] in the rig file",
            "Jedes Instrument durch seinen Trokar führen; ist es so, die beiden [devices.*.rcm] in der Aufbaudatei \
             tauschen",
        ),
    };
    with(capital(exchange_words(exchange)), cure)
}

/// The arm was not moved, or the other one was too.
pub(super) fn arm_stuck(by_m: f64) -> [String; 2] {
    with(
        told!(
            "The arm moved by {:.0} mm, or the other arm moved too",
            "Der Arm bewegte sich um {:.0} mm, oder der andere auch",
            1e3 * by_m
        ),
        word(
            "Move the instrument that is asked for and let the other one rest; if the arm does not follow, see the \
             panel Devices",
            "Das verlangte Instrument bewegen, das andere ruhen lassen; folgt der Arm nicht, siehe Panel Geräte",
        ),
    )
}

/// The marker did not move with its arm, or the other one did too.
pub(super) fn marker_stuck(by_m: f64) -> [String; 2] {
    with(
        told!(
            "The marker moved by {:.0} mm while its arm was moved, or the other marker moved too",
            "Der Marker bewegte sich um {:.0} mm, während sein Arm bewegt wurde, oder der andere Marker auch",
            1e3 * by_m
        ),
        word(
            "Make sure that the tracker sees the markers of both instruments and that the other one rests",
            "Sicherstellen, dass der Tracker die Marker beider Instrumente sieht und das andere ruht",
        ),
    )
}

/// No push was felt.
pub(super) fn no_push(most_n: f64) -> [String; 2] {
    with(
        told!(
            "No push of 1 N was measured; the largest force was {most_n:.2} N",
            "Kein Druck von 1 N gemessen; die größte Kraft war {most_n:.2} N"
        ),
        word(
            "Push harder; if the sensor does not react, check its cable and its mount",
            "Stärker drücken; reagiert der Sensor nicht, Kabel und Montage prüfen",
        ),
    )
}

/// The handle moved by itself.
pub(super) fn handle_pulls(by_m: f64) -> [String; 2] {
    with(
        told!(
            "Let go, the handle moved by {:.1} mm and did not rest",
            "Losgelassen bewegte sich das Handgerät um {:.1} mm und ruhte nicht",
            1e3 * by_m
        ),
        word(
            "Let it go; if it moves by itself, calibrate the handle (button on the device) and check its balance",
            "Loslassen; bewegt es sich von selbst, Handgerät kalibrieren (Taste am Gerät) und Gewichtsausgleich prüfen",
        ),
    )
}

/// The handle was not moved.
pub(super) fn handle_stuck(by_m: f64) -> [String; 2] {
    with(
        told!("The handle moved by {:.1} mm only", "Das Handgerät bewegte sich nur um {:.1} mm", 1e3 * by_m),
        word(
            "Move the handle; if it is stuck, look for what blocks it and calibrate it (button on the device)",
            "Handgerät bewegen; klemmt es, Ursache suchen und kalibrieren (Taste am Gerät)",
        ),
    )
}

/// The handle went another way than asked for.
pub(super) fn handle_askew(by_deg: f64) -> [String; 2] {
    with(
        told!(
            "The handle's reading moved {by_deg:.0} degrees off the direction asked for",
            "Der Messwert des Handgeräts wich {by_deg:.0} Grad von der verlangten Richtung ab"
        ),
        word(
            "Repeat the move; if it stays, calibrate the view, or see how the handle stands and whether left and right \
             are exchanged",
            "Bewegung wiederholen; bleibt es, Bildlage kalibrieren oder prüfen, wie das Handgerät steht und ob links \
             und rechts vertauscht sind",
        ),
    )
}

/// The trocar is not where it was.
pub(super) fn trocar_moved(by_m: f64) -> [String; 2] {
    with(
        told!(
            "The trocar is {:.1} mm from where it was, across the shaft",
            "Der Trokar liegt {:.1} mm neben dem alten Ort, quer zum Schaft",
            1e3 * by_m
        ),
        word(
            "Put patient or table back, or calibrate the trocar again",
            "Patient oder Tisch zurückstellen oder Trokar neu kalibrieren",
        ),
    )
}
