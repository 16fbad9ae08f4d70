//! A drawing next to each instruction to the person at the arm: the tool, its contact, and its motion.

use std::f32::consts::{FRAC_PI_2, TAU};

use egui::{Align2, Color32, Painter, Pos2, Rect, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo, pos2, vec2};
use nalgebra::{UnitQuaternion, Vector3};
use nima_core::calibration::frames::ViewMove;
use nima_machine::rig::Prompt;
use nima_screen::theme;
use nima_words::text;

use super::drawings::{on_paper, pose_image};

pub(super) const SIZE: Vec2 = vec2(240.0, 190.0);
/// Angle of the tilted tools, rad.
const TILT: f32 = 0.42;
/// Length of the drawn tool.
const TOOL: f32 = 110.0;

/// Draws `content` with the drawing of an instruction at its right; nothing is drawn while the person rests.
pub(super) fn beside<R>(
    ui: &mut Ui,
    prompt: &Prompt,
    held: Option<&UnitQuaternion<f64>>,
    content: impl FnOnce(&mut Ui) -> R,
) -> R {
    if *prompt == Prompt::Rest {
        return content(ui);
    }
    ui.horizontal_top(|ui| {
        let width = (ui.available_width() - SIZE.x - ui.spacing().item_spacing.x).max(200.0);
        let inner = ui.vertical(|ui| {
            ui.set_width(width);
            content(ui)
        });
        match prompt {
            Prompt::Hold { world_from_s1 } => pose_image(ui, Some(world_from_s1), held),
            other => guide_image(ui, other),
        }
        inner.inner
    })
    .inner
}

fn guide_image(ui: &mut Ui, prompt: &Prompt) {
    let (rect, response) = ui.allocate_exact_size(SIZE, Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, text::wizards::POSE_IMAGE.get()));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, theme::CORNER, theme::now().groove);
    let paper = Paper { painter: &painter, rect };
    match prompt {
        Prompt::Rest | Prompt::Hold { .. } => {}
        Prompt::Wave | Prompt::Turn => paper.turn(),
        Prompt::Push { direction } => paper.push(direction),
        Prompt::Work => paper.through_trocar(0.80, true),
        Prompt::WorkFree => paper.through_trocar(0.64, true),
        Prompt::PivotInTrocar => paper.through_trocar(0.78, false),
        Prompt::PivotInDimple => paper.pivot_in_dimple(),
        Prompt::Touch { point } => paper.table(*point),
        Prompt::MoveTip(way) => paper.image(*way, true),
        Prompt::MoveHandle(way) => paper.image(*way, false),
    }
}

/// The area of a drawing; positions are fractions of its size.
struct Paper<'a> {
    painter: &'a Painter,
    rect: Rect,
}

impl Paper<'_> {
    fn at(&self, x: f32, y: f32) -> Pos2 {
        self.rect.lerp_inside(vec2(x, y))
    }

    /// Draws the tool with its tip here, tilted by this angle about its tip; dashed if it is another position of it.
    fn tool(&self, tip: Pos2, tilt: f32, other: bool) {
        let up = -Vec2::angled(FRAC_PI_2 - tilt);
        let across = up.rot90();
        let (colour, width) = if other { (theme::now().reference, 1.5) } else { (theme::now().measured, 3.0) };
        let stroke = Stroke::new(width, colour);
        let jaw = tip + up * 12.0;
        let sensor = tip + up * TOOL;
        if other {
            self.painter.extend(Shape::dashed_line(&[jaw, sensor], stroke, 6.0, 4.0));
        } else {
            self.painter.line_segment([jaw, sensor], stroke);
        }
        for side in [-5.0, 5.0] {
            self.painter.line_segment([jaw, tip + across * side], stroke);
        }
        self.painter.line_segment([sensor - across * 16.0, sensor + across * 16.0], Stroke::new(3.0 * width, colour));
    }

    fn arrow(&self, from: Pos2, to: Pos2) {
        self.painter.arrow(from, to - from, Stroke::new(3.0, theme::now().rendered));
    }

    /// Draws arrows in both directions along a part of a circle.
    fn arc(&self, centre: Pos2, radius: Vec2, from: f32, to: f32) {
        let at = |fraction: f32| centre + radius * Vec2::angled(from + (to - from) * fraction);
        let points: Vec<Pos2> = (0..=24_u8).map(|i| at(f32::from(i) / 24.0)).collect();
        self.painter.line(points, Stroke::new(3.0, theme::now().rendered));
        self.arrow(at(0.9), at(1.0));
        self.arrow(at(0.1), at(0.0));
    }

    fn surface(&self, y: f32) {
        let area = Rect::from_min_max(self.at(0.0, y), self.rect.max);
        self.painter.rect_filled(area, 0.0, theme::now().control);
    }

    fn words(&self, at: Pos2, words: &str) {
        self.painter.text(at, Align2::CENTER_CENTER, words, theme::strong(14.0), theme::now().text);
    }

    /// Free motion: tilted to all sides, and turned about the shaft.
    fn turn(&self) {
        let tip = self.at(0.5, 0.86);
        for tilt in [-TILT, TILT] {
            self.tool(tip, tilt, true);
        }
        self.tool(tip, 0.0, false);
        self.arc(tip, Vec2::splat(TOOL + 18.0), -FRAC_PI_2 - TILT, -FRAC_PI_2 + TILT);
        self.arc(tip - vec2(0.0, 0.5 * TOOL), vec2(26.0, 9.0), 0.4, TAU - 2.0);
    }

    fn pivot_in_dimple(&self) {
        self.surface(0.84);
        let tip = self.at(0.5, 0.88);
        let dimple = vec![tip - vec2(13.0, 8.0), tip + vec2(0.0, 2.0), tip + vec2(13.0, -8.0)];
        self.painter.add(Shape::convex_polygon(dimple, theme::now().groove, Stroke::NONE));
        for tilt in [-TILT, TILT] {
            self.tool(tip, tilt, true);
        }
        self.tool(tip, 0.0, false);
        self.arc(tip, Vec2::splat(TOOL + 18.0), -FRAC_PI_2 - TILT, -FRAC_PI_2 + TILT);
    }

    /// Draws the tool through its trocar, with its tip at this height; `tissue`: work on tissue, else pivoting alone.
    fn through_trocar(&self, height: f32, tissue: bool) {
        let trocar = self.at(0.5, 0.45);
        let below = self.at(0.5, height) - trocar;
        for tilt in [-TILT, TILT] {
            let tip = trocar + below.length() * Vec2::angled(FRAC_PI_2 + tilt);
            self.tool(tip, -tilt, true);
        }
        self.tool(trocar + below, 0.0, false);
        let skin = Stroke::new(5.0, theme::now().text_weak);
        let y = trocar.y;
        self.painter.hline(self.rect.left()..=trocar.x - 14.0, y, skin);
        self.painter.hline(trocar.x + 14.0..=self.rect.right(), y, skin);
        if tissue {
            self.surface(0.80);
        }
        let side = self.at(0.14, 0.5).x;
        self.arrow(pos2(side, y - 12.0), pos2(side, y - 46.0));
        self.arrow(pos2(side, y + 12.0), pos2(side, y + 46.0));
        let reach = below.length() + 10.0;
        self.arc(trocar, Vec2::splat(reach), FRAC_PI_2 - TILT, FRAC_PI_2 + TILT);
    }

    /// A push seen by a person behind the base: x of the workspace leads away, y to the left.
    fn push(&self, direction: &Vector3<f64>) {
        let tip = self.at(0.5, 0.66);
        let seen = Vector3::new(-direction.y, direction.x, direction.z);
        let corner = |x: f64, y: f64| on_paper(tip, 62.0, &Vector3::new(x, y, 0.0)).0;
        let tissue = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        let edge = Stroke::new(1.0, theme::now().line);
        self.painter.add(Shape::convex_polygon(tissue, theme::now().control, edge));
        self.tool(tip, 0.0, false);
        self.arrow(tip, on_paper(tip, 64.0, &seen).0);
    }

    /// The table seen from above at a slant, with the points of its frame; this one is touched now.
    fn table(&self, point: u8) {
        let corners = [(0.04, 0.92), (0.8, 0.92), (0.98, 0.34), (0.24, 0.34)].map(|(x, y)| self.at(x, y));
        let edge = Stroke::new(1.0, theme::now().line);
        self.painter.add(Shape::convex_polygon(corners.to_vec(), theme::now().control, edge));
        let origin = self.at(0.22, 0.8);
        let along_x = self.at(0.66, 0.8);
        let along_y = self.at(0.34, 0.46);
        let axis = Stroke::new(1.5, theme::now().text_weak);
        for (end, name) in [(along_x, "x"), (along_y, "y")] {
            self.painter.arrow(origin, (end - origin) * 1.25, axis);
            self.words(origin + (end - origin) * 1.25 + vec2(10.0, 10.0), name);
        }
        let points = [origin, along_x, along_y, self.at(0.72, 0.5)];
        let now = usize::from(point).min(points.len() - 1);
        for (i, at) in points.iter().enumerate() {
            if i < now {
                self.painter.circle_filled(*at, 5.0, theme::now().engaged);
            } else if i < 3 {
                self.painter.circle_stroke(*at, 5.0, Stroke::new(1.5, theme::now().reference));
            }
        }
        self.painter.circle_stroke(points[now], 9.0, Stroke::new(2.5, theme::now().rendered));
        self.tool(points[now], 0.2, false);
    }

    /// The endoscope image with the motion in it.
    fn image(&self, way: ViewMove, of_tip: bool) {
        let frame = self.rect.shrink2(vec2(26.0, 18.0));
        self.painter.rect_filled(frame, 3.0, Color32::BLACK);
        self.painter.rect_stroke(frame, 3.0, Stroke::new(2.0, theme::now().text_weak), egui::StrokeKind::Outside);
        let tip = frame.center();
        let shaft = Stroke::new(6.0, theme::DARK.reference);
        self.painter.line_segment([frame.right_bottom() - vec2(20.0, 0.0), tip + vec2(8.0, 8.0)], shaft);
        self.painter.circle_filled(tip, 5.0, theme::DARK.measured);
        let colour = theme::DARK.rendered;
        let ring = Stroke::new(3.0, colour);
        let along = match way {
            ViewMove::Right => vec2(1.0, 0.0),
            ViewMove::Left => vec2(-1.0, 0.0),
            ViewMove::Up => vec2(0.0, -1.0),
            ViewMove::Down => vec2(0.0, 1.0),
            // Into the image: a cross in a ring, the feathers of an arrow; out of it: its point.
            ViewMove::Deeper => {
                self.painter.circle_stroke(tip, 20.0, ring);
                for arm in [vec2(14.0, 14.0), vec2(14.0, -14.0)] {
                    self.painter.line_segment([tip - arm, tip + arm], ring);
                }
                Vec2::ZERO
            }
            ViewMove::Back => {
                self.painter.circle_stroke(tip, 20.0, ring);
                self.painter.circle_filled(tip, 7.0, colour);
                Vec2::ZERO
            }
        };
        if along != Vec2::ZERO {
            self.painter.arrow(tip + along * 12.0, along * 50.0, ring);
        }
        if !of_tip {
            self.painter.text(
                frame.left_top() + vec2(8.0, 6.0),
                Align2::LEFT_TOP,
                text::frames::THE_HANDLE.get(),
                theme::strong(14.0),
                theme::DARK.text,
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use egui_kittest::{Harness, kittest::Queryable as _};
    use nalgebra::UnitVector3;

    use super::*;

    #[test]
    fn every_instruction_has_a_drawing_inside_its_area() {
        let push = Prompt::Push { direction: UnitVector3::new_normalize(Vector3::new(0.0, 1.0, -1.0)) };
        let hold = Prompt::Hold { world_from_s1: UnitQuaternion::identity() };
        let touches = [0, 1, 2, 9].map(|point| Prompt::Touch { point });
        let moves = ViewMove::ALL.into_iter().flat_map(|way| [Prompt::MoveTip(way), Prompt::MoveHandle(way)]);
        let others = [Prompt::Wave, Prompt::Turn, Prompt::Work, Prompt::WorkFree, Prompt::PivotInDimple];
        for prompt in [push, hold, Prompt::PivotInTrocar].into_iter().chain(others).chain(touches).chain(moves) {
            let draw = move |ui: &mut Ui| {
                if theme::is_applied(ui.ctx()) {
                    beside(ui, &prompt, None, |ui| ui.label("Instruction"));
                }
            };
            let mut window = Harness::builder().with_size(vec2(736.0, 300.0)).build_ui(draw);
            window.run_steps(3);
            let drawing = window.get_by_label("Drawing of the required pose").rect();
            let words = window.get_by_label("Instruction").rect();
            assert!(drawing.left() > words.right() && drawing.right() <= 736.0, "{prompt:?}: {drawing:?}");
            assert!((drawing.top() - words.top()).abs() < 20.0, "{prompt:?}: beside it, not below");
        }
    }
}
