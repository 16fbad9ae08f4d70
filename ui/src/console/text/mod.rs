//! Every word that the console shows, one module per room, so that a translation has one place to work in.
//!
//! Plain constants, and small functions where a sentence holds numbers; a panel refers to them and holds no words of its own.

pub(super) mod alarms;
pub(super) mod calibrations;
pub(super) mod common;
pub(super) mod correspondence;
pub(super) mod degrees;
pub(super) mod desk;
pub(super) mod devices;
pub(super) mod feedback;
pub(super) mod field;
pub(super) mod force_space;
pub(super) mod forces;
pub(super) mod gates;
pub(super) mod gravity;
pub(super) mod help;
pub(super) mod horizon;
pub(super) mod menu;
pub(super) mod modes;
pub(super) mod roles;
pub(super) mod safety;
pub(super) mod settings;
pub(super) mod timing;
pub(super) mod tip_force;
pub(super) mod top_bar;
pub(super) mod tradeoff;
pub(super) mod wizards;
