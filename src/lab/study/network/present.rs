//! The study of impaired lines as tables (text, Markdown, CSV) and as a picture.

use std::{collections::BTreeMap, fmt::Write as _};

use nima_charts::{Axis, Chart, Series, SeriesStyle, svg};
use nima_core::impedance::{Mode, OwnMotion};
use nima_machine::runtime::ClockProfile;

use super::{
    BASE_MS, ConditionJitter, DELAYS_MS, JITTERS, LOSSES_PERCENT, LinkEvent, NetworkCondition, NetworkError,
    NetworkOptions, NetworkReport, NetworkRow, PlanExtent, StudyAim, plan::judged_line, study,
};
use crate::{Experiment, Findings, clocks};

const CSV_HEADER: &str = "clock,mode,delay_ms,jitter_ms,loss_percent,burst_ms,happening,error_n,asked_error_n,tissue_n,over_clean,over_same_playout,\
    over_reflection,injected_mj,tissue_injected_mj,oscillation_n,tissue_oscillation_n,ceiling_breaches,slew_breaches,\
    without_force_ms,force_after_data_ms,engaged,stops,resumed,console_faults,follower_faults,return_step_mm,there_ms,back_ms,\
    round_trip_ms,late_there_percent,late_back_percent,lost_there_percent,lost_back_percent,recovered_there_percent,\
    recovered_back_percent,clock_error_ms,clock_bound_ms,clock_step_named_ms\n";

const CELLS_HEADER: &str = "| mode | delay (ms) | jitter (ms) | loss (%) | other | error (N) | of clean | of dfr | energy (mJ) | tissue's (mJ) | 2-50 Hz (N) | tissue's (N) | no force (ms) | after data (ms) | stops | step (mm) | there, back (ms) | late (%) | lost (%) | recovered (%) |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";

impl NetworkCondition {
    /// Returns the loss for tables.
    fn loss_word(&self) -> String {
        let burst = self.burst_ms.map(|burst_ms| format!(" in {burst_ms} ms"));
        format!("{}{}", self.loss_percent, burst.unwrap_or_default())
    }

    /// Returns the number of factors, other than the delay, that differ from their default.
    fn factors(&self) -> usize {
        let jitters = self.jitter != ConditionJitter::None;
        let loses = self.loss_percent > 0.0;
        usize::from(jitters) + usize::from(loses) + usize::from(self.happening != LinkEvent::Nothing)
    }

    fn is_at(&self, delay_ms: f64) -> bool {
        (self.delay_ms - delay_ms).abs() < 1e-9
    }
}

impl NetworkRow {
    /// Returns the cell in a few words.
    pub(super) fn place(&self) -> String {
        let NetworkCondition { delay_ms, jitter, loss_percent, happening, .. } = self.condition;
        let mut text = format!("{}, {delay_ms} ms", self.mode);
        // Writing into a String cannot fail, here and below.
        if jitter != ConditionJitter::None {
            write!(text, ", jitter {}", jitter.word()).ok();
        }
        if loss_percent > 0.0 {
            write!(text, ", loss {} %", self.condition.loss_word()).ok();
        }
        if happening != LinkEvent::Nothing {
            write!(text, ", {}", happening.word()).ok();
        }
        text
    }

    /// Stops with their causes.
    fn stops_text(&self) -> String {
        if self.stops == 0 {
            return "0".to_owned();
        }
        let causes: Vec<_> = self.console_faults.keys().map(String::as_str).collect();
        format!("{} ({})", self.stops, causes.join(", "))
    }

    fn line(&self, text: &mut String) {
        let ratio = |ratio: Option<f64>| ratio.map_or_else(|| "-".to_owned(), |ratio| format!("{ratio:.2}"));
        let two = |pair: [f64; 2], digits: usize| format!("{:.digits$}, {:.digits$}", pair[0], pair[1]);
        let step = self.return_step_mm.map_or_else(|| "-".to_owned(), |mm| format!("{mm:.3}"));
        let NetworkCondition { delay_ms, jitter, happening, .. } = self.condition;
        writeln!(
            text,
            "| {} | {delay_ms} | {} | {} | {} | {} | {} | {} | {:.1} | {:.1} | {} | {} | {:.0} | {:.0} | {} | {step} | {} | {} | {} | {} |",
            self.mode,
            jitter.word(),
            self.condition.loss_word(),
            happening.word(),
            newtons(self.error_n),
            ratio(self.over_clean),
            ratio(self.over_reflection),
            self.injected_mj,
            self.tissue_injected_mj,
            newtons(self.oscillation_n),
            newtons(self.tissue_oscillation_n),
            self.without_force_ms,
            self.force_after_data_ms,
            self.stops_text(),
            two(self.under_way_ms, 1),
            two(self.late_percent, 2),
            two(self.lost_percent, 2),
            two(self.recovered_percent, 1),
        )
        .ok();
    }

    fn csv(&self, text: &mut String) {
        let NetworkCondition { delay_ms, jitter, loss_percent, burst_ms, happening } = self.condition;
        let maybe = |value: Option<f64>| value.map(|value| value.to_string()).unwrap_or_default();
        let all = |numbers: &[f64]| numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        let faults = |faults: &BTreeMap<String, u32>| {
            let each: Vec<_> = faults.iter().map(|(fault, count)| format!("{fault} {count}")).collect();
            each.join("; ").replace([',', '"'], "")
        };
        let fractions = [self.late_percent, self.lost_percent, self.recovered_percent].concat();
        let cells = [
            self.clock.to_string(),
            self.mode.to_string(),
            delay_ms.to_string(),
            jitter.word(),
            loss_percent.to_string(),
            maybe(burst_ms),
            happening.word().to_owned(),
            all(&[self.error_n, self.asked_error_n, self.tissue_n]),
            maybe(self.over_clean),
            maybe(self.over_same_playout),
            maybe(self.over_reflection),
            all(&[self.injected_mj, self.tissue_injected_mj, self.oscillation_n, self.tissue_oscillation_n]),
            self.ceiling_breaches.to_string(),
            self.slew_breaches.to_string(),
            all(&[self.without_force_ms, self.force_after_data_ms, self.engaged]),
            self.stops.to_string(),
            self.resumed.to_string(),
            faults(&self.console_faults),
            faults(&self.follower_faults),
            maybe(self.return_step_mm),
            all(&self.under_way_ms),
            self.round_trip_ms.to_string(),
            all(&fractions),
            all(&[self.clock_error_ms, self.clock_bound_ms]),
            maybe(self.clock_step_named_ms),
        ];
        writeln!(text, "{}", cells.join(",")).ok();
    }
}

/// Returns a force, or a text if there was none.
fn newtons(value_n: f64) -> String {
    if value_n.is_finite() { format!("{value_n:.3}") } else { "never engaged".to_owned() }
}

impl NetworkReport {
    /// Returns the modes in the order in which they were run.
    fn modes(&self) -> Vec<Mode> {
        let mut modes = Vec::new();
        for row in &self.rows {
            if !modes.contains(&row.mode) {
                modes.push(row.mode);
            }
        }
        modes
    }

    fn row(&self, condition: &NetworkCondition, mode: Mode) -> Option<&NetworkRow> {
        self.rows.iter().find(|row| row.mode == mode && row.condition == *condition)
    }

    /// Returns the clocks in the order in which they were run.
    fn clocks(&self) -> Vec<ClockProfile> {
        let mut clocks: Vec<_> = self.rows.iter().map(|row| row.clock).collect();
        clocks.dedup();
        clocks
    }

    /// Returns the results on this clock.
    fn on(&self, clock: ClockProfile) -> Self {
        let rows = self.rows.iter().filter(|row| row.clock == clock).cloned().collect();
        let aims = self.aims.iter().filter(|aim| aim.clock == clock).cloned().collect();
        Self { aims, rows, ..self.clone() }
    }

    /// Returns Markdown for a document or a terminal.
    pub fn markdown(&self) -> String {
        let on = |clock| clocks::heading(clock) + &self.on(clock).tables();
        let tables: String = self.clocks().into_iter().map(on).collect();
        self.head() + &tables
    }

    /// Returns the results on the only clock.
    fn tables(&self) -> String {
        let mut text = String::new();
        self.aims_table(&mut text);
        self.over_delay(&mut text);
        for mode in self.modes() {
            self.over_loss(&mut text, mode);
        }
        text.push_str("Every factor alone, and the line that is judged:\n\n");
        text.push_str(CELLS_HEADER);
        let is_shown = |row: &&NetworkRow| {
            let condition = &row.condition;
            (condition.is_at(BASE_MS) && condition.factors() <= 1) || *condition == judged_line(condition.delay_ms)
        };
        self.rows.iter().filter(is_shown).for_each(|row| row.line(&mut text));
        text.push('\n');
        text
    }

    fn head(&self) -> String {
        let extent = match self.extent {
            PlanExtent::Quick => "a few cells (--quick)",
            PlanExtent::Usual => "every mode over every delay; loss with jitter and every other factor alone at 36 ms",
            PlanExtent::Full => "every combination (--full)",
        };
        format!(
            "{} cells: {extent}. Runs of {} s on the virtual clock; the last {} s are judged; before each run the line has been open for {} s ({} s with jitter). Scene peg_transfer, delay in each direction, one seed. ETVO (Kroep and others, 2021) is not computed.\n\n",
            self.rows.len(),
            self.run_s,
            self.judged_s,
            self.known_s[1],
            self.known_s[0],
        )
    }

    fn aims_table(&self, text: &mut String) {
        writeln!(
            text,
            "Judged mode: {}{}.\n\n| aim | at most | worst | in | cells | result |\n|---|---|---|---|---|---|",
            self.judged,
            if self.own_motion == OwnMotion::Handle { ", on the motion of the handle" } else { "" },
        )
        .ok();
        for aim in &self.aims {
            let result = if aim.missed == 0 { "met".to_owned() } else { format!("MISSED in {}", aim.missed) };
            writeln!(
                text,
                "| {} | {} | {:.3} | {} | {} | {result} |",
                aim.what, aim.limit, aim.worst, aim.place, aim.cells
            )
            .ok();
        }
        text.push('\n');
    }

    /// Writes the error over the delay of a line without other impairments.
    fn over_delay(&self, text: &mut String) {
        let delays: Vec<f64> = DELAYS_MS
            .into_iter()
            .filter(|delay| self.row(&NetworkCondition::clean(*delay), self.judged).is_some())
            .collect();
        text.push_str("Mean error (N) over the delay (ms) alone; with the engaged fraction of the time if it was below 100 %:\n\n| mode |");
        for delay_ms in &delays {
            write!(text, " {delay_ms} |").ok();
        }
        writeln!(text, "\n|---|{}", "---|".repeat(delays.len())).ok();
        for mode in self.modes() {
            write!(text, "| {mode} |").ok();
            for delay_ms in &delays {
                let cell = self.row(&NetworkCondition::clean(*delay_ms), mode).map_or_else(|| "-".to_owned(), short);
                write!(text, " {cell} |").ok();
            }
            text.push('\n');
        }
        text.push('\n');
    }

    /// Writes the error over loss and jitter.
    fn over_loss(&self, text: &mut String, mode: Mode) {
        let at = |jitter, loss_percent| {
            self.row(&NetworkCondition { jitter, loss_percent, ..NetworkCondition::clean(BASE_MS) }, mode)
        };
        let (Some(_), Some(_)) = (at(JITTERS[1], 0.0), at(ConditionJitter::None, LOSSES_PERCENT[1])) else { return };
        writeln!(
            text,
            "{mode} at {BASE_MS} ms, each datagram lost for itself: mean error (N), and over the same delay alone:\n"
        )
        .ok();
        text.push_str("| jitter (ms) |");
        text.push_str(&LOSSES_PERCENT.map(|loss| format!(" {loss} % |")).concat());
        writeln!(text, "\n|---|{}", "---|".repeat(LOSSES_PERCENT.len())).ok();
        for jitter in JITTERS {
            write!(text, "| {} |", jitter.word()).ok();
            for loss_percent in LOSSES_PERCENT {
                let cell = at(jitter, loss_percent).map_or_else(
                    || "-".to_owned(),
                    |row| format!("{} / {:.2}", short(row), row.over_clean.unwrap_or(f64::NAN)),
                );
                write!(text, " {cell} |").ok();
            }
            text.push('\n');
        }
        text.push('\n');
    }

    /// Returns every cell.
    pub fn csv(&self) -> String {
        let mut text = CSV_HEADER.to_owned();
        self.rows.iter().for_each(|row| row.csv(&mut text));
        text
    }

    /// Returns a plot of the error over the delay in every mode, and over the loss at each jitter.
    pub fn svg(&self) -> String {
        let colours = |modes: Vec<Mode>| modes.into_iter().enumerate();
        let delays = colours(self.modes()).map(|(colour, mode)| Series {
            name: mode.name().to_owned(),
            colour,
            style: if colour < 7 { SeriesStyle::Line } else { SeriesStyle::Dashed },
            points: self.points(mode, NetworkCondition::is_clean, |condition| condition.delay_ms),
        });
        let pairs = JITTERS.into_iter().enumerate().flat_map(|(colour, jitter)| {
            [(self.judged, SeriesStyle::Line), (Mode::Dfr, SeriesStyle::Dashed)].map(|(mode, style)| Series {
                name: format!("{mode}, jitter {}", jitter.word()),
                colour,
                style,
                points: self.points(
                    mode,
                    |condition| {
                        *condition
                            == NetworkCondition {
                                jitter,
                                loss_percent: condition.loss_percent,
                                ..NetworkCondition::clean(BASE_MS)
                            }
                    },
                    |condition| condition.loss_percent,
                ),
            })
        });
        let chart = |title: &str, x, series: Vec<Series>| Chart {
            title: title.to_owned(),
            x,
            y: Axis::log("mean error (N)", 0.02, 5.0),
            series,
        };
        let max_ms = DELAYS_MS[DELAYS_MS.len() - 1];
        svg(&[
            chart("Delay alone", Axis::linear("delay in each direction (ms)", 0.0, max_ms), delays.collect()),
            chart(
                &format!("Loss and jitter (ms) at {BASE_MS} ms"),
                Axis::linear("datagrams lost (%)", 0.0, 30.0),
                pairs.collect(),
            ),
        ])
    }

    fn points(
        &self,
        mode: Mode,
        is_shown: impl Fn(&NetworkCondition) -> bool,
        x: impl Fn(&NetworkCondition) -> f64,
    ) -> Vec<[f64; 2]> {
        let rows = self.rows.iter().filter(|row| row.mode == mode && is_shown(&row.condition));
        rows.map(|row| [x(&row.condition), row.error_n]).collect()
    }
}

/// Returns the error of a row, and the engaged fraction of the time if it was below 100 %.
fn short(row: &NetworkRow) -> String {
    let all = row.engaged > 0.999;
    if all || row.error_n.is_nan() {
        newtons(row.error_n)
    } else {
        format!("{} ({:.0} %)", newtons(row.error_n), 100.0 * row.engaged)
    }
}

impl Experiment for NetworkOptions {
    const NAME: &'static str = "network";
    const FILES: &'static [&'static str] = &[".md", ".csv", ".svg"];
    type Findings = NetworkReport;
    type Error = NetworkError;

    fn run(&self, progress: &mut dyn FnMut(usize, usize, &str)) -> Result<NetworkReport, NetworkError> {
        study(self, progress)
    }
}

impl Findings for NetworkReport {
    fn text(&self) -> String {
        self.markdown()
    }

    fn files(&self) -> Vec<(String, String)> {
        // The chart shows the first clock.
        let shown = self.clocks().first().map_or_else(|| self.clone(), |clock| self.on(*clock));
        vec![(".md".to_owned(), self.markdown()), (".csv".to_owned(), self.csv()), (".svg".to_owned(), shown.svg())]
    }

    fn judge(&self) -> Result<(), String> {
        let missed: Vec<_> = self.aims.iter().filter(|aim| aim.missed > 0).collect();
        if missed.is_empty() {
            return Ok(());
        }
        let report = missed.iter().map(|aim| {
            let StudyAim { clock, what, worst, limit, place, .. } = aim;
            format!("{what}: {worst:.3}, at most {limit} ({place}, {clock} clock)")
        });
        Err(format!(
            "{} of {} aims were missed. {}",
            missed.len(),
            self.aims.len(),
            report.collect::<Vec<_>>().join("; ")
        ))
    }
}
