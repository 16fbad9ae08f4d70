//! One file per panel. Each [`panel::Panel`] shows [`nima_screen::live::LiveState`] and puts the operator's commands into the outbox.
// These macros panic if stderr or stdout is closed.
#![cfg_attr(not(test), deny(clippy::print_stderr, clippy::print_stdout))]

mod axis;
pub mod calibrations;
pub mod degrees;
pub mod devices;
pub mod endoscope_view;
pub mod feedback;
mod field;
pub mod force_space;
pub mod gates;
pub mod horizon;
pub mod link;
mod modes;
pub mod panel;
pub mod rig_choice;
pub mod roles;
pub mod safety;
pub mod settings;
pub mod tiles;
pub mod timing;
mod timing_bars;
pub mod traces;
mod traces_menu;
mod traces_plot;
mod traces_state;
mod tradeoff;

pub use calibrations::{CalibrationPage, CalibrationWish, calibrations_ui};
pub use degrees::{DegreesState, degrees_ui};
pub use devices::DevicesState;
pub use feedback::{FeedbackState, calm_gain_ui};
pub use force_space::{ForceSpaceState, force_space_ui};
pub use gates::why_no_force;
pub use horizon::horizon_ui;
pub use traces::force_traces_ui;
pub use traces_state::ForcesView;
pub use traces_state::TracesState;

use std::{fmt::Debug, sync::OnceLock};

use egui::{Rect, Ui};
use nima_machine::config::RigConfig;
use nima_screen::{live::LiveState, outbox::Outbox};

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
pub type StripUi = fn(&mut Ui, &LiveState, Rect, f64);

/// Panels and parts of panels that extras have.
#[derive(Clone, Copy, Debug, Default)]
pub struct PanelExtras {
    /// Trade-off between speed and accuracy.
    pub tradeoff: Option<fn() -> Box<dyn Tile>>,
    /// The highest gain at which a gripping hand is stable.
    pub stable_gain: Option<StripUi>,
    /// Whether the arm may be at another machine.
    pub has_link: bool,
}

static EXTRAS: OnceLock<PanelExtras> = OnceLock::new();

impl PanelExtras {
    pub fn offer(self) {
        EXTRAS.get_or_init(|| self);
    }

    pub fn offered() -> Self {
        EXTRAS.get().copied().unwrap_or_default()
    }
}
