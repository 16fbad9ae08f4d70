//! The results as text, Markdown and CSV.

use std::fmt::Write as _;

use super::{BaselineMean, BaselineReport, BaselineRow, CHOSEN_ON, MeanInterval, Split, modes};
use crate::Findings;

impl Findings for BaselineReport {
    /// Returns one table for each part of the material.
    fn text(&self) -> String {
        // Writing into a String cannot fail.
        let mut text = format!(
            "Mean prediction error relative to that of delayed reflection, start-up included; lower is better, 1 is reflection.\n\
             In brackets: {}. Each delay is rounded to whole samples of a source.\n\
             Held-out split: constants of all modes were chosen on the recordings whose names begin with {}; all other recordings are held out.\n",
            self.interval,
            CHOSEN_ON.join(" or "),
        );
        for split in Split::ALL {
            self.table(split, &mut text);
        }
        text
    }

    fn files(&self) -> Vec<(String, String)> {
        vec![(".md".to_owned(), self.text()), (".csv".to_owned(), self.csv())]
    }
}

impl BaselineReport {
    fn table(&self, split: Split, text: &mut String) {
        let of_split: Vec<&BaselineMean> = self.means.iter().filter(|mean| mean.split == split).collect();
        let mut delays_ms: Vec<f64> = of_split.iter().map(|mean| mean.delay_ms).collect();
        delays_ms.sort_by(f64::total_cmp);
        delays_ms.dedup();
        if of_split.is_empty() {
            return;
        }
        writeln!(text, "\n{}: {}\n", title(split), self.names(split).join(", ")).ok();
        let head = delays_ms.iter().map(|delay_ms| format!(" {delay_ms} ms |")).collect::<Vec<_>>().concat();
        writeln!(text, "| mode |{head}\n|---|{}", "---|".repeat(delays_ms.len())).ok();
        for mode in modes() {
            let cells = delays_ms.iter().map(|delay_ms| {
                let is_here = |mean: &&&BaselineMean| mean.mode == mode && mean.delay_ms.total_cmp(delay_ms).is_eq();
                of_split.iter().find(is_here).map_or_else(String::new, |mean| format!(" {} |", words(&mean.ratio)))
            });
            writeln!(text, "| {mode} |{}", cells.collect::<Vec<_>>().concat()).ok();
        }
    }

    fn names(&self, split: Split) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for row in self.rows.iter().filter(|row| row.split == split) {
            if !names.contains(&row.source.as_str()) {
                names.push(&row.source);
            }
        }
        names
    }

    /// Returns each source separately, as CSV.
    fn csv(&self) -> String {
        let mut text = "source,split,delay_ms,used_delay_ms,mode,error,held_error,ratio\n".to_owned();
        for BaselineRow { source, split, delay_ms, used_delay_ms, mode, error, held_error, ratio } in &self.rows {
            let source = source.replace(['"', ',', '\n'], " ");
            write!(text, "{source},{},{delay_ms},{used_delay_ms},{mode},", key(*split)).ok();
            writeln!(text, "{error:.6},{held_error:.6},{ratio:.4}").ok();
        }
        text
    }
}

fn words(interval: &MeanInterval) -> String {
    match (interval.low, interval.high) {
        (Some(low), Some(high)) => format!("{:.3} [{low:.2}, {high:.2}]", interval.mean),
        _ => format!("{:.3}", interval.mean),
    }
}

const fn title(split: Split) -> &'static str {
    match split {
        Split::HeldOut => "Recordings held out",
        Split::ChosenOn => "Recordings that constants were chosen on",
        Split::Scene => "Simulated scenes (open loop)",
    }
}

const fn key(split: Split) -> &'static str {
    match split {
        Split::HeldOut => "held_out",
        Split::ChosenOn => "chosen_on",
        Split::Scene => "scene",
    }
}
