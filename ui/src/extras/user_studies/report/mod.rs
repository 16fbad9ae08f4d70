//! The report of a user study: one self-contained page, the tables behind it, and scripts for R.
//!
//! The statistics are the same as in `nima study trials`, on the same tables.

mod boxes;
mod markdown;
mod people;

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

use anyhow::Context as _;
use maud::{Markup, html};
use nima_core::Side;
use nima_report::{
    html::{self, section, table},
    output,
};
use nima_score::{CatalogueDefinition, MEASURES};
use nima_study::{
    Experiment as _, Findings as _,
    trials::{TrialReport, TrialTable, Trials},
};
use nima_user_study::{Label, UserStudy};

pub(super) const PAGE: &str = "report.html";
const TRIALS: &str = "trials.csv";
const QUESTIONNAIRES: &str = "questionnaires.csv";
/// Compared questionnaire scores; the single scales of the NASA-TLX are only in the table.
const SCORES: [&str; 4] = ["nasa_tlx_weighted", "nasa_tlx_raw", "sus", "realism"];

/// Writes the report of a study into a folder, which is created if missing; returns the path of the page.
pub(super) fn write(study: &UserStudy, out: &Path, all: bool) -> anyhow::Result<PathBuf> {
    let journal = study.folder().join(nima_user_study::JOURNAL);
    output::folder(out, &[PAGE, TRIALS, QUESTIONNAIRES], &[&journal])?;
    let trials = study.trials();
    let questionnaires = study.questionnaires();
    output::write(out, TRIALS, &trials.csv)?;
    output::write(out, QUESTIONNAIRES, &questionnaires.csv)?;
    let plan = study.plan();
    let named: Vec<String> = std::iter::once(&plan.primary).chain(&plan.secondary).cloned().collect();
    let wanted = if all { columns(&trials.csv, |name| !named.iter().any(|known| known == name)) } else { Vec::new() };
    let wanted: Vec<String> = named.into_iter().chain(wanted).collect();
    let measures = AnalysedTable::of(study, out, TRIALS, &trials.csv, &wanted, "trials")?;
    // Use only this study's questionnaires.
    let scores = columns(&questionnaires.csv, |name| SCORES.contains(&name));
    let scores = AnalysedTable::of(study, out, QUESTIONNAIRES, &questionnaires.csv, &scores, "questionnaires")?;
    let page = page(study, &trials, measures.as_ref(), scores.as_ref());
    output::write(out, PAGE, &page).context("the report")?;
    Ok(out.join(PAGE))
}

/// Returns the names of numeric columns that pass a filter.
fn columns(csv: &str, filter: impl Fn(&str) -> bool) -> Vec<String> {
    let names = csv.lines().next().unwrap_or_default().split(',');
    names
        .filter(|name| !["participant", "condition", "trial", "simulated"].contains(name) && filter(name))
        .map(str::to_owned)
        .collect()
}

/// A table with its analysis.
struct AnalysedTable {
    table: TrialTable,
    report: TrialReport,
    /// Measures without a value in any trial.
    absent: Vec<String>,
}

impl AnalysedTable {
    /// `None` if nothing can be compared: no rows, or none of the measures.
    fn of(
        study: &UserStudy,
        out: &Path,
        file: &str,
        csv: &str,
        wanted: &[String],
        name: &str,
    ) -> anyhow::Result<Option<Self>> {
        let known = columns(csv, |_| true);
        let (measures, absent): (Vec<String>, Vec<String>) =
            wanted.iter().cloned().partition(|key| known.contains(key));
        if measures.is_empty() || csv.lines().count() < 2 {
            return Ok(None);
        }
        let path = out.join(file);
        let table = TrialTable::read(&path, &measures)?;
        // Before unblinding, a reference would reveal its condition.
        let reference = study.opened().and_then(|opened| opened.reference().map(str::to_owned));
        let reference = reference.filter(|name| table.conditions().contains(name));
        let trials = Trials { path, measures, reference, confidence: 0.95, power: None };
        let report = trials.run(&mut |_, _, _| ())?;
        let json = (".json".to_owned(), serde_json::to_string_pretty(&report)?);
        for (end, text) in std::iter::once(json).chain(report.files()) {
            output::write(out, &format!("{name}-{}{end}", Trials::NAME), &text)?;
        }
        Ok(Some(Self { table, report, absent }))
    }
}

fn page(
    study: &UserStudy,
    trials: &nima_user_study::StudyTable,
    measures: Option<&AnalysedTable>,
    scores: Option<&AnalysedTable>,
) -> String {
    let plan = study.plan();
    let body = html! {
        p.note { "NIMA Console, research use only." }
        @if study.state().is_simulated() {
            p.error { "Simulated: this study contains trials or answers of simulated people. It is not evidence about real people." }
        }
        (conditions(study))
        (people::participants(study))
        (people::left_out(trials))
        (compared("Primary measure", study, measures, |key| key == plan.primary))
        (compared("Further measures", study, measures, |key| key != plan.primary))
        (compared("Questionnaires", study, scores, |_| true))
        (people::remarks(study))
        (people::learning(study))
        (methods(measures, scores))
    };
    html::page(&plan.name, &body)
}

/// Describes the blinding of the study, and its conditions.
fn conditions(study: &UserStudy) -> Markup {
    let plan = study.plan();
    let row = |(label, name): (Label, &str)| {
        let condition = study.opened().and_then(|opened| opened.condition(label));
        let mode = condition.map_or_else(String::new, |one| match one.mode {
            Some(mode) => format!("{mode}, gain {}", one.gain.unwrap_or(1.0)),
            None => "no force".to_owned(),
        });
        let delay = condition.and_then(|one| one.delay_ms);
        let delay = delay.map_or_else(|| "-".to_owned(), |delay_ms| format!("{delay_ms} ms"));
        vec![label.to_string(), name.to_owned(), mode, delay]
    };
    let body = html! {
        (blinding(study))
        p.note { "Commitment to the assignment (BLAKE2b-256): " code { (plan.commitment) } }
        @if let Some(opened) = study.opened() {
            @let rows: Vec<_> = opened.labels().map(row).collect();
            (table(&["label", "condition", "feedback", "delay"], &rows))
        }
    };
    section("Conditions", &body)
}

fn blinding(study: &UserStudy) -> Markup {
    let state = study.state();
    if !study.plan().blind {
        return html! { p { "The study is not blind." } };
    }
    let Some(by) = &state.unblinding else {
        return html! {
            p.warning {
                "Blind: the conditions are shown by their labels. They are compared with the first label. \
                 Measures that would reveal the condition are left out until unblinding."
            }
        };
    };
    let after = state.results() - by.trials_before.min(state.results());
    let when = if by.complete { "after all participants had finished" } else { "before all participants had finished" };
    let class = if by.complete && after == 0 { "note" } else { "warning" };
    html! {
        p class=(class) {
            "Unblinded by " (by.who) " at " (by.at) ", " (when) ": " (by.why) ". Trials with a result after that: " (after) "."
        }
    }
}

fn definition(key: &str) -> Option<&'static CatalogueDefinition> {
    let is = |definition: &&CatalogueDefinition| {
        let of = |side: Side| format!("{}_{}", definition.id, side.word()) == key;
        if definition.per_hand { Side::ALL.into_iter().any(of) } else { definition.id == key }
    };
    MEASURES.iter().find(is)
}

/// Returns the tables and the plot of each measure that passes a filter.
fn compared(title: &str, study: &UserStudy, analysed: Option<&AnalysedTable>, filter: impl Fn(&str) -> bool) -> Markup {
    let Some(AnalysedTable { table, report, absent }) = analysed else {
        return section(title, &html! { p { "Nothing to compare yet." } });
    };
    let order: Vec<String> = match study.opened() {
        Some(opened) => opened.labels().map(|(_, name)| name.to_owned()).collect(),
        None => study.plan().labels.iter().map(ToString::to_string).collect(),
    };
    let text = report.text();
    let parts = text.split("\n## ").skip(1).map(|part| part.split_once('\n').unwrap_or((part, "")));
    let absent: BTreeSet<&str> = absent.iter().map(String::as_str).filter(|key| filter(key)).collect();
    let body = html! {
        @for (name, tables) in parts.filter(|(name, _)| filter(name)) {
            @let about = definition(name);
            h3 { (name) }
            @if let Some(definition) = about {
                p.note { (definition.words) " (" (if definition.unit == "1" { "a ratio" } else { definition.unit }) ")" }
            }
            @let unit = about.map(|definition| definition.unit).filter(|unit| !["1", "count"].contains(unit));
            @let axis = unit.map_or_else(|| name.to_owned(), |unit| format!("{name} ({unit})"));
            (boxes::svg(table, name, &order, &axis))
            (markdown::markup(tables))
        }
        @for key in absent { p { (key) ": no trial has a value that may be shown." } }
    };
    section(title, &body)
}

fn methods(measures: Option<&AnalysedTable>, scores: Option<&AnalysedTable>) -> Markup {
    let mut rows = vec![vec![TRIALS, "every trial that counts, with all measures"]];
    if measures.is_some() {
        rows.push(vec!["trials-analysis.R", "repeats the tests in R: Rscript trials-analysis.R trials.csv"]);
        rows.push(vec!["trials-analysis.csv, .json, .md", "the comparisons of this page"]);
    }
    rows.push(vec![QUESTIONNAIRES, "the scores of the questionnaires after each condition"]);
    if scores.is_some() {
        rows.push(vec!["questionnaires-analysis.R, .csv, .json, .md", "the same for them"]);
    }
    let body = html! {
        p {
            "As " code { "nima study trials" } " does it: several trials of a participant under a condition count as their mean, the mixed \
             model takes each trial. p (Holm) is corrected for the pairs of one measure, not for several measures: the primary measure \
             decides. A box goes from the first to the third quartile of the participants' means, with the median; the lines reach the \
             farthest value within 1.5 of its height; every participant is a point."
        }
        (table(&["file", "holds"], &rows))
    };
    section("How it was computed", &body)
}
