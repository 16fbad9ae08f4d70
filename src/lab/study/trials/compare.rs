//! One measure under all conditions.

use std::collections::BTreeMap;

use nima_analysis::{
    AnalysisError, Bootstrap, SampleSummary, correction, effect, friedman,
    mann_whitney::{self},
    mixed::{MixedCriterion, MixedModel},
    power::{MinimumSample, PairedTest, Population, PowerSimulation},
    signed_rank::{self, Distribution, SignedRankOptions},
};

use super::{ConditionPair, OfCondition, OfMeasure, TrialDesign, TrialMixed, table::TrialTable};

/// Maximum number of participants considered when searching for a power.
const NEEDED_MAX: usize = 500;

type Means<'a> = BTreeMap<(&'a str, &'a str), (f64, usize)>;

pub(super) fn measure(
    table: &TrialTable,
    name: &str,
    reference: &str,
    confidence: f64,
    power: Option<f64>,
) -> Result<OfMeasure, AnalysisError> {
    let place = table.measures.iter().position(|known| known == name).unwrap_or(0);
    let means = table.means(place);
    let mut conditions: Vec<&str> = means.keys().map(|(_, condition)| *condition).collect();
    conditions.sort_unstable();
    conditions.dedup();
    let mut notes = Vec::new();
    let design = design(&means, &conditions);
    let rows = complete(&means, &conditions);
    let friedman = (design == TrialDesign::Within && conditions.len() > 2).then(|| friedman::test(&rows));
    let friedman = friedman.and_then(|test| or_note(test, "Friedman's test", &mut notes));
    let pairs = pairs(&means, &conditions, reference, design, confidence, power, &mut notes)?;
    let of = |condition: &&str| of_condition(&means, condition, confidence);
    Ok(OfMeasure {
        measure: name.to_owned(),
        missing: table.trials.len() - table.measured(place).count(),
        design,
        conditions: conditions.iter().map(of).collect::<Result<_, _>>()?,
        friedman,
        complete: rows.len(),
        pairs,
        mixed: mixed(table, place, &conditions, reference, confidence, &mut notes),
        notes,
    })
}

/// Returns the value, or adds a note that says why there is none.
fn or_note<T>(value: Result<T, AnalysisError>, what: &str, notes: &mut Vec<String>) -> Option<T> {
    value.map_err(|error| notes.push(format!("{what}: {error}"))).ok()
}

fn design(means: &Means<'_>, conditions: &[&str]) -> TrialDesign {
    let mut participants: Vec<&str> = means.keys().map(|(participant, _)| *participant).collect();
    let all = participants.len();
    // The keys are sorted, so the entries of a participant are adjacent.
    participants.dedup();
    match conditions.len() {
        0 | 1 => TrialDesign::Single,
        _ if participants.len() < all => TrialDesign::Within,
        _ => TrialDesign::Between,
    }
}

/// Returns the participants with data under every condition, one row each.
fn complete(means: &Means<'_>, conditions: &[&str]) -> Vec<Vec<f64>> {
    let mut participants: Vec<&str> = means.keys().map(|(participant, _)| *participant).collect();
    participants.dedup();
    let row =
        |participant: &str| conditions.iter().map(|condition| Some(means.get(&(participant, *condition))?.0)).collect();
    participants.into_iter().filter_map(row).collect()
}

fn values(means: &Means<'_>, condition: &str) -> Vec<f64> {
    means.iter().filter(|((_, of), _)| *of == condition).map(|(_, (mean, _))| *mean).collect()
}

fn of_condition(means: &Means<'_>, condition: &str, confidence: f64) -> Result<OfCondition, AnalysisError> {
    let values = values(means, condition);
    let SampleSummary { n, mean, sd, median, .. } = SampleSummary::of(&values)?;
    let trials = means.iter().filter(|((_, of), _)| *of == condition).map(|(_, (_, count))| count).sum();
    let bootstrap = Bootstrap { confidence, ..Bootstrap::default() };
    // There is no interval for too few values, or if all are equal.
    let interval = bootstrap.median(&values).ok();
    Ok(OfCondition { condition: condition.to_owned(), participants: n, trials, median, interval, mean, sd })
}

/// Compares every pair of conditions; the reference is the second of its pairs.
fn pairs(
    means: &Means<'_>,
    conditions: &[&str],
    reference: &str,
    design: TrialDesign,
    confidence: f64,
    power: Option<f64>,
    notes: &mut Vec<String>,
) -> Result<Vec<ConditionPair>, AnalysisError> {
    let mut order: Vec<&str> = conditions.to_vec();
    order.sort_by_key(|condition| *condition != reference);
    let mut pairs = Vec::new();
    for (at, second) in order.iter().enumerate() {
        for first in &order[at + 1..] {
            let pair = match design {
                TrialDesign::Within => within(means, first, second, confidence, power),
                TrialDesign::Between => between(means, first, second, confidence),
                TrialDesign::Single => continue,
            };
            pairs.extend(or_note(pair, &format!("{first} - {second}"), notes));
        }
    }
    let p: Vec<f64> = pairs.iter().map(|pair: &ConditionPair| pair.p).collect();
    if !p.is_empty() {
        for (pair, p_holm) in pairs.iter_mut().zip(correction::holm(&p)?) {
            pair.p_holm = p_holm;
        }
    }
    Ok(pairs)
}

/// Differences that are equal except for rounding are ties.
fn rounded(differences: Vec<f64>) -> Vec<f64> {
    let largest = differences.iter().fold(0.0, |max: f64, difference| max.max(difference.abs()));
    if largest <= 0.0 {
        return differences;
    }
    let unit = 10_f64.powi(largest.log10().floor() as i32 - 9);
    differences.into_iter().map(|difference| (difference / unit).round() * unit).collect()
}

fn within(
    means: &Means<'_>,
    first: &str,
    second: &str,
    confidence: f64,
    power: Option<f64>,
) -> Result<ConditionPair, AnalysisError> {
    let both = means.iter().filter(|((_, condition), _)| *condition == first);
    let differences =
        both.filter_map(|((participant, _), (mean, _))| Some(mean - means.get(&(*participant, second))?.0));
    let differences = rounded(differences.collect());
    let test = signed_rank::of_differences(&differences, &SignedRankOptions::default())?;
    let difference = signed_rank::location(&differences, confidence)?;
    let needed = power.and_then(|power| {
        let population = Population::from_pilot(&differences).ok()?;
        let simulation = PowerSimulation::default();
        let of = |n| simulation.paired(&population, difference.estimate, n, PairedTest::Wilcoxon);
        MinimumSample::of(power, 5, NEEDED_MAX, of).ok().map(|min| min.participants)
    });
    Ok(ConditionPair {
        first: first.to_owned(),
        second: second.to_owned(),
        participants: [differences.len(); 2],
        difference,
        p: test.p,
        exact: test.exact,
        p_holm: test.p,
        rank_effect: effect::rank_biserial(&differences)?,
        g: effect::cohens_dz(&differences).ok().map(|standardised| standardised.g),
        needed,
    })
}

fn between(means: &Means<'_>, first: &str, second: &str, confidence: f64) -> Result<ConditionPair, AnalysisError> {
    let one = values(means, first);
    let other = values(means, second);
    let test = mann_whitney::test(&one, &other, Distribution::Automatic)?;
    Ok(ConditionPair {
        first: first.to_owned(),
        second: second.to_owned(),
        participants: [one.len(), other.len()],
        difference: mann_whitney::shift(&one, &other, confidence)?,
        p: test.p,
        exact: test.exact,
        p_holm: test.p,
        rank_effect: effect::cliffs_delta(&one, &other)?,
        g: effect::cohens_d(&one, &other).ok().map(|standardised| standardised.g),
        needed: None,
    })
}

/// Analyses all trials, if participants have several or were under several conditions.
fn mixed(
    table: &TrialTable,
    place: usize,
    conditions: &[&str],
    reference: &str,
    confidence: f64,
    notes: &mut Vec<String>,
) -> Option<TrialMixed> {
    let trials: Vec<_> = table.measured(place).collect();
    let mut participants: Vec<&str> = trials.iter().map(|(trial, _)| trial.participant.as_str()).collect();
    participants.sort_unstable();
    participants.dedup();
    if conditions.len() < 2 || participants.len() == trials.len() {
        return None;
    }
    let column =
        |of: fn(&super::table::TableTrial) -> &str| trials.iter().map(|(trial, _)| of(trial)).collect::<Vec<_>>();
    let response: Vec<f64> = trials.iter().map(|(_, value)| *value).collect();
    let model =
        MixedModel::new(&column(|trial| &trial.participant), &column(|trial| &trial.condition), reference, &response);
    let numbers: Option<Vec<f64>> = trials.iter().map(|(trial, _)| trial.number).collect();
    let varies = |numbers: &Vec<f64>| numbers.windows(2).any(|two| two[0].total_cmp(&two[1]).is_ne());
    let model = model.and_then(|model| match numbers.filter(varies) {
        Some(numbers) => model.covariate("trial", &numbers),
        None => Ok(model),
    });
    let fit = model.and_then(|model| model.fit(MixedCriterion::Reml, confidence));
    let fit = or_note(fit, "mixed model", notes)?;
    let effects = fit.effects.iter().filter(|effect| effect.name != "(intercept)").cloned().collect();
    Some(TrialMixed { effects, conditions: fit.conditions, icc: fit.icc })
}
