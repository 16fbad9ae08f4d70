//! Whether the loop meets its deadlines, and its real-time privileges.

use egui::{Grid, RichText, Ui};
use nima_core::statistics::Quantiles;
use nima_screen::{
    live::LiveState,
    theme,
    widgets::{figure, small, weak},
};
use nima_words::{
    language::Text,
    report_text::{UNKNOWN, scheduling_text, sentence},
    text,
};

use crate::panel::{Panel, PanelContext, PanelSize};

use super::timing_bars::{TimingBar, bars_ui, missed_ui};

/// Interval of counting the histograms, which takes some time.
const BARS_EVERY_S: f64 = 0.25;

/// The histograms as last counted.
#[derive(Clone, Debug, Default)]
pub struct TimingState {
    bars: Vec<Vec<u64>>,
    made_at_s: Option<f64>,
}

/// Returns the measured durations, in the order of a tick. A duration without its own deadline is compared with the
/// period.
fn timings(live: &LiveState) -> Vec<TimingBar<'_>> {
    let deadline_us = 1e6 / live.rig.rate_hz;
    vec![
        TimingBar {
            name: text::timing::WAKE_UP.get(),
            meaning: text::timing::WAKE_UP_HOVER.get(),
            quantiles: live.figures.wake_us,
            durations: live.wake(),
            deadline_us,
        },
        TimingBar {
            name: text::timing::WORK.get(),
            meaning: text::timing::WORK_HOVER.get(),
            quantiles: live.figures.work_us,
            durations: live.work(),
            deadline_us,
        },
        TimingBar {
            name: text::timing::SAMPLE_TO_FORCE.get(),
            meaning: text::timing::SAMPLE_TO_FORCE_HOVER.get(),
            quantiles: live.figures.sample_to_force_us,
            durations: live.sample_to_force(),
            deadline_us,
        },
    ]
}

impl Panel for TimingState {
    const NAME: Text = text::timing::NAME;
    const MEANING: Text = text::timing::MEANING;
    const SIZE: PanelSize = PanelSize::FIGURES;

    fn ui(&mut self, ui: &mut Ui, at: &mut PanelContext<'_>) {
        timing_ui(ui, at.live, self);
    }
}

fn timing_ui(ui: &mut Ui, live: &LiveState, state: &mut TimingState) {
    let timings = timings(live);
    table_ui(ui, &timings);
    ui.add_space(2.0);
    let time_s = ui.input(|input| input.time);
    if state.made_at_s.is_none_or(|at_s| time_s - at_s >= BARS_EVERY_S) {
        state.made_at_s = Some(time_s);
        state.bars = timings.iter().map(TimingBar::bars).collect();
    }
    for (timing, bars) in timings.iter().zip(&state.bars) {
        bars_ui(ui, timing, bars);
    }
    missed_ui(ui, &live.deadlines);
    ui.add_space(4.0);
    let tick = live.first_tick();
    let rate = text::timing::ticks_at(&grouped(tick.map_or(0, |tick| tick.index + 1)), live.figures.rate_hz);
    figure(ui, text::timing::TICKS, rate, text::timing::TICKS_HOVER);
    let missed = grouped(tick.map_or(0, |tick| tick.timing.missed));
    figure(ui, text::timing::MISSED, missed, text::timing::MISSED_HOVER);
    let dropped = grouped(tick.map_or(0, |tick| tick.timing.dropped));
    figure(ui, text::timing::DROPPED, dropped, text::timing::DROPPED_HOVER);
    scheduling_ui(ui, live);
    let [p50, p99] = live.figures.frame_ms;
    let frame = text::timing::frame([p50, p99], live.figures.frame_work_ms);
    figure(
        ui,
        text::timing::CONSOLE_FRAME,
        frame,
        if live.rough_edges { text::timing::FRAME_HOVER_ROUGH.get() } else { text::timing::FRAME_HOVER.get() },
    );
}

fn table_ui(ui: &mut Ui, timings: &[TimingBar<'_>]) {
    // Four numbers follow the name, which wraps if it is long.
    let room = (ui.available_width() - 4.0 * 52.0).max(60.0);
    Grid::new("timing").num_columns(5).spacing([10.0, 3.0]).min_col_width(40.0).show(ui, |ui| {
        ui.label(small("µs"));
        for head in ["p50", "p99", "p99.9", "max"] {
            right(ui, small(head));
        }
        ui.end_row();
        for TimingBar { name, meaning, quantiles, durations, .. } in timings {
            ui.scope(|ui| {
                ui.set_max_width(room);
                ui.add(egui::Label::new(weak(*name)).wrap()).on_hover_text(*meaning);
            });
            let Quantiles { p50, p99, p999, max } = *quantiles;
            for value in [p50, p99, p999, max] {
                let words = if durations.count() == 0 { UNKNOWN.to_owned() } else { short(value) };
                right(ui, RichText::new(words).font(theme::strong(14.0)));
            }
            ui.end_row();
        }
    });
}

/// Returns microseconds in six characters at most; from 10 000 us on with a larger unit, which the heading of the table
/// does not name.
fn short(us: f64) -> String {
    match us {
        us if us < 9_999.5 => format!("{us:.0}"),
        us if us < 999_500.0 => format!("{:.0} ms", us / 1e3),
        us => format!("{:.0} s", us / 1e6),
    }
}

fn right(ui: &mut Ui, text: RichText) {
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| ui.label(text));
}

fn scheduling_ui(ui: &mut Ui, live: &LiveState) {
    let Some(scheduling) = live.scheduling else { return };
    let yes_no = |granted| if granted { text::timing::GRANTED.get() } else { text::timing::REFUSED.get() };
    let meaning = text::timing::SCHEDULING_HOVER.get();
    figure(ui, text::timing::REAL_TIME_PRIORITY, yes_no(scheduling.fifo), meaning);
    figure(ui, text::timing::LOCKED_MEMORY, yes_no(scheduling.memory_locked), meaning);
    if let Some(advice) = scheduling_text(scheduling) {
        ui.label(small(sentence(&advice)));
    }
}

/// Returns a number with its digits in groups of three.
pub(super) fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::{grouped, short};

    #[test]
    fn long_durations_have_a_larger_unit() {
        assert_eq!(
            [4.2, 9_999.0, 10_000.0, 999_000.0, 1_234_567.0].map(short),
            ["4", "9999", "10 ms", "999 ms", "1 s"]
        );
    }

    #[test]
    fn digits_stand_in_groups() {
        assert_eq!([0, 999, 1000, 1_234_567].map(grouped), ["0", "999", "1 000", "1 234 567"]);
    }
}
