//! Texts about the points of the ready check that move or push the instrument or the handle of one side.

use nima_machine::rig::SideSwap;

use super::{exchange_text, ready::with, sentence};
use crate::language::{text_format, word};

pub(super) fn exchanged(exchange: SideSwap) -> [String; 2] {
    let cure = match exchange {
        SideSwap::Handles => word(
            "Press Swap handles in the Devices panel (F2), or put each handle in its place",
            "Im Panel Geräte (F2) Handgeräte tauschen drücken, oder jedes Handgerät an seinen Platz stellen",
        ),
        SideSwap::Arms => word(
            "Swap the arms' cables, or press Swap arms in the Devices panel (F2); see the mounts in the rig file",
            "Kabel der Arme tauschen, oder im Panel Geräte (F2) Arme tauschen drücken; siehe Montage in der \
             Aufbaudatei",
        ),
        SideSwap::Sensors => word(
            "Swap the sensors' cables, or press Swap sensors in the Devices panel (F2), then calibrate",
            "Kabel der Sensoren tauschen, oder im Panel Geräte (F2) Sensoren tauschen drücken, dann kalibrieren",
        ),
        SideSwap::Servos => word(
            "Swap the servos' cables, or press Swap servos in the Devices panel (F2)",
            "Kabel der Servos tauschen, oder im Panel Geräte (F2) Servos tauschen drücken",
        ),
        SideSwap::Markers => word(
            "Put each marker on its instrument, or swap the first two tools of [devices.tracker] in the rig file",
            "Jeden Marker an sein Instrument setzen, oder die ersten beiden Tools von [devices.tracker] in der \
             Aufbaudatei tauschen",
        ),
        SideSwap::Trocars => word(
            "Insert each instrument through its own trocar; if that is already the case, swap the two [devices.*.rcm] \
             in the rig file",
            "Jedes Instrument durch seinen Trokar führen; ist es so, die beiden [devices.*.rcm] in der Aufbaudatei \
             tauschen",
        ),
    };
    with(sentence(exchange_text(exchange)), cure)
}

pub(super) fn arm_stuck(by_m: f64) -> [String; 2] {
    with(
        text_format!(
            "The arm moved {:.0} mm: too little, or the other arm moved too",
            "Der Arm bewegte sich um {:.0} mm: zu wenig, oder der andere bewegte sich auch",
            1e3 * by_m
        ),
        word(
            "Move the requested instrument and keep the other one at rest; if the arm does not follow, see the \
             Devices panel (F2)",
            "Das verlangte Instrument bewegen, das andere ruhen lassen; folgt der Arm nicht, siehe Panel Geräte (F2)",
        ),
    )
}

pub(super) fn marker_stuck(by_m: f64) -> [String; 2] {
    with(
        text_format!(
            "The marker moved {:.0} mm while its arm was moved: too little, or the other marker moved too",
            "Der Marker bewegte sich um {:.0} mm, während sein Arm bewegt wurde: zu wenig, oder der andere \
             Marker bewegte sich auch",
            1e3 * by_m
        ),
        word(
            "Make sure that the tracker sees the markers of both instruments and that the other instrument is at \
             rest",
            "Sicherstellen, dass der Tracker die Marker beider Instrumente sieht und das andere ruht",
        ),
    )
}

pub(super) fn no_push(max_n: f64) -> [String; 2] {
    with(
        text_format!(
            "No push of 1 N was measured; the largest force was {max_n:.2} N",
            "Kein Druck von 1 N gemessen; die größte Kraft war {max_n:.2} N"
        ),
        word(
            "Push harder; if the sensor does not react, check its cable and its mount",
            "Stärker drücken; reagiert der Sensor nicht, Kabel und Montage prüfen",
        ),
    )
}

pub(super) fn handle_pulls(by_m: f64) -> [String; 2] {
    with(
        text_format!(
            "After release, the handle moved {:.1} mm and did not come to rest",
            "Nach dem Loslassen bewegte sich das Handgerät um {:.1} mm und kam nicht zur Ruhe",
            1e3 * by_m
        ),
        word(
            "Release the handle; if it moves by itself, calibrate it (button on the device) and check its balance",
            "Loslassen; bewegt es sich von selbst, Handgerät kalibrieren (Taste am Gerät) und Gewichtsausgleich prüfen",
        ),
    )
}

pub(super) fn handle_stuck(by_m: f64) -> [String; 2] {
    with(
        text_format!("The handle moved only {:.1} mm", "Das Handgerät bewegte sich nur um {:.1} mm", 1e3 * by_m),
        word(
            "Move the handle; if it is stuck, find the obstacle, then calibrate the handle (button on the device)",
            "Handgerät bewegen; klemmt es, Ursache suchen und kalibrieren (Taste am Gerät)",
        ),
    )
}

pub(super) fn handle_askew(by_deg: f64) -> [String; 2] {
    with(
        text_format!(
            "The handle's reading differed by {by_deg:.0} degrees from the requested direction",
            "Der Messwert des Handgeräts wich {by_deg:.0} Grad von der verlangten Richtung ab"
        ),
        word(
            "Repeat the move; if the error remains, calibrate the view, or check the handle's orientation and \
             whether left and right are swapped",
            "Bewegung wiederholen; bleibt es, Bildlage kalibrieren oder prüfen, wie das Handgerät steht und ob links \
             und rechts vertauscht sind",
        ),
    )
}

pub(super) fn trocar_moved(by_m: f64) -> [String; 2] {
    with(
        text_format!(
            "The trocar has moved {:.1} mm across the shaft",
            "Der Trokar hat sich {:.1} mm quer zum Schaft bewegt",
            1e3 * by_m
        ),
        word(
            "Move the patient or table back, or calibrate the trocar again",
            "Patient oder Tisch zurückstellen oder Trokar neu kalibrieren",
        ),
    )
}
