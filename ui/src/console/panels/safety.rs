//! The interlock of each arm pair as a state diagram with the current state highlighted, and the gates in the order in which
//! a force passes them, with the number and reason of their actions.

use egui::{Align2, Color32, Painter, Pos2, Rect, ScrollArea, Sense, Stroke, Ui, pos2, vec2};
use nima_core::safety::TransitionCause;
use nima_machine::{messages::LoopState, rig::Side};

use super::gates::{GateView, gates, history};
use crate::console::{
    live::LiveState,
    readings::StateEntry,
    scene3d::side_name,
    text, theme,
    widgets::{Sign, fitting, sign},
};
use crate::language::Text;
use crate::report_text::{side_word, state_name, within};

const NODE: egui::Vec2 = vec2(82.0, 28.0);
const DIAGRAM_HEIGHT: f32 = 118.0;
/// With less width the states would overlap, so the diagrams are placed below one another.
const DIAGRAM_WIDTH: f32 = 440.0;
const GATE_HEIGHT: f32 = 82.0;

pub fn safety_ui(ui: &mut Ui, live: &LiveState) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        let mut sides: Vec<Side> = live.sides().collect();
        sides.reverse();
        if ui.available_width() < DIAGRAM_WIDTH * sides.len() as f32 {
            for side in &sides {
                interlock_ui(ui, live, *side);
            }
        } else {
            ui.columns(sides.len(), |columns| {
                for (ui, side) in columns.iter_mut().zip(&sides) {
                    interlock_ui(ui, live, *side);
                }
            });
        }
        for side in sides {
            gates_row_ui(ui, live, side);
        }
    });
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
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), DIAGRAM_HEIGHT + 40.0), Sense::hover());
    let state = live.tick_of(side).map_or(LoopState::Idle, |tick| tick.state);
    let change = live.changes[side.index()];
    let since = change.map_or_else(
        || text::safety::SINCE_START.get().to_owned(),
        |StateEntry { t_s, why, .. }| text::safety::since(t_s, why_text(why)),
    );
    let title = text::safety::interlock(&of_side(live, side), &within(state_name(state)));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, format!("{title}, {since}")));
    response.on_hover_text(text::safety::INTERLOCK_HOVER.get());
    let painter = ui.painter_at(rect);
    painter.text(rect.left_top() + vec2(4.0, 2.0), Align2::LEFT_TOP, title, theme::strong(15.0), theme::now().text);
    painter.text(
        rect.left_top() + vec2(4.0, 22.0),
        Align2::LEFT_TOP,
        since,
        theme::regular(12.5),
        theme::now().text_weak,
    );
    let diagram = Rect::from_min_max(rect.min + vec2(0.0, 40.0), rect.max);
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

fn gates_row_ui(ui: &mut Ui, live: &LiveState, side: Side) {
    let Some(tick) = live.tick_of(side) else { return };
    let asked_n = tick.asked_n[tick.mode.index()].norm();
    ui.add_space(6.0);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(5.0, 5.0);
        let ends = 66.0;
        let gates = gates(live, side);
        let width = ((ui.available_width() - 2.0 * ends) / gates.len() as f32 - 5.6).max(72.0);
        end_ui(ui, ends, if live.is_bimanual() { side_name(side) } else { text::safety::ASKED.get() }, asked_n);
        for gate in &gates {
            gate_ui(ui, live, side, gate, width);
        }
        end_ui(ui, ends, text::safety::HAND.get(), live.figures.rendered_n[side.index()]);
    });
}

/// Draws the start or end of the row of gates: a force.
fn end_ui(ui: &mut Ui, width: f32, name: &str, force_n: f64) {
    let (rect, response) = ui.allocate_exact_size(vec2(width, GATE_HEIGHT), Sense::hover());
    let number = if force_n < 1e3 { format!("{force_n:.1} N") } else { "> 1 kN".to_owned() };
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, format!("{name}: {number}")));
    response.on_hover_text(text::safety::FORCE_HOVER.get());
    let painter = ui.painter_at(rect);
    painter.text(
        rect.center() - vec2(0.0, 10.0),
        Align2::CENTER_CENTER,
        name,
        fitting(&painter, name, theme::regular(12.5), rect.width() - 4.0),
        theme::now().text_weak,
    );
    painter.text(rect.center() + vec2(0.0, 9.0), Align2::CENTER_CENTER, number, theme::strong(16.0), theme::now().text);
}

/// Draws one gate: indicator, effect, and how often it acted.
fn gate_ui(ui: &mut Ui, live: &LiveState, side: Side, gate: &GateView, width: f32) {
    let (rect, response) = ui.allocate_exact_size(vec2(width, GATE_HEIGHT), Sense::hover());
    let (what, word) = gate.standing();
    let acted = live.tick_of(side).map_or(0, |tick| tick.gates.counts.acted[gate.which.index()]);
    let words = text::safety::gate(gate.name, &of_side(live, side), word, acted);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &words));
    response.on_hover_text(format!("{}\n{}\n{}", gate.meaning, gate.note, history(live, side, gate.which)));
    let open = what == Sign::Disc;
    let line: Color32 = if open { theme::now().line } else { theme::now().text };
    let painter = ui.painter_at(rect);
    painter.rect(
        rect,
        theme::CORNER,
        theme::now().card,
        Stroke::new(if open { 1.0 } else { 2.0 }, line),
        egui::StrokeKind::Inside,
    );
    let colour = if open { theme::now().engaged.gamma_multiply(0.75) } else { theme::now().text };
    sign(&painter, what, rect.center_top() + vec2(0.0, 15.0), 6.0, colour);
    for (y, text, font, ink) in [
        (34.0, gate.name.to_owned(), theme::strong(13.0), theme::now().text),
        (51.0, word.to_owned(), theme::regular(12.5), if open { theme::now().text_weak } else { theme::now().text }),
        (69.0, compact(acted), theme::regular(12.5), theme::now().text_weak),
    ] {
        let font = fitting(&painter, &text, font, rect.width() - 8.0);
        painter.text(rect.center_top() + vec2(0.0, y), Align2::CENTER_CENTER, text, font, ink);
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
