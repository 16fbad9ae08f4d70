//! The release study as tables, as Markdown, and as a picture.

use std::fmt::Write as _;

use nima_charts::{Axis, Chart, Series, SeriesStyle, svg};
use nima_core::impedance::Mode;
use nima_machine::runtime::ClockProfile;

use super::{
    AIM_M_S, AIM_MJ, AIM_MM, AIM_N, CONTACTS_N, DELAYS_MS, ReleaseReport, ReleaseRow, ReleaseSituation, WEAK_AIM_MM,
    Worst, methods,
};
use crate::{Findings, clocks};

impl Findings for ReleaseReport {
    /// Returns for each clock a summary, other handles, and every release of 5 N.
    fn text(&self) -> String {
        let on = |clock| clocks::heading(clock) + &self.on(clock).tables();
        self.clocks().into_iter().map(on).collect()
    }

    fn files(&self) -> Vec<(String, String)> {
        // The chart shows the first clock.
        let shown = self.clocks().first().map_or_else(Self::default, |clock| self.on(*clock));
        vec![(".md".to_owned(), self.text()), (".svg".to_owned(), shown.svg())]
    }
}

impl ReleaseReport {
    /// Returns the clocks, in the order in which they were tested.
    fn clocks(&self) -> Vec<ClockProfile> {
        let mut clocks: Vec<_> = self.rows.iter().map(|row| row.clock).collect();
        clocks.dedup();
        clocks
    }

    /// Returns the results on this clock.
    fn on(&self, clock: ClockProfile) -> Self {
        let rows = self.rows.iter().filter(|row| row.clock == clock).copied().collect();
        Self { rows, worst: self.worst.iter().filter(|worst| worst.clock == clock).copied().collect() }
    }

    fn tables(&self) -> String {
        let mut text = String::new();
        self.summary(&mut text);
        self.handles(&mut text);
        for (situation, title) in
            [(ReleaseSituation::Held, "Held for two seconds"), (ReleaseSituation::Pressing, "While pressing")]
        {
            // Writing into a String cannot fail, here and below.
            writeln!(text, "{title}, {} N:\n", CONTACTS_N[0]).ok();
            text.push_str(
                "| mode | delay (ms) | governor | force before (N) | travel (mm) | peak (m/s) | energy (mJ) | after 100 ms (N) |\n|---|---|---|---|---|---|---|---|\n",
            );
            for row in self.rows.iter().filter(|row| row.situation == situation && row.contact_n >= CONTACTS_N[0]) {
                line(&mut text, row);
            }
            text.push('\n');
        }
        text
    }

    /// Writes the worst of all delays and both situations for each mode and force; rows without a held force are left
    /// out.
    fn summary(&self, text: &mut String) {
        writeln!(
            text,
            "Worst of all delays, held and pressing. Aims with the governor: {AIM_MM} mm ({WEAK_AIM_MM} mm up to 2 N), {AIM_M_S} m/s, {AIM_MJ} mJ, {AIM_N} N.\n"
        )
        .ok();
        text.push_str(
            "| contact (N) | mode | governor | travel (mm) | peak (m/s) | energy (mJ) | after 100 ms (N) | aims met |\n|---|---|---|---|---|---|---|---|\n",
        );
        for contact_n in CONTACTS_N {
            for mode in methods() {
                for governor in [false, true] {
                    let all = || {
                        self.rows.iter().filter(|row| {
                            row.mode == mode
                                && row.governor == governor
                                && (row.contact_n - contact_n).abs() < 1e-9
                                && row.counts()
                        })
                    };
                    let worst = |of: fn(&ReleaseRow) -> f64| all().map(of).fold(0.0, f64::max);
                    let met = all().filter(|row| row.meets_the_aims()).count();
                    let of = all().count();
                    let on = on_or_off(governor);
                    writeln!(
                        text,
                        "| {contact_n} | {mode} | {on} | {:.2} | {:.3} | {:.2} | {:.2} | {met} of {of} |",
                        worst(|row| row.travel_mm),
                        worst(|row| row.peak_m_s),
                        worst(|row| row.energy_mj),
                        worst(|row| row.force_after_100_ms_n),
                    )
                    .ok();
                }
            }
        }
        text.push('\n');
    }

    fn handles(&self, text: &mut String) {
        text.push_str("Other handles and brakes (the governor assumes 0.25 kg), dfr and anchored, worst of all delays, held and pressing:\n\n| contact (N) | brake (N s/m) | handle (kg) | Coulomb friction (N) | travel (mm) | peak (m/s) | energy (mJ) | after 100 ms (N) |\n|---|---|---|---|---|---|---|---|\n");
        for worst in &self.worst {
            let Worst { contact_n, brake_n_s_m, handle_kg, coulomb_n, travel_mm, .. } = *worst;
            let Worst { peak_m_s, energy_mj, force_after_100_ms_n, .. } = *worst;
            writeln!(
                text,
                "| {contact_n} | {brake_n_s_m} | {handle_kg:.2} | {coulomb_n:.2} | {travel_mm:.2} | {peak_m_s:.3} | {energy_mj:.2} | {force_after_100_ms_n:.2} |"
            )
            .ok();
        }
        text.push('\n');
    }

    /// Returns a plot of travel and energy over the delay, for the hand that held 5 N, for each of the program's own
    /// modes with and without the governor.
    fn svg(&self) -> String {
        let chart = |title: &str, unit: &str, low: f64, high: f64, of: fn(&ReleaseRow) -> f64| Chart {
            title: title.into(),
            x: Axis::linear("delay of the link (ms)", 0.0, DELAYS_MS[DELAYS_MS.len() - 1]),
            y: Axis::log(unit, low, high),
            series: [(false, SeriesStyle::Dashed, "without"), (true, SeriesStyle::Line, "governor")]
                .into_iter()
                .flat_map(|(governor, style, word)| {
                    Mode::ALL.into_iter().enumerate().map(move |(colour, mode)| (governor, style, word, colour, mode))
                })
                .map(|(governor, style, word, colour, mode)| Series {
                    name: format!("{mode}, {word}"),
                    colour,
                    style,
                    points: self.points(governor, mode, of),
                })
                .collect(),
        };
        svg(&[
            chart("Handle travel within 1 s of letting go of 5 N", "travel (mm)", 0.1, 1e3, |row| row.travel_mm),
            chart("Energy given to the handle", "energy (mJ)", 0.1, 1e3, |row| row.energy_mj),
        ])
    }

    fn points(&self, governor: bool, mode: Mode, of: fn(&ReleaseRow) -> f64) -> Vec<[f64; 2]> {
        let wanted = |row: &&ReleaseRow| {
            row.situation == ReleaseSituation::Held
                && row.governor == governor
                && row.mode == mode
                && row.contact_n >= CONTACTS_N[0]
        };
        self.rows.iter().filter(wanted).map(|row| [row.delay_ms, of(row)]).collect()
    }
}

const fn on_or_off(governor: bool) -> &'static str {
    if governor { "on" } else { "off" }
}

fn line(text: &mut String, row: &ReleaseRow) {
    let ReleaseRow { mode, delay_ms, governor, before_n, closed_before, .. } = *row;
    let ReleaseRow { travel_mm, peak_m_s, energy_mj, force_after_100_ms_n, .. } = *row;
    let on = on_or_off(governor);
    let mark = if closed_before { ", withholding" } else { "" };
    writeln!(
        text,
        "| {mode} | {delay_ms:.0} | {on} | {before_n:.2}{mark} | {travel_mm:.2} | {peak_m_s:.3} | {energy_mj:.2} | {force_after_100_ms_n:.2} |"
    )
    .ok();
}
