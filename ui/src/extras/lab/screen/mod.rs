//! The studies in the window.

mod stable_gain;
mod tradeoff;
mod tradeoff_apply;
mod tradeoff_plot;

pub(super) use stable_gain::stable_gain_ui;
pub(super) use tradeoff::TradeoffPanel;
