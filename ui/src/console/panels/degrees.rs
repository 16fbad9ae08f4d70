//! The identified polynomial degrees: the current one, the fraction of nonlinear ones, and how well the motion determines
//! them.

use crate::console::text;
use egui::{Align2, Rect, Sense, Ui, vec2};
use nima_core::impedance::Mode;

use crate::console::{
    live::{DEGREES_S, LiveState},
    rolling::DEGREES,
    theme,
    widgets::{figure, small},
};
use crate::report_text::three_digits;

const CHART_HEIGHT: f32 = 92.0;

pub fn degrees_ui(ui: &mut Ui, live: &LiveState) {
    let compares = live.first_tick().is_some_and(|tick| tick.identification.modes.contains(Mode::Literal));
    ui.horizontal(|ui| {
        key_ui(ui, theme::now().rendered, text::degrees::KEY_OURS.get(), text::degrees::KEY_OURS_HOVER.get());
        if compares {
            key_ui(ui, theme::now().reference, text::degrees::KEY_PAPER.get(), text::degrees::KEY_PAPER_HOVER.get());
        }
        ui.label(small(text::degrees::last_minutes(DEGREES_S / 60.0)));
    });
    chart_ui(ui, live, compares);
    let fraction = |fraction: f64| format!("{:.0} %", 100.0 * fraction);
    figure(
        ui,
        text::degrees::NONLINEAR_OURS.get(),
        fraction(live.degrees.nonlinear()),
        text::degrees::NONLINEAR_OURS_HOVER.get(),
    );
    let papers =
        if compares { fraction(live.paper_degrees.nonlinear()) } else { text::degrees::NOT_COMPUTED.get().to_owned() };
    figure(ui, text::degrees::NONLINEAR_PAPER.get(), papers, text::degrees::NONLINEAR_PAPER_HOVER.get());
    quality_ui(ui, live, compares);
}

fn quality_ui(ui: &mut Ui, live: &LiveState, compares: bool) {
    let Some(tick) = live.first_tick() else { return };
    let report = &tick.identification;
    if !compares {
        for (name, meaning) in [
            (text::degrees::CONDITION.get(), text::degrees::CONDITION_HOVER.get()),
            (text::degrees::RANK.get(), text::degrees::RANK_HOVER.get()),
            (text::degrees::EXCITATION.get(), text::degrees::EXCITATION_HOVER.get()),
        ] {
            figure(ui, name, text::degrees::NOT_COMPUTED.get().to_owned(), meaning);
        }
        return;
    }
    figure(ui, text::degrees::CONDITION.get(), three_digits(report.condition), text::degrees::CONDITION_HOVER.get());
    figure(
        ui,
        text::degrees::RANK.get(),
        text::degrees::columns(report.rank, 3 * live.rig.identification.max_degree, report.columns),
        text::degrees::RANK_HOVER.get(),
    );
    let excitation = &report.excitation;
    figure(
        ui,
        text::degrees::EXCITATION.get(),
        format!("{:.1} mm   {:.0} mm/s", excitation.position_m.norm() * 1e3, excitation.velocity_m_s.norm() * 1e3),
        text::degrees::EXCITATION_HOVER.get(),
    );
}

fn key_ui(ui: &mut Ui, colour: egui::Color32, name: &str, meaning: &str) {
    let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
    ui.painter().rect_filled(rect, 2.0, colour);
    ui.label(small(name)).on_hover_text(meaning);
}

/// Draws six pairs of bars, degrees 0 to 5, with their percentages above.
fn chart_ui(ui: &mut Ui, live: &LiveState, compares: bool) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), CHART_HEIGHT + 20.0), Sense::hover());
    let ours = live.degrees.fractions();
    let papers = live.paper_degrees.fractions();
    let words = |fractions: &[f64; DEGREES]| {
        fractions
            .iter()
            .enumerate()
            .map(|(n, fraction)| format!("{n}: {:.0} %", 100.0 * fraction))
            .collect::<Vec<_>>()
            .join("   ")
    };
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, text::degrees::chosen(&words(&ours))));
    response.on_hover_text(if compares {
        text::degrees::both(&words(&ours), &words(&papers))
    } else {
        text::degrees::chosen(&words(&ours))
    });
    let painter = ui.painter();
    let ground = Rect::from_min_size(rect.min, vec2(rect.width(), CHART_HEIGHT));
    painter.rect_filled(ground, 3.0, theme::now().groove);
    let cell = ground.width() / DEGREES as f32;
    let width = 0.32 * cell;
    for degree in 0..DEGREES {
        let middle = ground.left() + (degree as f32 + 0.5) * cell;
        let bars = [
            (ours[degree], middle - width - 1.0, theme::now().rendered),
            (papers[degree], middle + 1.0, theme::now().reference),
        ];
        for (fraction, left, colour) in bars.into_iter().take(1 + usize::from(compares)) {
            let height = (CHART_HEIGHT - 18.0) * fraction as f32;
            let filled = Rect::from_min_max(
                egui::pos2(left, ground.bottom() - height.max(1.0)),
                egui::pos2(left + width, ground.bottom()),
            );
            painter.rect_filled(filled, 1.0, colour);
            if fraction >= 0.005 {
                let place = egui::pos2(left + 0.5 * width, ground.bottom() - height - 8.0);
                painter.text(
                    place,
                    Align2::CENTER_CENTER,
                    format!("{:.0}", 100.0 * fraction),
                    theme::regular(11.0),
                    theme::now().text_weak,
                );
            }
        }
        let name = if degree == 0 { text::degrees::NONE.get().to_owned() } else { degree.to_string() };
        painter.text(
            egui::pos2(middle, ground.bottom() + 10.0),
            Align2::CENTER_CENTER,
            name,
            theme::regular(12.5),
            theme::now().text_weak,
        );
    }
}
