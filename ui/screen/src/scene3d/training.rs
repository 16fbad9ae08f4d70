//! Wire and loop, marks and lumps, and one line about the progress of the trial.

use egui::{Color32, Label, Rect, RichText, Ui, vec2};
use nalgebra::{UnitQuaternion, Vector3};
use nima_core::impedance::Mode;
use nima_machine::rig::Side;
use nima_simulation::{Training, scene::Scene};
use nima_words::text;

use super::{
    mesh::{Material, Mesh, Paint},
    objects::{self, DisplayedObjects},
    reach::JawReach,
    shadows::Shadows,
    side_name,
};
use crate::{live::LiveState, theme};

const WIRE: Paint = Paint(Color32::from_rgb(0xa9, 0xbd, 0xcc), Material::Metal);
const LOOP: Paint = Paint(Color32::from_rgb(0xd8, 0xdd, 0xe2), Material::Metal);
/// A loop in contact: brighter and thicker.
const LOOP_TOUCHES: Paint = Paint(Color32::from_rgb(0xe0, 0x8a, 0x2e), Material::Plain);
const THICKER: f32 = 1.5;
/// The free end of a wire and its goal.
const ENDS: Paint = Paint(Color32::from_rgb(0xe8, 0xed, 0xf2), Material::Matte);
const MARK: Paint = Paint(Color32::from_rgb(0xee, 0xf1, 0xf5), Material::Matte);
const MARK_FALSE: Paint = Paint(Color32::from_rgb(0x3a, 0x42, 0x4c), Material::Matte);
const PIN: Paint = Paint(Color32::from_rgb(0xb4, 0xbc, 0xc6), Material::Metal);
const LUMP: Paint = Paint(Color32::from_rgb(0x6a, 0x2f, 0x4e), Material::Matte);

/// Largest width of the line about the trial, points: the longest text in the longest language fits.
const LINE_MAX: f32 = 640.0;
/// Width of the gauges at the right of the view, points.
const GAUGES: f32 = 110.0;
/// One in this many points of the wire's curve is drawn.
const POINTS: usize = 3;
/// Height of a pin, and radius of its head, m.
const PIN_M: f32 = 0.007;
const HEAD_M: f32 = 0.0015;

/// Draws the wire and its board, with the goal.
pub(super) fn wire(mesh: &mut Mesh, scene: &Scene, shadows: &mut Shadows) {
    let Some(setting) = &scene.wire else { return };
    let curve = setting.curve();
    let radius_m = setting.radius_m as f32;
    let last = curve.points_m().len() - 1;
    let points_m: Vec<Vector3<f32>> = curve
        .points_m()
        .iter()
        .enumerate()
        .filter(|(i, _)| i % POINTS == 0 || *i == last)
        .map(|(_, point_m)| point_m.cast())
        .collect();
    mesh.pipe(&points_m, radius_m, 10, WIRE);
    mesh.sphere(points_m[0], 1.4 * radius_m, 8, ENDS);
    let goal_m = curve.given_m(setting.goal_point);
    for band in 0..3 {
        let position_m = goal_m + 0.003 * f64::from(band);
        let ends = [position_m, position_m + 0.0012].map(|along_m| curve.at(along_m).cast());
        mesh.tube(ends, [1.9 * radius_m; 2], 14, ENDS);
    }
    shadows.line(points_m, radius_m);
}

/// Adds the loop of an instrument; returns the end of the shaft. `None` in a scene without a wire.
pub(super) fn hoop(
    mesh: &mut Mesh,
    scene: &Scene,
    shown: &DisplayedObjects,
    (side, tip_m, trocar_m): (Side, &Vector3<f32>, &Vector3<f32>),
    shadows: &mut Shadows,
) -> Option<Vector3<f32>> {
    let hoop = scene.wire.as_ref()?.hoop;
    let along_shaft = trocar_m - tip_m;
    let given = hoop.axis.map_or(along_shaft, |axis| Vector3::from(axis).cast());
    let axis = given.try_normalize(1e-6).unwrap_or_else(Vector3::x);
    let turn = UnitQuaternion::rotation_between(&Vector3::z(), &axis).unwrap_or_else(UnitQuaternion::identity);
    let [major_m, tube_m] = [hoop.radius_m as f32, hoop.tube_radius_m as f32];
    let (paint, thick) = if shown.loops[side.index()].touches { (LOOP_TOUCHES, THICKER) } else { (LOOP, 1.0) };
    mesh.torus(*tip_m, &turn, [major_m, thick * tube_m], paint);
    shadows.circle(tip_m, &turn, [major_m, tube_m]);
    let in_plane = along_shaft - axis * axis.dot(&along_shaft);
    let up = in_plane.try_normalize(1e-4).unwrap_or_else(|| turn * Vector3::x());
    Some(tip_m + up * major_m)
}

/// Draws pins at the operator's marks; after the trial also the lumps, and false marks look different.
pub(super) fn marks(mesh: &mut Mesh, scene: &Scene, shown: &DisplayedObjects, lift_m: impl Fn(f32, f32) -> f32) {
    for (position_m, is_true) in &shown.marks {
        let foot_m = position_m + Vector3::z() * lift_m(position_m.x, position_m.y);
        let head_m = foot_m + Vector3::z() * PIN_M;
        mesh.tube([foot_m, head_m], [0.0004; 2], 8, PIN);
        if shown.ended && !is_true {
            mesh.cuboid(head_m - Vector3::repeat(HEAD_M), head_m + Vector3::repeat(HEAD_M), MARK_FALSE);
        } else {
            mesh.sphere(head_m, HEAD_M, 8, MARK);
        }
    }
    let Some((lumps, tissue)) = scene.placed_lumps().zip(scene.tissue).filter(|_| shown.ended) else { return };
    for lump in &lumps.list {
        let [x, y] = lump.position_m.map(|m| m as f32);
        let position_m = Vector3::new(x, y, tissue.surface_z_m as f32);
        mesh.ring(position_m, [lump.radius_m as f32, 0.0007], &lift_m, LUMP);
    }
}

/// Adds the board under the wire, or under the pegs.
pub(super) fn board(mesh: &mut Mesh, scene: &Scene) {
    if let Some(board) = board_of(scene) {
        objects::board(mesh, board);
    }
}

/// Returns the board of a scene.
pub(super) fn board_of(scene: &Scene) -> Option<&nima_simulation::physics::BoardSettings> {
    let under_pegs = scene.objects.as_ref().map(|setting| &setting.board);
    under_pegs.or_else(|| scene.wire.as_ref().map(|setting| &setting.board))
}

/// Duration of a trial, on the loop's clock. It begins with the loop or with a restart, and ends with the task.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TrialClock {
    began_s: f64,
    ended_s: Option<f64>,
}

impl TrialClock {
    /// Returns the duration at this time, s; `begins`: the trial has just been restarted.
    pub(super) fn seconds(&mut self, now_s: f64, begins: bool, ended: bool) -> f64 {
        if begins || now_s < self.began_s {
            *self = Self { began_s: if begins { now_s } else { 0.0 }, ended_s: None };
        }
        self.ended_s = ended.then(|| self.ended_s.unwrap_or(now_s));
        self.ended_s.unwrap_or(now_s) - self.began_s
    }
}

/// Returns the progress of the trial as text, and the ring in reach of the driven instrument; `None` in a scene where
/// it is unknown.
pub(super) fn report(live: &LiveState, led: Option<Side>, reach: Option<JawReach>) -> Option<String> {
    let training = live.training.as_ref()?;
    let is_led = led.is_some();
    if live.scene.objects.is_some() {
        let jaws = led.map(|side| text::training::jaws(side_name(side), reach.map(name_of)));
        let Training { passed, placed, dropped, fraction, .. } = training;
        let rings = live.scene.objects.as_ref().map_or(0, |setting| setting.rings.len());
        // Each ring goes to the other side and back.
        let left = (2.0 * rings as f64 * (1.0 - fraction)).round() as u32;
        return Some(text::training::rings(jaws.as_deref(), [left, *passed, *placed, *dropped], training.ended));
    }
    if live.scene.wire.is_some() {
        return Some(text::training::wire(training.touches, training.fraction, training.ended, is_led));
    }
    let lumps = live.scene.task.as_ref().filter(|_| live.scene.is_searched())?.lumps.unwrap_or(0);
    let mark_false = training.marks.iter().flatten().filter(|mark| !mark.is_true).count() as u32;
    Some(if training.ended {
        text::training::lumps_found(training.found, lumps, mark_false)
    } else {
        text::training::lumps_marked(training.marked, is_led)
    })
}

/// Above this delay, s, two hands that hold one ring excite each other through the link in the modes that carry force.
const LONG_S: f64 = 0.01;

/// Returns whether the rings can end in a fault in the current mode.
pub(super) fn needs_another_mode(live: &LiveState) -> bool {
    let carries_force = matches!(live.mode(), Mode::Best | Mode::Anchored);
    let shares_rings = live.scene.objects.is_some() && live.is_bimanual();
    shares_rings && carries_force && live.delay_s() > LONG_S && !live.is_shown_only()
}

fn name_of(reach: JawReach) -> &'static str {
    match reach {
        JawReach::Above(_) => text::training::JAWS_ABOVE.get(),
        JawReach::Between(_) => text::training::JAWS_AROUND.get(),
        JawReach::Held(_) => text::training::JAWS_HOLD.get(),
    }
}

/// Draws the line at the top of the view; `readings` is the width of the readings at its left, if figures are shown.
pub(super) fn line_ui(ui: &mut Ui, rect: Rect, words: Option<String>, readings: f32, figures: bool) {
    let Some(words) = words else { return };
    // Place it between the readings and the gauges, if they are shown.
    let room = if figures {
        Rect::from_min_max(rect.left_top() + vec2(readings, 0.0), rect.right_bottom() - vec2(GAUGES, 0.0))
    } else {
        rect
    };
    let place =
        Rect::from_center_size(room.center_top() + vec2(0.0, 22.0), vec2(room.width().clamp(60.0, LINE_MAX), 28.0));
    ui.painter_at(rect).rect_filled(place, theme::CORNER, theme::VEIL);
    ui.put(place, Label::new(RichText::new(words).font(theme::strong(14.0)).color(theme::DARK.text)).truncate());
}

#[cfg(test)]
mod tests {
    use nima_machine::config::RigConfig;
    use nima_simulation::{LoopObservation, MARKS_MAX, PlaceMark};

    use super::*;

    fn live(scene: &str, training: &Training) -> LiveState {
        let mut live = LiveState::new(RigConfig::load("simulated").unwrap(), Scene::load(scene).unwrap());
        live.training = Some(*training);
        live
    }

    fn marked(ended: bool) -> Training {
        let mut marks = [None; MARKS_MAX];
        for (mark, is_true) in marks.iter_mut().zip([true, false, false]) {
            *mark = Some(PlaceMark { position_m: Vector3::new(0.01, 0.0, 0.0), is_true });
        }
        Training { ended, marks, marked: 3, found: 1, ..Training::default() }
    }

    fn vertices(live: &LiveState) -> usize {
        let mut mesh = Mesh::default();
        marks(&mut mesh, &live.scene, &DisplayedObjects::of(live, None).unwrap(), |_, _| 0.0);
        mesh.vertices.len()
    }

    #[test]
    fn the_clock_of_a_trial_stops_at_its_end_and_begins_again() {
        let mut clock = TrialClock::default();
        let mut seconds = |now_s, begins, ended| clock.seconds(now_s, begins, ended).round() as i32;
        assert_eq!(seconds(12.0, false, false), 12);
        assert_eq!(seconds(20.0, true, false), 0);
        assert_eq!([seconds(25.0, false, true), seconds(30.0, false, true)], [5, 5]);
        assert_eq!(seconds(1.0, false, false), 1, "another loop");
    }

    #[test]
    fn neither_picture_nor_words_tell_of_lumps_before_the_trial_is_over() {
        let during = live("find_lumps", &marked(false));
        let after = live("find_lumps", &marked(true));
        let mut wrong = marked(false);
        wrong.marks.iter_mut().flatten().for_each(|mark| mark.is_true = false);
        wrong.found = 0;
        let wrong = live("find_lumps", &wrong);
        assert_eq!(vertices(&during), vertices(&wrong), "a true mark looks as a false one does");
        let led = Some(Side::Right);
        assert_eq!(report(&during, led, None), report(&wrong, led, None));
        assert!(vertices(&after) > vertices(&during) + 1000, "the lumps");
        assert_eq!(report(&after, None, None).unwrap(), "Lumps found: 1 of 5, false marks: 2");
        assert_eq!(report(&live("lumps", &marked(true)), None, None), None, "they are not searched");
    }

    #[test]
    fn what_jaws_hold_is_told_with_what_was_counted() {
        let training = Training { passed: 3, placed: 2, dropped: 1, ..Training::default() };
        let report = |training: &Training, led, reach| report(&live("rings", training), led, reach).unwrap();
        let counted = "12 to go, passed 3, placed 2, dropped 1";
        assert_eq!(report(&training, None, None), format!("Rings: {counted}"));
        let left = |reach| report(&training, Some(Side::Left), reach);
        assert_eq!(left(None), format!("Left instrument. Rings: {counted}"));
        assert_eq!(left(Some(JawReach::Held(4))), format!("Left instrument holds a ring. Rings: {counted}"));
        assert_eq!(left(Some(JawReach::Above(4))), format!("Left instrument above a ring. Rings: {counted}"));
        assert_eq!(left(Some(JawReach::Between(4))), format!("Left instrument around a ring. Rings: {counted}"));
        let done = Training { passed: 12, placed: 12, ended: true, ..Training::default() };
        assert_eq!(report(&done, None, None), "Task done. Rings: passed 12, placed 12, dropped 0");
    }

    #[test]
    fn two_hands_on_rings_are_told_which_mode_they_need() {
        let needs = |scene: &str, mode: Mode, delay_s: f64| {
            let mut rig = RigConfig::load("simulated").unwrap();
            rig.mode = mode;
            rig.delay_s = delay_s;
            needs_another_mode(&LiveState::new(rig, Scene::load(scene).unwrap()))
        };
        assert!(needs("rings", Mode::Best, 0.05) && needs("rings", Mode::Anchored, 0.05));
        assert!(!needs("rings", Mode::Matched, 0.05) && !needs("rings", Mode::Best, 0.0));
        assert!(!needs("bimanual", Mode::Best, 0.05), "there each hand presses for itself");
    }

    #[test]
    fn a_loop_hangs_on_its_shaft_and_shows_that_it_touches() {
        let mut training = Training::default();
        training.loops[Side::Right.index()] = LoopObservation { touches: true, on_wire: true };
        let of = |training: &Training| {
            let live = live("wire", training);
            let mut mesh = Mesh::default();
            let shown = DisplayedObjects::of(&live, None).unwrap();
            let tip_m = Vector3::new(0.0, 0.0, 0.03);
            let trocar_m = Vector3::new(0.0, -0.06, 0.14);
            let mut shadows = Shadows::on(board_of(&live.scene));
            let end_m = hoop(&mut mesh, &live.scene, &shown, (Side::Right, &tip_m, &trocar_m), &mut shadows).unwrap();
            assert!(((end_m - tip_m).norm() - 0.006).abs() < 1e-6 && end_m.z > tip_m.z, "{end_m}");
            wire(&mut mesh, &live.scene, &mut shadows);
            shadows.lay(&mut mesh);
            assert!(mesh.vertices.iter().all(|vertex| vertex.position.iter().all(|x| x.is_finite())));
            mesh.vertices.iter().filter(|vertex| vertex.colour[3] == Material::Plain as u8).count()
        };
        assert!(of(&training) > 100 && of(&Training::default()) == 0);
    }
}
