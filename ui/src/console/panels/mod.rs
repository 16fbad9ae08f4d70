//! One file per panel. Each panel is a function that shows [`super::live::Live`] and puts the operator's commands into
//! the outbox.

mod axis;
pub mod calibrations;
pub mod degrees;
pub mod devices;
pub mod feedback;
pub mod force_space;
pub mod forces;
pub mod gates;
pub mod horizon;
pub mod safety;
mod stable_gain;
pub mod timing;
mod timing_bars;
pub mod top_bar;
pub mod tradeoff;
mod tradeoff_apply;
mod tradeoff_plot;

use nima_core::impedance::{Baseline, Mode};

pub use calibrations::{CalibrationWish, Page, calibrations_ui};
pub use degrees::degrees_ui;
pub(crate) use devices::finding_words;
pub use devices::{DevicesState, devices_ui};
pub use feedback::{FeedbackState, calm_gain_ui, feedback_ui};
pub use force_space::{ForceSpaceState, force_space_ui};
pub use forces::{ForcesState, forces_ui, gauge};
pub use gates::{GatesState, gates_ui, why_no_force};
pub use horizon::horizon_ui;
pub use safety::safety_ui;
pub use timing::{TimingState, timing_ui};
pub use top_bar::{TopBarState, top_bar_ui};
pub use tradeoff::{TradeoffState, tradeoff_ui};

use crate::console::text;

/// Name of a mode on a button.
pub const fn mode_name(mode: Mode) -> &'static str {
    match mode {
        Mode::Literal => text::modes::LITERAL,
        Mode::Linear => text::modes::LINEAR,
        Mode::Dfr => text::modes::DFR,
        Mode::Anchored => text::modes::ANCHORED,
        Mode::Matched => text::modes::MATCHED,
        Mode::Nima => text::modes::NIMA,
        Mode::Best => text::modes::BEST,
        Mode::Baseline(Baseline::ModelMediated) => text::modes::MODEL_MEDIATED,
        Mode::Baseline(Baseline::Waves) => text::modes::WAVES,
        Mode::Baseline(Baseline::Passivity) => text::modes::PASSIVITY,
        Mode::Baseline(Baseline::Kalman) => text::modes::KALMAN,
        Mode::Baseline(Baseline::Autoregressive) => text::modes::AUTOREGRESSIVE,
    }
}

/// Explanation of a mode, one sentence.
pub const fn mode_meaning(mode: Mode) -> &'static str {
    match mode {
        Mode::Literal => text::modes::LITERAL_HOVER,
        Mode::Linear => text::modes::LINEAR_HOVER,
        Mode::Dfr => text::modes::DFR_HOVER,
        Mode::Anchored => text::modes::ANCHORED_HOVER,
        Mode::Matched => text::modes::MATCHED_HOVER,
        Mode::Nima => text::modes::NIMA_HOVER,
        Mode::Best => text::modes::BEST_HOVER,
        Mode::Baseline(Baseline::ModelMediated) => text::modes::MODEL_MEDIATED_HOVER,
        Mode::Baseline(Baseline::Waves) => text::modes::WAVES_HOVER,
        Mode::Baseline(Baseline::Passivity) => text::modes::PASSIVITY_HOVER,
        Mode::Baseline(Baseline::Kalman) => text::modes::KALMAN_HOVER,
        Mode::Baseline(Baseline::Autoregressive) => text::modes::AUTOREGRESSIVE_HOVER,
    }
}
