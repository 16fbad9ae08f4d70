//! All texts of the window, one module per part of it, so that a translation has one place to work in. Texts for values
//! that the libraries report (faults, gate reasons, verdicts) are in `crate::report_text`, which the command line shares.
//!
//! Each text is here in both languages (`crate::language`): constants as [`Text`](crate::language::Text), sentences with values as small
//! functions that use `report!`. A text without one of the languages does not compile. Constants are named by role. Panels contain no
//! texts. A message library (fluent-bundle 0.16) was tried on the Feedback panel and not adopted: it shows a misspelt name or a missing
//! argument on the screen, which the compiler rejects here; `maximumFractionDigits` is ignored
//! (0.8349 instead of 0.83); a sentence with two numbers takes 13 us instead of 0.8 us in each frame; and its 12 crates
//! add 23 s of processor time to a clean build. Its advantage, plural rules, would help three sentences.

pub(crate) mod alarms;
pub(crate) mod calibrations;
pub(crate) mod checkup;
pub(crate) mod commands;
pub(crate) mod common;
pub(crate) mod correspondence;
pub(crate) mod degrees;
pub(crate) mod devices;
pub(crate) mod endoscope_view;
pub(crate) mod feedback;
pub(crate) mod field;
pub(crate) mod force_space;
pub(crate) mod frames;
pub(crate) mod gates;
pub(crate) mod gravity;
pub(crate) mod help;
pub(crate) mod horizon;
pub(crate) mod link;
pub(crate) mod menu;
pub(crate) mod monitor;
pub(crate) mod overview;
pub(crate) mod playback;
pub(crate) mod ready;
pub(crate) mod roles;
pub(crate) mod safety;
pub(crate) mod sessions;
pub(crate) mod settings;
pub(crate) mod start;
pub(crate) mod tiles;
pub(crate) mod timing;
pub(crate) mod tip_force;
pub(crate) mod top_bar;
pub(crate) mod traces;
pub(crate) mod training;
pub(crate) mod wizards;
