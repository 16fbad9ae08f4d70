//! Every word that the window shows, one module per room, so that a translation has one place to work in. What the library reports as
//! values (faults, gate reasons, verdicts) has its words in `crate::words`, which the command line shares.
//!
//! Constants named by role, and small functions where a sentence holds numbers; a panel refers to them and holds no words of its own.
//! A message library was tried on the feedback panel (fluent-bundle 0.16) and not taken: a mistyped name or a missing argument shows
//! its own name on the screen where the compiler refuses a constant, `maximumFractionDigits` is ignored (0.8349 where 0.83 was asked for),
//! a sentence with two numbers takes 13 us in place of 0.8 us in each frame, and its 12 crates add 23 s of processor time to a clean
//! build. What it does well, plural rules, three sentences here could use; a second language would turn these functions into a choice
//! by language, in these files alone.

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
