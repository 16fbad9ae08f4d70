//! Comparison of the results with their targets.

use nima_core::impedance::Mode;
use serde::Serialize;

use super::{
    Endurance, LeastSquaresSolver, ORDINARY_CONDITION, StabilityDrift, StabilityEntry, StabilityExtreme, TARGET,
};

/// The targets, and the failures of each solver.
#[derive(Clone, Debug, Serialize)]
pub struct StabilityVerdict {
    /// Whether this project's solver and the mode *matched* reach all targets.
    pub reached: bool,
    /// Fraction of the solver's predictions that are finite.
    #[serde(rename = "ours_finite_share")]
    pub ours_finite_fraction: f64,
    /// Whether the whole identifier stayed finite in every case.
    pub identifier_finite: bool,
    /// Worst relative error where the scaled condition number is below 1e6.
    pub ours_worst_error: f64,
    /// Worst relative error in any case.
    pub ours_worst_error_anywhere: f64,
    /// Largest scaled condition number.
    pub ours_worst_condition: f64,
    /// Worst difference between metres and millimetres where the scaled condition number is below 1e6.
    pub ours_unit_difference: f64,
    /// The pseudo-inverse's worst difference between metres and millimetres.
    pub pseudo_inverse_unit_difference: f64,
    /// The modes that send only parameters.
    pub renderings: Vec<RenderingVerdict>,
    /// Number of missing and wrong predictions of each solver.
    pub failures: Vec<Failures>,
}

/// One of the modes that send only parameters.
#[derive(Clone, Debug, Serialize)]
pub struct RenderingVerdict {
    pub mode: Mode,
    /// Whether it reaches the targets.
    pub reached: bool,
    /// Fraction of its forces that are finite, in every case and in the long run.
    #[serde(rename = "finite_share")]
    pub finite_fraction: f64,
    /// Worst difference between metres and millimetres, and the case in which it occurs.
    pub unit_difference: f64,
    /// See `unit_difference`.
    pub worst_case: String,
    /// Difference between a long run and a fresh one; `None` if the run was too short.
    pub long_run_difference: Option<f64>,
}

impl RenderingVerdict {
    fn of(extremes: &[StabilityExtreme], run: &Endurance) -> Self {
        let mut asked = run.ticks;
        let mut finite = run.ticks - run.not_finite;
        let mut unit_difference = 0.0;
        let mut worst_case = String::new();
        for extreme in extremes {
            for rendering in extreme.renderings.iter().filter(|rendering| rendering.mode == run.mode) {
                asked += rendering.asked as u64;
                finite += rendering.finite as u64;
                if let Some(difference) = rendering.unit_difference.filter(|difference| *difference > unit_difference) {
                    unit_difference = difference;
                    worst_case.clone_from(&extreme.name);
                }
            }
        }
        let reached = finite == asked
            && unit_difference <= TARGET
            && run.difference.is_none_or(|difference| difference <= TARGET);
        let finite_fraction = finite as f64 / asked.max(1) as f64;
        Self {
            mode: run.mode,
            reached,
            finite_fraction,
            unit_difference,
            worst_case,
            long_run_difference: run.difference,
        }
    }
}

#[derive(Clone, Debug, Serialize)]
pub struct Failures {
    pub solver: LeastSquaresSolver,
    /// Number of cases and degrees tested.
    pub tried: usize,
    /// Among these, cases with a prediction that is not finite.
    pub not_finite: usize,
    /// Among these, cases that are finite but with an error above 1 % of the force.
    pub wrong: usize,
}

impl StabilityVerdict {
    pub(super) fn of(extremes: &[StabilityExtreme], drift: &StabilityDrift, endurance: &[Endurance]) -> Self {
        let all = || extremes.iter().flat_map(|extreme| &extreme.entries);
        let ours = || all().filter(|entry| entry.solver == LeastSquaresSolver::Sliding);
        let ordinary = || ours().filter(|entry| entry.condition.is_some_and(|c| c < ORDINARY_CONDITION));
        let max = |values: &mut dyn Iterator<Item = Option<f64>>| values.flatten().fold(0.0, f64::max);
        let (asked, finite) = ours().fold((0, 0), |(a, f), entry| (a + entry.asked, f + entry.finite));
        let failures = LeastSquaresSolver::ALL.map(|solver| {
            let of = || all().filter(|entry| entry.solver == solver);
            let wrong =
                |entry: &&StabilityEntry| entry.finite == entry.asked && entry.error.is_none_or(|error| error > 0.01);
            Failures {
                solver,
                tried: of().count(),
                not_finite: of().filter(|entry| entry.finite < entry.asked).count(),
                wrong: of().filter(wrong).count(),
            }
        });
        let mut verdict = Self {
            reached: false,
            ours_finite_fraction: finite as f64 / asked.max(1) as f64,
            identifier_finite: extremes.iter().all(|extreme| extreme.identifier_finite),
            ours_worst_error: max(&mut ordinary().map(|entry| entry.error)),
            ours_worst_error_anywhere: max(&mut ours().map(|entry| entry.error)),
            ours_worst_condition: max(&mut ours().map(|entry| entry.condition)),
            ours_unit_difference: max(&mut ordinary().map(|entry| entry.unit_difference)),
            pseudo_inverse_unit_difference: max(&mut all()
                .filter(|e| e.solver == LeastSquaresSolver::PseudoInverse)
                .map(|e| e.unit_difference)),
            renderings: endurance.iter().map(|run| RenderingVerdict::of(extremes, run)).collect(),
            failures: failures.to_vec(),
        };
        verdict.reached = asked == finite
            && verdict.identifier_finite
            && verdict.ours_worst_error <= TARGET
            && verdict.ours_unit_difference <= TARGET
            && drift.ours_late <= drift.ours_early
            && verdict.renderings.iter().all(|one| one.reached || one.mode != Mode::Matched);
        verdict
    }
}
