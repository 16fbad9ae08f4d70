//! The visible interval of the traces, and the pause.

use nima_machine::rig::Side;

use crate::console::{
    history::{CHANNELS, PlotTrace, SignalHistory},
    live::LiveState,
};

const DEFAULT_VIEW_S: (f64, f64) = (-10.0, 0.0);
const SHORTEST_S: f64 = 0.2;
const LONGEST_S: f64 = 500.0;
/// Minimum range of the force axis, N.
pub(super) const MIN_RANGE_N: f64 = 0.25;

#[derive(Debug)]
pub struct TracesState {
    /// Interval on display, s, relative to `now`.
    pub(super) view_s: (f64, f64),
    pub(super) paused_at_s: Option<f64>,
    pub(super) ranges_n: [(f64, f64); 3],
    pub(super) lines: [PlotTrace; CHANNELS],
    pub(super) cursor_s: Option<f64>,
    /// Step of the view, s, so that nothing is redrawn for less than one pixel.
    pub(super) step_s: f64,
    /// The side whose forces are shown.
    pub(super) side: Side,
}

impl Default for TracesState {
    fn default() -> Self {
        Self {
            view_s: DEFAULT_VIEW_S,
            paused_at_s: None,
            ranges_n: [(-MIN_RANGE_N, MIN_RANGE_N); 3],
            lines: Default::default(),
            cursor_s: None,
            step_s: 0.0,
            side: Side::Right,
        }
    }
}

/// Visible part of the traces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::console) struct ForcesView {
    pub(in crate::console) view_s: (f64, f64),
    pub(in crate::console) side: Side,
}

impl TracesState {
    pub(in crate::console) const fn view(&self) -> ForcesView {
        ForcesView { view_s: self.view_s, side: self.side }
    }

    pub(in crate::console) const fn show(&mut self, ForcesView { view_s, side }: ForcesView) {
        self.view_s = view_s;
        self.side = side;
    }

    /// Shows the last ten seconds.
    pub(in crate::console) const fn show_last_ten(&mut self) {
        self.view_s = DEFAULT_VIEW_S;
    }

    /// Pauses or resumes the display.
    pub(in crate::console) fn toggle_pause(&mut self, live: &LiveState) {
        self.paused_at_s = if self.is_paused() { None } else { Some(self.history(live).latest_s()) };
    }

    pub fn of(side: Side) -> Self {
        Self { side, ..Self::default() }
    }

    pub fn show_last(&mut self, seconds: f64) {
        if seconds.is_finite() {
            self.view_s = (-seconds.clamp(SHORTEST_S, LONGEST_S), 0.0);
        }
    }

    pub const fn side(&self) -> Side {
        self.side
    }

    pub const fn is_paused(&self) -> bool {
        self.paused_at_s.is_some()
    }

    /// Returns the time at the cursor, s on the loop's clock.
    pub fn cursor_at_s(&self, live: &LiveState) -> Option<f64> {
        self.cursor_s.map(|cursor_s| self.now_s(self.history(live)) + cursor_s)
    }

    pub(super) const fn history<'a>(&self, live: &'a LiveState) -> &'a SignalHistory {
        &live.history[self.side.index()]
    }

    pub(super) fn now_s(&self, history: &SignalHistory) -> f64 {
        self.paused_at_s.unwrap_or(stepped(history.latest_s(), self.step_s))
    }

    pub(super) fn pan(&mut self, by_s: f64) {
        let width_s = self.view_s.1 - self.view_s.0;
        let to_s = (self.view_s.1 + by_s).clamp(width_s - LONGEST_S, 0.0);
        self.view_s = (to_s - width_s, to_s);
    }

    /// Divides the interval by this factor, keeping `around_s` in place.
    pub(super) fn zoom(&mut self, factor: f64, around_s: f64) {
        let width_s = ((self.view_s.1 - self.view_s.0) / factor).clamp(SHORTEST_S, LONGEST_S);
        let fraction = (around_s - self.view_s.0) / (self.view_s.1 - self.view_s.0);
        let to_s = (around_s + (1.0 - fraction) * width_s).min(0.0);
        self.view_s = (to_s - width_s, to_s);
    }
}

/// Returns the last multiple of the step before a time, both in s.
pub(super) fn stepped(t_s: f64, step_s: f64) -> f64 {
    if step_s > 0.0 { (t_s / step_s).floor() * step_s } else { t_s }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_view_never_shows_the_future_and_zooms_around_the_pointer() {
        let mut state = TracesState::default();
        state.pan(5.0);
        assert_eq!(state.view_s, (-10.0, 0.0));
        state.pan(-5.0);
        assert_eq!(state.view_s, (-15.0, -5.0));
        state.zoom(2.0, -10.0);
        assert_eq!(state.view_s, (-12.5, -7.5));
        for _ in 0..100 {
            state.zoom(2.0, -10.0);
        }
        assert!((state.view_s.1 - state.view_s.0 - SHORTEST_S).abs() < 1e-9);
        for _ in 0..100 {
            state.zoom(0.5, -10.0);
        }
        assert!(state.view_s.1 <= 0.0 && state.view_s.1 - state.view_s.0 <= LONGEST_S + 1e-9);
    }

    #[test]
    fn the_picture_moves_in_whole_steps() {
        assert!((stepped(1.234, 0.1) - 1.2).abs() < 1e-9 && (stepped(1.29, 0.1) - 1.2).abs() < 1e-9);
        assert!((stepped(1.234, 0.0) - 1.234).abs() < 1e-12);
    }
}
