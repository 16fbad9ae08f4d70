//! The result as text, as a table, and as a script that repeats it in R.

use std::fmt::Write as _;

use nima_analysis::ConfidenceInterval;
use nima_files::csv_cell;

use super::{ConditionPair, OfCondition, OfMeasure, TrialDesign, TrialMixed, TrialReport};
use crate::Findings;

impl Findings for TrialReport {
    fn text(&self) -> String {
        let Self { table, trials, participants, conditions, reference, confidence, measures } = self;
        let mut text = format!(
            "{table}: {trials} trials of {participants} participants; conditions: {}; compared with {reference}; intervals of {:.0} %\n",
            conditions.join(", "),
            100.0 * confidence
        );
        for measure in measures {
            measure.write(&mut text);
        }
        text
    }

    fn files(&self) -> Vec<(String, String)> {
        vec![(".md".to_owned(), self.text()), (".csv".to_owned(), self.csv()), (".R".to_owned(), self.script())]
    }
}

/// Returns a p-value in the usual notation of papers.
fn p_text(p: f64) -> String {
    if p < 0.001 { "< 0.001".to_owned() } else { format!("{p:.3}") }
}

/// Formats a number with four significant digits.
fn digits(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let places = (3 - value.abs().log10().floor() as i32).clamp(0, 9);
    format!("{value:.*}", places as usize)
}

fn interval_text(interval: &ConfidenceInterval) -> String {
    format!("{} to {}", digits(interval.lower), digits(interval.upper))
}

impl OfMeasure {
    fn write(&self, text: &mut String) {
        let Self { measure, missing, design, conditions, friedman, complete, pairs, mixed, notes } = self;
        writeln!(text, "\n## {measure}\n").ok();
        if *missing > 0 {
            writeln!(text, "{missing} trials have no value.\n").ok();
        }
        writeln!(
            text,
            "| condition | participants | trials | median | interval | mean | sd |\n|---|---|---|---|---|---|---|"
        )
        .ok();
        for OfCondition { condition, participants, trials, median, interval, mean, sd } in conditions {
            let interval = interval.as_ref().map_or_else(|| "-".to_owned(), interval_text);
            let sd = sd.map_or_else(|| "-".to_owned(), digits);
            let median = digits(*median);
            let mean = digits(*mean);
            writeln!(text, "| {condition} | {participants} | {trials} | {median} | {interval} | {mean} | {sd} |").ok();
        }
        if let Some(test) = friedman {
            let chi_square = digits(test.chi_square);
            let df = test.df;
            let w = digits(test.w);
            let p = p_text(test.p);
            let f_p = p_text(test.f_p);
            writeln!(text, "\nFriedman, {complete} participants under all conditions: chi-square({df}) = {chi_square}, p {p} (Iman-Davenport p {f_p}), Kendall's W {w}").ok();
        }
        if !pairs.is_empty() {
            let (name, rank) = match design {
                TrialDesign::Between => ("Mann-Whitney", "Cliff's delta"),
                _ => ("Wilcoxon", "rank-biserial r"),
            };
            let needed = pairs.iter().any(|pair| pair.needed.is_some());
            let [head, line] = if needed { [" participants needed |", "---|"] } else { [""; 2] };
            writeln!(
                text,
                "\n| difference ({name}) | participants | Hodges-Lehmann | interval | p | p (Holm) | {rank} | Hedges' g |{head}\n|---|---|---|---|---|---|---|---|{line}"
            )
            .ok();
            for pair in pairs {
                pair.write(text, needed);
            }
        }
        if let Some(TrialMixed { effects, conditions, icc }) = mixed {
            let all = conditions.map_or_else(String::new, |test| {
                format!(
                    "; conditions: F({}, {:.1}) = {}, p {}",
                    test.df,
                    test.denominator_df,
                    digits(test.f),
                    p_text(test.p)
                )
            });
            writeln!(
                text,
                "\nMixed model (REML, random intercept per participant, Satterthwaite), ICC {icc:.2}{all}\n"
            )
            .ok();
            writeln!(text, "| effect | estimate | interval | standard error | df | p |\n|---|---|---|---|---|---|")
                .ok();
            for effect in effects {
                writeln!(
                    text,
                    "| {} | {} | {} | {} | {:.1} | {} |",
                    effect.name,
                    digits(effect.estimate),
                    interval_text(&effect.interval),
                    digits(effect.standard_error),
                    effect.df,
                    p_text(effect.p)
                )
                .ok();
            }
        }
        for note in notes {
            writeln!(text, "\nNot computed: {note}").ok();
        }
    }
}

impl ConditionPair {
    fn write(&self, text: &mut String, needed: bool) {
        let Self {
            first,
            second,
            participants: [one, other],
            difference,
            p,
            exact,
            p_holm,
            rank_effect,
            g,
            needed: min,
        } = self;
        let participants = if one == other { one.to_string() } else { format!("{one}, {other}") };
        let exact = if *exact { "" } else { " (normal)" };
        let g = g.map_or_else(|| "-".to_owned(), digits);
        let estimate = digits(difference.estimate);
        let interval = interval_text(&difference.interval);
        let p = p_text(*p);
        let p_holm = p_text(*p_holm);
        write!(
            text,
            "| {first} - {second} | {participants} | {estimate} | {interval} | {p}{exact} | {p_holm} | {rank_effect:.2} | {g} |"
        )
        .ok();
        if needed {
            let min = min.map_or_else(|| "> 500".to_owned(), |min| min.to_string());
            write!(text, " {min} |").ok();
        }
        text.push('\n');
    }
}

impl TrialReport {
    /// Returns the table as CSV, with one row per measure and pair.
    fn csv(&self) -> String {
        let mut text = "measure,first,second,participants_first,participants_second,difference,lower,upper,p,exact,p_holm,rank_effect,hedges_g\n".to_owned();
        for measure in &self.measures {
            for pair in &measure.pairs {
                let ConditionPair {
                    first,
                    second,
                    participants: [one, other],
                    difference,
                    p,
                    exact,
                    p_holm,
                    rank_effect,
                    g,
                    ..
                } = pair;
                let (lower, upper, estimate) =
                    (difference.interval.lower, difference.interval.upper, difference.estimate);
                let g = g.map_or_else(String::new, |g| g.to_string());
                let names = [&measure.measure, first, second].map(|name| csv_cell(name)).join(",");
                writeln!(
                    text,
                    "{names},{one},{other},{estimate},{lower},{upper},{p},{exact},{p_holm},{rank_effect},{g}"
                )
                .ok();
            }
        }
        text
    }

    /// Returns the same in R, for verification.
    fn script(&self) -> String {
        let quoted = |word: &str| format!("\"{}\"", word.replace('\\', "\\\\").replace('"', "\\\""));
        let measures: Vec<String> = self.measures.iter().map(|measure| quoted(&measure.measure)).collect();
        format!(
            r#"# Repeats the analysis in R: Rscript analysis.R [TRIALS.csv]. Needs lmerTest for the mixed model.
given <- commandArgs(trailingOnly = TRUE)
path <- if (length(given)) given[1] else {table}
script <- sub("^--file=", "", grep("^--file=", commandArgs(), value = TRUE))
# The folder may have been moved, or R started elsewhere: then the table lies beside this script.
if (!file.exists(path) && length(script)) path <- file.path(dirname(script), basename(path))
trials <- read.csv(path, check.names = FALSE)
trials$condition <- relevel(factor(trials$condition), ref = {reference})
for (measure in c({measures})) {{
  cat("\n##", measure, "\n")
  data <- data.frame(participant = factor(trials$participant), condition = trials$condition, y = trials[[measure]])
  if ("trial" %in% names(trials)) data$trial <- trials$trial
  data <- data[!is.na(data$y), ]
  wide <- tapply(data$y, list(data$participant, data$condition), mean)
  print(apply(wide, 2, median, na.rm = TRUE))
  complete <- wide[complete.cases(wide), , drop = FALSE]
  if (ncol(complete) > 2 && nrow(complete) > 1) print(friedman.test(complete))
  pairs <- combn(colnames(wide), 2)
  p <- apply(pairs, 2, function(pair) {{
    both <- wide[complete.cases(wide[, pair]), pair, drop = FALSE]
    within <- nrow(both) > 0
    a <- if (within) both[, 2] else na.omit(wide[, pair[2]])
    b <- if (within) both[, 1] else na.omit(wide[, pair[1]])
    test <- suppressWarnings(wilcox.test(a, b, paired = within, conf.int = TRUE, conf.level = {confidence}))
    cat(pair[2], "-", pair[1], ": difference", test$estimate, "interval", test$conf.int, "p", test$p.value, "\n")
    test$p.value
  }})
  print(p.adjust(p, "holm"))
  if (requireNamespace("lmerTest", quietly = TRUE) && anyDuplicated(data$participant)) {{
    formula <- if ("trial" %in% names(data)) y ~ condition + trial + (1 | participant) else y ~ condition + (1 | participant)
    print(summary(lmerTest::lmer(formula, data)))
  }}
}}
"#,
            table = quoted(&self.table),
            reference = quoted(&self.reference),
            measures = measures.join(", "),
            confidence = self.confidence,
        )
    }
}
