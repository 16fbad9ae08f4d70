//! One file per panel. Each panel is a function that shows [`super::live::LiveState`] and puts the operator's commands into the
//! outbox.

mod axis;
pub mod calibrations;
pub mod degrees;
pub mod devices;
pub mod feedback;
pub mod force_space;
pub mod gates;
pub mod horizon;
pub mod link;
mod modes;
pub mod safety;
pub mod timing;
mod timing_bars;
pub mod top_bar;
pub mod traces;
mod traces_menu;
mod traces_plot;
mod traces_state;

pub use calibrations::{CalibrationPage, CalibrationWish, calibrations_ui};
pub use degrees::{DegreesState, degrees_ui};
pub use devices::{DevicesState, devices_ui};
pub use feedback::{FeedbackState, calm_gain_ui, feedback_ui};
pub use force_space::{ForceSpaceState, force_space_ui};
pub use gates::why_no_force;
pub use horizon::horizon_ui;
pub use link::link_ui;
pub use safety::{SafetyState, safety_ui};
pub use timing::{TimingState, timing_ui};
pub(super) use top_bar::state_ui;
pub use top_bar::{TopBarState, top_bar_ui};
pub use traces::force_traces_ui;
pub(super) use traces_state::ForcesView;
pub use traces_state::TracesState;

use std::fmt::Debug;

use egui::{Rect, Ui};
use nima_machine::config::RigConfig;

use super::{live::LiveState, outbox::Outbox};

/// A panel of an extra. Dropping it ends its background work.
pub trait Tile: Debug {
    /// Draws the panel. Returns a rig if the loop must be restarted with it.
    fn ui(&mut self, ui: &mut Ui, live: &LiveState, outbox: &mut Outbox) -> Option<RigConfig>;

    /// Reports the outcome of the restart.
    fn restarted(&mut self, outcome: Result<(), String>);

    /// Requests the end of its background work.
    fn stop(&self);

    /// Returns whether it has results.
    fn is_measured(&self) -> bool;
}

/// Draws a strip below a slider with this rectangle, whose right end has this value.
pub(crate) type StripUi = fn(&mut Ui, &LiveState, Rect, f64);
