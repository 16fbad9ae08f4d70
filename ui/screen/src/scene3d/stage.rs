//! Builds the 3-D scene: tissue, targets, trocar, instrument, forces, trail. Rebuilt in each frame from one tick.

use egui::Color32;
use nalgebra::Vector3;
use nima_machine::rig::{SIDES, Side};
use nima_simulation::scene::Scene;

use super::{
    arrows::{ClearTip, measured_arrow, rendered_arrow},
    mesh::{Material, Mesh, Paint},
    objects::{self, DisplayedObjects},
    shadows::Shadows,
    training,
};

/// Length of a force arrow, m per N.
pub const ARROW_M_PER_N: f32 = 0.017;
/// Radius of the instrument's shaft, m (a 5 mm instrument).
pub const SHAFT_RADIUS_M: f32 = 0.0025;
/// Width of the dent under a tip, m.
const DENT_M: f32 = 0.0085;
const SLAB_THICKNESS_M: f32 = 0.016;
/// Cells of the tissue's surface along each side; fewer with a software renderer.
const CELLS: u32 = 64;
const CELLS_COARSE: u32 = 40;

const TISSUE_DARK: Color32 = Color32::from_rgb(0xb9, 0x66, 0x62);
const TISSUE_PALE: Color32 = Color32::from_rgb(0xcc, 0x7f, 0x77);
const TISSUE_HOLLOW: Color32 = Color32::from_rgb(0x5c, 0x22, 0x26);
const TISSUE_SIDE: Paint = Paint(Color32::from_rgb(0x9e, 0x55, 0x54), Material::Matte);
const TRAY: Paint = Paint(Color32::from_rgb(0x2c, 0x33, 0x3c), Material::Matte);
const TARGET: Paint = Paint(Color32::from_rgb(0xd9, 0xde, 0xe3), Material::Matte);
const STEEL: Paint = Paint(Color32::from_rgb(0xb4, 0xbc, 0xc6), Material::Metal);
const SLEEVE: Paint = Paint(Color32::from_rgb(0x4a, 0x53, 0x5f), Material::Matte);
const TRAIL: Paint = Paint(Color32::from_rgb(0xc8, 0xcf, 0xd8), Material::Plain);

/// Data that change from frame to frame, in the workspace frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StagePose {
    /// Tip of the instrument, m.
    pub tip_m: Vector3<f32>,
    /// Force measured at the tip, N; `None` while it is unknown.
    pub measured_n: Option<Vector3<f32>>,
    /// Force rendered to the hand, N.
    pub rendered_n: Vector3<f32>,
}

/// Deformation of the surface around a tip.
#[derive(Clone, Copy, Debug)]
pub struct Dent {
    position_m: [f32; 2],
    depth_m: f32,
}

impl Dent {
    pub const NONE: Self = Self { position_m: [0.0; 2], depth_m: 0.0 };

    /// Creates the deformation by a tip in the scene's tissue; none if the tip is next to or above it.
    pub fn new(scene: &Scene, tip_m: &Vector3<f32>) -> Self {
        let depth_m = scene.tissue.map_or(0.0, |tissue| {
            let [x_m, y_m] = tissue.size_m.map(|x| 0.5 * x as f32);
            let over = tip_m.x.abs() <= x_m && tip_m.y.abs() <= y_m;
            if over { (tissue.surface_z_m as f32 - tip_m.z).clamp(0.0, SLAB_THICKNESS_M * 0.9) } else { 0.0 }
        });
        Self { position_m: [tip_m.x, tip_m.y], depth_m }
    }

    /// Returns the change of height at a position, m: down under the tip, with a slight bulge around it, as in a soft
    /// body of constant volume.
    pub fn lift_m(&self, x: f32, y: f32) -> f32 {
        let q = ((x - self.position_m[0]).powi(2) + (y - self.position_m[1]).powi(2)) / (DENT_M * DENT_M);
        // Farther away, the change is below a micrometre.
        if self.depth_m <= 0.0 || q > 18.0 {
            return 0.0;
        }
        -self.depth_m * (1.0 - 0.22 * q) * (-q / 1.5).exp()
    }
}

/// The deformations by both instruments.
#[derive(Clone, Copy, Debug)]
pub struct Dents(pub [Dent; SIDES]);

impl Dents {
    /// Returns the change of height at a position, m. Where two dents overlap the deeper one counts: tissue is never
    /// below the lowest tip.
    pub fn lift_m(&self, x: f32, y: f32) -> f32 {
        let [one, other] = self.0.each_ref().map(|dent| dent.lift_m(x, y));
        if one < 0.0 && other < 0.0 { one.min(other) } else { one + other }
    }

    /// Returns the upward normal of the deformed surface.
    fn normal(&self, x: f32, y: f32) -> Vector3<f32> {
        // Small compared to the width of a dent, m.
        const STEP: f32 = 2e-4;
        let slope = |dx, dy| (self.lift_m(x + dx, y + dy) - self.lift_m(x - dx, y - dy)) / (2.0 * STEP);
        Vector3::new(-slope(STEP, 0.0), -slope(0.0, STEP), 1.0).normalize()
    }
}

/// The objects of one arm pair.
#[derive(Clone, Debug, PartialEq)]
pub struct StageArm {
    pub side: Side,
    /// Position of its trocar, m.
    pub trocar_m: Vector3<f32>,
    /// Positions of its targets, m.
    pub targets_m: Vec<Vector3<f32>>,
    pub pose: StagePose,
    /// Recent positions of the tip, m, oldest first.
    pub trail_m: Vec<Vector3<f32>>,
    /// Base, joints, flange and sensor of the robot arm, m; empty if it is not drawn.
    pub links_m: Vec<Vector3<f32>>,
}

#[derive(Clone, Copy, Debug)]
pub struct SceneStyle<'a> {
    /// Eye position, m.
    pub eye_m: &'a Vector3<f32>,
    /// Direction to the right of the screen.
    pub right: &'a Vector3<f32>,
    /// More triangles.
    pub fine: bool,
    /// Shadows on a board.
    pub shadows: bool,
}

pub fn build(scene: &Scene, arms: &[StageArm], shown: Option<&DisplayedObjects>, style: SceneStyle<'_>) -> Mesh {
    let SceneStyle { eye_m, right, fine, .. } = style;
    let mut shadows = Shadows::on(training::board_of(scene).filter(|_| style.shadows));
    let mut mesh = Mesh { vertices: Vec::with_capacity(12_000), indices: Vec::with_capacity(60_000) };
    let mut dents = Dents([Dent::NONE; SIDES]);
    // Draw front objects first, so that hidden pixels are not shaded.
    for StageArm { side, trocar_m, pose, .. } in arms {
        let [measured, rendered] = arrow_bases_m(pose, trocar_m, right);
        let clear = ClearTip { tip_m: &pose.tip_m, eye_m };
        pose.measured_n.iter().for_each(|force_n| measured_arrow(&mut mesh, measured, force_n, clear));
        rendered_arrow(&mut mesh, rendered, &pose.rendered_n, clear);
        let tool = shown.and_then(|shown| {
            let jaws = objects::jaws(&mut mesh, scene, shown, *side, &pose.tip_m, &mut shadows);
            jaws.or_else(|| training::hoop(&mut mesh, scene, shown, (*side, &pose.tip_m, trocar_m), &mut shadows))
        });
        match tool {
            Some(end_m) => shaft(&mut mesh, trocar_m, &end_m),
            None => instrument(&mut mesh, trocar_m, &pose.tip_m),
        }
        shadows.rod(&tool.unwrap_or(pose.tip_m), trocar_m, SHAFT_RADIUS_M);
        dents.0[side.index()] = Dent::new(scene, &pose.tip_m);
    }
    for StageArm { targets_m, trail_m, links_m, trocar_m, .. } in arms {
        robot(&mut mesh, links_m, trocar_m);
        for target_m in targets_m.iter().filter(|_| shown.is_none()) {
            mesh.ring(*target_m, [0.0055, 0.0008], |x, y| dents.lift_m(x, y), TARGET);
        }
        mesh.ribbon(trail_m, eye_m, |i| 0.0011 * (i as f32 / trail_m.len() as f32), TRAIL);
    }
    if let Some(shown) = shown {
        objects::ground(&mut mesh, scene, shown, &mut shadows);
        training::wire(&mut mesh, scene, &mut shadows);
        training::marks(&mut mesh, scene, shown, |x, y| dents.lift_m(x, y));
        shadows.lay(&mut mesh);
        training::board(&mut mesh, scene);
    }
    tissue(&mut mesh, scene, &dents, if fine { CELLS } else { CELLS_COARSE });
    mesh
}

fn tissue(mesh: &mut Mesh, scene: &Scene, dents: &Dents, cells: u32) {
    let Some(tissue) = scene.tissue else { return };
    let [x_m, y_m] = tissue.size_m.map(|x| 0.5 * x as f32);
    let top_m = tissue.surface_z_m as f32;
    let bottom_m = top_m - SLAB_THICKNESS_M;
    let place = |i: u32, half_m: f32| half_m * (2.0 * i as f32 / cells as f32 - 1.0);
    let first = mesh.vertices.len() as u32;
    for row in 0..=cells {
        for column in 0..=cells {
            let x = place(column, x_m);
            let y = place(row, y_m);
            let lift_m = dents.lift_m(x, y);
            // Darker in a depression, and paler where the tissue is compressed.
            let shade = (-lift_m / 0.010).clamp(0.0, 1.0) * 0.55;
            let colour = mottled(x, y).lerp_to_gamma(TISSUE_HOLLOW, shade);
            let position = Vector3::new(x, y, top_m + lift_m);
            mesh.vertex(position, dents.normal(x, y), Paint(colour, Material::Tissue));
        }
    }
    mesh.sheet(first, cells, cells);
    for (sign, along_x) in [(-1.0, true), (1.0, true), (-1.0, false), (1.0, false)] {
        let first = mesh.vertices.len() as u32;
        let normal = if along_x { Vector3::new(0.0, sign, 0.0) } else { Vector3::new(sign, 0.0, 0.0) };
        for low in [false, true] {
            for i in 0..=cells {
                let (x, y) = if along_x { (place(i, x_m), sign * y_m) } else { (sign * x_m, place(i, y_m)) };
                let z = if low { bottom_m } else { top_m + dents.lift_m(x, y) };
                mesh.vertex(Vector3::new(x, y, z), normal, TISSUE_SIDE);
            }
        }
        mesh.sheet(first, 1, cells);
    }
    mesh.cuboid(
        Vector3::new(-x_m - 0.012, -y_m - 0.012, bottom_m - 0.004),
        Vector3::new(x_m + 0.012, y_m + 0.012, bottom_m),
        TRAY,
    );
}

/// Returns the tissue's colour at a position, with slow variations that look like blood below the surface.
fn mottled(x: f32, y: f32) -> Color32 {
    let wave = (x * 97.0 + 2.1 * (y * 61.0).sin()).sin() + (y * 83.0 - 2.3 * (x * 53.0).sin() + 1.0).sin();
    let fine = ((x + 0.7 * y) * 271.0 + (y * 190.0).sin()).sin();
    let fraction = (0.5 + 0.22 * wave + 0.10 * fine).clamp(0.0, 1.0);
    TISSUE_DARK.lerp_to_gamma(TISSUE_PALE, fraction)
}

/// Draws the shaft through the trocar, with a blunt tip; its lowest point is the tip position.
fn instrument(mesh: &mut Mesh, trocar_m: &Vector3<f32>, tip_m: &Vector3<f32>) {
    let knob = tip_m + Vector3::z() * SHAFT_RADIUS_M;
    mesh.sphere(knob, SHAFT_RADIUS_M, 12, STEEL);
    shaft(mesh, trocar_m, &knob);
}

/// Draws the shaft from the end of the instrument through its trocar.
fn shaft(mesh: &mut Mesh, trocar_m: &Vector3<f32>, knob: &Vector3<f32>) {
    let Some(axis) = (trocar_m - knob).try_normalize(1e-4) else { return };
    mesh.tube([*knob, knob + axis * 0.012], [SHAFT_RADIUS_M * 0.8; 2], 20, STEEL);
    mesh.tube([knob + axis * 0.011, knob + axis * 0.014], [SHAFT_RADIUS_M, SHAFT_RADIUS_M * 1.15], 20, STEEL);
    mesh.tube([knob + axis * 0.014, trocar_m + axis * 0.12], [SHAFT_RADIUS_M * 1.15; 2], 20, SHAFT);
    mesh.tube([trocar_m - axis * 0.012, trocar_m + axis * 0.012], [SHAFT_RADIUS_M * 2.0; 2], 24, SLEEVE);
    mesh.tube([trocar_m + axis * 0.012, trocar_m + axis * 0.018], [SHAFT_RADIUS_M * 4.0; 2], 28, SLEEVE);
}

/// Draws the arm as capsules between its joints, and the shaft from the sensor to the trocar.
fn robot(mesh: &mut Mesh, links_m: &[Vector3<f32>], trocar_m: &Vector3<f32>) {
    for ends in links_m.windows(2) {
        mesh.tube([ends[0], ends[1]], [LINK_RADIUS_M; 2], 20, LINK);
        mesh.sphere(ends[1], LINK_RADIUS_M, 12, LINK);
    }
    if let Some(sensor_m) = links_m.last() {
        mesh.tube([*sensor_m, *trocar_m], [SHAFT_RADIUS_M * 1.15; 2], 20, SHAFT);
    }
}

/// Half the thickness of a link of the usual arms, m.
const LINK_RADIUS_M: f32 = 0.035;
const LINK: Paint = Paint(Color32::from_rgb(0x8a, 0x93, 0x9e), Material::Matte);
const SHAFT: Paint = Paint(Color32::from_rgb(0x6d, 0x76, 0x82), Material::Metal);

/// Returns the starting points of both arrows: next to the tip, on the side that the shaft does not cover in the
/// operator's view, the measured force further out, so that equal forces do not overlap.
pub fn arrow_bases_m(pose: &StagePose, trocar_m: &Vector3<f32>, right: &Vector3<f32>) -> [Vector3<f32>; 2] {
    let side = if (trocar_m - pose.tip_m).dot(right) > 0.0 { -1.0 } else { 1.0 };
    [0.0135, 0.0060].map(|away| pose.tip_m + right * (side * away) + Vector3::z() * 0.002)
}

#[cfg(test)]
mod tests {
    use super::*;

    const EYE_M: Vector3<f32> = Vector3::new(0.0, -0.3, 0.2);
    const RIGHT: Vector3<f32> = Vector3::new(1.0, 0.0, 0.0);
    const STYLE: SceneStyle<'static> = SceneStyle { eye_m: &EYE_M, right: &RIGHT, fine: true, shadows: true };

    fn pose(z: f32, force_n: Vector3<f32>) -> StagePose {
        StagePose { tip_m: Vector3::new(0.0, 0.018, z), measured_n: Some(force_n), rendered_n: force_n * 0.5 }
    }

    fn arm(pose: StagePose) -> StageArm {
        let trocar_m = Vector3::new(0.0, -0.06, 0.14);
        StageArm { side: Side::Right, trocar_m, targets_m: vec![], pose, trail_m: vec![], links_m: vec![] }
    }

    #[test]
    fn two_dents_are_both_there_and_where_they_meet_no_deeper_than_the_deeper_one() {
        let scene = Scene::load("bimanual").unwrap();
        let dent = |x, z| Dent::new(&scene, &Vector3::new(x, 0.0, z));
        let apart = Dents([dent(0.03, -0.006), dent(-0.03, -0.004)]);
        assert!((apart.lift_m(0.03, 0.0) + 0.006).abs() < 1e-5 && (apart.lift_m(-0.03, 0.0) + 0.004).abs() < 1e-5);
        let together = Dents([dent(0.001, -0.006), dent(-0.001, -0.005)]);
        let deepest = (-20..=20).map(|i| together.lift_m(i as f32 * 5e-4, 0.0)).fold(0.0, f32::min);
        assert!((deepest + 0.006).abs() < 1e-4, "{deepest}");
    }

    #[test]
    fn both_instruments_stand_on_the_stage() {
        let scene = Scene::load("free_motion").unwrap();
        let one = arm(pose(0.01, Vector3::z()));
        let other = StageArm { side: Side::Left, ..one.clone() };
        let corners = |arms: &[StageArm]| build(&scene, arms, None, STYLE).vertices.len();
        assert_eq!(corners(&[one.clone(), other]), 2 * corners(&[one]));
    }

    #[test]
    fn the_dent_is_as_deep_as_the_tip_and_local() {
        let scene = Scene::load("peg_transfer").unwrap();
        let dent = Dent::new(&scene, &Vector3::new(0.01, 0.0, -0.006));
        assert!((dent.lift_m(0.01, 0.0) + 0.006).abs() < 1e-6);
        assert!(dent.lift_m(0.05, 0.0).abs() < 1e-5);
        let above = Dent::new(&scene, &Vector3::new(0.01, 0.0, 0.006));
        assert!(above.lift_m(0.01, 0.0).abs() < 1e-9);
        let beside = Dent::new(&scene, &Vector3::new(0.2, 0.0, -0.006));
        assert!(beside.lift_m(0.2, 0.0).abs() < 1e-9);
    }

    #[test]
    fn a_scene_without_tissue_has_none_and_no_force_has_no_arrow() {
        let full = Scene::load("peg_transfer").unwrap();
        let bare = Scene::load("free_motion").unwrap();
        let size = |scene: &Scene, force_n| build(scene, &[arm(pose(0.01, force_n))], None, STYLE).vertices.len();
        assert!(size(&full, Vector3::zeros()) > size(&bare, Vector3::zeros()) + 4000);
        assert!(size(&bare, Vector3::z()) > size(&bare, Vector3::z() * 0.01));
        let coarse = SceneStyle { fine: false, ..STYLE };
        let coarse = build(&full, &[arm(pose(0.01, Vector3::zeros()))], None, coarse);
        assert!(2 * coarse.vertices.len() < 2 * 1000 + size(&full, Vector3::zeros()));
    }

    #[test]
    fn what_is_not_finite_reaches_no_arrow() {
        let scene = Scene::load("free_motion").unwrap();
        let nowhere = arm(pose(0.01, Vector3::repeat(f32::NAN)));
        let mesh = build(&scene, &[nowhere], None, STYLE);
        assert!(mesh.vertices.iter().all(|v| v.position.iter().all(|x| x.is_finite())));
    }
}
