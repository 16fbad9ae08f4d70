//! Texts: what the ready check finds when the instrument or the handle of one side is moved or pushed.

use nima_machine::rig::Exchange;

use super::ready::{capital, with};
use crate::language::{told, word};

/// Right and left are exchanged: what, and what to do.
pub(super) fn exchanged(exchange: Exchange) -> [String; 2] {
    let cure = match exchange {
        Exchange::Handles => word(
            "Exchange Handles in the panel Devices, or put each handle in its place",
            "Exchange Handles in the panel Devices, or put each handle in its place",
        ),
        Exchange::Arms => word(
            "Exchange the arms' cables, or Arms in the panel Devices; see the mounts in the rig file",
            "Exchange the arms' cables, or Arms in the panel Devices; see the mounts in the rig file",
        ),
        Exchange::Sensors => word(
            "Exchange the sensors' cables, or Sensors in the panel Devices, then calibrate",
            "Exchange the sensors' cables, or Sensors in the panel Devices, then calibrate",
        ),
        Exchange::Servos => word(
            "Exchange the servos' cables, or Servos in the panel Devices",
            "Exchange the servos' cables, or Servos in the panel Devices",
        ),
        Exchange::Markers => word(
            "Put each marker on its instrument, or exchange the first two tools of [devices.tracker] in the rig file",
            "Put each marker on its instrument, or exchange the first two tools of [devices.tracker] in the rig file",
        ),
        Exchange::Trocars => word(
            "Put each instrument through its own trocar; if it is, exchange the two [devices.*.rcm] in the rig file",
            "Put each instrument through its own trocar; if it is, exchange the two [devices.*.rcm] in the rig file",
        ),
    };
    with(capital(exchange.words()), cure)
}

/// The arm was not moved, or the other one was too.
pub(super) fn arm_stuck(by_m: f64) -> [String; 2] {
    with(
        told!(
            "The arm moved by {:.0} mm, or the other arm moved too",
            "The arm moved by {:.0} mm, or the other arm moved too",
            1e3 * by_m
        ),
        word(
            "Move the instrument that is asked for and let the other one rest; if the arm does not follow, see the \
             panel Devices",
            "Move the instrument that is asked for and let the other one rest; if the arm does not follow, see the \
             panel Devices",
        ),
    )
}

/// The marker did not move with its arm, or the other one did too.
pub(super) fn marker_stuck(by_m: f64) -> [String; 2] {
    with(
        told!(
            "The marker moved by {:.0} mm while its arm was moved, or the other marker moved too",
            "The marker moved by {:.0} mm while its arm was moved, or the other marker moved too",
            1e3 * by_m
        ),
        word(
            "Make sure that the tracker sees the markers of both instruments and that the other one rests",
            "Make sure that the tracker sees the markers of both instruments and that the other one rests",
        ),
    )
}

/// No push was felt.
pub(super) fn no_push(most_n: f64) -> [String; 2] {
    with(
        told!(
            "No push of 1 N was measured; the largest force was {most_n:.2} N",
            "No push of 1 N was measured; the largest force was {most_n:.2} N"
        ),
        word(
            "Push harder; if the sensor does not react, check its cable and its mount",
            "Push harder; if the sensor does not react, check its cable and its mount",
        ),
    )
}

/// The handle moved by itself.
pub(super) fn handle_pulls(by_m: f64) -> [String; 2] {
    with(
        told!(
            "Let go, the handle moved by {:.1} mm and did not rest",
            "Let go, the handle moved by {:.1} mm and did not rest",
            1e3 * by_m
        ),
        word(
            "Let it go; if it moves by itself, calibrate the handle (button on the device) and check its balance",
            "Let it go; if it moves by itself, calibrate the handle (button on the device) and check its balance",
        ),
    )
}

/// The handle was not moved.
pub(super) fn handle_stuck(by_m: f64) -> [String; 2] {
    with(
        told!("The handle moved by {:.1} mm only", "The handle moved by {:.1} mm only", 1e3 * by_m),
        word(
            "Move the handle; if it is stuck, look for what blocks it and calibrate it (button on the device)",
            "Move the handle; if it is stuck, look for what blocks it and calibrate it (button on the device)",
        ),
    )
}

/// The handle went another way than asked for.
pub(super) fn handle_askew(by_deg: f64) -> [String; 2] {
    with(
        told!(
            "The handle's reading moved {by_deg:.0} degrees off the direction asked for",
            "The handle's reading moved {by_deg:.0} degrees off the direction asked for"
        ),
        word(
            "Repeat the move; if it stays, calibrate the view, or see how the handle stands and whether left and right \
             are exchanged",
            "Repeat the move; if it stays, calibrate the view, or see how the handle stands and whether left and right \
             are exchanged",
        ),
    )
}

/// The trocar is not where it was.
pub(super) fn trocar_moved(by_m: f64) -> [String; 2] {
    with(
        told!(
            "The trocar is {:.1} mm from where it was, across the shaft",
            "The trocar is {:.1} mm from where it was, across the shaft",
            1e3 * by_m
        ),
        word(
            "Put patient or table back, or calibrate the trocar again",
            "Put patient or table back, or calibrate the trocar again",
        ),
    )
}
