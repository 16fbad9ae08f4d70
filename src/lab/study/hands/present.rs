//! The study of hands as tables, as Markdown.

use std::fmt::Write as _;

use nima_machine::runtime::ClockProfile;

use super::{
    FORCES_N, HandReport,
    aims::{ALARMS_PER_MIN, AT_ONCE_LATE_MM, AT_ONCE_MM, Aims, ENERGY_MJ, FROM_N, OPENING_MM, WITHHELD_PERCENT},
    kind::HandKind,
    present_hands::HeldTally,
    released::{OPENINGS_MS, Releases},
};
use crate::{Findings, clocks};

const HELD: &str = "alarms (1/min) | reversed (ticks) | reversed (N) | beyond slew (N) | withheld (%) | hands with an alarm (%) | declared gone |\n|---|---|---|---|---|---|---|---|\n";

impl Findings for HandReport {
    /// Returns the targets and the cases that miss them for all clocks in one table, and the tables of each clock.
    fn text(&self) -> String {
        let mut text = self.aims_text();
        text.push_str("Hands that stay, all kinds together:\n\n| clock | ");
        text.push_str(HELD);
        for clock in self.clocks() {
            line(&mut text, &clock.to_string(), &self.all_kinds(clock));
        }
        text.push('\n');
        self.clocks().into_iter().for_each(|clock| self.on(clock, &mut text));
        text
    }

    fn judge(&self) -> Result<(), String> {
        let mut all = HeldTally::default();
        self.clocks().into_iter().for_each(|clock| all.add(&self.all_kinds(clock)));
        if all.reversed_ticks == 0 && all.beyond_slew_n <= 1e-9 {
            return Ok(());
        }
        let HeldTally { reversed_ticks, reversed_n, beyond_slew_n, .. } = all;
        Err(format!(
            "the governor opposed hands that held the handle: {reversed_ticks} ticks reversed, by up to {reversed_n:.2} N; \
             steps up to {beyond_slew_n:.2} N beyond the slew limit"
        ))
    }
}

impl HandReport {
    fn aims_text(&self) -> String {
        let Aims { judged, missed } = self.aims();
        let [p95_mm, max_mm] = AT_ONCE_MM;
        let [late_mm, very_late_mm] = AT_ONCE_LATE_MM;
        let [opening_p95_mm, opening_max_mm] = OPENING_MM;
        let mut text = format!(
            "Aims for hands that stay: no tick reversed by more than 0.05 N, {ALARMS_PER_MIN} alarms a minute, {WITHHELD_PERCENT} % withheld, no step \
             beyond the slew limit. For releases from {FROM_N} N on, at once: {p95_mm} mm at p95 and {max_mm} mm at most (perfect, quiet), \
             {late_mm} mm at most (up to 1 % late ticks), {very_late_mm} mm at most (5 %, busy), {ENERGY_MJ} mJ; within 10 to 40 ms: \
             {opening_p95_mm} mm at p95 and {opening_max_mm} mm at most. Releases during a pause of the loop have no aim.\n\n\
             Missed: {} of {judged}.\n\n",
            missed.len()
        );
        for miss in &missed {
            writeln!(text, "- {miss}").ok();
        }
        if !missed.is_empty() {
            text.push('\n');
        }
        text
    }

    fn on(&self, clock: ClockProfile, text: &mut String) {
        text.push_str(&clocks::heading(clock));
        text.push_str("| hands that stay | ");
        text.push_str(HELD);
        for row in self.held.iter().filter(|row| row.clock == clock) {
            line(text, row.kind, &row.tally);
        }
        text.push_str("\n| mode of the whole loop | ");
        text.push_str(HELD);
        for row in self.modes.iter().filter(|row| row.clock == clock) {
            line(text, row.mode.name(), &row.tally);
        }
        text.push('\n');
        for kind in &HandKind::ALL {
            self.releases_of(clock, kind, text);
        }
    }

    fn releases_of(&self, clock: ClockProfile, kind: &HandKind, text: &mut String) {
        let of_kind = |row: &&Releases| row.clock == clock && row.kind == kind.name;
        let rows: Vec<&Releases> = self.releases.iter().filter(of_kind).collect();
        if rows.is_empty() {
            return;
        }
        writeln!(
            text,
            "Hands that let go, *{}*: 95th percentile / maximum of the travel (mm), maximum energy (mJ), median time to detection (ms).\n\n\
             | opens within (ms) | {} |\n|---{}|",
            kind.name,
            FORCES_N.map(|n| format!("{n} N")).join(" | "),
            "|---".repeat(FORCES_N.len()),
        )
        .ok();
        let of_opening = |opening_ms: f64| rows.iter().filter(move |row| (row.opening_ms - opening_ms).abs() < 1e-9);
        for opening_ms in OPENINGS_MS.into_iter().filter(|opening_ms| of_opening(*opening_ms).count() > 0) {
            write!(text, "| {opening_ms} |").ok();
            for row in of_opening(opening_ms) {
                let detected = row.detected_ms.map_or_else(|| "–".to_owned(), |ms| format!("{ms:.0}"));
                let Releases { travel_p95_mm, travel_max_mm, energy_max_mj, .. } = row;
                write!(text, " {travel_p95_mm:.1} / {travel_max_mm:.1}, {energy_max_mj:.1}, {detected} |").ok();
            }
            text.push('\n');
        }
        text.push('\n');
    }
}

/// Appends a row for hands that hold the handle; writing into a String cannot fail, here and above.
fn line(text: &mut String, of: &str, tally: &HeldTally) {
    let HeldTally { hands, reversed_ticks, reversed_n, beyond_slew_n, hands_alarmed, hands_gone, .. } = *tally;
    let alarms = tally.alarms_per_min();
    let withheld = tally.withheld_percent();
    let alarmed = 100.0 * hands_alarmed as f64 / hands.max(1) as f64;
    writeln!(
        text,
        "| {of} | {alarms:.3} | {reversed_ticks} | {reversed_n:.2} | {beyond_slew_n:.2} | {withheld:.4} | {alarmed:.1} | {hands_gone} |"
    )
    .ok();
}
