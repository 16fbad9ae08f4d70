//! The Prediction error panel: error of each mode at the prediction horizon, which is the delay of the link.

use egui::{Align2, Rect, Sense, Ui, vec2};
use nima_core::impedance::{Mode, ModeSet};
use nima_machine::messages::Command;
use nima_screen::{
    live::{LiveState, TREND_S},
    outbox::Outbox,
    theme,
    widgets::{Sign, bar, fitting, sign, small, width_of},
};
use nima_words::{
    language::Text,
    report_text::{COMPARED, UNKNOWN, mode_meaning, mode_name, newtons, newtons_in_three, three_digits},
    text,
};

use crate::panel::{Panel, PanelContext, PanelSize};

/// Upper end of the bars, as a multiple of the error of delayed DFR.
const LONGEST: f64 = 2.5;
/// Height of the trend plot.
const TREND_HEIGHT: f32 = 46.0;
/// A smaller error is noise, and its ratio is meaningless, N.
const MIN_N: f64 = 1e-4;

/// Right end of a mode's error, from the left edge.
const NUMBER_RIGHT: f32 = 200.0;
/// Largest ratio and error that are shown to an audience, as a multiple of the error of delayed DFR.
const PLAIN_MAX: f64 = 10.0;

#[derive(Debug, Default)]
pub struct HorizonPanel;

impl Panel for HorizonPanel {
    const NAME: Text = text::horizon::NAME;
    const MEANING: Text = text::horizon::MEANING;
    const SIZE: PanelSize = PanelSize::FIGURES;

    fn ui(&mut self, ui: &mut Ui, at: &mut PanelContext<'_>) {
        horizon_ui(ui, at.live, at.outbox, false);
    }
}

/// Draws the panel; `plain`: for an audience, without abbreviations and huge numbers.
pub fn horizon_ui(ui: &mut Ui, live: &LiveState, outbox: &mut Outbox, plain: bool) {
    let computed = live.first_tick().map_or(ModeSet::only(Mode::Dfr), |tick| tick.identification.modes);
    let dfr_n = live.figures.horizon_n[Mode::Dfr.index()];
    let compares = outbox.compares(live);
    let ahead = if plain { text::horizon::ahead_plain } else { text::horizon::ahead };
    ui.label(small(ahead(live.delay_s() * 1e3)));
    if plain {
        // The demonstration compares all modes, and its rows must fit into a low window.
        ui.spacing_mut().item_spacing.y = 2.0;
    } else {
        compare_ui(ui, live, compares, outbox);
    }
    ui.add_space(2.0);
    let modes = COMPARED.into_iter().chain(computed.baseline().map(Mode::Baseline));
    // Another panel may have all modes computed; they are listed here only by the operator's choice.
    let is_listed = |mode: &Mode| compares || [Mode::Dfr, live.mode()].contains(mode);
    for mode in modes.filter(|mode| computed.contains(*mode) && is_listed(mode)) {
        let error = ModeError { mode, error_n: live.figures.horizon_n[mode.index()], dfr_n, plain };
        mode_ui(ui, &error, live.mode() == mode);
    }
    if !plain || ui.available_height() > TREND_HEIGHT {
        trend_ui(ui, live, plain);
    }
}

fn compare_ui(ui: &mut Ui, live: &LiveState, mut compares: bool, outbox: &mut Outbox) {
    let compare = egui::Checkbox::new(&mut compares, text::horizon::COMPARE);
    let compare = ui.add_enabled(!live.is_shown_only(), compare).on_hover_text(text::horizon::COMPARE_HOVER);
    if compare.on_disabled_hover_text(live.of.blocked()).changed() {
        outbox.push(Command::Compare(compares));
    }
}

/// Returns the mean error of a mode over the last minutes, N; `None` if the force was never known.
fn mean_n(live: &LiveState, mode: Mode) -> Option<f64> {
    let errors_n = live.trend_n.iter().map(|errors_n| errors_n[mode.index()]).filter(|error_n| error_n.is_finite());
    let (count, sum_n) = errors_n.fold((0.0, 0.0), |(count, sum_n), error_n| (count + 1.0, sum_n + error_n));
    (count > 0.0).then(|| sum_n / count)
}

/// Draws the errors of the active mode and of delayed DFR over the last minutes, one point per second.
fn trend_ui(ui: &mut Ui, live: &LiveState, plain: bool) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), TREND_HEIGHT), Sense::hover());
    let [ours, dfr] = [live.mode(), Mode::Dfr].map(|mode| newtons_in_three(mean_n(live, mode)));
    let reference = if plain { text::horizon::DIRECT.get() } else { text::horizon::DELAYED_DFR.get() };
    let words = text::horizon::trend(live.trend_n.len(), name_of(live.mode(), plain), &ours, reference, &dfr);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, text::horizon::trend_name(&words)));
    response.on_hover_text(text::horizon::trend_meaning(&words));
    let painter = ui.painter();
    painter.rect_filled(rect, 3.0, theme::now().groove);
    let highest_n = 1.1 * live.trend_n.iter().map(|errors_n| errors_n[Mode::Dfr.index()]).fold(MIN_N, f64::max);
    // The labels have their own column: lines over them would make both unreadable.
    let is_known = live.trend_n.iter().flatten().any(|error_n| error_n.is_finite());
    let highest = format!("{} N", if is_known { three_digits(highest_n) } else { UNKNOWN.to_owned() });
    let font = theme::regular(11.0);
    let labels = [highest.as_str(), text::horizon::LAST_3_MIN.get()];
    let width = labels.map(|label| width_of(painter, label, font.clone())).into_iter().fold(0.0, f32::max);
    let lines = rect.with_min_x(rect.left() + width + 10.0);
    for (mode, colour) in [(Mode::Dfr, theme::now().reference), (live.mode(), theme::now().rendered)] {
        let points = live.trend_n.iter().rev().enumerate().map(|(age_s, errors_n)| {
            let along = 1.0 - age_s as f32 / (TREND_S - 1) as f32;
            let error_n = Some(errors_n[mode.index()]).filter(|error_n| error_n.is_finite())?;
            let up = (error_n / highest_n).min(1.0) as f32;
            let x = lines.left() + along * lines.width();
            let y = lines.bottom() - 2.0 - up * (lines.height() - 4.0);
            Some(egui::pos2(x, y))
        });
        let points: Vec<_> = points.collect();
        for run in points.split(Option::is_none) {
            painter.line(run.iter().flatten().copied().collect(), egui::Stroke::new(1.5, colour));
        }
    }
    let [above, below] = labels;
    let ink = theme::now().text_weak;
    painter.text(rect.left_top() + vec2(4.0, 3.0), Align2::LEFT_TOP, above, font.clone(), ink);
    painter.text(rect.left_bottom() + vec2(4.0, -3.0), Align2::LEFT_BOTTOM, below, font, ink);
}

/// Returns the name of a mode, without an abbreviation for an audience.
fn name_of(mode: Mode, plain: bool) -> &'static str {
    if plain && mode == Mode::Dfr { text::horizon::DIRECT.get() } else { mode_name(mode) }
}

/// Error of a mode, compared with delayed DFR.
struct ModeError {
    mode: Mode,
    error_n: Option<f64>,
    dfr_n: Option<f64>,
    plain: bool,
}

impl ModeError {
    /// Returns the ratio to the error of delayed DFR; NaN if it is unknown.
    fn ratio(&self) -> f64 {
        let dfr_n = self.dfr_n.filter(|dfr_n| *dfr_n > MIN_N);
        self.error_n.zip(dfr_n).map_or(f64::NAN, |(error_n, dfr_n)| error_n / dfr_n)
    }

    /// Returns the error and the ratio as text.
    fn words(&self) -> [String; 2] {
        let ratio = self.ratio();
        if let (true, true, Some(dfr_n)) = (self.plain, ratio > PLAIN_MAX, self.dfr_n) {
            let error = format!("> {}", newtons(Some(PLAIN_MAX * dfr_n), 1));
            return [error, text::horizon::times_direct(&format!("> {PLAIN_MAX:.0}"))];
        }
        let ratio = match ratio {
            _ if self.mode == Mode::Dfr => text::horizon::REFERENCE.get().to_owned(),
            ratio if !ratio.is_finite() => String::new(),
            ratio if self.plain => text::horizon::times_direct(&three_digits(ratio)),
            ratio => format!("{} x DFR", three_digits(ratio)),
        };
        [newtons_in_three(self.error_n), ratio]
    }
}

fn mode_ui(ui: &mut Ui, error: &ModeError, active: bool) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 38.0), Sense::hover());
    let mode = error.mode;
    let ratio = error.ratio();
    let [number, ratio_text] = error.words();
    let name = name_of(mode, error.plain);
    let words = format!("{name}: {number}, {ratio_text}");
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
    let room = NUMBER_RIGHT - 14.0 - width_of(painter, &number, font.clone()) - 8.0;
    let name_font = fitting(painter, name, font.clone(), room);
    painter.text(egui::pos2(rect.left() + 14.0, top), Align2::LEFT_CENTER, name, name_font, ink);
    painter.text(egui::pos2(rect.left() + NUMBER_RIGHT, top), Align2::RIGHT_CENTER, number, font, ink);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_audience_reads_no_abbreviation_and_no_huge_number() {
        let error = |mode, error_n, plain| ModeError { mode, error_n: Some(error_n), dfr_n: Some(0.5), plain }.words();
        assert_eq!(error(Mode::Literal, 2.2e27, true), ["> 5.0 N", "> 10x direct"]);
        assert_eq!(error(Mode::Literal, f64::INFINITY, true)[1], "> 10x direct");
        assert_eq!(error(Mode::Linear, 0.25, true), ["0.250 N", "0.500x direct"]);
        assert_eq!(error(Mode::Linear, 0.25, false)[1], "0.500 x DFR");
        assert!(!name_of(Mode::Dfr, true).contains("DFR"));
    }
}
