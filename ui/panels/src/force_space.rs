//! Measured and rendered force as points in 3-D: the last seconds, the ceiling as a sphere, and the ellipsoid that contains
//! 95 % of their differences. Rotated by dragging; drawn by egui's painter, so that it looks the same with and without a GPU.

use std::f32::consts::TAU;

use egui::{
    Align2, Button, Color32, Painter, Pos2, Rect, RichText, Sense, Shape, Stroke, TextStyle, TextWrapMode, Ui,
    UiBuilder, Vec2, pos2, vec2,
};
use nalgebra::Vector3;
use nima_machine::rig::Side;
use nima_screen::{
    force_cloud::{Ellipsoid, ForcePair, GAP_S, SECONDS},
    live::LiveState,
    theme,
    widgets::{fitting, width_of},
};
use nima_words::{language::Text, report_text::newtons, text};

use crate::{
    panel::{Panel, PanelContext, PanelSize},
    roles::Panels,
};

use super::traces_state::stepped;

/// Height of the caption.
const CAPTION: f32 = 40.0;
/// Space for the legend at the upper left, in which no number of an axis is drawn.
const LEGEND: Vec2 = vec2(190.0, 50.0);
/// Smallest radius of the view, N.
const MIN_N: f32 = 0.75;
const RING: u32 = 48;

/// Direction of view, and radius.
#[derive(Clone, Copy, Debug)]
pub struct ForceSpaceState {
    yaw: f32,
    pitch: f32,
    reach_n: f32,
    /// The error ellipsoid, with the number and the end time (s) of the samples from which it was computed: older samples may
    /// be added later.
    ellipsoid: (usize, f64, Option<Ellipsoid>),
    /// Whether the measured and the rendered force are hidden.
    hidden: [bool; 2],
}

impl Default for ForceSpaceState {
    fn default() -> Self {
        Self { yaw: 0.6, pitch: 0.35, reach_n: MIN_N, ellipsoid: (0, f64::NEG_INFINITY, None), hidden: [false; 2] }
    }
}

impl ForceSpaceState {
    /// Looks from the first direction again, at both forces.
    fn reset(&mut self) {
        *self = Self::default();
    }
}

/// Projection from force to the screen.
struct ForceProjection {
    centre: Pos2,
    points_per_n: f32,
    right: Vector3<f32>,
    up: Vector3<f32>,
    /// Centre of the view: contact pushes upwards, so it is half a radius above zero.
    middle_n: Vector3<f32>,
}

impl ForceProjection {
    fn place(&self, force_n: &Vector3<f32>) -> Pos2 {
        let from_middle = force_n - self.middle_n;
        self.centre + self.points_per_n * vec2(from_middle.dot(&self.right), -from_middle.dot(&self.up))
    }
}

#[derive(Debug, Default)]
pub struct ForceSpacePanel;

impl Panel for ForceSpacePanel {
    const NAME: Text = text::force_space::NAME;
    const MEANING: Text = text::force_space::MEANING;
    const SIZE: PanelSize = PanelSize::filling([200.0, 180.0]);

    fn ui(&mut self, ui: &mut Ui, at: &mut PanelContext<'_>) {
        let Panels { forces, space, .. } = &mut *at.panels;
        force_space_ui(ui, at.live, forces.side(), space, forces.cursor_at_s(at.live));
    }
}

/// Draws the plot over the available space; `cursor_s` is the time at the cursor of a trace, s on the loop's clock.
pub fn force_space_ui(ui: &mut Ui, live: &LiveState, side: Side, state: &mut ForceSpaceState, cursor_s: Option<f64>) {
    let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
    let cloud = &live.clouds[side.index()];
    let newest_s = cloud.pairs().next_back().map_or(0.0, |pair| pair.t_s);
    let now_s = live.tick_of(side).map_or(newest_s, |tick| tick.t_s);
    let is_known = now_s - newest_s < GAP_S;
    let shown_s = stepped(now_s, live.min_step_s());
    let (count, until_s, _) = state.ellipsoid;
    if count != cloud.pairs().len() || until_s.total_cmp(&shown_s).is_ne() {
        state.ellipsoid = (cloud.pairs().len(), shown_s, cloud.ellipsoid());
    }
    let ellipsoid = state.ellipsoid.2.filter(|_| is_known);
    // Show slightly less than what is stored, because the oldest samples are dropped between two frames.
    let shown = (shown_s - SECONDS + 2.0 * live.min_step_s())..=shown_s;
    let pairs: Vec<&ForcePair> = cloud.pairs().filter(|pair| shown.contains(&pair.t_s)).collect();
    let words = if is_known { caption(ellipsoid.as_ref()) } else { text::force_space::unknown(SECONDS) };
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Canvas, true, text::force_space::canvas(&words)));
    if response.dragged() {
        state.yaw += response.drag_delta().x * 0.01;
        state.pitch = (state.pitch + response.drag_delta().y * 0.01).clamp(-1.5, 1.5);
    }
    if response.double_clicked() {
        state.reset();
    }
    response.on_hover_text(text::force_space::HOVER);
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, theme::CORNER, theme::now().groove);
    let max_n = pairs.iter().map(|pair| pair.measured_n.amax().max(pair.rendered_n.amax())).fold(0.0, f64::max);
    state.reach_n = reach_n(max_n as f32, state.reach_n);
    let place = Rect::from_min_max(rect.min, rect.max - vec2(0.0, CAPTION));
    let view = view(state, place);
    axes(&painter, &view, state.reach_n);
    ceiling(&painter.with_clip_rect(place), &view, live.gate_settings().ceiling_n as f32);
    let magnitudes_n = curves(&painter, &view, &pairs, state.hidden, cursor_s.unwrap_or(now_s));
    if let (Some(ellipsoid), Some(pair)) = (ellipsoid, pairs.last()) {
        rings(&painter.with_clip_rect(place), &view, &pair.measured_n.cast(), &ellipsoid);
    }
    let at = pos2(rect.left() + 10.0, rect.bottom() - CAPTION + 4.0);
    for (i, line) in words.split("; ").enumerate() {
        let at = at + vec2(0.0, 16.0 * i as f32);
        let font = fitting(&painter, line, theme::regular(12.5), rect.right() - at.x - 4.0);
        painter.text(at, Align2::LEFT_TOP, line, font, theme::now().text_weak);
    }
    legend_ui(ui, state, rect, magnitudes_n);
}

/// Draws the curves that are not hidden, and a dot at this time, s; returns the magnitudes of the measured and of the rendered
/// force at the dots, N.
fn curves(
    painter: &Painter,
    view: &ForceProjection,
    pairs: &[&ForcePair],
    hidden: [bool; 2],
    at_s: f64,
) -> [Option<f64>; 2] {
    let mut magnitudes_n = [None; 2];
    // The measured force is drawn over the rendered one.
    for (colour, width, rendered) in [(theme::now().rendered, 1.6, true), (theme::now().measured, 2.2, false)] {
        if hidden[usize::from(rendered)] {
            continue;
        }
        let force_n = |pair: &ForcePair| if rendered { pair.rendered_n } else { pair.measured_n };
        // Draw one line for each interval in which the measured force was known.
        for run in pairs.chunk_by(|before, after| after.t_s - before.t_s < GAP_S) {
            let points = run.iter().map(|pair| view.place(&force_n(pair).cast())).collect();
            painter.line(points, Stroke::new(width, colour.gamma_multiply(0.75)));
        }
        // The newest sample, or the sample at the cursor of a trace, if the force was known then.
        let pointed_at = pairs.iter().min_by(|a, b| (a.t_s - at_s).abs().total_cmp(&(b.t_s - at_s).abs()));
        if let Some(pair) = pointed_at.filter(|pair| (pair.t_s - at_s).abs() < GAP_S) {
            painter.circle_filled(view.place(&force_n(pair).cast()), 4.5, colour);
            magnitudes_n[usize::from(rendered)] = Some(force_n(pair).norm());
        }
    }
    magnitudes_n
}

/// Draws the names of both forces with their magnitudes at the dots, and the button that resets the view. A click on a name
/// hides or shows its curve.
fn legend_ui(ui: &mut Ui, state: &mut ForceSpaceState, rect: Rect, magnitudes_n: [Option<f64>; 2]) {
    let names = [(&text::traces::MEASURED, theme::now().measured), (&text::traces::RENDERED, theme::now().rendered)];
    for (row, ((name, colour), force_n)) in names.into_iter().zip(magnitudes_n).enumerate() {
        let is_hidden = state.hidden[row];
        let words = text::force_space::magnitude(name.get(), &newtons(force_n, 2));
        let words = RichText::new(words).font(theme::strong(12.5));
        let words = if is_hidden { words.strikethrough().color(theme::now().text_weak) } else { words.color(colour) };
        let place = Rect::from_min_size(rect.left_top() + vec2(6.0, 4.0 + 20.0 * row as f32), vec2(rect.width(), 18.0));
        let button = Button::new(words).frame_when_inactive(false).small().wrap_mode(TextWrapMode::Extend);
        // The circle of the ceiling may pass behind the name.
        let ground = ui.painter().add(Shape::Noop);
        let response = ui.new_child(UiBuilder::new().max_rect(place).id_salt(row)).add(button);
        ui.painter().set(ground, Shape::rect_filled(response.rect, 0.0, theme::now().groove));
        response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, !is_hidden, name.get()));
        if response.on_hover_text(text::traces::LEGEND_HOVER).clicked() {
            state.hidden[row] ^= true;
        }
    }
    let font = TextStyle::Button.resolve(ui.style());
    let width = width_of(ui.painter(), text::force_space::RESET.get(), font) + 2.0 * ui.spacing().button_padding.x;
    let size = vec2(width, 22.0);
    let place = Rect::from_min_size(rect.right_top() + vec2(-size.x - 6.0, 6.0), size);
    let reset = ui.put(place, Button::new(text::force_space::RESET).small().min_size(size));
    if reset.on_hover_text(text::force_space::RESET_HOVER).clicked() {
        state.reset();
    }
}

fn caption(ellipsoid: Option<&Ellipsoid>) -> String {
    ellipsoid.map_or_else(
        || text::force_space::too_short(SECONDS),
        |Ellipsoid { mean_n, half_axes_n, holds }| {
            let mut halves_n = [0, 1, 2].map(|axis| half_axes_n.column(axis).norm());
            halves_n.sort_by(|a, b| b.total_cmp(a));
            text::force_space::error(SECONDS, mean_n.norm(), halves_n, 100.0 * holds)
        },
    )
}

/// Returns a round radius that contains all samples and does not shrink at once.
fn reach_n(max_n: f32, now_n: f32) -> f32 {
    let steps = [MIN_N, 1.5, 3.0, 4.5, 6.0, 9.0, 12.0];
    let wanted = steps.into_iter().find(|&step| max_n <= step).unwrap_or(12.0);
    if wanted > now_n || max_n < 0.3 * now_n { wanted } else { now_n }
}

fn view(state: &ForceSpaceState, place: Rect) -> ForceProjection {
    let (sin_yaw, cos_yaw) = state.yaw.sin_cos();
    let (sin_pitch, cos_pitch) = state.pitch.sin_cos();
    ForceProjection {
        centre: place.center(),
        points_per_n: 0.56 * place.width().min(place.height()) / state.reach_n,
        right: Vector3::new(cos_yaw, sin_yaw, 0.0),
        up: Vector3::new(-sin_yaw * sin_pitch, cos_yaw * sin_pitch, cos_pitch),
        middle_n: Vector3::z() * 0.35 * state.reach_n,
    }
}

/// Draws three axes with a mark at every newton, or every half newton if the radius is small.
fn axes(painter: &Painter, view: &ForceProjection, reach_n: f32) {
    let stroke = Stroke::new(1.0, theme::now().line.lerp_to_gamma(theme::now().text_weak, 0.4));
    let step_n = if reach_n > 4.0 {
        2.0
    } else if reach_n > 1.6 {
        1.0
    } else {
        0.5
    };
    for (name, axis) in [("x", Vector3::x()), ("y", Vector3::y()), ("z", Vector3::z())] {
        let low_n = if name == "z" { -0.4 * reach_n } else { -0.75 * reach_n };
        let high_n = if name == "z" { 1.1 * reach_n } else { 0.75 * reach_n };
        painter.line_segment([view.place(&(axis * low_n)), view.place(&(axis * high_n))], stroke);
        for i in (low_n / step_n).ceil() as i32..=(high_n / step_n) as i32 {
            let force_n = i as f32 * step_n;
            let at = view.place(&(axis * force_n));
            painter.circle_filled(at, 1.6, theme::now().text_weak);
            let legend = Rect::from_min_size(painter.clip_rect().min, LEGEND);
            if i != 0 && name == "z" && !legend.contains(at) {
                let words = format!("{force_n} N");
                painter.text(
                    at - vec2(7.0, 0.0),
                    Align2::RIGHT_CENTER,
                    words,
                    theme::regular(11.5),
                    theme::now().text_weak,
                );
            }
        }
        let end = view.place(&(axis * high_n));
        let out = (end - view.place(&Vector3::zeros())).normalized();
        let out = if out.is_finite() { out } else { Vec2::ZERO };
        painter.text(end + out * 9.0, Align2::CENTER_CENTER, name, theme::regular(13.0), theme::now().text);
    }
}

fn ring(at: impl Fn(f32, f32) -> Pos2) -> Vec<Pos2> {
    (0..=RING)
        .map(|i| {
            let (sin, cos) = (TAU * i as f32 / RING as f32).sin_cos();
            at(cos, sin)
        })
        .collect()
}

/// Draws the outline of the sphere of the force ceiling.
fn ceiling(painter: &Painter, view: &ForceProjection, ceiling_n: f32) {
    let points = ring(|cos, sin| view.place(&(ceiling_n * (view.right * cos + view.up * sin))));
    painter.add(egui::Shape::Vec(egui::Shape::dashed_line(
        &points,
        Stroke::new(1.2, theme::now().text_weak),
        6.0,
        6.0,
    )));
}

/// Draws the ellipsoid as its three sections through two half axes each.
fn rings(painter: &Painter, view: &ForceProjection, around_n: &Vector3<f32>, ellipsoid: &Ellipsoid) {
    let half_n = ellipsoid.half_axes_n.cast::<f32>();
    let centre_n = around_n + ellipsoid.mean_n.cast::<f32>();
    let colour: Color32 = theme::now().engaged;
    for (a, b) in [(0, 1), (1, 2), (2, 0)] {
        let points = ring(|cos, sin| view.place(&(centre_n + half_n.column(a) * cos + half_n.column(b) * sin)));
        painter.line(points, Stroke::new(1.4, colour));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reach_grows_at_once_and_shrinks_late() {
        assert!((reach_n(2.4, MIN_N) - 3.0).abs() < 1e-6);
        assert!((reach_n(1.2, 3.0) - 3.0).abs() < 1e-6);
        assert!((reach_n(0.1, 3.0) - MIN_N).abs() < 1e-6);
        assert!((reach_n(1e9, 3.0) - 12.0).abs() < 1e-6);
    }

    #[test]
    fn up_is_up_and_the_place_is_finite() {
        let rect = Rect::from_min_size(pos2(10.0, 20.0), vec2(300.0, 280.0));
        let view = view(&ForceSpaceState::default(), rect);
        let low = view.place(&Vector3::zeros());
        let high = view.place(&Vector3::z());
        assert!(high.y < low.y && (high.x - low.x).abs() < 1e-3 && rect.contains(low));
    }
}
