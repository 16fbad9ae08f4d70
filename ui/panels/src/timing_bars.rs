//! Histograms of the loop's durations with the deadline marked, counts on a logarithmic scale so that one late tick is
//! visible among millions; and the missed periods of the last two minutes as a strip.

use egui::{Align2, Painter, Rect, Sense, Stroke, Ui, pos2, vec2};
use nima_core::statistics::{Percentiles, Quantiles};
use nima_screen::{
    deadlines::{Deadlines, SECONDS},
    theme,
    widgets::{fitting, small},
};
use nima_words::text;

use super::timing::grouped;

/// Number of bars of a histogram; the last one includes everything longer.
const BARS: usize = 50;
/// Upper end of the histogram, as a multiple of the deadline.
const REACH: f64 = 1.25;
const HEIGHT: f32 = 58.0;
const AXIS: f32 = 15.0;
const STRIP: f32 = 26.0;

/// A duration measured in every tick.
pub(super) struct TimingBar<'a> {
    pub(super) name: &'static str,
    pub(super) meaning: &'static str,
    pub(super) quantiles: Quantiles,
    pub(super) durations: &'a Percentiles,
    /// Deadline, us.
    pub(super) deadline_us: f64,
}

impl TimingBar<'_> {
    /// Counts of all bars.
    pub(super) fn bars(&self) -> Vec<u64> {
        self.durations.bars(self.step_us(), BARS)
    }

    fn step_us(&self) -> f64 {
        REACH * self.deadline_us / BARS as f64
    }

    /// Returns the hover text of one bar.
    fn words(&self, bars: &[u64], bar: usize) -> String {
        let total = bars.iter().sum::<u64>().max(1);
        let count = bars.get(bar).copied().unwrap_or_default();
        let from_us = bar as f64 * self.step_us();
        let to_us = (bar + 1) as f64 * self.step_us();
        let range =
            if bar + 1 == BARS { text::timing::and_more(from_us) } else { text::timing::from_to(from_us, to_us) };
        text::timing::bar(self.name, &range, &grouped(count), &percent(count as f64 / total as f64))
    }
}

/// Converts a fraction to percent, with enough digits to show that it is not zero.
fn percent(fraction: f64) -> String {
    match 100.0 * fraction {
        x if x <= 0.0 => "0 %".to_owned(),
        x if x >= 0.1 => format!("{x:.1} %"),
        x => format!("{x:.5} %"),
    }
}

/// Returns the height of a bar, 0 to 1, on a logarithmic scale with `max` at 1. A single tick is visible.
fn height(count: u64, max: u64) -> f32 {
    if count == 0 { 0.0 } else { ((1.0 + count as f64).ln() / (1.0 + max.max(1) as f64).ln()) as f32 }
}

/// Draws one histogram; the bar under the pointer shows its text.
pub(super) fn bars_ui(ui: &mut Ui, timing: &TimingBar<'_>, bars: &[u64]) {
    ui.label(small(timing.name)).on_hover_text(timing.meaning);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT + AXIS), Sense::hover());
    let ground = Rect::from_min_size(rect.min, vec2(rect.width(), HEIGHT));
    let total: u64 = bars.iter().sum();
    let late: u64 = late(bars);
    response.widget_info(|| {
        let words = text::timing::histogram(timing.name, &grouped(late), &grouped(total), timing.deadline_us);
        egui::WidgetInfo::labeled(egui::Role::Label, true, words)
    });
    let pointed = response.hover_pos().map(|at| {
        let along = ((at.x - ground.left()) / ground.width()).clamp(0.0, 1.0);
        ((along * BARS as f32) as usize).min(BARS - 1)
    });
    let painter = ui.painter();
    painter.rect_filled(ground, 3.0, theme::now().groove);
    let max = bars.iter().copied().max().unwrap_or_default();
    let width = ground.width() / BARS as f32;
    for (bar, count) in bars.iter().enumerate().filter(|(_, count)| **count > 0) {
        let left = ground.left() + width * bar as f32;
        let top = ground.bottom() - (HEIGHT - 12.0) * height(*count, max).max(0.06);
        let filled = Rect::from_min_max(pos2(left + 0.5, top), pos2(left + width - 0.5, ground.bottom()));
        let colour = if pointed == Some(bar) { theme::now().text } else { theme::now().rendered };
        painter.rect_filled(filled, 0.0, colour);
    }
    axis(painter, ground, timing.deadline_us, max);
    if let Some(bar) = pointed {
        response.on_hover_text_at_pointer(timing.words(bars, bar));
    }
}

/// Returns the number of ticks after the deadline: those in bars that begin there or later.
fn late(bars: &[u64]) -> u64 {
    let first = (BARS as f64 / REACH).round() as usize;
    bars.iter().skip(first).sum()
}

/// Marks below the histogram, the deadline in it, and the explanation of its height.
fn axis(painter: &Painter, ground: Rect, deadline_us: f64, max: u64) {
    let font = theme::regular(11.0);
    let ink = theme::now().text_weak;
    let x = |fraction: f64| ground.left() + ground.width() * (fraction / REACH) as f32;
    painter.vline(x(1.0), ground.y_range(), Stroke::new(1.5, theme::now().text));
    let under = ground.bottom() + 2.0;
    painter.text(pos2(ground.left(), under), Align2::LEFT_TOP, "0", font.clone(), ink);
    painter.text(pos2(x(0.5), under), Align2::CENTER_TOP, format!("{:.0}", 0.5 * deadline_us), font.clone(), ink);
    let deadline = text::timing::deadline(deadline_us);
    let smaller = fitting(painter, &deadline, font.clone(), 2.0 * (ground.right() - x(1.0) - 8.0));
    painter.text(pos2(x(1.0) + 8.0, under), Align2::CENTER_TOP, deadline, smaller, ink);
    let scale = text::timing::log_scale(&grouped(max));
    painter.text(pos2(x(1.0) - 6.0, ground.top() + 1.0), Align2::RIGHT_TOP, scale, font, ink);
}

/// Draws the missed periods of the last two minutes, one bar per second.
pub(super) fn missed_ui(ui: &mut Ui, deadlines: &Deadlines) {
    let total = deadlines.total();
    let words = text::timing::missed(SECONDS / 60, &grouped(total));
    ui.label(small(&words)).on_hover_text(text::timing::MISSED);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), STRIP), Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, text::timing::missed_periods(&words)));
    let painter = ui.painter();
    painter.rect_filled(rect, 3.0, theme::now().groove);
    let width = rect.width() / SECONDS as f32;
    let max = deadlines.newest_first().map(|(_, count)| count).max().unwrap_or_default();
    for (age, count) in deadlines.newest_first().filter(|(_, count)| *count > 0) {
        let right = rect.right() - width * age as f32;
        let top = rect.bottom() - (STRIP - 2.0) * height(count, max).max(0.15);
        painter.rect_filled(
            Rect::from_min_max(pos2(right - width, top), pos2(right, rect.bottom())),
            0.0,
            theme::now().text,
        );
    }
    if let Some(at) = response.hover_pos() {
        let age = ((rect.right() - at.x) / width).max(0.0) as usize;
        let count = deadlines.newest_first().nth(age).map_or(0, |(_, count)| count);
        response.on_hover_text_at_pointer(text::timing::missed_at(age, &grouped(count)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_late_tick_among_millions_is_seen_and_read() {
        let mut durations = Percentiles::new();
        for _ in 0..99_999 {
            durations.record(40e-6);
        }
        durations.record(1.03e-3);
        let timing = TimingBar {
            name: "Work",
            meaning: "",
            quantiles: Quantiles::default(),
            durations: &durations,
            deadline_us: 1000.0,
        };
        let bars = timing.bars();
        assert_eq!((bars.iter().sum::<u64>(), late(&bars)), (100_000, 1));
        assert!(height(bars[41], 99_999) > 0.05);
        assert_eq!(timing.words(&bars, 41), "Work: 1025 to 1050 µs\n1 ticks, 0.00100 %");
        assert_eq!(timing.words(&bars, 1), "Work: 25 to 50 µs\n99 999 ticks, 100.0 %");
        assert!(timing.words(&bars, 49).contains("or more"));
    }

    #[test]
    fn the_pointer_reads_a_bar() {
        use egui_kittest::kittest::Queryable as _;
        let mut durations = Percentiles::new();
        (0..7).for_each(|_| durations.record(90e-6));
        let mut harness = egui_kittest::Harness::builder().with_size([400.0, 300.0]).build_ui(|ui| {
            theme::apply(ui.ctx());
            let quantiles = durations.quantiles();
            let timing = TimingBar { name: "Work", meaning: "", quantiles, durations: &durations, deadline_us: 1000.0 };
            bars_ui(ui, &timing, &timing.bars());
        });
        let rect = harness.get_by_label_contains("Work histogram: 0 of 7 ticks").rect();
        harness.hover_at(rect.left_top() + vec2(0.07 * rect.width(), 20.0));
        harness.run_steps(40);
        let read = harness.query_all_by_label_contains("75 to 100 µs").count();
        assert!(read > 0, "the hint is next to the pointer");
    }

    #[test]
    fn nothing_measured_is_no_bar() {
        assert!(height(0, 0).abs() < f32::EPSILON && height(1, 0).is_finite());
    }
}
