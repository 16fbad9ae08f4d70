//! Tables for the analysis, as CSV: one row per trial, and for the questionnaires one row per participant and
//! condition.

use std::{collections::BTreeMap, fmt::Write as _};

use nima_files::csv_cell;

use crate::{
    Assignment, CountedTrial, Exclusion, Label, StudyPlan, StudyState, TrialMeasures, exclusion::exclusions,
    file::measure_keys,
};

/// A table, with its exclusions.
#[derive(Clone, Debug)]
pub struct StudyTable {
    /// The text of the file.
    pub csv: String,
    /// Number of rows, without the header.
    pub rows: usize,
    /// Exclusions by rules and by people.
    pub excluded: Vec<Exclusion>,
    /// Trials without a result.
    pub missing: Vec<(String, u32)>,
}

/// One row: participant, condition, number, whether it was simulated, and its values.
struct StudyTableRow<'a> {
    participant: &'a str,
    condition: String,
    number: Option<u32>,
    simulated: bool,
    values: TrialMeasures,
}

/// Returns the name of a condition if it may be shown, otherwise its label. Names contain no commas and no quotes.
fn shown(label: Label, opened: Option<&Assignment>) -> String {
    let named = opened.and_then(|opened| opened.condition(label));
    named.map_or_else(|| label.to_string(), |condition| condition.name.clone())
}

/// Returns the trials that count for the analysis. `withheld` returns the measures that reveal the condition, if they
/// may be shown.
pub(crate) fn trials(
    plan: &StudyPlan,
    state: &StudyState,
    opened: Option<&Assignment>,
    withheld: impl Fn(&str, &CountedTrial) -> Option<TrialMeasures>,
) -> StudyTable {
    let excluded = exclusions(plan, state);
    let mut rows = Vec::new();
    let mut missing = Vec::new();
    for (participant, progress) in state.participants() {
        for made in &progress.trials {
            let is_out =
                |one: &&Exclusion| one.participant == participant && one.trial.is_none_or(|trial| trial == made.number);
            let Some(measures) = &made.measures else {
                missing.push((participant.to_owned(), made.number));
                continue;
            };
            if excluded.iter().find(is_out).is_some() {
                continue;
            }
            let mut values = measures.clone();
            values.extend(opened.and_then(|_| withheld(participant, made)).unwrap_or_default());
            let condition = shown(made.label, opened);
            let number = Some(made.number);
            rows.push(StudyTableRow { participant, condition, number, simulated: made.simulated, values });
        }
    }
    StudyTable { csv: csv(&rows, &measure_keys().collect::<Vec<_>>()), rows: rows.len(), excluded, missing }
}

/// Returns the scores of the questionnaires after each condition.
pub(crate) fn questionnaires(plan: &StudyPlan, state: &StudyState, opened: Option<&Assignment>) -> StudyTable {
    let excluded: Vec<Exclusion> = exclusions(plan, state).into_iter().filter(|one| one.trial.is_none()).collect();
    let mut rows = Vec::new();
    for (participant, progress) in state.participants() {
        if excluded.iter().any(|one| one.participant == participant) {
            continue;
        }
        let mut given: BTreeMap<Label, StudyTableRow<'_>> = BTreeMap::new();
        for (after, answers, simulated) in &progress.answers {
            let Some(label) = after else { continue };
            let scores: Vec<_> = answers.scores();
            if scores.is_empty() {
                continue;
            }
            let empty = || StudyTableRow {
                participant,
                condition: shown(*label, opened),
                number: None,
                simulated: false,
                values: TrialMeasures::new(),
            };
            let row = given.entry(*label).or_insert_with(empty);
            row.simulated |= *simulated;
            row.values.extend(scores.into_iter().map(|(name, score)| (name.to_owned(), score)));
        }
        rows.extend(given.into_values());
    }
    let names = ["nasa_tlx_weighted", "nasa_tlx_raw", "sus", "realism"].map(str::to_owned);
    StudyTable { csv: csv(&rows, &names), rows: rows.len(), excluded, missing: Vec::new() }
}

/// Returns the table as CSV: columns in this order, then the others; only columns with a value.
fn csv(rows: &[StudyTableRow<'_>], order: &[String]) -> String {
    let place = |key: &str| order.iter().position(|known| known == key).unwrap_or(order.len());
    let mut columns: Vec<&String> = rows.iter().flat_map(|row| row.values.keys()).collect();
    columns.sort_by_key(|key| (place(key), (*key).clone()));
    columns.dedup();
    let numbered = rows.iter().any(|row| row.number.is_some());
    let mut text = "participant,condition".to_owned();
    text.push_str(if numbered { ",trial,simulated" } else { ",simulated" });
    for column in &columns {
        // Writing into a String cannot fail, here and below.
        write!(text, ",{column}").ok();
    }
    text.push('\n');
    for row in rows {
        write!(text, "{},{}", csv_cell(row.participant), csv_cell(&row.condition)).ok();
        if numbered {
            text.push(',');
            row.number.map(|number| write!(text, "{number}").ok());
        }
        text.push_str(if row.simulated { ",yes" } else { ",no" });
        for column in &columns {
            text.push(',');
            row.values.get(*column).map(|value| write!(text, "{value}").ok());
        }
        text.push('\n');
    }
    text
}
