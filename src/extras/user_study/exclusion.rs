//! Rules for excluding trials and participants, set before the first trial.

use serde::{Deserialize, Serialize};

use crate::{ParticipantProgress, StudyPlan, StudyState};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExclusionRule {
    /// The measure to which it applies.
    pub measure: String,
    /// Comparison at which it applies.
    pub is: MeasureComparison,
    /// Limit of the measure, in its unit; not for `missing`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit: Option<f64>,
    /// The trial or the participant.
    pub exclude: Excludes,
    /// Number of such trials from which a participant is excluded; only for participants.
    #[serde(default = "once", skip_serializing_if = "is_once")]
    pub times: u32,
}

/// Comparison of a measure with a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MeasureComparison {
    /// The measure is greater than the limit.
    Above,
    /// The measure is less than the limit.
    Below,
    /// The measure has no value.
    Missing,
}

/// Scope of a rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Excludes {
    /// Excludes this trial.
    Trial,
    /// All trials of the participant.
    Participant,
}

/// An exclusion from the analysis, with its reason.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Exclusion {
    pub participant: String,
    /// Number of the trial; `None` for all trials.
    pub trial: Option<u32>,
    /// The rule as text, or the reason given by a person.
    pub why: String,
}

const fn once() -> u32 {
    1
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for a reference")]
const fn is_once(times: &u32) -> bool {
    *times == 1
}

impl ExclusionRule {
    pub(crate) fn mistakes(&self) -> Vec<String> {
        let Self { is, limit, exclude, times, .. } = self;
        let mut wrong = Vec::new();
        match (is, limit) {
            (MeasureComparison::Missing, Some(_)) => {
                wrong.push("is = \"missing\" takes no limit: remove it".to_owned());
            }
            (MeasureComparison::Above | MeasureComparison::Below, None) => wrong.push("limit is missing".to_owned()),
            (_, Some(limit)) if !limit.is_finite() => wrong.push("limit must be a number".to_owned()),
            _ => {}
        }
        if *times == 0 || (*times > 1 && *exclude == Excludes::Trial) {
            wrong.push("times must be at least 1, and more than 1 only with exclude = \"participant\"".to_owned());
        }
        wrong
    }

    fn applies(&self, value: Option<f64>) -> bool {
        match (self.is, value, self.limit) {
            (MeasureComparison::Above, Some(value), Some(limit)) => value > limit,
            (MeasureComparison::Below, Some(value), Some(limit)) => value < limit,
            (MeasureComparison::Missing, value, _) => value.is_none(),
            _ => false,
        }
    }

    /// Returns the rule as text.
    fn as_text(&self) -> String {
        let Self { measure, is, limit, times, .. } = self;
        let limit = limit.map_or_else(String::new, |limit| limit.to_string());
        let what = match is {
            MeasureComparison::Above => format!("{measure} above {limit}"),
            MeasureComparison::Below => format!("{measure} below {limit}"),
            MeasureComparison::Missing => format!("{measure} missing"),
        };
        if *times > 1 { format!("{what} in {times} trials or more") } else { what }
    }
}

/// Returns the exclusions by rules and by people, in the order of participants and trials.
pub(crate) fn exclusions(plan: &StudyPlan, state: &StudyState) -> Vec<Exclusion> {
    let mut all = Vec::new();
    for (participant, progress) in state.participants() {
        let of = |trial: Option<u32>, why: String| Exclusion { participant: participant.to_owned(), trial, why };
        all.extend(progress.excluded.iter().map(|why| of(None, why.clone())));
        for rule in &plan.exclusion {
            let met: Vec<u32> =
                made(progress).filter(|(_, values)| rule.applies(values(&rule.measure))).map(|m| m.0).collect();
            match rule.exclude {
                Excludes::Trial => all.extend(met.iter().map(|trial| of(Some(*trial), rule.as_text()))),
                Excludes::Participant if met.len() >= rule.times as usize => all.push(of(None, rule.as_text())),
                Excludes::Participant => {}
            }
        }
        all.extend(progress.excluded_trials.iter().map(|(trial, why)| of(Some(*trial), why.clone())));
    }
    all
}

/// Returns the trials with a result, and their measures.
fn made(progress: &ParticipantProgress) -> impl Iterator<Item = (u32, impl Fn(&str) -> Option<f64>)> {
    progress.trials.iter().filter_map(|made| {
        let measures = made.measures.as_ref()?;
        Some((made.number, |key: &str| measures.get(key).copied()))
    })
}
