//! The loop on the virtual clock: whole scenes, calibrations and training, as fast as the processor allows.
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod bimanual;
mod contacts;
mod davinci;
mod force_response;
mod leading;
mod letting_go;
mod over_a_network;
mod ready_check;
mod rings;
mod simulated_calibration;
mod simulated_experiments;
mod slow_arm;
mod structure;
mod tip_force_loop;
mod training;
mod unknown_force;
mod virtual_loop;
mod watchdogs;
