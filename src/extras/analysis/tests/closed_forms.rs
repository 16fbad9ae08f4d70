//! Results that can be computed by hand.

use super::{near, wilcoxon};
use crate::mixed::{MixedCriterion, MixedFit, MixedModel};
use crate::signed_rank::{self, Distribution, SignedRankOptions, Zeros};
use crate::{Bootstrap, SampleSummary, correction, effect, friedman, mann_whitney, t_test};

/// Responses of six participants under three conditions, once each.
const TABLE: [[f64; 3]; 6] =
    [[8.1, 6.9, 5.2], [9.4, 8.8, 7.7], [6.2, 6.6, 4.1], [7.7, 5.9, 5.5], [10.3, 9.1, 7.2], [8.8, 8.2, 8.0]];

fn balanced(conditions: usize, criterion: MixedCriterion) -> MixedFit {
    let cells = (0..6).flat_map(|participant| (0..conditions).map(move |condition| (participant, condition)));
    let participant: Vec<String> = cells.clone().map(|(participant, _)| participant.to_string()).collect();
    let condition: Vec<String> = cells.clone().map(|(_, condition)| condition.to_string()).collect();
    let response: Vec<f64> = cells.map(|(participant, condition)| TABLE[participant][condition]).collect();
    MixedModel::new(&participant, &condition, "0", &response).unwrap().fit(criterion, 0.95).unwrap()
}

fn mean(values: impl Iterator<Item = f64> + Clone) -> f64 {
    values.clone().sum::<f64>() / values.count() as f64
}

#[test]
fn a_balanced_mixed_model_is_the_analysis_of_variance() {
    let fit = balanced(3, MixedCriterion::Reml);
    let column = |condition: usize| mean(TABLE.iter().map(move |row| row[condition]));
    let grand = mean((0..3).map(column));
    let of_conditions = 6.0 * (0..3).map(|condition| (column(condition) - grand).powi(2)).sum::<f64>() / 2.0;
    let rows = TABLE.map(|row| mean(row.into_iter()));
    let of_participants = 3.0 * rows.iter().map(|row| (row - grand).powi(2)).sum::<f64>() / 5.0;
    let error = |row: usize, condition: usize| (TABLE[row][condition] - rows[row] - column(condition) + grand).powi(2);
    let residual = (0..6).flat_map(|row| (0..3).map(move |condition| error(row, condition))).sum::<f64>() / 10.0;
    near(fit.residual_variance, residual, 1e-12);
    near(fit.participant_variance, (of_participants - residual) / 3.0, 1e-12);
    near(fit.icc, fit.participant_variance / (fit.participant_variance + residual), 1e-12);
    let joint = fit.conditions.unwrap();
    near(joint.f, of_conditions / residual, 1e-11);
    near(joint.denominator_df, 10.0, 1e-9);
    let effect = fit.effect("2").unwrap();
    near(effect.estimate, column(2) - column(0), 1e-12);
    near(effect.standard_error, (2.0 * residual / 6.0).sqrt(), 1e-12);
    near(effect.df, 10.0, 1e-9);
    let between = fit.between("2", "1").unwrap();
    near(between.estimate, column(2) - column(1), 1e-12);
    near(between.standard_error, effect.standard_error, 1e-12);
    assert_eq!(fit.between("2", "0").unwrap().estimate.to_bits(), effect.estimate.to_bits());
    // The predicted intercept of a participant is the deviation of its mean from the grand mean, shrunk.
    let shrink = 3.0 * fit.participant_variance / (3.0 * fit.participant_variance + residual);
    fit.intercepts.iter().zip(rows).for_each(|((_, intercept), row)| near(*intercept, shrink * (row - grand), 1e-11));
}

#[test]
fn a_mixed_model_of_two_conditions_is_the_paired_t_test() {
    let fit = balanced(2, MixedCriterion::Reml);
    let differences = TABLE.map(|row| row[1] - row[0]);
    let t = t_test::of_differences(&differences, 0.95).unwrap();
    let effect = fit.effect("1").unwrap();
    near(effect.t, t.t, 1e-11);
    near(effect.p, t.p, 1e-10);
    near(effect.interval.lower, t.interval.lower, 1e-10);
    near(fit.conditions.unwrap().f, t.t * t.t, 1e-11);
}

#[test]
fn likelihood_takes_balanced_variances_by_the_share_of_participants() {
    // For a balanced design, ML divides both sums of squares by one more participant than REML.
    let reml = balanced(3, MixedCriterion::Reml);
    let ml = balanced(3, MixedCriterion::Ml);
    near(ml.residual_variance, reml.residual_variance * 5.0 / 6.0, 1e-11);
    let whole = |fit: &MixedFit| 3.0 * fit.participant_variance + fit.residual_variance;
    near(whole(&ml), whole(&reml) * 5.0 / 6.0, 1e-11);
}

#[test]
fn participants_that_are_no_more_alike_than_others_have_no_variance() {
    // Both participants have the same mean, so the variance between them would be negative: ordinary least squares.
    let participant = ["a", "a", "a", "a", "b", "b", "b", "b"];
    let condition = ["x", "y", "x", "y", "x", "y", "x", "y"];
    let fit = MixedModel::new(&participant, &condition, "x", &[1.0, 4.0, 3.0, 2.0, 2.0, 3.0, 2.0, 3.0])
        .unwrap()
        .fit(MixedCriterion::Reml, 0.95)
        .unwrap();
    assert!(fit.participant_variance.abs() < 1e-300 && fit.icc.abs() < 1e-300);
    near(fit.effects[1].df, 6.0, 1e-12);
    near(fit.effects[1].estimate, 1.0, 1e-12);
    near(fit.residual_variance, 4.0 / 6.0, 1e-12);
}

#[test]
fn a_covariate_with_a_large_mean_costs_no_digits() {
    let cells = || (0..6_u32).flat_map(|participant| (0..3_u32).map(move |condition| (participant, condition)));
    let participant: Vec<String> = cells().map(|(participant, _)| participant.to_string()).collect();
    let condition: Vec<String> = cells().map(|(_, condition)| condition.to_string()).collect();
    let response: Vec<f64> = TABLE.concat();
    let fit = |offset: f64| {
        let trial: Vec<f64> = cells()
            .map(|(participant, condition)| offset + f64::from((participant * 5 + condition * 7) % 11))
            .collect();
        MixedModel::new(&participant, &condition, "0", &response)
            .unwrap()
            .covariate("trial", &trial)
            .unwrap()
            .fit(MixedCriterion::Reml, 0.95)
            .unwrap()
    };
    let near_zero = fit(0.0);
    let far = fit(1e6);
    near(far.effects[3].estimate, near_zero.effects[3].estimate, 1e-8);
    near(far.effects[3].p, near_zero.effects[3].p, 1e-8);
    near(far.effects[2].df, near_zero.effects[2].df, 1e-8);
}

#[test]
fn five_differences_of_one_sign_have_a_p_of_one_sixteenth() {
    near(wilcoxon(&[0.3, 1.2, 0.7, 2.0, 0.1]).unwrap().p, 1.0 / 16.0, 1e-15);
    // The same with ties: only all-positive and all-negative samples are as extreme.
    near(wilcoxon(&[0.5, 0.5, 0.5, 1.0, 1.0]).unwrap().p, 1.0 / 16.0, 1e-15);
}

#[test]
fn pratts_rule_lets_zeros_take_the_low_ranks() {
    let pratt = SignedRankOptions { zeros: Zeros::Pratt, distribution: Distribution::Automatic };
    let test = signed_rank::of_differences(&[0.0, -0.0, -1.0, 2.0, 3.0], &pratt).unwrap();
    // Ranks 3, 4, 5: of the eight combinations, four have sums of at most 3 or at least 9: 0, 3, 9, 12.
    assert_eq!(
        (test.n, test.zeros, test.w_plus.to_bits(), test.w_minus.to_bits()),
        (3, 2, 9_f64.to_bits(), 3_f64.to_bits())
    );
    near(test.p, 0.5, 1e-15);
}

#[test]
fn the_exact_interval_tells_the_confidence_that_it_has() {
    // For five differences the widest interval covers 1 - 2/32, which is less than 95 %.
    let interval = signed_rank::location(&[1.0, 2.0, 4.0, 8.0, 16.0], 0.95).unwrap().interval;
    assert!((interval.lower - 1.0).abs() + (interval.upper - 16.0).abs() < 1e-15);
    near(interval.confidence, 1.0 - 2.0 / 32.0, 1e-15);
}

#[test]
fn separate_groups_have_the_least_p_there_is() {
    // 2 of the 20 ways to choose three of six.
    let test = mann_whitney::test(&[4.0, 5.0, 6.0], &[1.0, 2.0, 3.0], Distribution::Automatic).unwrap();
    near(test.p, 0.1, 1e-14);
    near(test.u, 9.0, 1e-15);
    near(mann_whitney::shift(&[4.0, 5.0, 6.0], &[1.0, 2.0, 3.0], 0.95).unwrap().estimate, 3.0, 1e-15);
}

#[test]
fn participants_who_agree_have_the_probability_of_chance() {
    let test = friedman::test(&[[1.0, 2.0, 3.0], [0.0, 5.0, 9.0], [2.0, 3.0, 7.0], [1.0, 4.0, 6.0]]).unwrap();
    assert_eq!(test.f, None);
    near(test.w, 1.0, 1e-14);
    near(test.f_p, 1.0 / 216.0, 1e-14);
}

#[test]
fn effect_sizes_at_their_ends() {
    near(effect::rank_biserial(&[1.0, 2.0, 3.0]).unwrap(), 1.0, 1e-15);
    near(effect::rank_biserial(&[-3.0, 0.0, 1.0, 2.0]).unwrap(), 0.0, 1e-15);
    near(effect::cliffs_delta(&[3.0, 4.0], &[1.0, 2.0, 2.0]).unwrap(), 1.0, 1e-15);
    near(effect::vargha_delaney(&[1.0, 1.0], &[1.0]).unwrap(), 0.5, 1e-15);
    // J of two degrees of freedom: 1 / sqrt(pi).
    near(effect::cohens_dz(&[1.0, 2.0, 3.0]).unwrap().g, 2.0 / std::f64::consts::PI.sqrt(), 1e-13);
}

#[test]
fn holm_keeps_the_order_of_the_p_values() {
    assert_eq!(correction::holm(&[0.5, 0.01, 0.9]).unwrap(), [1.0, 0.03, 1.0]);
    assert_eq!(correction::bonferroni(&[0.5, 0.25]).unwrap(), [1.0, 0.5]);
}

#[test]
fn a_summary_has_what_it_says() {
    let summary = SampleSummary::of(&[4.0, 1.0, 3.0, 2.0]).unwrap();
    assert_eq!((summary.n, summary.quartiles, summary.extremes), (4, [1.75, 3.25], [1.0, 4.0]));
    near(summary.median, 2.5, 1e-15);
    near(summary.sd.unwrap(), (5.0_f64 / 3.0).sqrt(), 1e-15);
    assert_eq!(SampleSummary::of(&[4.0]).unwrap().sd, None);
}

#[test]
fn a_sample_of_equal_values_has_an_interval_without_width() {
    let interval = Bootstrap::default().median(&[2.0; 6]).unwrap();
    assert!((interval.lower - 2.0).abs() + (interval.upper - 2.0).abs() < 1e-15);
}
