//! Texts: what the ready check finds when the instrument or the handle of one side is moved or pushed.

use nima_machine::rig::Exchange;

use super::ready::{capital, with};

/// Right and left are exchanged: what, and what to do.
pub(super) fn exchanged(exchange: Exchange) -> [String; 2] {
    let cure = match exchange {
        Exchange::Handles => "Exchange Handles in the panel Devices, or put each handle in its place",
        Exchange::Arms => "Exchange the arms' cables, or Arms in the panel Devices; see the mounts in the rig file",
        Exchange::Sensors => "Exchange the sensors' cables, or Sensors in the panel Devices, then calibrate",
        Exchange::Servos => "Exchange the servos' cables, or Servos in the panel Devices",
        Exchange::Markers => {
            "Put each marker on its instrument, or exchange the first two tools of [devices.tracker] in the rig file"
        }
        Exchange::Trocars => {
            "Put each instrument through its own trocar; if it is, exchange the two [devices.*.rcm] in the rig file"
        }
    };
    with(capital(exchange.words()), cure)
}

/// The arm was not moved, or the other one was too.
pub(super) fn arm_stuck(by_m: f64) -> [String; 2] {
    with(
        format!("The arm moved by {:.0} mm, or the other arm moved too", 1e3 * by_m),
        "Move the instrument that is asked for and let the other one rest; if the arm does not follow, see the panel Devices",
    )
}

/// The marker did not move with its arm, or the other one did too.
pub(super) fn marker_stuck(by_m: f64) -> [String; 2] {
    with(
        format!("The marker moved by {:.0} mm while its arm was moved, or the other marker moved too", 1e3 * by_m),
        "Make sure that the tracker sees the markers of both instruments and that the other one rests",
    )
}

/// No push was felt.
pub(super) fn no_push(most_n: f64) -> [String; 2] {
    with(
        format!("No push of 1 N was measured; the largest force was {most_n:.2} N"),
        "Push harder; if the sensor does not react, check its cable and its mount",
    )
}
