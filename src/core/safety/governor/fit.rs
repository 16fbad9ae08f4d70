//! The hand's force as the second derivative of [`ObserverHistory::y`]: one parabola, or a parabola whose curvature steps once.
//!
//! Each force has a bound on its error: the largest that readings in steps can cause (half a step each, all of the worst
//! sign), three deviations of the residuals, or what the inexact times of the readings cause at the present speed, whichever is
//! largest. So friction that sticks and slips, vibration and inexact times widen the bound instead of looking like a hand. *Scatter* is
//! the part of the bound that the steps do not explain.

use nalgebra::{Matrix4, SMatrix, SVector, Vector4};

use super::observer::ObserverHistory;

/// Fewest samples on each side of a fit's parameters. A parabola has three parameters, a kink four; fewer samples would
/// leave no residual to judge the fit by.
const MIN_SAMPLES: usize = 5;
/// Deviations of the residuals that count. Exceeded in 0.3 % of the windows by noise alone; the duration that every
/// finding needs excludes the rest.
const DEVIATIONS: f64 = 3.0;
/// Half a tick's tolerance in the length of a window, s: times are rounded.
const TOLERANCE_S: f64 = 1e-4;

/// Hand force over the last milliseconds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parabola<const D: usize> {
    /// Force of the hand on the handle, N.
    pub(super) hand_n: SVector<f64, D>,
    /// Bound on the error of the force, N.
    pub(super) error_n: f64,
    /// Part of the error that the steps of the reading do not explain, N.
    pub(super) scatter_n: f64,
    /// Velocity at the newest sample, m/s.
    pub(super) velocity_m_s: SVector<f64, D>,
    /// Mean applied force, N.
    pub(super) applied_n: SVector<f64, D>,
    /// Length of the window, s.
    pub(super) span_s: f64,
}

/// A hand force that stepped once.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kink<const D: usize> {
    /// Force of the hand before and after the step, N.
    pub(super) before_n: SVector<f64, D>,
    pub(super) after_n: SVector<f64, D>,
    /// Bounds on the errors of the force after the step, and of the step, N.
    pub(super) after_error_n: f64,
    pub(super) step_error_n: f64,
    /// Part of the error of the step that steps of the reading do not explain, N.
    pub(super) scatter_n: f64,
    /// Mean applied force before and after the step, N.
    pub(super) applied_before_n: SVector<f64, D>,
    pub(super) applied_after_n: SVector<f64, D>,
    /// Velocity at the newest sample, m/s.
    pub(super) velocity_m_s: SVector<f64, D>,
    /// Time since the step, and total length of both windows, s.
    pub(super) after_s: f64,
    pub(super) span_s: f64,
}

/// Bounds on the error of a parameter.
struct ErrorBound {
    all: f64,
    /// Part that steps of the reading do not explain.
    scatter: f64,
}

impl ErrorBound {
    /// Computes the error from the bound by reading steps, the deviation of the residuals, the timing error of each
    /// sample, and the deviation of the parameter for samples of deviation 1.
    fn of(steps: f64, residual: f64, off: f64, deviation: f64) -> Self {
        let left = DEVIATIONS * residual * deviation;
        // Below the bound of the reading's steps, the residual is rounding and not motion.
        let scatter = (off * deviation).max(if left > steps { left } else { 0.0 });
        Self { all: steps.max(scatter), scatter }
    }
}

impl<const D: usize> ObserverHistory<D> {
    /// Returns the last sample of a window of at least `span_s` (s) and [`MIN_SAMPLES`] samples that starts at `from`.
    fn window(&self, from: usize, span_s: f64) -> Option<usize> {
        let at_least = from + MIN_SAMPLES - 1;
        let begin_s = *self.t_s.get(from)?;
        // Times count backwards from now, hence older samples are smaller.
        (at_least..self.count).find(|k| begin_s - self.t_s[*k] >= span_s - TOLERANCE_S)
    }

    /// Returns the mean force applied between two samples, N.
    fn mean_n(&self, old: usize, new: usize) -> SVector<f64, D> {
        (self.impulse_n_s[old] - self.impulse_n_s[new]) / (self.t_s[new] - self.t_s[old])
    }

    /// Returns the error of each `y` due to inexact times, at the root mean square speed from this sample on, kg m.
    fn off_kg_m(&self, old: usize) -> f64 {
        let between =
            |k: usize| (self.from_now_m[k] - self.from_now_m[k + 1]).norm_squared() / (self.t_s[k] - self.t_s[k + 1]);
        // Root mean square, because the errors of a fit add as squares.
        let speed_m_s = ((0..old).map(between).sum::<f64>() / -self.t_s[old]).sqrt();
        self.handle.mass_kg * speed_m_s * self.inexact_s
    }

    /// Fits one parabola to the last `span_s` (s).
    pub(super) fn parabola(&self, span_s: f64) -> Option<Parabola<D>> {
        let end = self.window(0, span_s)?;
        let n = (end + 1) as f64;
        let mean_s = self.t_s[..=end].iter().sum::<f64>() / n;
        let mean_y = self.y[..=end].iter().sum::<SVector<f64, D>>() / n;
        let centred = |k: usize| self.t_s[k] - mean_s;
        let squares = (0..=end).map(|k| centred(k) * centred(k)).sum::<f64>();
        let cubes = (0..=end).map(|k| centred(k) * centred(k) * centred(k)).sum::<f64>();
        // Orthogonal to 1 and t over these samples, whether or not they are evenly spaced.
        let square = |k: usize| centred(k) * (centred(k) - cubes / squares) - squares / n;
        // With orthogonal functions each parameter has its own sum, and no system of equations has to be solved in
        // every tick.
        let norm = (0..=end).map(|k| square(k) * square(k)).sum::<f64>();
        let slope = (0..=end).map(|k| self.y[k] * centred(k)).sum::<SVector<f64, D>>() / squares;
        let bend = (0..=end).map(|k| self.y[k] * square(k)).sum::<SVector<f64, D>>() / norm;
        let weights = (0..=end).map(|k| square(k).abs()).sum::<f64>() / norm;
        let left = |k: usize| (self.y[k] - mean_y - slope * centred(k) - bend * square(k)).norm_squared();
        // Three parameters are fitted, so three degrees of freedom are lost.
        let residual = ((0..=end).map(left).sum::<f64>() / (n - 3.0)).sqrt();
        // A reading is at most half a step off; all errors in the worst sign.
        let worst = 0.5 * self.handle.mass_kg * self.handle.step_m * weights;
        // y' = m v + c (x - x_now) + the impulse until now; the last two terms are zero at the newest sample.
        let velocity_m_s = (slope + bend * (2.0 * centred(0) - cubes / squares)) / self.handle.mass_kg;
        let error = ErrorBound::of(worst, residual, self.off_kg_m(end), 1.0 / norm.sqrt());
        let fit = Parabola {
            hand_n: bend * 2.0,
            // Twice: the force is twice the bend of the parabola (y = F t^2 / 2).
            error_n: 2.0 * error.all,
            scatter_n: 2.0 * error.scatter,
            velocity_m_s,
            applied_n: self.mean_n(end, 0),
            span_s: -self.t_s[end],
        };
        // Samples at equal times make the sums zero; the quotients are then NaN.
        fit.error_n.is_finite().then_some(fit)
    }

    /// Fits a parabola whose curvature changed in a step `after_s` (s) ago and that reaches `before_s` (s) farther
    /// back.
    pub(super) fn kink(&self, before_s: f64, after_s: f64) -> Option<Kink<D>> {
        let at = self.window(0, after_s)?;
        let end = self.window(at, before_s)?;
        let span_s = -self.t_s[end];
        // In units of the span, to keep the equations well conditioned.
        let row = |k: usize| {
            let u = self.t_s[k] / span_s;
            let after = (self.t_s[k] - self.t_s[at]).max(0.0) / span_s;
            Vector4::new(1.0, u, 0.5 * u * u, 0.5 * after * after)
        };
        let normal = (0..=end).map(|k| row(k) * row(k).transpose()).sum::<Matrix4<f64>>();
        let right = (0..=end).map(|k| row(k) * self.y[k].transpose()).sum::<SMatrix<f64, 4, D>>();
        // The inverse itself is needed, because it contains the weights of the errors.
        // `None` if the samples are at equal times: there is no parabola through them.
        let inverse = normal.try_inverse()?;
        let solved = inverse * right;
        let left = |k: usize| (self.y[k] - solved.transpose() * row(k)).norm_squared();
        let residual = ((0..=end).map(left).sum::<f64>() / (end as f64 - 3.0)).sqrt();
        let half_step = 0.5 * self.handle.mass_kg * self.handle.step_m;
        let off = self.off_kg_m(end);
        // Error of a sum of the four parameters.
        let error = |sum: Vector4<f64>| {
            let weights = (0..=end).map(|k| (inverse * row(k)).dot(&sum).abs()).sum::<f64>();
            let deviation = sum.dot(&(inverse * sum)).max(0.0).sqrt();
            ErrorBound::of(half_step * weights, residual, off, deviation)
        };
        // After the step the curvature is the sum of the third and fourth parameter; the step is the fourth alone.
        let [after, step] = [Vector4::new(0.0, 0.0, 1.0, 1.0), Vector4::w()].map(error);
        let before_n: SVector<f64, D> = solved.row(2).transpose() / (span_s * span_s);
        let step_n: SVector<f64, D> = solved.row(3).transpose() / (span_s * span_s);
        // The slope at the newest sample: the kink added curvature from its own time on.
        let slope: SVector<f64, D> = (solved.row(1) - solved.row(3) * (self.t_s[at] / span_s)).transpose() / span_s;
        let fit = Kink {
            before_n,
            after_n: before_n + step_n,
            after_error_n: after.all / (span_s * span_s),
            step_error_n: step.all / (span_s * span_s),
            scatter_n: step.scatter / (span_s * span_s),
            applied_before_n: self.mean_n(end, at),
            applied_after_n: self.mean_n(at, 0),
            velocity_m_s: slope / self.handle.mass_kg,
            after_s: -self.t_s[at],
            span_s,
        };
        (fit.after_error_n.is_finite() && fit.step_error_n.is_finite()).then_some(fit)
    }
}
