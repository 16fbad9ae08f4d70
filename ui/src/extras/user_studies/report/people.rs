//! The participants in the report: progress, exclusions, remarks, learning.

use maud::{Markup, PreEscaped, html};
use nima_charts::{Axis, Chart, Series, SeriesStyle, svg};
use nima_report::html::{digits, section, table, table_or};
use nima_score::{CurveShape, LearningCurve, TrainingState};
use nima_user_study::{Exclusion, LearningModel, QuestionnaireAnswers, StudyTable, UserStudy};

/// Maximum number of participants whose times are drawn: more lines would be indistinguishable.
const DRAWN: usize = 7;

pub(super) fn participants(study: &UserStudy) -> Markup {
    let plan = study.plan();
    let state = study.state();
    let row = |participant: &nima_user_study::Participant| {
        let order: Vec<String> = participant.order.iter().map(ToString::to_string).collect();
        let progress = state.progress(&participant.name);
        let count = |of: &dyn Fn(&nima_user_study::ParticipantProgress) -> usize| progress.map_or(0, of).to_string();
        let next = study.next(&participant.name).map_or_else(|error| error.to_string(), |step| step.to_string());
        vec![
            participant.name.clone(),
            order.join(" "),
            count(&|one| one.practice_s.len()),
            count(&|one| one.trials.iter().filter(|made| made.measures.is_some()).count()),
            count(&|one| one.trials.iter().filter(|made| made.measures.is_none()).count()),
            count(&|one| one.interruptions as usize),
            count(&|one| one.breaks_s.len()),
            next,
        ]
    };
    let rows: Vec<Vec<String>> = plan.participants.iter().map(row).collect();
    let heads = ["participant", "order", "practice", "trials", "without result", "interruptions", "breaks", "next"];
    section("Participants", &table(&heads, &rows))
}

/// Lists the exclusions from the analysis, with reasons.
pub(super) fn left_out(trials: &StudyTable) -> Markup {
    let excluded = trials.excluded.iter().map(|Exclusion { participant, trial, why }| {
        let what = trial.map_or_else(|| "everything".to_owned(), |trial| format!("trial {trial}"));
        vec![participant.clone(), what, why.clone()]
    });
    let missing = trials.missing.iter().map(|(participant, trial)| {
        vec![participant.clone(), format!("trial {trial}"), "interrupted: no result".to_owned()]
    });
    let rows: Vec<Vec<String>> = excluded.chain(missing).collect();
    section("Excluded from the analysis", &table_or(&["participant", "what", "why"], &rows, "Nothing."))
}

/// Scores at the end, free texts, and notes of the experimenters.
pub(super) fn remarks(study: &UserStudy) -> Markup {
    let mut scores = Vec::new();
    let mut rows = Vec::new();
    for (name, progress) in study.state().participants() {
        for (after, answers, _) in &progress.answers {
            let about = after.map_or_else(|| "at the end".to_owned(), |label| format!("after {label}"));
            if let QuestionnaireAnswers::FreeText(text) = answers {
                rows.push(vec![name.to_owned(), about, text.clone()]);
            } else if after.is_none() {
                let of = |(score, value): (&str, f64)| vec![name.to_owned(), score.to_owned(), digits(value)];
                scores.extend(answers.scores().into_iter().map(of));
            }
        }
    }
    let notes = study.state().notes.iter().map(|(at, about, text)| {
        vec![about.clone().unwrap_or_else(|| "-".to_owned()), format!("note of {at}"), text.clone()]
    });
    rows.extend(notes);
    html! {
        @if !scores.is_empty() { (section("Scores at the end", &table(&["participant", "score", "value"], &scores))) }
        @if !rows.is_empty() { (section("Remarks and notes", &table(&["participant", "when", "text"], &rows))) }
    }
}

/// Returns proficiency and learning curves.
pub(super) fn learning(study: &UserStudy) -> Markup {
    let all = study.learning();
    // A task without an end, such as touching for a given time, has no completion times.
    if all.iter().all(|of| of.practice == 0 && of.times_s.iter().all(Option::is_none)) {
        return html! {};
    }
    let row = |of: &LearningModel| {
        let standing = of.standing.map_or_else(|| "-".to_owned(), standing_text);
        let last = of.times_s.iter().rev().find_map(|time_s| *time_s).map_or_else(|| "-".to_owned(), digits);
        let first = of.times_s.iter().find_map(|time_s| *time_s).map_or_else(|| "-".to_owned(), digits);
        let curve = of.curve.as_ref().map_or_else(|| "too few times".to_owned(), curve_text);
        vec![of.participant.clone(), of.practice.to_string(), standing, first, last, curve]
    };
    let rows: Vec<Vec<String>> = all.iter().map(row).collect();
    let heads = ["participant", "practice", "criterion", "first time (s)", "last time (s)", "curve"];
    let body = html! {
        (table(&heads, &rows))
        (times(&all))
    };
    section("Learning", &body)
}

fn standing_text(standing: TrainingState) -> String {
    match standing {
        TrainingState::Practising { in_a_row } => format!("not yet ({in_a_row} in a row)"),
        TrainingState::Confirming { additional } => format!("not yet ({additional} additional)"),
        TrainingState::Reached { trial } => format!("reached in trial {trial}"),
        TrainingState::GivenUp => "not reached".to_owned(),
    }
}

fn curve_text(curve: &LearningCurve) -> String {
    let shape = match curve.shape {
        CurveShape::Exponential => "exponential",
        CurveShape::Power => "power law",
        CurveShape::Flat => return format!("flat at {} s", digits(curve.asymptote_s)),
    };
    let plateau = match (curve.trials_to_plateau, curve.plateau_seen) {
        (Some(trial), true) => format!("reached in trial {trial}"),
        (Some(trial), false) => format!("not reached; expected in trial {trial}"),
        (None, _) => "out of reach".to_owned(),
    };
    format!("{shape}, plateau {} s, {plateau}", digits(curve.asymptote_s))
}

/// Returns a plot of completion times over the trials, of the first participants.
fn times(all: &[LearningModel]) -> Markup {
    let known = |of: &&LearningModel| of.times_s.iter().flatten().count() > 1;
    let drawn: Vec<&LearningModel> = all.iter().filter(known).take(DRAWN).collect();
    if drawn.is_empty() {
        return html! {};
    }
    let points = |of: &LearningModel| {
        let numbered = of.times_s.iter().zip(1_u32..);
        numbered.filter_map(|(time_s, number)| Some([f64::from(number), (*time_s)?])).collect::<Vec<_>>()
    };
    let series: Vec<Series> = drawn
        .iter()
        .enumerate()
        .map(|(colour, of)| Series {
            name: of.participant.clone(),
            colour,
            style: SeriesStyle::Line,
            points: points(of),
        })
        .collect();
    let values = |axis: usize| series.iter().flat_map(move |one| one.points.iter().map(move |point| point[axis]));
    let chart = Chart {
        title: "Completion time".to_owned(),
        x: Axis::around("trial, practice first", values(0), false),
        y: Axis::around("completion time (s)", values(1), false),
        series: series.clone(),
    };
    PreEscaped(svg(&[chart]))
}
