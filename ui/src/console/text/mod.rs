//! All texts of the window, one module per part of it, so that a translation has one place to work in. Texts for values
//! that the libraries report (faults, gate reasons, verdicts) are in `crate::words`, which the command line shares.
//!
//! Every text stands in each language side by side (`crate::language`): constants as [`Text`](crate::language::Text), sentences with values as
//! small functions that choose with `told!`. A text that lacks a language does not compile. Constants are named by role. Panels contain no
//! texts of their own. A message library (fluent-bundle 0.16) was tried on the feedback panel and not adopted: a misspelt name or a missing
//! argument appears on the screen, where the compiler refuses an unknown constant; `maximumFractionDigits` is ignored
//! (0.8349 instead of 0.83); a sentence with two numbers takes 13 us instead of 0.8 us in each frame; and its 12 crates
//! add 23 s of processor time to a clean build. Its advantage, plural rules, would help three sentences.

pub(super) mod alarms;
pub(super) mod calibrations;
pub(super) mod camera;
pub(super) mod checkup;
pub(super) mod commands;
pub(super) mod common;
pub(super) mod correspondence;
pub(super) mod degrees;
pub(super) mod desk;
pub(super) mod devices;
pub(super) mod eyes;
pub(super) mod feedback;
pub(super) mod field;
pub(super) mod force_space;
pub(super) mod forces;
pub(super) mod frames;
pub(super) mod gates;
pub(super) mod gravity;
pub(super) mod help;
pub(super) mod horizon;
pub(super) mod link;
pub(super) mod menu;
pub(super) mod monitor;
pub(super) mod overview;
pub(super) mod past;
pub(super) mod questionnaires;
pub(super) mod ready;
pub(super) mod roles;
pub(super) mod safety;
pub(super) mod sessions;
pub(super) mod settings;
pub(super) mod start;
pub(super) mod studies;
pub(super) mod study_form;
pub(super) mod timing;
pub(super) mod tip_force;
pub(super) mod top_bar;
pub(super) mod tradeoff;
pub(super) mod training;
pub(super) mod wizards;
