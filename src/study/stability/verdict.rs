//! Comparison of the figures with their targets.

use serde::Serialize;

use super::{Drift, Entry, Extreme, ORDINARY_CONDITION, Solver, TARGET};

/// The targets, and how often each solver fails.
#[derive(Clone, Debug, Serialize)]
pub struct Verdict {
    /// Whether this project's solver reaches all targets.
    pub reached: bool,
    /// Share of its predictions that are finite.
    pub ours_finite_share: f64,
    /// Whether the whole identifier stayed finite in every case.
    pub identifier_finite: bool,
    /// Its worst relative error where the scaled condition is below 1e6.
    pub ours_worst_error: f64,
    /// Its worst relative error in any case.
    pub ours_worst_error_anywhere: f64,
    /// Its largest scaled condition.
    pub ours_worst_condition: f64,
    /// Its worst difference between metres and millimetres where the scaled condition is below 1e6.
    pub ours_unit_difference: f64,
    /// The pseudo-inverse's worst difference between metres and millimetres.
    pub pseudo_inverse_unit_difference: f64,
    /// How often each solver gives no prediction or a wrong one.
    pub failures: Vec<Failures>,
}

/// Failures of one solver.
#[derive(Clone, Debug, Serialize)]
pub struct Failures {
    /// The solver.
    pub solver: Solver,
    /// Number of cases and degrees tried.
    pub tried: usize,
    /// Of these, with a prediction that is not finite.
    pub not_finite: usize,
    /// Of these, all finite, but with an error above 1 % of the force.
    pub wrong: usize,
}

impl Verdict {
    pub(super) fn of(extremes: &[Extreme], drift: &Drift) -> Self {
        let all = || extremes.iter().flat_map(|extreme| &extreme.entries);
        let ours = || all().filter(|entry| entry.solver == Solver::Sliding);
        let ordinary = || ours().filter(|entry| entry.condition.is_some_and(|c| c < ORDINARY_CONDITION));
        let most = |values: &mut dyn Iterator<Item = Option<f64>>| values.flatten().fold(0.0, f64::max);
        let (asked, finite) = ours().fold((0, 0), |(a, f), entry| (a + entry.asked, f + entry.finite));
        let failures = Solver::ALL.map(|solver| {
            let of = || all().filter(|entry| entry.solver == solver);
            let wrong = |entry: &&Entry| entry.finite == entry.asked && entry.error.is_none_or(|error| error > 0.01);
            Failures {
                solver,
                tried: of().count(),
                not_finite: of().filter(|entry| entry.finite < entry.asked).count(),
                wrong: of().filter(wrong).count(),
            }
        });
        let mut verdict = Self {
            reached: false,
            ours_finite_share: finite as f64 / asked.max(1) as f64,
            identifier_finite: extremes.iter().all(|extreme| extreme.identifier_finite),
            ours_worst_error: most(&mut ordinary().map(|entry| entry.error)),
            ours_worst_error_anywhere: most(&mut ours().map(|entry| entry.error)),
            ours_worst_condition: most(&mut ours().map(|entry| entry.condition)),
            ours_unit_difference: most(&mut ordinary().map(|entry| entry.unit_difference)),
            pseudo_inverse_unit_difference: most(
                &mut all().filter(|e| e.solver == Solver::PseudoInverse).map(|e| e.unit_difference),
            ),
            failures: failures.to_vec(),
        };
        verdict.reached = asked == finite
            && verdict.identifier_finite
            && verdict.ours_worst_error <= TARGET
            && verdict.ours_unit_difference <= TARGET
            && drift.ours_late <= drift.ours_early;
        verdict
    }
}
