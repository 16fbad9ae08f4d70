//! Estimates the other machine's clock from four time stamps.
//!
//! A [`ClockExchange`] gives the apparent delay of one datagram in each direction. The offset is between the two bounds
//! given by these delays, whatever the delays are: the middle is the estimate, half the round trip its bound (Mills,
//! RFC 5905). For every 0.2 s only the minimum apparent delay of each direction is kept; a straight line through the
//! last 20 s of them, weighted by the stability of the round trip, gives offset and skew. A step of either clock moves
//! the two apparent delays in opposite directions and leaves the round trip unchanged; a longer route does not.

/// Minimum length of a window, s, and minimum number of exchanges in it; a window ends in any case after
/// [`WINDOW_MAX_S`].
const WINDOW_S: f64 = 0.2;
const WINDOW_SAMPLES: u32 = 20;
const WINDOW_MAX_S: f64 = 1.0;
/// Number of stored windows.
const WINDOWS: usize = 100;
/// Minimum number of windows for detecting a step.
const WINDOWS_MIN: usize = 4;
/// Minimum step that is reported, s; the estimate of two windows must exceed half of it.
pub const STEP_MIN_S: f64 = 5e-3;
/// Number of earlier windows with which a window is compared.
const REFERENCE: usize = 5;
/// A step must exceed the usual deviation of a window by this factor.
const STEP_DEVIATIONS: f64 = 6.0;
/// Usual deviation of a crystal's rate, as a fraction, and of a window's estimate, s; they determine how much the skew
/// estimate is shrunk.
const SKEW_USUAL: f64 = 1e-4;
const WINDOW_USUAL_S: f64 = 2e-4;
/// A window whose round trip exceeds the minimum by this, s, has half the weight.
const ROUND_TRIP_SCALE_S: f64 = 1e-4;

/// Four time stamps, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClockExchange {
    /// Sending of our datagram, by our clock.
    pub origin_s: f64,
    /// Arrival, by their clock.
    pub received_s: f64,
    /// Sending of their datagram, by their clock.
    pub sent_s: f64,
    /// Arrival, by our clock.
    pub arrived_s: f64,
}

/// Estimate of their clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClockEstimate {
    /// Their clock minus ours, s.
    pub offset_s: f64,
    /// Maximum error of the offset, s: half the minimum round trip.
    pub bound_s: f64,
    /// Minimum recent round trip, s.
    pub round_trip_s: f64,
    /// Relative rate error of their clock.
    pub skew: f64,
}

/// A step of either clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClockStep {
    /// Time of detection, by our clock, s.
    pub found_s: f64,
    /// Change of their clock minus ours, s.
    pub by_s: f64,
}

#[derive(Clone, Copy, Debug)]
struct ClockWindow {
    begin_s: f64,
    last_s: f64,
    samples: u32,
    /// Minimum apparent delay from us to them, and back, s.
    there_s: f64,
    back_s: f64,
}

impl ClockWindow {
    const fn starting(at_s: f64) -> Self {
        Self { begin_s: at_s, last_s: at_s, samples: 0, there_s: f64::INFINITY, back_s: f64::INFINITY }
    }

    const fn offset_s(&self) -> f64 {
        (self.there_s - self.back_s) / 2.0
    }

    const fn half_s(&self) -> f64 {
        f64::midpoint(self.there_s, self.back_s)
    }

    const fn middle_s(&self) -> f64 {
        f64::midpoint(self.begin_s, self.last_s)
    }

    fn is_full(&self) -> bool {
        let length_s = self.last_s - self.begin_s;
        (length_s >= WINDOW_S && self.samples >= WINDOW_SAMPLES) || length_s >= WINDOW_MAX_S
    }
}

/// Offset at a moment, and its rate of change.
#[derive(Clone, Copy, Debug)]
struct ClockLine {
    at_s: f64,
    offset_s: f64,
    skew: f64,
}

impl ClockLine {
    fn at(&self, t_s: f64) -> f64 {
        self.offset_s + self.skew * (t_s - self.at_s)
    }
}

/// Classification of a window.
#[derive(Clone, Copy, Debug, PartialEq)]
enum WindowVerdict {
    /// Similar to the previous windows.
    Usual,
    /// Different from them; the next window shows why.
    Suspect,
    /// The route is now longer or shorter in one direction.
    OtherWay,
    /// A clock was set.
    Step(f64),
}

/// Estimates the offset between two clocks.
#[derive(Clone, Debug)]
pub struct NetworkClock {
    windows: [ClockWindow; WINDOWS],
    /// Number of windows closed since the last step.
    closed: usize,
    open: Option<ClockWindow>,
    line: Option<ClockLine>,
    /// Minimum half round trip of the stored windows, s.
    half_s: f64,
    /// The windows from this one on are compared with the next.
    reference_from: usize,
    /// Deviations of offset and half round trip of the last window, s, if they looked like a step.
    suspect: Option<(f64, f64)>,
    step: Option<ClockStep>,
    steps: u32,
}

impl Default for NetworkClock {
    fn default() -> Self {
        Self {
            windows: [ClockWindow::starting(0.0); WINDOWS],
            closed: 0,
            open: None,
            line: None,
            half_s: f64::INFINITY,
            reference_from: 0,
            suspect: None,
            step: None,
            steps: 0,
        }
    }
}

impl NetworkClock {
    /// Adds one exchange. Returns the step that it proved, if any; the estimate then applies to the new clock.
    pub fn add(&mut self, exchange: &ClockExchange) -> Option<ClockStep> {
        let there_s = exchange.received_s - exchange.origin_s;
        let back_s = exchange.arrived_s - exchange.sent_s;
        let at_s = exchange.arrived_s;
        if !(there_s + back_s + at_s).is_finite() {
            return None;
        }
        let open = self.open.get_or_insert(ClockWindow::starting(at_s));
        open.samples += 1;
        open.last_s = open.last_s.max(at_s);
        open.there_s = open.there_s.min(there_s);
        open.back_s = open.back_s.min(back_s);
        let full = *open;
        if !full.is_full() {
            return None;
        }
        self.open = None;
        self.close(full)
    }

    /// Returns the estimate; `None` before the first exchange.
    pub fn estimate(&self, now_s: f64) -> Option<ClockEstimate> {
        let Some(line) = self.line else {
            let open = self.open.as_ref()?;
            let half_s = open.half_s().max(0.0);
            return Some(ClockEstimate {
                offset_s: open.offset_s(),
                bound_s: half_s,
                round_trip_s: 2.0 * half_s,
                skew: 0.0,
            });
        };
        let half_s = self.half_s.max(0.0);
        Some(ClockEstimate { offset_s: line.at(now_s), bound_s: half_s, round_trip_s: 2.0 * half_s, skew: line.skew })
    }

    /// Returns the last step, if there was one.
    pub const fn step(&self) -> Option<ClockStep> {
        self.step
    }

    /// Returns the number of detected steps.
    pub const fn steps(&self) -> u32 {
        self.steps
    }

    fn kept(&self) -> &[ClockWindow] {
        &self.windows[..self.closed.min(WINDOWS)]
    }

    fn close(&mut self, window: ClockWindow) -> Option<ClockStep> {
        let step = match self.judge(&window) {
            WindowVerdict::Usual => None,
            // Neither accept nor discard it: the next window decides.
            WindowVerdict::Suspect => return None,
            WindowVerdict::OtherWay => {
                self.reference_from = self.closed;
                None
            }
            WindowVerdict::Step(by_s) => {
                let step = ClockStep { found_s: window.last_s, by_s };
                *self = Self { steps: self.steps + 1, step: Some(step), ..Self::default() };
                Some(step)
            }
        };
        self.windows[self.closed % WINDOWS] = window;
        self.closed += 1;
        self.fit(window.last_s);
        step
    }

    /// Returns the last accepted windows, newest first, at most this many.
    fn last(&self, count: usize) -> impl Iterator<Item = &ClockWindow> {
        let count = count.min(self.closed).min(WINDOWS);
        (1..=count).map(|back| &self.windows[(self.closed - back) % WINDOWS])
    }

    /// Compares a window with the previous ones. A longer or shorter route in one direction moves the middle by as much
    /// as half the round trip; a step leaves the round trip unchanged. A window that contains the change itself shows
    /// an intermediate value, so only two consecutive windows that agree are judged.
    fn judge(&mut self, window: &ClockWindow) -> WindowVerdict {
        let count = REFERENCE.min(self.closed - self.reference_from);
        if self.closed < WINDOWS_MIN || count == 0 {
            return WindowVerdict::Usual;
        }
        let mean = |of: fn(&ClockWindow) -> f64| self.last(count).map(of).sum::<f64>() / count as f64;
        let by_s = window.offset_s() - mean(ClockWindow::offset_s);
        let longer_s = window.half_s() - mean(ClockWindow::half_s);
        // With few windows their deviation is uncertain.
        let deviations = STEP_DEVIATIONS * (1.0 + WINDOWS_MIN as f64 / self.closed.min(WINDOWS) as f64);
        let before = self.suspect.take();
        if by_s.abs() <= (STEP_MIN_S / 2.0).max(deviations * self.deviation_s()) {
            return WindowVerdict::Usual;
        }
        let agrees = |(before_s, before_longer_s): (f64, f64)| {
            (before_s - by_s).abs().max((before_longer_s - longer_s).abs()) < 0.3 * by_s.abs()
        };
        if !before.is_some_and(agrees) {
            self.suspect = Some((by_s, longer_s));
            return WindowVerdict::Suspect;
        }
        if longer_s.abs() < 0.4 * by_s.abs() { WindowVerdict::Step(by_s) } else { WindowVerdict::OtherWay }
    }

    /// Returns the usual deviation of a window, s, from the differences of consecutive windows.
    fn deviation_s(&self) -> f64 {
        let differences = self.last(WINDOWS).zip(self.last(WINDOWS).skip(1));
        let (sum_s, count) =
            differences.fold((0.0, 0.0), |(sum, n), (a, b)| (sum + (a.offset_s() - b.offset_s()).abs(), n + 1.0));
        1.25 / std::f64::consts::SQRT_2 * sum_s / f64::max(count, 1.0)
    }

    /// Fits a straight line through the stored windows, with a skew that is shrunk towards zero.
    fn fit(&mut self, now_s: f64) {
        let half_s = self.kept().iter().map(ClockWindow::half_s).fold(f64::INFINITY, f64::min);
        self.half_s = half_s;
        let weight = |w: &ClockWindow| 1.0 / (1.0 + ((w.half_s() - half_s) / ROUND_TRIP_SCALE_S).powi(2)).max(1.0);
        let mut all = 0.0;
        let mut t = 0.0;
        let mut offset = 0.0;
        for window in self.kept() {
            let weight = weight(window);
            all += weight;
            t += weight * (window.middle_s() - now_s);
            offset += weight * window.offset_s();
        }
        let t = t / all;
        let offset = offset / all;
        let mut tt = all * (WINDOW_USUAL_S / SKEW_USUAL).powi(2) / self.kept().len().max(1) as f64;
        let mut to = 0.0;
        for window in self.kept() {
            let weight = weight(window);
            let away_s = window.middle_s() - now_s - t;
            tt += weight * away_s * away_s;
            to += weight * away_s * (window.offset_s() - offset);
        }
        self.line = Some(ClockLine { at_s: now_s + t, offset_s: offset, skew: to / tt });
    }
}

#[cfg(test)]
#[path = "clock_tests.rs"]
mod tests;
