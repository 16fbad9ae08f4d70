//! The safety functions between the model and the hand: why there is no force, the gates in the order in which a force passes
//! them, and the interlock of each arm pair as a state diagram with the current state highlighted.

use egui::{Align2, Button, Color32, Label, Painter, Pos2, Rect, RichText, Sense, Stroke, Ui, UiBuilder, pos2, vec2};
use nima_core::safety::TransitionCause;
use nima_machine::{
    messages::LoopState,
    rig::{SIDES, Side},
};
use nima_screen::{
    live::LiveState,
    readings::StateEntry,
    scene3d::side_name,
    theme,
    widgets::{Sign, fitting, sign},
};
use nima_words::{
    language::Text,
    report_text::{side_word, state_name, within},
    text,
};

use crate::panel::{Panel, PanelContext, PanelSize};

use super::gates::{GateView, answer, gates, history};

const NODE: egui::Vec2 = vec2(82.0, 28.0);
const DIAGRAM_HEIGHT: f32 = 118.0;
/// Height of the title above the diagram, with the reason in up to two lines.
const TITLE_HEIGHT: f32 = 56.0;
/// Width from which two columns have room.
const TWO_COLUMNS: f32 = 600.0;
/// Distance between the columns of both hands.
const BETWEEN_HANDS: f32 = 24.0;
/// Height of a gate's row, and of a line of the answer.
const LINE: f32 = 20.0;
/// Distance of a gate's name from the left edge, behind its sign.
const NAME: f32 = 20.0;

/// State of the panel: the arm that is shown where there is no room for two.
#[derive(Clone, Copy, Debug)]
pub struct SafetyState {
    side: Side,
}

impl Default for SafetyState {
    fn default() -> Self {
        Self { side: Side::Right }
    }
}

impl Panel for SafetyState {
    const NAME: Text = text::safety::NAME;
    const MEANING: Text = text::safety::MEANING;
    const SIZE: PanelSize = PanelSize::KNOBS;

    fn ui(&mut self, ui: &mut Ui, at: &mut PanelContext<'_>) {
        safety_ui(ui, at.live, self);
    }
}

fn safety_ui(ui: &mut Ui, live: &LiveState, state: &mut SafetyState) {
    let is_wide = ui.available_width() >= TWO_COLUMNS;
    if !live.is_bimanual() {
        state.side = Side::Right;
        answer_ui(ui, live, Side::Right);
        if is_wide {
            ui.columns(2, |columns| {
                gates_ui(&mut columns[0], live, Side::Right);
                interlock_ui(&mut columns[1], live, Side::Right);
            });
            return;
        }
    } else if is_wide {
        ui.spacing_mut().item_spacing.x = BETWEEN_HANDS;
        ui.columns(SIDES, |columns| {
            for (ui, side) in columns.iter_mut().zip(Side::LEFT_TO_RIGHT) {
                ui.label(RichText::new(text::common::hand(side_name(side))).font(theme::strong(15.0)));
                answer_ui(ui, live, side);
                gates_ui(ui, live, side);
                interlock_ui(ui, live, side);
            }
        });
        return;
    } else {
        side_ui(ui, &mut state.side);
        answer_ui(ui, live, state.side);
    }
    gates_ui(ui, live, state.side);
    interlock_ui(ui, live, state.side);
}

fn side_ui(ui: &mut Ui, now: &mut Side) {
    ui.horizontal(|ui| {
        for side in Side::LEFT_TO_RIGHT {
            let button = Button::selectable(*now == side, text::common::hand(side_name(side)));
            let button = button.frame_when_inactive(true).min_size(vec2(104.0, 26.0));
            if ui.add(button).on_hover_text(text::gates::gates_of(side_word(side))).clicked() {
                *now = side;
            }
        }
    });
}

/// Draws the reason for a missing force in the space of two lines, so that the gates below never move.
fn answer_ui(ui: &mut Ui, live: &LiveState, side: Side) {
    let words = answer(live, side);
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 2.0 * LINE), Sense::hover());
    let mut place = ui.new_child(UiBuilder::new().max_rect(rect));
    let label = Label::new(RichText::new(&words).font(theme::strong(14.0))).wrap();
    place.add(label).on_hover_text(&words);
}

fn gates_ui(ui: &mut Ui, live: &LiveState, side: Side) {
    ui.spacing_mut().item_spacing.y = 1.0;
    let tick = live.tick_of(side);
    end_ui(ui, text::safety::ASKED.get(), tick.map(|tick| tick.rendering.asked_n[tick.mode.index()].norm()));
    for gate in &gates(live, side) {
        gate_ui(ui, live, side, gate);
    }
    end_ui(ui, text::safety::HAND.get(), live.rendered_n(side));
    ui.add_space(6.0);
}

/// Returns the suffix that names the side of a rig with two arms.
fn of_side(live: &LiveState, side: Side) -> String {
    if live.is_bimanual() { text::safety::of_hand(side_word(side)) } else { String::new() }
}

/// States and their positions, relative to the diagram's size.
const PLACES: [(Text, f32, f32); 7] = [
    (text::safety::NO_DEVICE, 0.10, 0.26),
    (text::safety::IDLE, 0.32, 0.26),
    (text::safety::READY, 0.52, 0.26),
    (text::safety::ENGAGED, 0.72, 0.26),
    (text::safety::CLUTCHED, 0.90, 0.26),
    (text::safety::STOPPED, 0.32, 0.82),
    (text::safety::FAULT, 0.72, 0.82),
];
/// Transitions between states; stop and fault can be entered from every state and lead back to idle.
const WAYS: [(usize, usize); 6] = [(0, 1), (1, 2), (2, 3), (3, 4), (5, 1), (6, 1)];

const fn place_of(state: LoopState) -> usize {
    match state {
        LoopState::Disconnected => 0,
        LoopState::Idle => 1,
        LoopState::Ready => 2,
        LoopState::Engaged => 3,
        LoopState::Clutched => 4,
        LoopState::Stopped => 5,
        LoopState::Faulted(_) => 6,
    }
}

fn why_text(why: TransitionCause) -> &'static str {
    match why {
        TransitionCause::Asked => text::safety::WHY_ASKED.get(),
        TransitionCause::Connected => text::safety::WHY_CONNECTED.get(),
        TransitionCause::Disconnected => text::safety::WHY_DISCONNECTED.get(),
        TransitionCause::Agreed => text::safety::WHY_AGREED.get(),
        TransitionCause::Clutch => text::safety::WHY_CLUTCH.get(),
        TransitionCause::Late => text::safety::WHY_LATE.get(),
        TransitionCause::Absent => text::safety::WHY_ABSENT.get(),
        TransitionCause::Fault => text::safety::WHY_FAULT.get(),
    }
}

fn interlock_ui(ui: &mut Ui, live: &LiveState, side: Side) {
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), DIAGRAM_HEIGHT + TITLE_HEIGHT), Sense::hover());
    let state = live.tick_of(side).map_or(LoopState::Idle, |tick| tick.state);
    let change = live.changes[side.index()];
    let since = change.map_or_else(
        || text::safety::SINCE_START.get().to_owned(),
        |StateEntry { t_s, why, .. }| text::safety::since(t_s, why_text(why)),
    );
    let title = text::safety::interlock(&of_side(live, side), &within(state_name(state)));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, format!("{title}, {since}")));
    response.on_hover_text(text::safety::INTERLOCK_HOVER);
    let painter = ui.painter_at(rect);
    let width = rect.width() - 8.0;
    let font = fitting(&painter, &title, theme::strong(15.0), width);
    painter.text(rect.left_top() + vec2(4.0, 2.0), Align2::LEFT_TOP, title, font, theme::now().text);
    let since = painter.layout(since, theme::regular(12.5), theme::now().text_weak, width);
    painter.galley(rect.left_top() + vec2(4.0, 22.0), since, theme::now().text_weak);
    let diagram = Rect::from_min_max(rect.min + vec2(0.0, TITLE_HEIGHT), rect.max);
    let node = vec2(NODE.x.min(0.172 * diagram.width()), NODE.y);
    let at = |i: usize| {
        let (_, x, y) = PLACES[i];
        Rect::from_center_size(diagram.min + vec2(x * diagram.width(), y * diagram.height()), node)
    };
    let last = change.map(|change| (place_of(change.from), place_of(state)));
    for (from, to) in WAYS {
        let lit = last.is_some_and(|last| last == (from, to) || last == (to, from));
        way(&painter, at(from), at(to), from < 5, lit);
    }
    // One line below all states stands for the transitions from every state to stop and fault.
    let rail = diagram.top() + 0.54 * diagram.height();
    let stroke = Stroke::new(1.0, theme::now().text_weak);
    painter.add(egui::Shape::dashed_line(&[pos2(at(0).left(), rail), pos2(at(4).right(), rail)], stroke, 4.0, 4.0));
    let right = pos2(at(4).right(), rail - 2.0);
    painter.text(
        right,
        Align2::RIGHT_BOTTOM,
        text::safety::FROM_ANY_STATE.get(),
        theme::regular(11.0),
        theme::now().text_weak,
    );
    for i in [5, 6] {
        let x = at(i).center().x + 16.0;
        arrow(&painter, pos2(x, rail), pos2(x, at(i).top()), stroke);
    }
    for (i, (name, ..)) in PLACES.iter().enumerate() {
        node_ui(&painter, at(i), name.get(), i == place_of(state), state);
    }
}

fn node_ui(painter: &Painter, rect: Rect, name: &str, lit: bool, state: LoopState) {
    let (fill, ink, line) = match state {
        _ if !lit => (theme::now().groove, theme::now().text_weak, theme::now().line),
        LoopState::Engaged | LoopState::Ready | LoopState::Clutched => {
            (theme::now().engaged, theme::now().background, theme::now().text)
        }
        LoopState::Faulted(_) => (theme::now().alarm_high, theme::now().background, theme::now().text),
        LoopState::Stopped => (theme::now().stop, theme::now().background, theme::now().text),
        LoopState::Idle | LoopState::Disconnected => (theme::now().at_rest, theme::now().background, theme::now().text),
    };
    painter.rect(rect, theme::CORNER, fill, Stroke::new(if lit { 2.0 } else { 1.0 }, line), egui::StrokeKind::Inside);
    let font = if lit { theme::strong(14.0) } else { theme::regular(13.0) };
    let font = fitting(painter, name, font, rect.width() - 8.0);
    painter.text(rect.center(), Align2::CENTER_CENTER, name, font, ink);
}

fn way(painter: &Painter, from: Rect, to: Rect, along: bool, lit: bool) {
    let stroke = if lit {
        Stroke::new(2.5, theme::now().text)
    } else {
        Stroke::new(1.0, theme::now().text_weak.gamma_multiply(0.8))
    };
    if along {
        arrow(painter, from.right_center(), to.left_center(), stroke);
    } else {
        let x = to.center().x - if from.center().x > to.center().x { -16.0 } else { 16.0 };
        let turn = pos2(x, from.center().y);
        if (from.center().x - to.center().x).abs() > from.width() {
            painter.line_segment([from.left_center(), turn], stroke);
            arrow(painter, turn, pos2(x, to.bottom()), stroke);
        } else {
            arrow(painter, pos2(x, from.top()), pos2(x, to.bottom()), stroke);
        }
    }
}

fn arrow(painter: &Painter, from: Pos2, to: Pos2, stroke: Stroke) {
    painter.line_segment([from, to], stroke);
    let Some(along) = Some((to - from).normalized()).filter(|along| along.is_finite()) else { return };
    let head = 6.0;
    let side = vec2(-along.y, along.x) * 0.5 * head;
    let base = to - along * head;
    painter.add(egui::Shape::convex_polygon(vec![to, base + side, base - side], stroke.color, Stroke::NONE));
}

/// Draws the force before or after all gates.
fn end_ui(ui: &mut Ui, name: &str, force_n: Option<f64>) {
    let number = match force_n.filter(|force_n| force_n.is_finite()) {
        Some(force_n) if force_n < 1e3 => format!("{force_n:.1} N"),
        Some(_) => "> 1 kN".to_owned(),
        None => "\u{2013}".to_owned(),
    };
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), LINE), Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, format!("{name}: {number}")));
    response.on_hover_text(text::safety::FORCE_HOVER);
    let painter = ui.painter_at(rect);
    let left = rect.left_center() + vec2(NAME, 0.0);
    painter.text(left, Align2::LEFT_CENTER, name, theme::strong(13.0), theme::now().text);
    painter.text(rect.right_center(), Align2::RIGHT_CENTER, number, theme::strong(14.0), theme::now().text);
}

/// Draws one gate in fixed columns: sign, name, state, setting or present effect, and how often it acted.
fn gate_ui(ui: &mut Ui, live: &LiveState, side: Side, gate: &GateView) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), LINE), Sense::hover());
    let (what, word) = gate.standing();
    let acted = live.tick_of(side).map(|tick| tick.gates.counts.acted[gate.which.index()]);
    let words = text::safety::gate(gate.name, &of_side(live, side), word, acted.unwrap_or_default());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &words));
    response.on_hover_text(format!("{}\n{}", gate.meaning, history(live, side, gate.which)));
    let is_open = what == Sign::Disc;
    let palette = theme::now();
    let painter = ui.painter_at(rect);
    let colour = if is_open { palette.engaged.gamma_multiply(0.75) } else { palette.text };
    sign(&painter, what, rect.left_center() + vec2(8.0, 0.0), 5.0, colour);
    let ink: Color32 = if is_open { palette.text_weak } else { palette.text };
    let room = rect.width() - NAME;
    let name_font = if is_open { theme::regular(13.0) } else { theme::strong(13.0) };
    let counted = acted.map_or_else(|| "\u{2013}".to_owned(), compact);
    for (from, to, words, font, align) in [
        (0.0, 0.29, gate.name, name_font, Align2::LEFT_CENTER),
        (0.30, 0.51, word, theme::regular(13.0), Align2::LEFT_CENTER),
        (0.52, 0.82, gate.note.as_str(), theme::regular(12.5), Align2::RIGHT_CENTER),
        (0.83, 1.0, counted.as_str(), theme::regular(12.5), Align2::RIGHT_CENTER),
    ] {
        let left = rect.left() + NAME + from * room;
        let right = rect.left() + NAME + to * room;
        let x = if align == Align2::LEFT_CENTER { left } else { right };
        let font = fitting(&painter, words, font, right - left);
        painter.text(pos2(x, rect.center().y), align, words, font, ink);
    }
}

/// Returns a count in a short form that fits below a gate.
fn compact(count: u64) -> String {
    match count {
        0 => text::safety::NEVER.get().to_owned(),
        1..=9999 => format!("{count} x"),
        10_000..=9_999_999 => format!("{} k x", count / 1000),
        _ => format!("{} M x", count / 1_000_000),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_fit_under_a_gate() {
        assert_eq!([0, 7, 12_345, 99_000_000].map(compact), ["never", "7 x", "12 k x", "99 M x"].map(str::to_owned));
        assert!(compact(u64::MAX).len() < 24);
    }
}
