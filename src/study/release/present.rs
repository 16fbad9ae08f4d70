//! The study of a released handle as a table, as Markdown, and as a picture.

use std::fmt::Write as _;

use nima_core::impedance::Mode;

use super::{
    AIM_M, AIM_N, BRAKES_N_S_M, Braked, DELAYS_MS, Gates, MODES, Options, Outcome, ReleaseError, Report, STEADY,
    Situation, study,
};
use crate::{
    Experiment, Findings,
    picture::{Axis, Chart, Series, Style, svg},
};

impl Report {
    /// One Markdown table for each situation, for a terminal and for a document.
    pub fn markdown(&self) -> String {
        let mut text = String::new();
        for (situation, title) in [(Situation::Held, "Held for two seconds"), (Situation::Pressing, "While pressing")] {
            // Writing into a String cannot fail, here and below.
            writeln!(text, "{title}:\n").ok();
            text.push_str(
                "| gates | mode | delay (ms) | force before (N) | travel in 20 ms (mm) | travel in 1 s (mm) | peak (N) | after 20 ms (N) | energy (mJ) |\n|---|---|---|---|---|---|---|---|---|\n",
            );
            for outcome in self.outcomes.iter().filter(|outcome| outcome.situation == situation) {
                row(&mut text, outcome);
            }
            text.push('\n');
        }
        self.brakes(&mut text);
        text
    }

    /// The longest travel and the latest force by viscosity of the brakes, over all delays.
    fn brakes(&self, text: &mut String) {
        let worst = |wanted: &dyn Fn(&Braked) -> bool, of: fn(&Outcome) -> f64| {
            self.braked.iter().filter(|braked| wanted(braked)).map(|braked| of(&braked.outcome)).fold(0.0, f64::max)
        };
        text.push_str("With all gates and brakes, the worst of all delays:\n\n| brakes (N s/m) | mode | held: travel in 1 s (mm) | after 20 ms (N) | pressing: travel in 1 s (mm) | after 20 ms (N) |\n|---|---|---|---|---|---|\n");
        for brake_n_s_m in BRAKES_N_S_M {
            for mode in STEADY {
                write!(text, "| {brake_n_s_m:.0} | {mode} |").ok();
                for situation in [Situation::Held, Situation::Pressing] {
                    let wanted = |braked: &Braked| {
                        (braked.brake_n_s_m - brake_n_s_m).abs() < 1e-9
                            && (braked.outcome.mode, braked.outcome.situation) == (mode, situation)
                    };
                    let (travel_mm, late_n) = (worst(&wanted, |o| o.travel_mm), worst(&wanted, |o| o.late_n));
                    write!(text, " {travel_mm:.2} | {late_n:.2} |").ok();
                }
                text.push('\n');
            }
        }
    }

    /// Number of releases with a force in the hand that meet both targets, by gates and mode: `(reached, of)`.
    pub fn reached(&self, gates: Gates, mode: Mode) -> (usize, usize) {
        let with_force = |outcome: &&Outcome| {
            outcome.gates == gates && outcome.mode == mode && outcome.before_n > AIM_N && !outcome.closed_before
        };
        let good = |outcome: &&Outcome| outcome.late_n <= AIM_N && outcome.travel_mm <= 1e3 * AIM_M;
        (self.outcomes.iter().filter(with_force).filter(good).count(), self.outcomes.iter().filter(with_force).count())
    }

    /// Travel and energy over the delay in the situation [`Situation::Held`], each mode without and with all gates.
    pub fn svg(&self) -> String {
        let chart = |title: &str, unit: &str, low: f64, high: f64, of: fn(&Outcome) -> f64| Chart {
            title: title.into(),
            x: Axis::linear("delay of the link (ms)", 0.0, DELAYS_MS[DELAYS_MS.len() - 1]),
            y: Axis::log(unit, low, high),
            series: [
                (Gates::None, Style::Dashed, "no gates"),
                (Gates::WithoutRelease, Style::Line, "without release gate"),
                (Gates::All, Style::Points, "all gates"),
            ]
            .into_iter()
            .flat_map(|(gates, style, word)| {
                MODES.into_iter().enumerate().map(move |(colour, mode)| (gates, style, word, colour, mode))
            })
            .map(|(gates, style, word, colour, mode)| Series {
                name: format!("{mode}, {word}"),
                colour,
                style,
                points: self.points(gates, mode, of),
            })
            .collect(),
        };
        svg(&[
            chart("Handle travel within 1 s of release", "travel (mm)", 1.0, 1e4, |outcome| outcome.travel_mm),
            chart("Energy given to the handle", "energy (mJ)", 0.1, 1e5, |outcome| outcome.energy_mj),
        ])
    }

    fn points(&self, gates: Gates, mode: Mode, of: fn(&Outcome) -> f64) -> Vec<[f64; 2]> {
        let wanted =
            |outcome: &&Outcome| outcome.situation == Situation::Held && outcome.gates == gates && outcome.mode == mode;
        self.outcomes.iter().filter(wanted).map(|outcome| [outcome.delay_ms, of(outcome)]).collect()
    }
}

fn row(text: &mut String, outcome: &Outcome) {
    let Outcome { gates, mode, delay_ms, before_n, closed_before, .. } = *outcome;
    let Outcome { travel_mm, travel_soon_mm, peak_n, late_n, energy_mj, .. } = *outcome;
    let before = if closed_before { "closed wrongly".to_owned() } else { format!("{before_n:.2}") };
    writeln!(
        text,
        "| {} | {mode} | {delay_ms:.0} | {before} | {travel_soon_mm:.2} | {travel_mm:.1} | {peak_n:.2} | {late_n:.2} | {energy_mj:.1} |",
        gates.words()
    )
    .ok();
}

impl Experiment for Options {
    const NAME: &'static str = "release";
    const FILES: &'static [&'static str] = &[".md", ".svg"];
    type Findings = Report;
    type Error = ReleaseError;

    fn run(&self, progress: &mut dyn FnMut(usize, usize, &str)) -> Result<Report, ReleaseError> {
        study(progress)
    }
}

impl Findings for Report {
    fn text(&self) -> String {
        self.markdown()
    }

    fn files(&self) -> Vec<(String, String)> {
        vec![(".md".to_owned(), self.markdown()), (".svg".to_owned(), self.svg())]
    }
}
