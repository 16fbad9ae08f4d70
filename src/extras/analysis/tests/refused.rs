//! Bad input gets one sentence, never a panic or NaN.

use super::wilcoxon;
use crate::mixed::{MixedCriterion, MixedFit, MixedModel};
use crate::power::{MinimumSample, MixedStudy, PairedTest, Population, PowerSimulation};
use crate::signed_rank::{self, Distribution, SignedRankOptions};
use crate::{AnalysisError, Bootstrap, SampleSummary, correction, effect, friedman, mann_whitney, summary, t_test};

#[track_caller]
fn says<T: std::fmt::Debug>(result: Result<T, AnalysisError>, expected: &str) {
    assert_eq!(result.unwrap_err().to_string(), expected);
}

const NONE: [f64; 0] = [];

#[test]
fn values_that_are_no_numbers_are_named() {
    let bad = [1.0, 2.5, f64::NAN, 4.0];
    let sentence =
        |what: &str| format!("value 3 of {what} is not a usable number (finite, and smaller than 1e150); correct it");
    says(SampleSummary::of(&bad), &sentence("the sample"));
    says(Bootstrap::default().mean(&bad), &sentence("the sample"));
    says(wilcoxon(&bad), &sentence("differences"));
    says(signed_rank::location(&bad, 0.95), &sentence("differences"));
    says(signed_rank::paired(&[1.0; 4], &bad, &SignedRankOptions::default()), &sentence("the second values"));
    says(mann_whitney::test(&bad, &bad, Distribution::Automatic), &sentence("values of the first group"));
    says(friedman::test(&[[1.0, 2.0, 3.0], [1.0, 2.0, f64::INFINITY]]), &sentence("the row of participant 2"));
    says(effect::cohens_dz(&bad), &sentence("differences"));
    says(t_test::of_differences(&bad, 0.95), &sentence("differences"));
    says(Population::from_pilot(&bad), &sentence("differences of the pilot"));
    says(summary::mean(&[0.0, 0.0, 1e200]), &sentence("the sample"));
}

#[test]
fn too_few_values_are_counted() {
    says(SampleSummary::of(&NONE), "the sample: 0 are too few; provide at least 1");
    says(Bootstrap::default().median(&[1.0]), "the sample: 1 are too few; provide at least 2");
    says(wilcoxon(&NONE), "differences: 0 are too few; provide at least 1");
    says(friedman::test(&[[1.0, 2.0]]), "participants: 1 are too few; provide at least 2");
    says(effect::cohens_d(&[1.0], &[1.0, 2.0]), "values of the first group: 1 are too few; provide at least 2");
    says(correction::holm(&NONE), "p-values: 0 are too few; provide at least 1");
    let many = vec![1.0; 51];
    let exact = SignedRankOptions { distribution: Distribution::Exact, ..SignedRankOptions::default() };
    says(
        signed_rank::of_differences(&many, &exact),
        "differences for an exact test: 51 are too many; provide at most 50",
    );
    says(signed_rank::location(&[1.0; 2001], 0.9), "differences: 2001 are too many; provide at most 2000");
}

#[test]
fn lengths_that_differ_are_told() {
    says(
        t_test::paired(&[1.0, 2.0], &[1.0], 0.95),
        "the second values and the first ones differ in number: 1 instead of 2; provide the same number of both",
    );
    let rows = [vec![1.0, 2.0], vec![1.0]];
    says(
        friedman::test(&rows),
        "the values in the row of participant 2 and the conditions differ in number: 1 instead of 2; provide the same number of both",
    );
}

#[test]
fn what_does_not_vary_cannot_be_judged() {
    let all = "are all the same, so there is no variation to judge by; provide values that differ";
    says(wilcoxon(&[0.0, -0.0, 0.0]), &format!("the two values of every participant {all}"));
    says(effect::rank_biserial(&[0.0]), &format!("the two values of every participant {all}"));
    says(mann_whitney::test(&[1.0, 1.0], &[1.0], Distribution::Normal), &format!("the values of both groups {all}"));
    says(friedman::test(&[[1.0; 3], [2.0; 3]]), &format!("the values of every participant {all}"));
    // Their mean is rounded, so their deviations from it might not be zero.
    says(t_test::of_differences(&[0.1; 7], 0.95), &format!("the differences {all}"));
    says(effect::cohens_dz(&[0.1; 7]), &format!("the differences {all}"));
    says(effect::cohens_d(&[0.1; 7], &[0.3; 3]), &format!("the values of each group {all}"));
}

#[test]
fn shares_outside_of_their_range_are_told() {
    says(summary::quantile(&[1.0], 1.5), "the level of a quantile must be from 0 to 1, not 1.5");
    says(summary::quantile(&[1.0], f64::NAN), "the level of a quantile must be from 0 to 1, not NaN");
    says(signed_rank::location(&[1.0], 95.0), "the confidence must be between 0 and 1, not 95");
    says(correction::holm(&[0.2, 1.2]), "a p-value must be from 0 to 1, not 1.2");
    says(
        PowerSimulation { level: 0.0, ..PowerSimulation::default() }.paired(
            &Population::Normal { sd: 1.0 },
            1.0,
            9,
            PairedTest::T,
        ),
        "the level of significance must be between 0 and 1, not 0",
    );
    says(
        PowerSimulation::default().paired(&Population::Normal { sd: -1.0 }, 1.0, 9, PairedTest::T),
        "the standard deviation must be a positive number, not -1",
    );
    let study = MixedStudy { effects: vec![1.0], trials: 1, participant_variance: -1.0, residual_variance: 1.0 };
    says(
        PowerSimulation::default().mixed(&study, 5),
        "the variance of the participants must be zero or a positive number, not -1",
    );
}

#[test]
fn a_power_that_is_not_reached_is_told() {
    let simulation = PowerSimulation { runs: 200, ..PowerSimulation::default() };
    let power = |n| simulation.paired(&Population::Normal { sd: 1.0 }, 0.0, n, PairedTest::T);
    let error = MinimumSample::of(0.9, 5, 20, power).unwrap_err();
    assert!(matches!(error, AnalysisError::NotReached { largest: 20, .. }), "{error}");
    says(MinimumSample::of(0.9, 5, 4, power), "the maximum number of participants: 4 are too few; provide at least 5");
}

fn fit(
    participant: &str,
    condition: &str,
    response: &[f64],
    covariate: Option<&[f64]>,
) -> Result<MixedFit, AnalysisError> {
    let letters = |text: &str| text.chars().map(String::from).collect::<Vec<_>>();
    let model = MixedModel::new(&letters(participant), &letters(condition), "x", response)?;
    match covariate {
        Some(values) => model.covariate("order", values)?,
        None => model,
    }
    .fit(MixedCriterion::Reml, 0.95)
}

#[test]
fn a_model_that_cannot_be_fitted_says_why() {
    let y = [1.0, 2.5, 2.0, 3.1, 0.4, 2.2];
    says(fit("aabbcc", "zyzyzy", &y, None), "there is no condition called 'x'");
    says(
        fit("aabbc", "xyxyx", &y, None),
        "the participants and the responses differ in number: 5 instead of 6; provide the same number of both",
    );
    says(fit("aaaaaa", "xyxyxy", &y, None), "participants: 1 are too few; provide at least 2");
    let nan = [1.0, f64::NAN, 2.0, 3.0, 0.0, 2.0];
    says(
        fit("aabbcc", "xyxyxy", &nan, None),
        "value 2 of responses is not a usable number (finite, and smaller than 1e150); correct it",
    );
    says(
        fit("aabbcc", "xyxyxy", &y, Some(&nan)),
        "value 2 of the covariate 'order' is not a usable number (finite, and smaller than 1e150); correct it",
    );
    // The order repeats the condition.
    says(
        fit("aabbcc", "xyxyxy", &y, Some(&[1.0, 2.0, 1.0, 2.0, 1.0, 2.0])),
        "the column 'order' is a combination of earlier columns, so its effect cannot be separated from theirs; leave it out",
    );
    says(
        fit("abcdef", "xyxyxy", &y, None),
        "the variances cannot be estimated: there are too few trials for the participants and the effects within them",
    );
    // The condition differs only between the two participants.
    says(
        fit("aaabbb", "xxxyyy", &y, None),
        "the variances cannot be estimated: there are too few participants for the effects that differ between them",
    );
    let without_rest =
        "the variances cannot be estimated: the fixed effects explain the responses exactly, without a residual";
    says(fit("aabbcc", "xyxyxy", &[1.0, 2.0, 1.0, 2.0, 1.0, 2.0], None), without_rest);
    says(fit("aabbcc", "xyxyxy", &[0.1; 6], None), without_rest);
    says(
        fit("aabbcc", "xyxyxy", &[1.0, 2.0, 3.0, 4.0, 7.0, 8.0], None),
        "the variances cannot be estimated: the trials of each participant differ only by the fixed effects",
    );
    let fit = fit("aabbcc", "xyxyxy", &y, None).unwrap();
    says(fit.between("x", "q"), "there is no condition called 'q'");
}
