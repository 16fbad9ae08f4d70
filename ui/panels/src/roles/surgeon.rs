//! The Surgeon view: the endoscope image, or a drawing of the field for a rig without endoscope; below it both forces with
//! the ceiling for each hand, and the gain in between. At most six numbers: two forces of each hand, the gain, the ceiling.

use egui::{
    Align2, Button, CentralPanel, FontId, Frame, Margin, Panel, Rect, RichText, Sense, TextStyle, Ui, pos2, vec2,
};
use nima_core::impedance::Mode;
use nima_machine::{messages::Command, rig::Side};
use nima_screen::{
    live::LiveState,
    outbox::Outbox,
    scene3d::{scene_ui, side_name},
    theme,
    widgets::{bar, fitting, force_sign, small, width_of},
};
use nima_words::{
    report_text::{mode_meaning, mode_name, newtons, newtons_read},
    text::{self, of_files::of_file},
};

use super::{Panels, acts};
use crate::{calm_gain_ui, why_no_force};

const STRIP: f32 = 206.0;
const GAIN_WIDTH: f32 = 330.0;
/// Upper end of a bar, as a multiple of the ceiling.
const BEYOND_CEILING: f64 = 1.25;

pub(super) fn surgeon_ui(ui: &mut Ui, live: &mut LiveState, panels: &mut Panels, outbox: &mut Outbox) {
    let strip = Frame::new().fill(theme::now().panel).inner_margin(Margin::same(8));
    Panel::bottom("strip").exact_size(STRIP).resizable(false).frame(strip).show(ui, |ui| {
        let room = ui.available_rect_before_wrap();
        let gain = Rect::from_center_size(room.center(), vec2(GAIN_WIDTH, room.height()));
        let left = Rect::from_min_max(room.min, pos2(gain.left() - theme::GAP, room.bottom()));
        let right = Rect::from_min_max(pos2(gain.right() + theme::GAP, room.top()), room.max);
        hand_ui(ui, live, Side::Right, right);
        if live.is_bimanual() {
            hand_ui(ui, live, Side::Left, left);
        } else {
            reported_ui(ui, live, left);
        }
        ui.scope_builder(egui::UiBuilder::new().max_rect(gain), |ui| {
            theme::card().show(ui, |ui| {
                ui.set_min_size(ui.available_size());
                acts(ui, live, |ui| {
                    calm_gain_ui(ui, live, &mut panels.feedback, outbox);
                    modes_ui(ui, live, outbox);
                });
                ui.add(egui::Label::new(small(report(live))).wrap());
            });
        });
    });
    CentralPanel::no_frame().show(ui, |ui| {
        if panels.eyes.is_on() {
            panels.eyes.ui(ui, live);
        } else {
            scene_ui(ui, live, &mut panels.scene, outbox);
        }
    });
}

/// Modes that a surgeon may choose: those whose force does not grow with the delay of the link.
const MODES: [Mode; 3] = [Mode::Best, Mode::Matched, Mode::Anchored];

fn modes_ui(ui: &mut Ui, live: &LiveState, outbox: &mut Outbox) {
    ui.spacing_mut().item_spacing.x = 6.0;
    let count = MODES.len() as f32;
    let padding = 2.0 * ui.spacing().button_padding.x;
    let room = ui.available_width() - 6.0 * (count - 1.0) - count * padding;
    let font = TextStyle::Button.resolve(ui.style());
    let widths = MODES.map(|mode| width_of(ui.painter(), mode_name(mode), font.clone()));
    // A long name takes space from the short ones before any name gets smaller.
    let are_equal = widths.iter().all(|width| *width <= room / count);
    let needed: f32 = widths.iter().sum();
    let font = FontId { size: font.size * (0.98 * room / needed).min(1.0), ..font };
    ui.horizontal(|ui| {
        for (mode, needs) in MODES.into_iter().zip(widths) {
            let width = if are_equal { room / count } else { room * needs / needed } + padding;
            let name = mode_name(mode);
            let font = font.clone();
            let button = Button::selectable(live.mode() == mode, RichText::new(name).font(font));
            let button = ui.add(button.frame_when_inactive(true).min_size(vec2(width, 28.0)));
            if button.on_hover_text(mode_meaning(mode)).clicked() {
                outbox.push(Command::SetMode(mode));
            }
        }
    });
}

/// Returns the reason why a hand gets less force than requested, with the hand; otherwise the mode.
fn report(live: &LiveState) -> String {
    let whys: Vec<(Side, String)> =
        live.sides().filter_map(|side| why_no_force(live, side).map(|why| (side, why))).collect();
    match whys.as_slice() {
        // The buttons above already name it.
        [] if MODES.contains(&live.mode()) => String::new(),
        [] => mode_name(live.mode()).to_owned(),
        [(_, one), (_, other)] if one == other => one.clone(),
        [(side, why), ..] if live.is_bimanual() => format!("{}: {why}", side_name(*side)),
        [(_, why), ..] => why.clone(),
    }
}

/// Explains the colours where a second hand would be shown.
fn reported_ui(ui: &Ui, live: &LiveState, place: Rect) {
    let painter = ui.painter_at(place);
    painter.rect_filled(place, theme::CORNER, theme::now().card);
    let text = place.left_top() + vec2(16.0, 16.0);
    painter.text(text, Align2::LEFT_TOP, of_file(&live.scene.name), theme::strong(17.0), theme::now().text);
    for (i, (rendered, words)) in
        [(false, text::roles::MEASURED.get()), (true, text::roles::RENDERED.get())].into_iter().enumerate()
    {
        let y = text.y + 52.0 + 34.0 * i as f32;
        force_sign(&painter, theme::now(), Rect::from_center_size(pos2(text.x + 18.0, y), vec2(36.0, 16.0)), rendered);
        painter.text(pos2(text.x + 48.0, y), Align2::LEFT_CENTER, words, theme::regular(15.0), theme::now().text_weak);
    }
}

/// Draws both forces of a hand as numbers and as bars with the ceiling.
fn hand_ui(ui: &mut Ui, live: &LiveState, side: Side, place: Rect) {
    let ceiling_n = live.gate_settings().ceiling_n;
    let measured_n = live.figures.measured_n[side.index()];
    let rendered_n = live.rendered_n(side);
    let response = ui.allocate_rect(place, Sense::hover());
    let name = text::common::hand(side_name(side));
    let [measured, rendered] = [measured_n, rendered_n].map(|force_n| newtons_read(force_n, 1));
    let words = text::roles::hand(&name, &measured, &rendered, ceiling_n);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &words));
    response.on_hover_text(text::roles::BARS_HOVER);
    let painter = ui.painter_at(place);
    painter.rect_filled(place, theme::CORNER, theme::now().card);
    let inner = place.shrink2(vec2(16.0, 12.0));
    painter.text(inner.left_top(), Align2::LEFT_TOP, name, theme::strong(17.0), theme::now().text);
    let bars = Rect::from_min_max(inner.left_top() + vec2(190.0, 34.0), inner.max);
    let mark = bars.left() + bars.width() / BEYOND_CEILING as f32;
    for (i, (force_n, rendered, colour)) in
        [(measured_n, false, theme::now().measured), (rendered_n, true, theme::now().rendered)].into_iter().enumerate()
    {
        let y = bars.top() + (0.25 + 0.5 * i as f32) * bars.height();
        force_sign(
            &painter,
            theme::now(),
            Rect::from_center_size(pos2(inner.left() + 18.0, y), vec2(36.0, 16.0)),
            rendered,
        );
        let at = pos2(inner.left() + 172.0, y);
        painter.text(at, Align2::RIGHT_CENTER, newtons(force_n, 1), theme::strong(38.0), colour);
        let groove = Rect::from_center_size(pos2(bars.center().x, y), vec2(bars.width(), 26.0));
        bar(&painter, groove, force_n.map_or(0.0, |force_n| force_n / (BEYOND_CEILING * ceiling_n)), colour);
    }
    let acts = live.is_limited(side);
    let ink = if acts { theme::now().alarm_medium } else { theme::now().text };
    painter.vline(mark, bars.top()..=bars.bottom(), egui::Stroke::new(2.5, ink));
    let words = if acts { text::roles::limited(ceiling_n) } else { text::roles::ceiling(ceiling_n) };
    let at = pos2(mark, inner.top() + 2.0);
    let font = if acts { theme::strong(14.0) } else { theme::regular(14.0) };
    let font = fitting(&painter, &words, font, 2.0 * (inner.right() - mark));
    painter.text(at, Align2::CENTER_TOP, words, font, if acts { ink } else { theme::now().text_weak });
}

#[cfg(test)]
mod tests {
    use egui_kittest::{Harness, kittest::Queryable as _};

    use super::*;

    #[test]
    fn the_forces_before_the_first_tick_are_unknown() {
        let plan = nima_tests::plan("peg_transfer");
        let live = LiveState::new(plan.rig, plan.scene);
        let draw = move |ui: &mut Ui| {
            if theme::is_applied(ui.ctx()) {
                let place = ui.max_rect();
                hand_ui(ui, &live, Side::Right, place);
            }
        };
        let mut window = Harness::builder().with_size([500.0, 200.0]).build_ui(draw);
        window.run_steps(3);
        assert!(window.query_by_label_contains("measured unknown, rendered unknown").is_some());
    }
}
