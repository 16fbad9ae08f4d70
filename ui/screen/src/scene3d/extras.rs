//! Optional objects in the 3-D view: the force ceiling around each tip, and coordinate frames. Drawn by egui's painter
//! over the triangles.

use egui::{
    Align2, Button, Color32, Painter, PopupCloseBehavior, Rect, Shape, Stroke, Ui, UiBuilder,
    containers::menu::{MenuButton, MenuConfig},
    pos2, vec2,
};
use nalgebra::Vector3;
use nima_simulation::scene::Scene;
use nima_words::{language::Text, report_text::side_word, text};

use super::{
    SceneCamera,
    labels::label,
    stage::{self, StageArm},
};
use crate::theme;

/// Length of a frame's axes, m.
const AXIS_M: f32 = 0.016;
const RING: u32 = 64;

pub const SHOW: Text = text::field::SHOW;
pub const SHOW_MEANING: Text = text::field::SHOW_HOVER;
pub const CEILING: Text = text::field::CEILING;
pub const CEILING_MEANING: Text = text::field::CEILING_HOVER;
pub const FRAMES: Text = text::field::FRAMES;
pub const FRAMES_MEANING: Text = text::field::FRAMES_HOVER;
pub const SHADOWS: Text = text::field::SHADOWS;
pub const DEPTH: Text = text::field::DEPTH;
pub const ROUND: Text = text::field::ROUND;

/// Optional objects, and the look of the view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "each is a separate switch")]
pub struct Extras {
    pub ceiling: bool,
    pub frames: bool,
    /// Shadows on a board.
    pub shadows: bool,
    /// The links of the robot arm.
    pub robot: bool,
    /// More distant objects are darker.
    pub depth: bool,
    /// The endoscope image is round, in the Surgeon view.
    pub round: bool,
}

impl Default for Extras {
    fn default() -> Self {
        Self { ceiling: false, frames: false, shadows: true, robot: true, depth: true, round: true }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MenuSwitch {
    Ceiling,
    Frames,
    Shadows,
    Robot,
    Depth,
    Round,
}

impl MenuSwitch {
    /// All switches, in the order of the menu.
    pub const ALL: [Self; 6] = [Self::Ceiling, Self::Frames, Self::Shadows, Self::Robot, Self::Depth, Self::Round];

    pub fn name(self) -> &'static str {
        match self {
            Self::Ceiling => CEILING.get(),
            Self::Frames => FRAMES.get(),
            Self::Shadows => SHADOWS.get(),
            Self::Robot => text::field::ROBOT.get(),
            Self::Depth => DEPTH.get(),
            Self::Round => ROUND.get(),
        }
    }

    pub fn meaning(self) -> &'static str {
        match self {
            Self::Ceiling => CEILING_MEANING.get(),
            Self::Frames => FRAMES_MEANING.get(),
            Self::Shadows => text::field::SHADOWS_HOVER.get(),
            Self::Robot => text::field::ROBOT_HOVER.get(),
            Self::Depth => text::field::DEPTH_HOVER.get(),
            Self::Round => text::field::ROUND_HOVER.get(),
        }
    }
}

/// Origin (m) and axes of a frame, in the workspace.
#[derive(Clone, Debug)]
struct FrameAxes {
    name: String,
    origin_m: Vector3<f32>,
    ways: [Vector3<f32>; 3],
}

impl Extras {
    /// Returns the setting that this switch changes.
    pub const fn of(&mut self, switch: MenuSwitch) -> &mut bool {
        match switch {
            MenuSwitch::Ceiling => &mut self.ceiling,
            MenuSwitch::Frames => &mut self.frames,
            MenuSwitch::Shadows => &mut self.shadows,
            MenuSwitch::Robot => &mut self.robot,
            MenuSwitch::Depth => &mut self.depth,
            MenuSwitch::Round => &mut self.round,
        }
    }

    /// Draws the menu, next to the switch for mouse control.
    pub(super) fn ui(&mut self, ui: &mut Ui, rect: Rect) {
        let place = Rect::from_min_size(rect.right_bottom() - vec2(330.0, 46.0), vec2(72.0, 34.0)).intersect(rect);
        ui.scope_builder(UiBuilder::new().max_rect(place), |ui| {
            let on = *self != Self::default();
            let button = Button::selectable(on, SHOW).frame_when_inactive(true).min_size(place.size());
            // Stays open until a click elsewhere, because users often need several switches.
            let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
            let menu = MenuButton::from_button(button).config(config);
            let (response, _) = menu.ui(ui, |ui| {
                ui.set_min_width(200.0);
                for switch in MenuSwitch::ALL {
                    ui.checkbox(self.of(switch), switch.name()).on_hover_text(switch.meaning());
                }
            });
            response.on_hover_text(SHOW_MEANING);
        });
    }

    pub(super) fn paint(
        self,
        painter: &Painter,
        rect: Rect,
        camera: &SceneCamera,
        scene: &Scene,
        arms: &[StageArm],
        ceiling_n: f64,
    ) {
        if self.ceiling {
            for arm in arms {
                ceiling(painter, rect, camera, arm, ceiling_n as f32);
            }
        }
        if self.frames {
            for frame in &frames(scene, arms) {
                axes(painter, rect, camera, frame);
            }
        }
    }
}

/// Draws the outline of the sphere that represents the force ceiling, around this tip.
fn ceiling(painter: &Painter, rect: Rect, camera: &SceneCamera, arm: &StageArm, ceiling_n: f32) {
    let radius_m = ceiling_n * stage::ARROW_M_PER_N;
    let outline = (0..=RING).filter_map(|i| {
        let (sin, cos) = (std::f32::consts::TAU * i as f32 / RING as f32).sin_cos();
        camera.project(&(arm.pose.tip_m + (camera.right() * cos + camera.up() * sin) * radius_m), rect)
    });
    let outline: Vec<_> = outline.collect();
    let Some(top) = outline.iter().copied().min_by(|a, b| a.y.total_cmp(&b.y)) else { return };
    painter.add(Shape::convex_polygon(outline.clone(), Color32::from_white_alpha(10), Stroke::NONE));
    painter.add(Shape::Vec(Shape::dashed_line(&outline, Stroke::new(1.4, theme::DARK.text_weak), 7.0, 6.0)));
    // Keep it inside the view, however large the sphere is.
    let place = pos2(top.x, top.y.max(rect.top() + 24.0));
    label(
        painter,
        place,
        Align2::CENTER_BOTTOM,
        &text::field::ceiling_sphere(ceiling_n),
        theme::regular(12.5),
        theme::DARK.text,
    );
}

/// Returns all frames of a scene.
fn frames(scene: &Scene, arms: &[StageArm]) -> Vec<FrameAxes> {
    let base = [Vector3::x(), Vector3::y(), Vector3::z()];
    let endoscope = SceneCamera::endoscope(scene);
    let mut frames = vec![
        FrameAxes { name: text::field::FRAME_WORLD.get().to_owned(), origin_m: Vector3::zeros(), ways: base },
        FrameAxes {
            name: text::field::ENDOSCOPE.get().to_owned(),
            origin_m: endoscope.eye_m(),
            ways: [endoscope.right(), endoscope.up(), endoscope.right().cross(&endoscope.up())],
        },
    ];
    for arm in arms {
        let side = if arms.len() > 1 { format!(" {}", side_word(arm.side)) } else { String::new() };
        frames.push(FrameAxes {
            name: text::field::TROCAR.get().to_owned() + &side,
            origin_m: arm.trocar_m,
            ways: base,
        });
        let Some(z) = (arm.trocar_m - arm.pose.tip_m).try_normalize(1e-4) else { continue };
        // Choose x as close as possible to the base's x axis.
        let x = (Vector3::x() - z * z.x).try_normalize(1e-3).unwrap_or_else(Vector3::y);
        frames.push(FrameAxes {
            name: text::field::TIP.get().to_owned() + &side,
            origin_m: arm.pose.tip_m,
            ways: [x, z.cross(&x), z],
        });
    }
    frames
}

fn axes(painter: &Painter, rect: Rect, camera: &SceneCamera, frame: &FrameAxes) {
    let Some(origin) = camera.project(&frame.origin_m, rect).filter(|at| rect.contains(*at)) else { return };
    for (name, axis) in ["x", "y", "z"].into_iter().zip(frame.ways) {
        let Some(end) = camera.project(&(frame.origin_m + axis * AXIS_M), rect) else { continue };
        painter.line_segment([origin, end], Stroke::new(2.0, theme::DARK.text));
        label(painter, end, Align2::CENTER_CENTER, name, theme::strong(12.5), theme::DARK.text);
    }
    let place = origin + vec2(8.0, 12.0);
    label(painter, place, Align2::LEFT_CENTER, &frame.name, theme::regular(12.5), theme::DARK.text_weak);
}

#[cfg(test)]
mod tests {
    use nima_machine::rig::Side;

    use super::*;

    #[test]
    fn every_frame_is_right_handed_and_of_unit_length() {
        let scene = Scene::load("bimanual").unwrap();
        let pose =
            stage::StagePose { tip_m: Vector3::new(0.0, 0.02, 0.0), measured_n: None, rendered_n: Vector3::zeros() };
        let arm = |side, x| StageArm {
            side,
            trocar_m: Vector3::new(x, -0.06, 0.14),
            targets_m: vec![],
            pose,
            trail_m: vec![],
            links_m: vec![],
        };
        let frames = frames(&scene, &[arm(Side::Right, 0.05), arm(Side::Left, 0.0)]);
        assert_eq!(frames.len(), 6);
        for FrameAxes { name, ways: [x, y, z], .. } in frames {
            assert!((x.cross(&y) - z).norm() < 1e-5 && (x.norm() - 1.0).abs() < 1e-5, "{name}: {x} {y} {z}");
        }
    }
}
