//! Board, pegs, rings and jaws of a scene with objects, and the moving parts of all training scenes.

use egui::Color32;
use nalgebra::{UnitQuaternion, Vector3};
use nima_machine::rig::{SIDES, Side};
use nima_session::objects::ObjectStates;
use nima_simulation::{LoopObservation, Training, scene::Scene};

use super::{
    mesh::{Material, Mesh, Paint},
    reach::JawReach,
    shadows::Shadows,
};
use crate::live::LiveState;

pub(super) const BOARD: Paint = Paint(Color32::from_rgb(0x3a, 0x45, 0x52), Material::Matte);
const PEG: Paint = Paint(Color32::from_rgb(0xc9, 0xcf, 0xd6), Material::Matte);
const RING: Paint = Paint(Color32::from_rgb(0xe0, 0x8a, 0x2e), Material::Matte);
/// A ring that the jaws of the driven instrument would grip, and one that they hold.
const RING_REACHED: Paint = Paint(Color32::from_rgb(0xf7, 0xdc, 0xb4), Material::Matte);
const RING_HELD: Paint = Paint(Color32::from_rgb(0x9c, 0xe8, 0x7a), Material::Matte);
const FINGER: Paint = Paint(Color32::from_rgb(0xb4, 0xbc, 0xc6), Material::Metal);
const BOARD_THICKNESS_M: f32 = 0.003;

/// Moving parts in addition to the instruments.
#[derive(Clone, Debug, PartialEq)]
pub struct DisplayedObjects {
    rings: Vec<(Vector3<f32>, UnitQuaternion<f32>)>,
    /// The ring that the jaws of the driven instrument would grip or hold.
    pub(super) reach: Option<JawReach>,
    /// Unknown in sessions of older versions.
    opening_rad: [Option<f32>; SIDES],
    /// Marked places, each with whether it is on a lump (shown only after the trial).
    pub(super) marks: Vec<(Vector3<f32>, bool)>,
    pub(super) loops: [LoopObservation; SIDES],
    pub(super) ended: bool,
}

impl DisplayedObjects {
    /// Returns the last reported objects, with the driven instrument; `None` in a scene without its own training task.
    pub(super) fn of(live: &LiveState, led: Option<Side>) -> Option<Self> {
        if !live.scene.is_played() {
            return None;
        }
        let none = ObjectStates::default();
        let blank = Training::default();
        let ObjectStates { rings, jaws, .. } = live.objects.as_ref().unwrap_or(&none);
        let training = live.training.as_ref().unwrap_or(&blank);
        let rings = rings.iter().flatten();
        let rings: Vec<_> = rings.map(|ring| (ring.translation.vector.cast(), ring.rotation.cast())).collect();
        let reach = led.and_then(|side| {
            let tick = live.tick_of(side)?;
            let jaws = jaws[side.index()].as_ref()?;
            JawReach::of(live.scene.objects.as_ref()?, &rings, &tick.positions.tip_m, jaws)
        });
        Some(Self {
            rings,
            reach,
            opening_rad: jaws.map(|jaws| jaws.map(|jaws| jaws.opening_rad as f32)),
            marks: training.marks.iter().flatten().map(|mark| (mark.position_m.cast(), mark.is_true)).collect(),
            loops: training.loops,
            ended: training.ended,
        })
    }

    /// Returns the centre of the ring in the jaws of the driven instrument, m.
    pub(super) fn held_m(&self) -> Option<Vector3<f32>> {
        let held = self.reach.filter(|reach| matches!(reach, JawReach::Held(_)))?;
        self.rings.get(held.ring()).map(|(middle_m, _)| *middle_m)
    }

    fn paint_of(&self, ring: usize) -> Paint {
        match self.reach.filter(|reach| reach.ring() == ring) {
            None => RING,
            Some(JawReach::Above(_) | JawReach::Between(_)) => RING_REACHED,
            Some(JawReach::Held(_)) => RING_HELD,
        }
    }
}

/// Adds a board with its surface at this height, m.
pub(super) fn board(mesh: &mut Mesh, board: &nima_simulation::physics::BoardSettings) {
    let [x_m, y_m] = board.size_m.map(|m| 0.5 * m as f32);
    let top_m = board.z_m as f32;
    let low = Vector3::new(-x_m, -y_m, top_m - BOARD_THICKNESS_M);
    mesh.cuboid(low, Vector3::new(x_m, y_m, top_m), BOARD);
}

/// Adds board, pegs and rings.
pub(super) fn ground(mesh: &mut Mesh, scene: &Scene, shown: &DisplayedObjects, shadows: &mut Shadows) {
    let Some(setting) = &scene.objects else { return };
    let [tube_m, major_m] = [setting.ring.tube_radius_m, setting.ring.major_radius_m].map(|m| m as f32);
    for (i, (centre_m, turn)) in shown.rings.iter().enumerate() {
        mesh.torus(*centre_m, turn, [major_m, tube_m], shown.paint_of(i));
        shadows.circle(centre_m, turn, [major_m, tube_m]);
    }
    let radius_m = setting.pegs.radius_m as f32;
    let foot_m = setting.board.z_m as f32;
    let top_m = foot_m + setting.pegs.height_m as f32 - radius_m;
    for [x, y] in &setting.pegs.position_m {
        let [foot, top] = [foot_m, top_m].map(|z| Vector3::new(*x as f32, *y as f32, z));
        mesh.tube([foot, top], [radius_m; 2], 16, PEG);
        mesh.sphere(top, radius_m, 8, PEG);
        shadows.rod(&foot, &(top + Vector3::z() * radius_m), radius_m);
    }
}

/// Draws both fingers, held upright by the wrist; returns the end of the shaft. `None` if they are unknown.
pub(super) fn jaws(
    mesh: &mut Mesh,
    scene: &Scene,
    shown: &DisplayedObjects,
    side: Side,
    tip_m: &Vector3<f32>,
    shadows: &mut Shadows,
) -> Option<Vector3<f32>> {
    let setting = scene.objects.as_ref()?;
    let opening_rad = shown.opening_rad[side.index()]?;
    let [length_m, radius_m] = [setting.jaws.finger_length_m, setting.jaws.finger_radius_m].map(|m| m as f32);
    let hinge_m = tip_m + Vector3::z() * length_m;
    for sign in [-1.0, 1.0] {
        let (sin, cos) = (0.5 * opening_rad * sign).sin_cos();
        let end_m = hinge_m + Vector3::new(sin, 0.0, -cos) * length_m;
        mesh.tube([hinge_m, end_m], [1.4 * radius_m, radius_m], 12, FINGER);
        mesh.sphere(end_m, radius_m, 6, FINGER);
        shadows.rod(&end_m, &hinge_m, 1.2 * radius_m);
    }
    Some(hinge_m)
}
