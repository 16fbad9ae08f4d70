//! Draws the forces into the picture: at each tip the measured force and, as a ring, the ceiling of what can reach the hand. Through the lens's
//! own distortion, so that nothing has to be straightened. Shapes and lightness tell them apart, not hues.

use std::f64::consts::TAU;

use egui::{Align2, Color32, Painter, Pos2, Shape, Stroke, vec2};
use nalgebra::Vector3;
use nima_endoscope::Camera;

use super::{place::Place, poses::Pose};
use crate::console::{text, theme};

/// Length of an arrow, m per N; a force beyond the second is drawn no longer, N.
const M_PER_N: f64 = 0.005;
const MOST_N: f64 = 8.0;
/// A smaller force has no arrow, because it would show noise, N.
const LEAST_N: f64 = 0.15;
/// Pieces of a line that the lens bends, and of the ring.
const PIECES: usize = 8;
const RING_PIECES: usize = 48;
/// Free space around a tip, points: the picture is never covered there.
const FREE: f32 = 7.0;
const ARROW: f32 = 3.0;
const HEAD: f32 = 12.0;
const RING: f32 = 1.5;
const SHADE: Color32 = Color32::from_black_alpha(200);

/// A picture, and what is drawn into it.
pub(super) struct Seen<'a> {
    pub(super) painter: &'a Painter,
    pub(super) place: &'a Place,
    pub(super) camera: &'a Camera,
    pub(super) ceiling_n: f64,
}

impl Seen<'_> {
    /// Draws the forces unless they are hidden; gives the places of the tips.
    pub(super) fn draw(&self, poses: impl Iterator<Item = Pose>, hidden: bool) -> Vec<Pos2> {
        let mut tips = Vec::new();
        for pose in poses {
            let Some(tip) = self.at(&pose.tip_m).filter(|tip| self.place.rect.contains(*tip)) else { continue };
            tips.push(tip);
            if !hidden {
                self.ring(&pose.tip_m);
                self.arrow(&pose, tip);
            }
        }
        tips
    }

    /// Place of a point of the workspace on the screen.
    pub(super) fn at(&self, point_m: &Vector3<f64>) -> Option<Pos2> {
        self.camera.project(point_m).map(|place_px| self.place.at(&place_px))
    }

    fn ring(&self, tip_m: &Vector3<f64>) {
        let radius_m = M_PER_N * self.ceiling_n.min(MOST_N);
        let (right, up) = (self.camera.right() * radius_m, self.camera.up() * radius_m);
        let points: Option<Vec<Pos2>> = (0..=RING_PIECES)
            .map(|piece| {
                let (sin, cos) = (TAU * piece as f64 / RING_PIECES as f64).sin_cos();
                self.at(&(tip_m + right * cos + up * sin))
            })
            .collect();
        let Some(points) = points else { return };
        self.painter.add(Shape::line(points.clone(), Stroke::new(RING + 2.0, SHADE)));
        // Dashes: nothing else in the picture has them.
        self.painter.extend(Shape::dashed_line(&points, Stroke::new(RING, theme::DARK.text), 6.0, 5.0));
        let place = points[RING_PIECES / 4] - vec2(0.0, 4.0);
        self.label(place, Align2::CENTER_BOTTOM, &text::roles::ceiling(self.ceiling_n), 13.0, theme::DARK.text);
    }

    fn arrow(&self, pose: &Pose, tip: Pos2) {
        let size_n = pose.measured_n.norm();
        if !(LEAST_N..1e6).contains(&size_n) {
            return;
        }
        let way_m = pose.measured_n * (M_PER_N * size_n.min(MOST_N) / size_n);
        let points: Option<Vec<Pos2>> =
            (0..=PIECES).map(|piece| self.at(&(pose.tip_m + way_m * (piece as f64 / PIECES as f64)))).collect();
        let Some(points) = points else { return };
        let end = points[PIECES];
        let colour = theme::DARK.measured;
        let free: Vec<Pos2> = points.iter().copied().filter(|point| (*point - tip).length() > FREE).collect();
        for (stroke, more) in [(SHADE, 3.0), (colour, 0.0)] {
            if free.len() > 1 {
                self.painter.add(Shape::line(free.clone(), Stroke::new(ARROW + more, stroke)));
            }
        }
        let along = (end - points[PIECES - 1]).normalized();
        if free.len() > 1 && along.is_finite() {
            let side = along.rot90() * (0.5 * HEAD);
            let head = vec![end + along * HEAD, end + side, end - side];
            self.painter.add(Shape::convex_polygon(head, colour, Stroke::new(1.5, SHADE)));
        } else {
            // Towards the lens or away from it: a ring around the tip.
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
        self.label(place, align, &text::eyes::force(size_n), 17.0, colour);
    }

    /// Words with a dark outline on all sides.
    fn label(&self, place: Pos2, align: Align2, words: &str, size: f32, colour: Color32) {
        for shift in [vec2(1.5, 0.0), vec2(-1.5, 0.0), vec2(0.0, 1.5), vec2(0.0, -1.5)] {
            self.painter.text(place + shift, align, words, theme::strong(size), SHADE);
        }
        self.painter.text(place, align, words, theme::strong(size), colour);
    }
}
