//! The visible interval of the traces, the chosen plots and lines, the two cursors, and the pause.

use egui::{Context, Rect};
use nima_machine::rig::Side;
use nima_screen::{
    exports,
    history::{CHANNELS, PlotTrace, SignalHistory},
    live::LiveState,
    signals::{PlotSet, TracePlot},
};

const DEFAULT_VIEW_S: (f64, f64) = (-10.0, 0.0);
const SHORTEST_S: f64 = 0.2;
const LONGEST_S: f64 = 500.0;
/// A vertical axis is zoomed between these factors of its smallest range.
const NARROWEST: f64 = 1e-3;
const WIDEST: f64 = 1e4;
const PLOTS: usize = TracePlot::ALL.len();

#[derive(Debug)]
pub struct TracesState {
    /// Interval on display, s, relative to `now`.
    pub(super) view_s: (f64, f64),
    pub(super) paused_at_s: Option<f64>,
    /// Ranges of the vertical axes as they follow the data.
    pub(super) ranges: [(f64, f64); PLOTS],
    /// Ranges set by the operator.
    pub(super) zoomed: [Option<(f64, f64)>; PLOTS],
    pub(super) lines: [PlotTrace; CHANNELS],
    /// Time under the pointer, s relative to `now`.
    pub(super) cursor_s: Option<f64>,
    /// Times of the two cursors, s on the loop's clock.
    pub(super) cursors_s: [Option<f64>; 2],
    /// Time at which the menu was opened, s on the loop's clock.
    pub(super) menu_s: f64,
    /// Step of the view, s, so that nothing is redrawn for less than one pixel.
    pub(super) step_s: f64,
    /// The side whose forces are shown.
    pub(super) side: Side,
    pub(super) plots: PlotSet,
    /// The plots that can be chosen: of other programs' recordings, only those with known signals.
    pub(super) offered: PlotSet,
    /// Lines that are not drawn, one bit per channel.
    pub(super) hidden: u32,
    /// Frames until the picture is taken: the menu that requested it must be gone.
    png_in: Option<u8>,
}

impl Default for TracesState {
    fn default() -> Self {
        Self {
            view_s: DEFAULT_VIEW_S,
            paused_at_s: None,
            ranges: [(0.0, 0.0); PLOTS],
            zoomed: [None; PLOTS],
            lines: Default::default(),
            cursor_s: None,
            cursors_s: [None; 2],
            menu_s: 0.0,
            step_s: 0.0,
            side: Side::Right,
            plots: PlotSet::default(),
            offered: TracePlot::ALL.into_iter().collect(),
            hidden: 0,
            png_in: None,
        }
    }
}

/// Visible part of the traces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForcesView {
    pub view_s: (f64, f64),
    pub side: Side,
    pub plots: PlotSet,
    pub hidden: u32,
}

impl TracesState {
    pub const fn view(&self) -> ForcesView {
        ForcesView { view_s: self.view_s, side: self.side, plots: self.plots, hidden: self.hidden }
    }

    pub const fn show(&mut self, ForcesView { view_s, side, plots, hidden }: ForcesView) {
        self.view_s = view_s;
        self.side = side;
        self.plots = plots;
        self.hidden = hidden;
    }

    /// Restarts for another loop, with the chosen plots.
    pub fn begin_anew(&mut self) {
        *self = Self { plots: self.plots, hidden: self.hidden, ..Self::default() };
    }

    /// Shows the last ten seconds.
    pub const fn show_last_ten(&mut self) {
        self.view_s = DEFAULT_VIEW_S;
    }

    /// Shows the last ten seconds, with axes that follow the data, without cursors.
    pub(super) const fn reset(&mut self) {
        self.show_last_ten();
        self.zoomed = [None; PLOTS];
        self.cursors_s = [None; 2];
    }

    /// Pauses or resumes the display.
    pub fn toggle_pause(&mut self, live: &LiveState) {
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

    /// Offers and shows only these plots.
    pub const fn offer(&mut self, plots: PlotSet) {
        self.offered = plots;
        self.plots = plots;
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

    pub(super) const fn is_hidden(&self, channel: usize) -> bool {
        self.hidden & (1 << channel) != 0
    }

    /// Hides these lines, or shows them again if the first one is hidden.
    pub(super) fn toggle(&mut self, channels: &[usize]) {
        let mask: u32 = channels.iter().map(|channel| 1 << channel).sum();
        let is_hidden = channels.first().is_some_and(|channel| self.is_hidden(*channel));
        self.hidden = if is_hidden { self.hidden & !mask } else { self.hidden | mask };
    }

    /// Returns the visible channels of a plot.
    pub(super) fn visible(&self, plot: TracePlot) -> Vec<usize> {
        plot.lines().iter().map(|line| line.channel).filter(|channel| !self.is_hidden(*channel)).collect()
    }

    /// Returns the range of the vertical axis of a plot.
    pub(super) fn range(&self, plot: TracePlot) -> (f64, f64) {
        self.zoomed[plot.index()].unwrap_or(self.ranges[plot.index()])
    }

    /// Divides the vertical range of a plot by this factor, keeping `around` in place.
    pub(super) fn zoom_vertically(&mut self, plot: TracePlot, factor: f64, around: f64) {
        let (low, high) = self.range(plot);
        let height = high - low;
        let least = plot.min_range();
        let wanted = (height / factor).clamp(NARROWEST * least, WIDEST * least);
        let scale = if height > 0.0 { wanted / height } else { 1.0 };
        self.zoomed[plot.index()] = Some((around + (low - around) * scale, around + (high - around) * scale));
    }

    /// Moves the vertical range of a plot, if the operator has set it.
    pub(super) fn pan_vertically(&mut self, plot: TracePlot, by: f64) {
        if let Some((low, high)) = &mut self.zoomed[plot.index()] {
            *low += by;
            *high += by;
        }
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

    pub(super) const fn want_png(&mut self) {
        self.png_in = Some(2);
    }

    /// Takes the requested picture of this part of the window.
    pub(super) fn take_png(&mut self, ctx: &Context, part: Rect) {
        self.png_in = match self.png_in {
            Some(0) => {
                exports::save_png(ctx, "traces", part);
                None
            }
            frames => frames.map(|frames| frames - 1),
        };
        if self.png_in.is_some() {
            ctx.request_repaint();
        }
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
    fn a_vertical_axis_is_zoomed_around_the_pointer_moved_and_reset() {
        let mut state = TracesState::default();
        let z = TracePlot::ForceZ;
        state.ranges[z.index()] = (-1.0, 3.0);
        state.pan_vertically(z, 1.0);
        assert_eq!(state.range(z), (-1.0, 3.0), "an axis that follows the data is not moved");
        state.zoom_vertically(z, 2.0, 3.0);
        assert_eq!(state.range(z), (1.0, 3.0));
        state.pan_vertically(z, -0.5);
        assert_eq!((state.range(z), state.range(TracePlot::ForceX)), ((0.5, 2.5), (0.0, 0.0)));
        for _ in 0..100 {
            state.zoom_vertically(z, 0.5, 0.0);
        }
        assert!(state.range(z).1.is_finite());
        state.reset();
        assert_eq!(state.range(z), (-1.0, 3.0));
    }

    #[test]
    fn lines_are_hidden_together_and_come_back() {
        let mut state = TracesState::default();
        state.toggle(&[3, 4]);
        assert_eq!(state.visible(TracePlot::ForceX), [0]);
        state.toggle(&[4]);
        state.toggle(&[3, 4]);
        assert_eq!(state.visible(TracePlot::ForceY), [4, 1]);
    }

    #[test]
    fn the_picture_moves_in_whole_steps() {
        assert!((stepped(1.234, 0.1) - 1.2).abs() < 1e-9 && (stepped(1.29, 0.1) - 1.2).abs() < 1e-9);
        assert!((stepped(1.234, 0.0) - 1.234).abs() < 1e-12);
    }
}
