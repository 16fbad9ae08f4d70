//! Draws the forces in the image: at each tip the measured force as an arrow, and the force ceiling as a ring. They are drawn
//! with the lens's distortion, so the image need not be undistorted. Parts behind the instrument are dim. Shapes and
//! lightness distinguish the drawings, not hues.

use std::f64::consts::TAU;

use egui::{Align, Align2, Color32, Painter, Pos2, Shape, Stroke, vec2};
use nalgebra::Vector3;
use nima_endoscope::Camera;
use nima_machine::rig::Side;
use nima_screen::{scene3d::side_name, theme};
use nima_words::{report_text::newtons, text};

use super::{occlusion::InstrumentShaft, place::ImagePlacement, poses::TipPose};

/// Length of an arrow, m per N; a force above the second constant has an arrow of constant length, N.
const M_PER_N: f64 = 0.005;
const MAX_N: f64 = 8.0;
/// A smaller force has no arrow, because the arrow would show noise, N.
const MIN_N: f64 = 0.15;
/// Segments of a line that the lens bends, and of the ring.
const PIECES: usize = 24;
const RING_PIECES: usize = 48;
/// Free space around a tip, points: the image is never covered there.
const FREE: f32 = 7.0;
const ARROW: f32 = 2.0;
const HEAD: f32 = 10.0;
const RING: f32 = 1.5;
/// Opacity of a line behind the instrument.
const HIDDEN: f32 = 0.35;
/// Half the side of the contact mark, and the length of its corners, points.
const CONTACT: f32 = 15.0;
const CORNER: f32 = 6.0;
/// Distance between the sign of a tip outside the view and the edge of the view, points.
const EDGE: f32 = 26.0;
const SHADE: Color32 = theme::VEIL;

/// An image, and its overlay.
pub(super) struct OverlayImage<'a> {
    pub(super) painter: &'a Painter,
    pub(super) place: &'a ImagePlacement,
    pub(super) camera: &'a Camera,
    pub(super) ceiling_n: f64,
}

/// An instrument in the image.
#[derive(Clone, Copy, Debug)]
pub(super) struct OverlayInstrument {
    pub(super) side: Side,
    pub(super) pose: TipPose,
    /// Position of its trocar; `None` if unknown.
    pub(super) trocar_m: Option<Vector3<f64>>,
}

/// A segment of a line on the screen.
struct OverlaySegment {
    points: Vec<Pos2>,
    /// Behind the instrument.
    hidden: bool,
}

impl OverlayImage<'_> {
    /// Draws the forces unless they are hidden; returns the tips with their positions. A tip outside the view is marked at the
    /// edge.
    pub(super) fn draw(&self, instruments: impl Iterator<Item = OverlayInstrument>, hidden: bool) -> Vec<(Side, Pos2)> {
        let mut tips = Vec::new();
        for instrument in instruments {
            let Some(tip) = self.at(&instrument.pose.tip_m) else { continue };
            if !self.place.rect.contains(tip) {
                self.beyond(instrument.side, tip);
                continue;
            }
            tips.push((instrument.side, tip));
            if !hidden {
                self.ring(&instrument);
                self.arrow(&instrument, tip);
            }
        }
        tips
    }

    /// Returns the screen position of a point in the workspace.
    pub(super) fn at(&self, point_m: &Vector3<f64>) -> Option<Pos2> {
        self.camera.project(point_m).map(|place_px| self.place.at(&place_px))
    }

    /// Draws a sign at the edge, towards a tip outside the view.
    fn beyond(&self, side: Side, tip: Pos2) {
        let inner = self.place.rect.shrink(EDGE);
        let at = tip.clamp(inner.min, inner.max);
        let out = (tip - at).normalized();
        if !inner.is_positive() || !out.is_finite() {
            return;
        }
        let across = out.rot90() * (0.5 * HEAD);
        let head = vec![at + out * HEAD, at + across, at - across];
        self.painter.add(Shape::convex_polygon(head, theme::DARK.text, Stroke::new(1.5, SHADE)));
        let align = Align2([Self::aligned(-out.x), Self::aligned(-out.y)]);
        self.label(at - out * 6.0, align, &text::endoscope_view::tip(side_name(side)), 15.0, theme::DARK.text);
    }

    /// Returns the alignment of a text on this side of its position.
    fn aligned(towards: f32) -> Align {
        if towards > 0.4 {
            Align::Min
        } else if towards < -0.4 {
            Align::Max
        } else {
            Align::Center
        }
    }

    /// Returns a line of the workspace as seen by the lens, in visible and hidden segments; `None` if the lens does not
    /// see all of it.
    fn line(&self, points_m: &[Vector3<f64>], instrument: &OverlayInstrument) -> Option<Vec<OverlaySegment>> {
        let lens_m = self.camera.world_from_camera.translation.vector;
        let shaft = instrument.trocar_m.map(|trocar_m| InstrumentShaft { tip_m: instrument.pose.tip_m, trocar_m });
        let mut stretches: Vec<OverlaySegment> = Vec::new();
        for point_m in points_m {
            let point = self.at(point_m)?;
            let hidden = shaft.is_some_and(|shaft| shaft.hides(&lens_m, point_m));
            match stretches.last_mut() {
                Some(last) if last.hidden == hidden => last.points.push(point),
                before => {
                    // Start at the end of the previous segment, so that there is no gap.
                    let joint = before.and_then(|before| before.points.last().copied());
                    stretches.push(OverlaySegment { points: joint.into_iter().chain([point]).collect(), hidden });
                }
            }
        }
        Some(stretches)
    }

    fn ring(&self, instrument: &OverlayInstrument) {
        let radius_m = M_PER_N * self.ceiling_n.min(MAX_N);
        let right = self.camera.right() * radius_m;
        let up = self.camera.up() * radius_m;
        let point_m = |piece: usize| {
            let (sin, cos) = (TAU * piece as f64 / RING_PIECES as f64).sin_cos();
            instrument.pose.tip_m + right * cos + up * sin
        };
        let points_m: Vec<_> = (0..=RING_PIECES).map(point_m).collect();
        let Some(stretches) = self.line(&points_m, instrument) else { return };
        for OverlaySegment { points, hidden } in stretches {
            self.painter.add(Shape::line(points.clone(), Stroke::new(RING + 2.0, seen_through(SHADE, hidden))));
            // Draw dashes, because nothing else in the image has them.
            let stroke = Stroke::new(RING, seen_through(theme::DARK.text, hidden));
            self.painter.extend(Shape::dashed_line(&points, stroke, 6.0, 5.0));
        }
        if let Some(top) = self.at(&points_m[RING_PIECES / 4]) {
            let words = text::roles::ceiling(self.ceiling_n);
            self.label(top - vec2(0.0, 4.0), Align2::CENTER_BOTTOM, &words, 13.0, theme::DARK.text);
        }
    }

    fn arrow(&self, instrument: &OverlayInstrument, tip: Pos2) {
        let TipPose { tip_m, measured_n } = instrument.pose;
        let Some(measured_n) = measured_n else {
            let place = tip - vec2(0.0, FREE + 4.0);
            return self.label(place, Align2::CENTER_BOTTOM, &newtons(None, 1), 17.0, theme::DARK.measured);
        };
        let size_n = measured_n.norm();
        if !(MIN_N..1e6).contains(&size_n) {
            return;
        }
        self.contact(tip);
        let travel_m = measured_n * (M_PER_N * size_n.min(MAX_N) / size_n);
        let points_m: Vec<_> = (0..=PIECES).map(|piece| tip_m + travel_m * (piece as f64 / PIECES as f64)).collect();
        let Some(stretches) = self.line(&points_m, instrument) else { return };
        let (Some(end), Some(before)) = (self.at(&points_m[PIECES]), self.at(&points_m[PIECES - 1])) else { return };
        let ends_hidden = stretches.last().is_some_and(|last| last.hidden);
        let colour = theme::DARK.measured;
        let mut drawn = false;
        for (stroke, more) in [(SHADE, 3.0), (colour, 0.0)] {
            for OverlaySegment { points, hidden } in &stretches {
                let free: Vec<Pos2> = points.iter().copied().filter(|point| (*point - tip).length() > FREE).collect();
                if free.len() > 1 {
                    drawn = true;
                    let stroke = Stroke::new(ARROW + more, seen_through(stroke, *hidden));
                    self.painter.add(Shape::line(free, stroke));
                }
            }
        }
        let along = (end - before).normalized();
        if drawn && along.is_finite() {
            let side = along.rot90() * (0.5 * HEAD);
            let head = vec![end + along * HEAD, end + side, end - side];
            let [fill, edge] = [colour, SHADE].map(|colour| seen_through(colour, ends_hidden));
            self.painter.add(Shape::convex_polygon(head, fill, Stroke::new(1.5, edge)));
        } else {
            // For a force towards or away from the lens, draw a ring around the tip.
            self.painter.circle_stroke(tip, FREE + 4.0, Stroke::new(ARROW + 3.0, SHADE));
            self.painter.circle_stroke(tip, FREE + 4.0, Stroke::new(ARROW, colour));
        }
        let out = if along.is_finite() { along } else { vec2(0.0, -1.0) };
        let place = end + out * (HEAD + 4.0);
        let align = if out.x.abs() > out.y.abs() {
            if out.x > 0.0 { Align2::LEFT_CENTER } else { Align2::RIGHT_CENTER }
        } else if out.y > 0.0 {
            Align2::CENTER_TOP
        } else {
            Align2::CENTER_BOTTOM
        };
        self.label(place, align, &text::endoscope_view::force(size_n), 17.0, colour);
    }

    /// Draws contact at the tip: four corners around it, which leave it free.
    fn contact(&self, tip: Pos2) {
        for (stroke, more) in [(SHADE, 2.0), (theme::DARK.text, 0.0)] {
            for (x, y) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
                let corner = tip + vec2(x, y) * CONTACT;
                let ends = [vec2(-x * CORNER, 0.0), vec2(0.0, 0.0), vec2(0.0, -y * CORNER)].map(|way| corner + way);
                self.painter.add(Shape::line(ends.to_vec(), Stroke::new(2.0 + more, stroke)));
            }
        }
    }

    /// Draws text with a dark outline on all sides.
    fn label(&self, place: Pos2, align: Align2, words: &str, size: f32, colour: Color32) {
        for shift in [vec2(1.5, 0.0), vec2(-1.5, 0.0), vec2(0.0, 1.5), vec2(0.0, -1.5)] {
            self.painter.text(place + shift, align, words, theme::strong(size), SHADE);
        }
        self.painter.text(place, align, words, theme::strong(size), colour);
    }
}

/// Returns the colour of a part that may be behind the instrument.
fn seen_through(colour: Color32, hidden: bool) -> Color32 {
    if hidden { colour.gamma_multiply(HIDDEN) } else { colour }
}
