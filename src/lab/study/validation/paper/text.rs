//! The results as tables, the same for a terminal and for a document.

use std::fmt::Write as _;

use super::{Kick, PaperEntry, PaperReport, judged::DELAYS_S};
use crate::{
    Findings,
    release::{ReleaseRow, ReleaseSituation},
    validation::rendering::RenderingFigures,
};

impl Findings for PaperReport {
    fn text(&self) -> String {
        let mut text = String::new();
        self.in_window(&mut text);
        self.at_horizon(&mut text);
        self.kicks(&mut text);
        text
    }
}

impl PaperReport {
    fn in_window(&self, text: &mut String) {
        text.push_str(
            "Inside the window, newest sample, all axes (N; recordings in their own unit), and windows for which a degree above 1 is chosen:\n\n\
             | | nonlinear | linear | less | above 1, choice = window | choice = next | nonlinear, reading = displacement |\n\
             |---|---|---|---|---|---|---|\n\
             | the paper | 0.01 ± 0.02 | 0.2 +- 0.4 | 95 % | 64 % | | |\n",
        );
        for PaperEntry { name, judged, .. } in &self.entries {
            let inside = &judged.in_window;
            let [less, window, next] =
                [inside.less, inside.window_fraction, inside.next_fraction].map(|fraction| 100.0 * fraction);
            // Writing into a String cannot fail, here and below.
            writeln!(
                text,
                "| {name} | {} | {} | {less:.0} % | {window:.0} % | {next:.0} % | {} |",
                pair(&inside.nonlinear),
                pair(&inside.linear),
                pair(&inside.displacement)
            )
            .ok();
        }
        text.push('\n');
    }

    fn at_horizon(&self, text: &mut String) {
        text.push_str("At the horizon, mean error (N; recordings in their own unit); each line changes one more key:\n\n| | recipe |");
        for delay_s in DELAYS_S {
            write!(text, " {:.0} ms |", 1e3 * delay_s).ok();
        }
        text.push_str(" stiffness in the fit, p99 (N/m) |\n|---|---|---|---|---|---|---|\n");
        for PaperEntry { name, judged, .. } in &self.entries {
            let mut name = name.as_str();
            for rows in judged.at_horizon.chunks(DELAYS_S.len()) {
                let recipe = rows.first().map_or("", |row| row.name);
                let stiffness = rows.first().map(|row| row.stiffness_p99_n_m);
                line(text, name, recipe, rows.iter().map(|row| row.literal.mae_n).chain(stiffness));
                name = "";
            }
            let last = judged.at_horizon.iter().rev().take(DELAYS_S.len()).rev();
            line(text, "", "reflection", last.map(|row| row.dfr.mae_n));
            text.truncate(text.trim_end().len());
            text.push_str(" |\n");
        }
        text.push('\n');
    }

    fn kicks(&self, text: &mut String) {
        text.push_str(
            "Letting go of 5 N, without the governor:\n\n\
             | | hand | grip (N/m) | tremor (mm) | noise (N) | delay (ms) | handle before (mm/s) | force before (N) | travel (mm) | energy (mJ) | after 100 ms (N) |\n\
             |---|---|---|---|---|---|---|---|---|---|---|\n",
        );
        for Kick { name, tremor_m, noise_n, grip_n_m, row } in &self.kicks {
            let ReleaseRow { delay_ms, before_n, travel_mm, energy_mj, force_after_100_ms_n, .. } = row;
            let (hand, shake) = match row.situation {
                ReleaseSituation::Held => ("holds", format!("{:.1}", 1e3 * row.shake_m_s)),
                ReleaseSituation::Pressing => ("presses", String::new()),
            };
            writeln!(
                text,
                "| {name} | {hand} | {grip_n_m} | {:.2} | {noise_n} | {delay_ms:.0} | {shake} | {before_n:.2} | {travel_mm:.1} | {energy_mj:.1} | {force_after_100_ms_n:.2} |",
                1e3 * tremor_m,
            )
            .ok();
        }
    }
}

fn line(text: &mut String, name: &str, recipe: &str, errors_n: impl Iterator<Item = f64>) {
    write!(text, "| {name} | {recipe} |").ok();
    for error_n in errors_n {
        write!(text, " {} |", number(error_n)).ok();
    }
    text.push('\n');
}

fn pair(figures: &RenderingFigures) -> String {
    format!("{} ± {}", number(figures.mae_n), number(figures.sd_n))
}

/// Formats a number with three digits if they are readable, otherwise with an exponent.
fn number(value: f64) -> String {
    match value {
        large if large >= 1e3 => format!("{large:.0e}"),
        large if large >= 10.0 => format!("{large:.0}"),
        small if small < 0.1 => format!("{small:.4}"),
        other => format!("{other:.3}"),
    }
}
