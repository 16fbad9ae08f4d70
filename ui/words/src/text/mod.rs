//! All texts of the window, one module per part of it, so that a translation has one place to work in. Texts for values
//! that the libraries report (faults, gate reasons, verdicts) are in `crate::report_text`, which the command line shares.
//!
//! Each text is here in both languages (`crate::language`): constants as [`Text`](crate::language::Text), sentences with values as small
//! functions that use `report!`. A text without one of the languages does not compile. Constants are named by role. Panels contain no
//! texts. A message library (fluent-bundle 0.16) was tried on the Feedback panel and not adopted: it shows a misspelt name or a missing
//! argument on the screen, which the compiler rejects here; `maximumFractionDigits` is ignored
//! (0.8349 instead of 0.83); a sentence with two numbers takes 13 us instead of 0.8 us in each frame; and its 12 crates
//! add 23 s of processor time to a clean build. Its advantage, plural rules, would help three sentences.

pub mod alarms;
pub mod calibrations;
pub mod checkup;
pub mod commands;
pub mod common;
pub mod correspondence;
pub mod current_session;
pub mod degrees;
pub mod devices;
pub mod endoscope_view;
pub mod feedback;
pub mod field;
pub mod force_space;
pub mod frames;
pub mod gates;
pub mod gravity;
pub mod help;
pub mod horizon;
pub mod link;
pub mod menu;
pub mod monitor;
pub mod of_files;
pub mod overview;
pub mod playback;
pub mod ready;
pub mod roles;
pub mod safety;
pub mod sessions;
pub mod settings;
pub mod start;
pub mod tiles;
pub mod timing;
pub mod tip_force;
pub mod top_bar;
pub mod traces;
pub mod tradeoff;
pub mod training;
pub mod wizards;
