//! Board, pegs, rings and jaws of a scene with objects.

use egui::Color32;
use nalgebra::{UnitQuaternion, Vector3};
use nima_machine::rig::{SIDES, Side};
use nima_world::scene::Scene;

use super::mesh::{Material, Mesh, Paint};
use crate::console::live::Live;

const BOARD: Paint = Paint(Color32::from_rgb(0x3a, 0x45, 0x52), Material::Matte);
const PEG: Paint = Paint(Color32::from_rgb(0xc9, 0xcf, 0xd6), Material::Matte);
const RING: Paint = Paint(Color32::from_rgb(0xe0, 0x8a, 0x2e), Material::Matte);
const FINGER: Paint = Paint(Color32::from_rgb(0xb4, 0xbc, 0xc6), Material::Metal);
const BOARD_THICKNESS_M: f32 = 0.003;

/// What moves besides the instruments.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    rings: Vec<(Vector3<f32>, UnitQuaternion<f32>)>,
    /// Not known of a past or far session: neither rings nor jaws are recorded.
    opening_rad: Option<[f32; SIDES]>,
}

impl Shown {
    /// What the simulation told last; `None` in a scene without objects.
    pub(super) fn of(live: &Live) -> Option<Self> {
        live.scene.objects.as_ref()?;
        let Some(moment) = &live.moment else { return Some(Self { rings: vec![], opening_rad: None }) };
        let rings = moment.rings.iter().flatten();
        Some(Self {
            rings: rings.map(|ring| (ring.centre_m.cast(), ring.world_from_ring.cast())).collect(),
            opening_rad: Some(moment.opening_rad.map(|rad| rad as f32)),
        })
    }
}

/// Board, pegs and rings.
pub(super) fn ground(mesh: &mut Mesh, scene: &Scene, shown: &Shown) {
    let Some(setting) = &scene.objects else { return };
    let [tube_m, major_m] = [setting.ring.tube_radius_m, setting.ring.major_radius_m].map(|m| m as f32);
    for (centre_m, turn) in &shown.rings {
        mesh.torus(*centre_m, turn, [major_m, tube_m], RING);
    }
    let (radius_m, foot_m) = (setting.pegs.radius_m as f32, setting.board.z_m as f32);
    let top_m = foot_m + setting.pegs.height_m as f32 - radius_m;
    for [x, y] in &setting.pegs.at_m {
        let [foot, top] = [foot_m, top_m].map(|z| Vector3::new(*x as f32, *y as f32, z));
        mesh.tube([foot, top], [radius_m; 2], 16, PEG);
        mesh.sphere(top, radius_m, 8, PEG);
    }
    let [x_m, y_m] = setting.board.size_m.map(|m| 0.5 * m as f32);
    let low = Vector3::new(-x_m, -y_m, foot_m - BOARD_THICKNESS_M);
    mesh.cuboid(low, Vector3::new(x_m, y_m, foot_m), BOARD);
}

/// Both fingers, which the wrist holds upright; where the shaft ends. `None` where they are not known.
pub(super) fn jaws(
    mesh: &mut Mesh,
    scene: &Scene,
    shown: &Shown,
    side: Side,
    tip_m: &Vector3<f32>,
) -> Option<Vector3<f32>> {
    let (setting, opening_rad) = (scene.objects.as_ref()?, shown.opening_rad?[side.index()]);
    let [length_m, radius_m] = [setting.jaws.finger_length_m, setting.jaws.finger_radius_m].map(|m| m as f32);
    let hinge_m = tip_m + Vector3::z() * length_m;
    for sign in [-1.0, 1.0] {
        let (sin, cos) = (0.5 * opening_rad * sign).sin_cos();
        let end_m = hinge_m + Vector3::new(sin, 0.0, -cos) * length_m;
        mesh.tube([hinge_m, end_m], [1.4 * radius_m, radius_m], 12, FINGER);
        mesh.sphere(end_m, radius_m, 6, FINGER);
    }
    Some(hinge_m)
}
