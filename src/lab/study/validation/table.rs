//! The paper's results and those of this project, with the reasons for differences.

use std::fmt::Write as _;

use nima_machine::runtime::ClockProfile;
use nima_training::EvaluationPart;
use serde::Serialize;

use super::{
    Isolation, ValidationAgreement, ValidationError, ValidationOptions, ValidationRendering, ValidationReport, study,
};
use crate::{Experiment, Findings};

/// One result: the paper's value, this project's, and why they differ.
#[derive(Clone, Debug, Serialize)]
pub struct ValidationRow {
    /// `I`, `II` or `III`.
    pub validation: &'static str,
    /// The compared quantity, with its unit.
    pub what: String,
    /// The paper's value, or values for x, y, z; empty if the paper has no such result.
    pub paper: Vec<f64>,
    /// This project's value or values.
    pub ours: Vec<f64>,
    /// Reason for the difference.
    pub why: &'static str,
}

fn row(
    validation: &'static str,
    what: impl Into<String>,
    paper: &[f64],
    ours: impl Into<Vec<f64>>,
    why: &'static str,
) -> ValidationRow {
    ValidationRow { validation, what: what.into(), paper: paper.to_vec(), ours: ours.into(), why }
}

pub(super) fn rows(one: &ValidationAgreement, two: &Isolation, three: &[ValidationRendering]) -> Vec<ValidationRow> {
    let mut all = vec![
        row(
            "I",
            "s1 against s2, MAE x y z (N)",
            &[0.11, 0.09, 0.13],
            one.error_n.mae,
            "simulated sensors: noise 0.04 N each, no hysteresis, no inertia",
        ),
        row("I", "s1 against s2, SD x y z (N)", &[0.11, 0.12, 0.18], one.error_n.sd, "as above"),
        row("I", "s1 against s2, R2", &[0.95], [one.r2], "as above"),
    ];
    all.extend(isolation(two));
    all.extend(three.iter().flat_map(rendering));
    all
}

fn axes(part: &EvaluationPart, method: usize, of: impl Fn(&nima_training::Stats) -> f64) -> Vec<f64> {
    part.methods[method].outputs.iter().flatten().map(of).collect()
}

fn isolation(two: &Isolation) -> Vec<ValidationRow> {
    const CANNOT: &str = "force and orientation do not show the direction of friction; the paper's sessions may have favoured one direction";
    const MEMORY: &str = "the inputs include the state of the seal";
    let theirs = &two.paper_inputs;
    let ours = &two.our_inputs;
    let free = |reached: &super::isolation::NetworkErrors, of: &dyn Fn(&nima_training::NoContact) -> f64| {
        reached.no_contact.iter().map(of).collect::<Vec<_>>()
    };
    let [mae, sd, mean_free, sd_free]: [&[f64]; 4] = [&[0.19, 0.16, 0.16], &[0.2; 3], &[0.02; 3], &[0.03; 3]];
    let mut all = vec![
        row("II", "tip force, the paper's 7 inputs, MAE x y z (N)", mae, axes(&theirs.measured, 0, |s| s.mae), CANNOT),
        row("II", "tip force, the paper's 7 inputs, SD x y z (N)", sd, axes(&theirs.measured, 0, |s| s.sd), CANNOT),
        row("II", "tip force, our 15 inputs, MAE x y z (N)", mae, axes(&ours.measured, 0, |s| s.mae), MEMORY),
        row("II", "tip force, our 15 inputs, SD x y z (N)", sd, axes(&ours.measured, 0, |s| s.sd), MEMORY),
        row(
            "II",
            "the same against the true force, MAE x y z (N)",
            &[],
            axes(&ours.truth, 0, |s| s.mae),
            "the sensor under the tissue has its own noise",
        ),
        row("II", "uncorrected wrist force, MAE x y z (N)", &[], axes(&ours.measured, 1, |s| s.mae), "no model"),
        row("II", "linear regression, MAE x y z (N)", &[], axes(&ours.measured, 2, |s| s.mae), "same inputs"),
        row(
            "II",
            "Coulomb and viscous friction, MAE x y z (N)",
            &[],
            axes(&ours.measured, 3, |s| s.mae),
            "same inputs",
        ),
        row("II", "no contact, 7 inputs, mean x y z (N)", mean_free, free(theirs, &|n| n.mean), CANNOT),
        row("II", "no contact, 7 inputs, SD x y z (N)", sd_free, free(theirs, &|n| n.sd), CANNOT),
        row("II", "no contact, 15 inputs, mean x y z (N)", mean_free, free(ours, &|n| n.mean), MEMORY),
        row("II", "no contact, 15 inputs, SD x y z (N)", sd_free, free(ours, &|n| n.sd), MEMORY),
        row(
            "II",
            "unseen samples flagged as uncertain (share)",
            &[],
            [ours.false_alarms],
            "false alarms; 0.05 is the limit",
        ),
    ];
    for set in &two.foreign {
        let what = format!("flagged: {} (share of {})", set.what, set.rows);
        all.push(row("II", what, &[], [set.flagged], "outside the training data on purpose"));
    }
    all
}

fn rendering(three: &ValidationRendering) -> Vec<ValidationRow> {
    const IN_WINDOW: &str = "the hand rests for 350 ms, longer than the window: X vanishes and the force does not; with holds of 100 ms: --paper";
    let pair = |figures: super::rendering::RenderingFigures| [figures.mae_n, figures.sd_n];
    let clock = three.clock;
    let mut all = vec![
        row(
            "III",
            format!("{clock} clock: nonlinear, in its window, MAE and SD (N)"),
            &[0.01, 0.02],
            pair(three.in_window_nonlinear),
            IN_WINDOW,
        ),
        row(
            "III",
            format!("{clock} clock: linear, in its window, MAE and SD (N)"),
            &[0.2, 0.4],
            pair(three.in_window_linear),
            IN_WINDOW,
        ),
        row(
            "III",
            format!("{clock} clock: windows that chose a nonlinear degree (share)"),
            &[0.64],
            [three.nonlinear_fraction],
            "inside the window the larger of two nested models always errs less; judged by the next 10 ms: --paper",
        ),
    ];
    for figures in &three.at_horizon {
        let what =
            format!("{clock} clock: {}, {:.0} ms later, MAE and SD (N)", figures.mode.name(), 1e3 * three.delay_s);
        all.push(row("III", what, &[], pair(figures.error), figures.mode.about()));
    }
    all
}

impl Findings for ValidationReport {
    fn text(&self) -> String {
        let mut out = format!("{:<4} {:<78} {:>17}  {:>23}\n", "", "", "paper", "ours");
        for row in &self.table {
            let ValidationRow { validation, what, paper, ours, .. } = row;
            // Writing into a String cannot fail.
            writeln!(out, "{validation:<4} {what:<78} {:>17}  {:>23}", words(paper), words(ours)).ok();
        }
        out + "\n" + &by_clock(&self.rendering)
    }

    /// Returns the tables for the documentation, with the reasons.
    fn files(&self) -> Vec<(String, String)> {
        let mut out = String::from("| | | paper | ours | why they differ |\n|---|---|---|---|---|\n");
        for ValidationRow { validation, what, paper, ours, why } in &self.table {
            writeln!(out, "| {validation} | {what} | {} | {} | {why} |", words(paper), words(ours)).ok();
        }
        out.push('\n');
        out.push_str(&by_clock(&self.rendering));
        vec![(".md".to_owned(), out)]
    }
}

/// Returns the errors at the horizon, a column for each clock, as ratios to the perfect clock if it is included.
fn by_clock(all: &[ValidationRendering]) -> String {
    let Some(first) = all.first() else { return String::new() };
    let perfect = all.iter().find(|rendering| rendering.clock == ClockProfile::Perfect);
    let heads: Vec<_> = all.iter().map(|rendering| format!(" {} |", rendering.clock)).collect();
    let mut out = format!(
        "Error at the horizon of {:.0} ms by clock, MAE (N) / over that on the perfect clock:\n\n| mode |{}\n|---|{}\n",
        1e3 * first.delay_s,
        heads.concat(),
        "---|".repeat(all.len())
    );
    for (at, figures) in first.at_horizon.iter().enumerate() {
        let cell = |rendering: &ValidationRendering| {
            let mae_n = rendering.at_horizon[at].error.mae_n;
            let ratio = perfect.map(|perfect| mae_n / perfect.at_horizon[at].error.mae_n);
            format!(" {} / {} |", words(&[mae_n]), ratio.map_or_else(|| "-".to_owned(), |ratio| format!("{ratio:.3}")))
        };
        // Writing into a String cannot fail.
        writeln!(out, "| {} |{}", figures.mode, all.iter().map(cell).collect::<String>()).ok();
    }
    out
}

fn words(values: &[f64]) -> String {
    let one = |value: &f64| if value.abs() >= 100.0 { format!("{value:.1e}") } else { format!("{value:.3}") };
    if values.is_empty() { "-".to_owned() } else { values.iter().map(one).collect::<Vec<_>>().join(" ") }
}

impl Experiment for ValidationOptions {
    const NAME: &'static str = "validation";
    type Findings = ValidationReport;
    type Error = ValidationError;

    fn run(&self, progress: &mut dyn FnMut(usize, usize, &str)) -> Result<ValidationReport, ValidationError> {
        study(self, progress)
    }
}
