//! The Prediction error panel: error of each mode at the prediction horizon, which is the delay of the link.

use egui::{Align2, Rect, Sense, Ui, vec2};
use nima_core::impedance::{Mode, ModeSet};
use nima_machine::messages::Command;

use crate::console::{
    live::{LiveState, TREND_S},
    outbox::Outbox,
    text, theme,
    widgets::{Sign, bar, sign, small},
};
use crate::report_text::{COMPARED, mode_meaning, mode_name, newtons_in_three, three_digits};

/// Upper end of the bars, as a multiple of the error of delayed DFR.
const LONGEST: f64 = 2.5;
/// Height of the trend plot.
const TREND_HEIGHT: f32 = 46.0;
/// A smaller error is noise, and its ratio is meaningless, N.
const MIN_N: f64 = 1e-4;

pub fn horizon_ui(ui: &mut Ui, live: &LiveState, outbox: &mut Outbox) {
    let computed = live.first_tick().map_or(ModeSet::only(Mode::Dfr), |tick| tick.identification.modes);
    let dfr_n = live.figures.horizon_n[Mode::Dfr.index()];
    ui.label(small(text::horizon::ahead(live.delay_s() * 1e3)));
    let mut compares = live.compares();
    let compare = egui::Checkbox::new(&mut compares, text::horizon::COMPARE.get());
    let compare = ui.add_enabled(!live.is_shown_only(), compare).on_hover_text(text::horizon::COMPARE_HOVER.get());
    if compare.on_disabled_hover_text(live.of.blocked()).changed() {
        outbox.push(Command::Compare(compares));
    }
    ui.add_space(2.0);
    let modes = COMPARED.into_iter().chain(computed.baseline().map(Mode::Baseline));
    for mode in modes.filter(|mode| computed.contains(*mode)) {
        mode_ui(ui, mode, live.figures.horizon_n[mode.index()], dfr_n, live.mode() == mode);
    }
    trend_ui(ui, live);
}

/// Returns the mean error of a mode over the last minutes, N; `None` if the force was never known.
fn mean_n(live: &LiveState, mode: Mode) -> Option<f64> {
    let errors_n = live.trend_n.iter().map(|errors_n| errors_n[mode.index()]).filter(|error_n| error_n.is_finite());
    let (count, sum_n) = errors_n.fold((0.0, 0.0), |(count, sum_n), error_n| (count + 1.0, sum_n + error_n));
    (count > 0.0).then(|| sum_n / count)
}

/// Errors of the active mode and of delayed DFR over the last minutes, one point per second.
fn trend_ui(ui: &mut Ui, live: &LiveState) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), TREND_HEIGHT), Sense::hover());
    let [ours, dfr] = [live.mode(), Mode::Dfr].map(|mode| newtons_in_three(mean_n(live, mode)));
    let words = text::horizon::trend(live.trend_n.len(), mode_name(live.mode()), &ours, &dfr);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, text::horizon::trend_name(&words)));
    response.on_hover_text(text::horizon::trend_meaning(&words));
    let painter = ui.painter();
    painter.rect_filled(rect, 3.0, theme::now().groove);
    let highest_n = 1.1 * live.trend_n.iter().map(|errors_n| errors_n[Mode::Dfr.index()]).fold(MIN_N, f64::max);
    for (mode, colour) in [(Mode::Dfr, theme::now().reference), (live.mode(), theme::now().rendered)] {
        let points = live.trend_n.iter().rev().enumerate().map(|(age_s, errors_n)| {
            let along = 1.0 - age_s as f32 / (TREND_S - 1) as f32;
            let error_n = Some(errors_n[mode.index()]).filter(|error_n| error_n.is_finite())?;
            let up = (error_n / highest_n).min(1.0) as f32;
            let x = rect.left() + along * rect.width();
            let y = rect.bottom() - 2.0 - up * (rect.height() - 4.0);
            Some(egui::pos2(x, y))
        });
        let points: Vec<_> = points.collect();
        for run in points.split(Option::is_none) {
            painter.line(run.iter().flatten().copied().collect(), egui::Stroke::new(1.5, colour));
        }
    }
    let note = format!("{} N", three_digits(highest_n));
    painter.text(
        rect.left_top() + vec2(4.0, 3.0),
        Align2::LEFT_TOP,
        note,
        theme::regular(11.0),
        theme::now().text_weak,
    );
    let note = text::horizon::LAST_3_MIN.get();
    painter.text(
        rect.left_bottom() + vec2(4.0, -3.0),
        Align2::LEFT_BOTTOM,
        note,
        theme::regular(11.0),
        theme::now().text_weak,
    );
}

fn mode_ui(ui: &mut Ui, mode: Mode, error_n: Option<f64>, dfr_n: Option<f64>, active: bool) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 38.0), Sense::hover());
    let dfr_n = dfr_n.filter(|dfr_n| *dfr_n > MIN_N);
    let ratio = error_n.zip(dfr_n).map_or(f64::NAN, |(error_n, dfr_n)| error_n / dfr_n);
    let ratio_text = if mode == Mode::Dfr {
        text::horizon::REFERENCE.get().to_owned()
    } else if ratio.is_finite() {
        format!("{} x DFR", three_digits(ratio))
    } else {
        String::new()
    };
    let words = format!("{}: {}, {ratio_text}", mode_name(mode), newtons_in_three(error_n));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, text::horizon::error(&words)));
    response.on_hover_text(format!(
        "{words}{}\n{}",
        if active { text::horizon::IN_USE.get() } else { "" },
        mode_meaning(mode)
    ));
    let painter = ui.painter();
    let top = rect.top() + 10.0;
    let ink = if active { theme::now().text } else { theme::now().text_weak };
    if active {
        sign(painter, Sign::Disc, egui::pos2(rect.left() + 4.0, top), 4.0, theme::now().rendered);
    }
    let font = if active { theme::strong(14.0) } else { theme::regular(14.0) };
    painter.text(egui::pos2(rect.left() + 14.0, top), Align2::LEFT_CENTER, mode_name(mode), font.clone(), ink);
    let number = newtons_in_three(error_n);
    painter.text(egui::pos2(rect.left() + 200.0, top), Align2::RIGHT_CENTER, number, font, ink);
    painter.text(
        egui::pos2(rect.right(), top),
        Align2::RIGHT_CENTER,
        ratio_text,
        theme::regular(12.5),
        theme::now().text_weak,
    );
    let groove =
        Rect::from_min_max(egui::pos2(rect.left(), rect.top() + 22.0), egui::pos2(rect.right(), rect.top() + 30.0));
    let colour = if active { theme::now().rendered } else { theme::now().reference };
    bar(painter, groove, if ratio.is_finite() { ratio / LONGEST } else { 0.0 }, colour);
    let line = groove.left() + groove.width() / LONGEST as f32;
    painter.vline(line, groove.top() - 2.0..=groove.bottom() + 2.0, egui::Stroke::new(1.5, theme::now().text));
    if ratio > LONGEST {
        let middle = groove.right_center();
        let tip = vec![middle + vec2(0.0, -6.0), middle + vec2(7.0, 0.0), middle + vec2(0.0, 6.0)];
        painter.add(egui::Shape::convex_polygon(tip, colour, egui::Stroke::NONE));
    }
}
