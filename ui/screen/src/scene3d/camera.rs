//! An orbit camera: looks at a point from a distance, rotated with the mouse. Frame: workspace, z up, metres.

use egui::{Pos2, Rect, Vec2};
use nalgebra::{Matrix4, Perspective3, Point3, Vector3, Vector4};
use nima_simulation::scene::Scene;

/// Vertical opening angle of the free view, rad.
const FIELD_OF_VIEW: f32 = 0.62;
/// Vertical opening angle of the endoscope view, which is wide, rad.
const ENDOSCOPE_FIELD: f32 = 0.92;
/// Distance of the endoscope from tissue, and from a board with rings or a wire: from there the image shows the whole board
/// and the hands above it, m.
const NEAR_TISSUE_M: f32 = 0.128;
const NEAR_BOARD_M: f32 = 0.168;
/// From next to the tip to where a whole robot arm is in view, m.
const DISTANCE_M: std::ops::RangeInclusive<f32> = 0.06..=2.5;
/// Range of pitch: from nearly level with the surface to nearly straight down, rad.
const PITCH: std::ops::RangeInclusive<f32> = 0.03..=1.5;
/// Sine of the minimum angle between a horizontal plane and the line of sight: below it a point of the screen covers
/// centimetres.
const FLATTEST: f32 = 0.15;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneCamera {
    /// Point looked at, m.
    pub target_m: Vector3<f32>,
    /// Distance from it, m.
    pub distance_m: f32,
    /// Rotation about z; 0 looks along +y, rad.
    pub yaw: f32,
    /// Angle above the horizon, rad.
    pub pitch: f32,
    /// Vertical opening angle, rad.
    pub field_of_view: f32,
}

impl Default for SceneCamera {
    fn default() -> Self {
        // Seen from the far side of the field, so that the shaft leans away and covers neither the tip nor the forces.
        let target_m = Vector3::new(0.0, -0.010, 0.046);
        Self { target_m, distance_m: 0.298, yaw: 2.62, pitch: 0.40, field_of_view: FIELD_OF_VIEW }
    }
}

impl SceneCamera {
    /// Returns the default camera of a scene. Two instruments, and a wire, are seen from the operator's side, so that
    /// the right instrument and the end of the wire are on the right.
    pub fn of(scene: &Scene) -> Self {
        if scene.left.is_none() && scene.wire.is_none() {
            return Self::default();
        }
        Self { target_m: Vector3::new(0.0, -0.012, 0.042), distance_m: 0.30, yaw: 0.16, pitch: 0.58, ..Self::default() }
    }

    /// Returns the camera of the endoscope: between two instruments, or next to a single one.
    pub fn endoscope(scene: &Scene) -> Self {
        if scene.objects.is_some() || scene.wire.is_some() {
            // Rings are passed between hands high above the board, where the hands also start.
            let target_m = Vector3::new(0.0, 0.0, 0.034);
            return Self { target_m, distance_m: NEAR_BOARD_M, yaw: 0.0, pitch: 0.62, field_of_view: ENDOSCOPE_FIELD };
        }
        let yaw = if scene.left.is_some() { 0.0 } else { -0.55 };
        let target_m = Vector3::new(0.0, 0.0, 0.006);
        Self { target_m, distance_m: NEAR_TISSUE_M, yaw, pitch: 0.72, field_of_view: ENDOSCOPE_FIELD }
    }

    /// Rotates by a drag of this many points.
    pub fn orbit(&mut self, drag: Vec2) {
        self.yaw -= drag.x * 0.008;
        self.pitch = (self.pitch + drag.y * 0.006).clamp(*PITCH.start(), *PITCH.end());
    }

    /// Moves nearer (factor above 1) or farther away.
    pub fn zoom(&mut self, factor: f32) {
        if factor.is_finite() && factor > 0.0 {
            self.distance_m = (self.distance_m / factor).clamp(*DISTANCE_M.start(), *DISTANCE_M.end());
        }
    }

    /// Returns the position of the eye, m.
    pub fn eye_m(&self) -> Vector3<f32> {
        let (sin_yaw, cos_yaw) = self.yaw.sin_cos();
        let (sin_pitch, cos_pitch) = self.pitch.sin_cos();
        self.target_m + self.distance_m * Vector3::new(sin_yaw * cos_pitch, -cos_yaw * cos_pitch, sin_pitch)
    }

    /// Returns the direction on the right of the screen, unit length.
    pub fn right(&self) -> Vector3<f32> {
        let (sin_yaw, cos_yaw) = self.yaw.sin_cos();
        Vector3::new(cos_yaw, sin_yaw, 0.0)
    }

    /// Returns the direction that is up on the screen, unit length.
    pub fn up(&self) -> Vector3<f32> {
        let (sin_yaw, cos_yaw) = self.yaw.sin_cos();
        let (sin_pitch, cos_pitch) = self.pitch.sin_cos();
        Vector3::new(-sin_yaw * sin_pitch, cos_yaw * sin_pitch, cos_pitch)
    }

    /// Returns the number of metres per point of the screen at the distance of the target, for a view of this height
    /// (points).
    pub fn metres_per_point(&self, height: f32) -> f32 {
        2.0 * self.distance_m * (0.5 * self.field_of_view).tan() / height.max(1.0)
    }

    /// Returns the depth cue: loss of brightness per metre, and the distance from which it starts, m. As with a light
    /// at the lens, objects beyond the target are darker.
    pub fn dims(&self) -> [f32; 2] {
        let distance_m = self.distance_m.max(0.01);
        [0.75 / distance_m, 0.88 * distance_m]
    }

    /// Returns the horizontal direction away from the eye, unit length.
    pub fn away(&self) -> Vector3<f32> {
        let (sin_yaw, cos_yaw) = self.yaw.sin_cos();
        Vector3::new(-sin_yaw, cos_yaw, 0.0)
    }

    /// Returns the transformation from workspace to OpenGL clip space for a view of this aspect ratio (width / height).
    pub fn clip_from_workspace(&self, aspect: f32) -> Matrix4<f32> {
        let aspect = if aspect.is_finite() { aspect.max(0.01) } else { 1.0 };
        let projection = Perspective3::new(aspect, self.field_of_view, 0.01, 3.0);
        let view = Matrix4::look_at_rh(&Point3::from(self.eye_m()), &Point3::from(self.target_m), &Vector3::z());
        projection.to_homogeneous() * view
    }

    /// Returns the position of a point on the screen; `None` if it is behind the eye.
    pub fn project(&self, point_m: &Vector3<f32>, rect: Rect) -> Option<Pos2> {
        let clip = self.clip_from_workspace(rect.aspect_ratio()) * Vector4::new(point_m.x, point_m.y, point_m.z, 1.0);
        if clip.w <= 1e-4 {
            return None;
        }
        let x = clip.x / clip.w;
        let y = clip.y / clip.w;
        Some(rect.center() + Vec2::new(0.5 * x * rect.width(), -0.5 * y * rect.height()))
    }

    /// Returns the intersection of the ray through a screen position with this height, m; `None` without one, or at too
    /// flat an angle.
    pub fn on_level(&self, place: Pos2, rect: Rect, height_m: f32) -> Option<Vector3<f32>> {
        let from_centre = place - rect.center();
        let x = 2.0 * from_centre.x / rect.width();
        let y = -2.0 * from_centre.y / rect.height();
        let workspace_from_clip = self.clip_from_workspace(rect.aspect_ratio()).try_inverse()?;
        let far = workspace_from_clip * Vector4::new(x, y, 1.0, 1.0);
        let eye_m = self.eye_m();
        let way = (far.xyz() / far.w - self.eye_m()).try_normalize(1e-6)?;
        let length_m = (height_m - eye_m.z) / way.z;
        (way.z <= -FLATTEST && length_m > 0.0).then(|| eye_m + way * length_m)
    }
}

#[cfg(test)]
mod tests {
    use egui::{pos2, vec2};
    use nima_simulation::Worlds;

    use super::*;
    use crate::scene3d::{aim, vignette};

    fn view() -> Rect {
        Rect::from_min_max(pos2(100.0, 50.0), pos2(900.0, 650.0))
    }

    #[test]
    fn the_target_is_in_the_middle_and_up_is_up() {
        let mut camera = SceneCamera::default();
        camera.orbit(Vec2::new(37.0, -20.0));
        let middle = camera.project(&camera.target_m, view()).unwrap();
        assert!((middle - view().center()).length() < 0.1, "{middle:?}");
        let above = camera.project(&(camera.target_m + Vector3::z() * 0.01), view()).unwrap();
        assert!(above.y < middle.y && (above.x - middle.x).abs() < 1.0);
        let up = camera.project(&(camera.target_m + camera.up() * 0.01), view()).unwrap();
        assert!(up.y < above.y && (up.x - middle.x).abs() < 1.0, "nothing is higher than straight up");
        let right = camera.project(&(camera.target_m + camera.right() * 0.01), view()).unwrap();
        assert!(right.x > middle.x && (right.y - middle.y).abs() < 1.0);
    }

    #[test]
    fn from_every_camera_the_targets_are_seen_and_the_right_hand_is_on_the_right() {
        let scene = Scene::load("bimanual").unwrap();
        for camera in [SceneCamera::of(&scene), SceneCamera::endoscope(&scene)] {
            let place = |position_m: &Vector3<f64>| camera.project(&position_m.cast(), view()).unwrap();
            assert!(scene.targets_m.iter().all(|position_m| view().contains(place(position_m))));
            let middle =
                |targets_m: &[Vector3<f64>]| targets_m.iter().map(|position_m| place(position_m).x).sum::<f32>() / 3.0;
            assert!(middle(&scene.targets_m) > middle(&scene.left.as_ref().unwrap().targets_m) + 50.0);
        }
        let single = Scene::load("peg_transfer").unwrap();
        let camera = SceneCamera::endoscope(&single);
        assert!(
            single
                .targets_m
                .iter()
                .all(|position_m| view().contains(camera.project(&position_m.cast(), view()).unwrap()))
        );
    }

    #[test]
    fn the_round_picture_has_the_tips_at_the_start_of_every_task_and_the_pegs() {
        let views = [[1280.0, 560.0], [1600.0, 840.0], [1920.0, 920.0], [700.0, 700.0]];
        let views = views.map(|[width, height]| Rect::from_min_size(pos2(0.0, 110.0), vec2(width, height)));
        let seen = |scene: &Scene, position_m: &Vector3<f64>, view: Rect| {
            let camera = SceneCamera::endoscope(scene);
            camera.project(&position_m.cast(), view).is_some_and(|at| vignette::shows(view, at, aim::CIRCLE))
        };
        for name in Scene::names() {
            let scene = Scene::load(name).unwrap();
            if scene.task.is_none() {
                continue;
            }
            for (position_m, view) in Worlds::new(&scene, 1e3)
                .tips_m()
                .iter()
                .flatten()
                .flat_map(|position_m| views.map(|view| (position_m, view)))
            {
                assert!(seen(&scene, position_m, view), "{name}: {position_m} in {view}");
            }
            for [x, y] in scene.objects.iter().flat_map(|setting| &setting.pegs.position_m) {
                let foot_m = Vector3::new(*x, *y, 0.0);
                let passed_m = Vector3::new(0.0, 0.0, 0.08);
                assert!(
                    views.iter().all(|view| seen(&scene, &foot_m, *view) && seen(&scene, &passed_m, *view)),
                    "{foot_m}"
                );
            }
        }
        let far_m = Vector3::new(0.15, 0.0, 0.1);
        assert!(!seen(&Scene::load("rings").unwrap(), &far_m, views[0]));
    }

    #[test]
    fn it_never_flips_over_or_dives_through() {
        let mut camera = SceneCamera::default();
        for _ in 0..1000 {
            camera.orbit(Vec2::new(13.0, 40.0));
            camera.zoom(1.2);
        }
        assert!(camera.pitch <= 1.5 && camera.distance_m >= 0.06);
        camera.zoom(f32::NAN);
        assert!(camera.distance_m.is_finite());
        assert!(camera.clip_from_workspace(f32::NAN).iter().all(|x| x.is_finite()));
    }

    #[test]
    fn a_place_on_the_screen_is_on_the_level_that_it_shows_and_none_is_too_far() {
        for camera in
            [SceneCamera::of(&Scene::load("rings").unwrap()), SceneCamera::endoscope(&Scene::load("rings").unwrap())]
        {
            for position_m in [Vector3::new(0.045, -0.026, 0.002), Vector3::new(-0.02, 0.03, 0.04), Vector3::zeros()] {
                let on_screen = camera.project(&position_m, view()).unwrap();
                let found_m = camera.on_level(on_screen, view(), position_m.z).unwrap();
                assert!((found_m - position_m).norm() < 1e-4, "{found_m} for {position_m}");
            }
            let above_eye_m = camera.eye_m().z + 0.01;
            assert_eq!(camera.on_level(view().center(), view(), above_eye_m), None);
        }
        let flat = SceneCamera { pitch: 0.1, ..SceneCamera::default() };
        assert_eq!(flat.on_level(view().center(), view(), 0.0), None);
    }

    #[test]
    fn what_is_behind_the_eye_has_no_place() {
        let camera = SceneCamera::default();
        let behind = camera.eye_m() + (camera.eye_m() - camera.target_m);
        assert_eq!(camera.project(&behind, view()), None);
    }
}
