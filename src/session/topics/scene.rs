//! The 3-D view of a session: poses of tip and leader, and the forces at the tip as arrows.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use nima_machine::{messages::Tick, rig::Side};
use nima_recording::{
    messages::foxglove::{
        self, ArrowPrimitive, Color, FrameTransform, FrameTransforms, Pose, Quaternion, SceneEntity, SceneUpdate,
        timestamp,
    },
    session::WriteError,
};

use crate::sinks::{SessionSinks, SinkChannel};
use prost::Message as _;

/// Interval between two views, s: a screen shows no more.
const EVERY_S: f64 = 0.02;
/// Length of an arrow, m/N.
const LENGTH_M_N: f64 = 0.02;
const SHAFT_M: f64 = 0.001;
const HEAD_M: f64 = 0.003;
const MEASURED: Color = Color { r: 0.1, g: 0.6, b: 0.9, a: 1.0 };
const RENDERED: Color = Color { r: 0.95, g: 0.5, b: 0.1, a: 1.0 };

pub(crate) const FRAMES_TOPIC: &str = "frames";
pub(crate) const ARROWS_TOPIC: &str = "arrows";

/// Parent of all other frames.
pub(super) const WORLD: &str = "world";
/// The frames drawn for a side.
pub(super) const DRAWN: [&str; 2] = ["tip", "leader"];

/// The endoscope's marker as a frame; only while its position is known.
pub(crate) const ENDOSCOPE: &str = "endoscope";

pub(super) fn name_of_frame(side: Side, what: &str) -> String {
    format!("{}.{what}", side.word())
}

pub(super) fn name_of_arrows(side: Side) -> String {
    name_of_frame(side, "forces")
}

#[derive(Debug)]
pub(super) struct SceneChannels {
    frames: SinkChannel,
    arrows: SinkChannel,
    due_s: f64,
}

impl SceneChannels {
    pub(super) fn new(out: &mut SessionSinks) -> Result<Self, WriteError> {
        let frames = out.channel(FRAMES_TOPIC, foxglove::encoding::<FrameTransforms>())?;
        let arrows = out.channel(ARROWS_TOPIC, foxglove::encoding::<SceneUpdate>())?;
        Ok(Self { frames, arrows, due_s: f64::NEG_INFINITY })
    }

    /// Writes a view of these simultaneous ticks, if it is due.
    pub(super) fn show<'a>(
        &mut self,
        out: &mut SessionSinks,
        time_ns: u64,
        t_s: f64,
        ticks: impl Iterator<Item = &'a Tick>,
    ) -> Result<(), WriteError> {
        // If the clock was set back, start again.
        if t_s < self.due_s && t_s > self.due_s - 2.0 * EVERY_S {
            return Ok(());
        }
        self.due_s = t_s + EVERY_S;
        let timestamp = Some(timestamp(time_ns));
        let mut frames = FrameTransforms::default();
        let mut scene = SceneUpdate::default();
        for tick in ticks {
            if let Some(world_from_n) = tick.calibration.view.world_from_n().filter(|_| !has_endoscope(&frames)) {
                frames.transforms.push(FrameTransform {
                    timestamp,
                    parent_frame_id: WORLD.to_owned(),
                    child_frame_id: ENDOSCOPE.to_owned(),
                    translation: Some(vector(&world_from_n.translation.vector)),
                    rotation: Some(quaternion(&world_from_n.rotation)),
                });
            }
            for (name, position_m) in DRAWN.into_iter().zip([tick.positions.tip_m, tick.positions.leader_m]) {
                frames.transforms.push(FrameTransform {
                    timestamp,
                    parent_frame_id: WORLD.to_owned(),
                    child_frame_id: name_of_frame(tick.side, name),
                    translation: Some(vector(&position_m)),
                    rotation: Some(quaternion(&UnitQuaternion::identity())),
                });
            }
            let arrows = [(tick.measured_n, MEASURED), (tick.rendering.rendered_n, RENDERED)];
            scene.entities.push(SceneEntity {
                timestamp,
                frame_id: WORLD.to_owned(),
                id: name_of_arrows(tick.side),
                arrows: arrows
                    .iter()
                    .filter_map(|(force_n, color)| arrow(&tick.positions.tip_m, force_n, *color))
                    .collect(),
                ..SceneEntity::default()
            });
        }
        out.message(self.frames, time_ns, &frames.encode_to_vec())?;
        out.message(self.arrows, time_ns, &scene.encode_to_vec())
    }
}

fn has_endoscope(frames: &FrameTransforms) -> bool {
    frames.transforms.iter().any(|frame| frame.child_frame_id == ENDOSCOPE)
}

/// Returns the endoscope's marker among recorded frames.
pub(crate) fn endoscope_of(data: &[u8]) -> Option<Isometry3<f64>> {
    let frames = FrameTransforms::decode(data).ok()?;
    let frame = frames.transforms.iter().find(|frame| frame.child_frame_id == ENDOSCOPE)?;
    let at = frame.translation?;
    let turn = frame.rotation?;
    let turn = UnitQuaternion::try_new(nalgebra::Quaternion::new(turn.w, turn.x, turn.y, turn.z), 1e-6)?;
    let world_from_n = Isometry3::from_parts(Vector3::new(at.x, at.y, at.z).into(), turn);
    world_from_n.to_homogeneous().iter().all(|number| number.is_finite()).then_some(world_from_n)
}

/// Returns a force (N) at a position (m); no arrow if the force is zero or unknown.
fn arrow(position_m: &Vector3<f64>, force_n: &Vector3<f64>, color: Color) -> Option<ArrowPrimitive> {
    // An arrow points along its own x axis; for the opposite direction, any half turn works.
    let turned = UnitQuaternion::rotation_between(&Vector3::x(), force_n)
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::PI));
    let length_m = force_n.norm() * LENGTH_M_N;
    (length_m > 1e-6).then(|| ArrowPrimitive {
        pose: Some(Pose { position: Some(vector(position_m)), orientation: Some(quaternion(&turned)) }),
        shaft_length: length_m,
        shaft_diameter: SHAFT_M,
        head_length: HEAD_M,
        head_diameter: HEAD_M,
        color: Some(color),
    })
}

pub(super) fn vector(of: &Vector3<f64>) -> foxglove::Vector3 {
    foxglove::Vector3 { x: of.x, y: of.y, z: of.z }
}

pub(super) fn quaternion(of: &UnitQuaternion<f64>) -> Quaternion {
    Quaternion { x: of.i, y: of.j, z: of.k, w: of.w }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_has_an_arrow_and_an_unknown_one_has_none() {
        let at = |force_n: Vector3<f64>| arrow(&Vector3::zeros(), &force_n, MEASURED);
        assert!((at(Vector3::new(0.0, 0.0, 2.0)).unwrap().shaft_length - 0.04).abs() < 1e-12);
        assert_eq!([at(Vector3::zeros()), at(nima_machine::messages::UNKNOWN_N)], [None, None]);
    }

    #[test]
    fn the_endoscopes_marker_is_read_as_it_was_written_and_no_other_frame_or_number_is() {
        let world_from_n = Isometry3::new(Vector3::new(0.1, -0.2, 0.3), Vector3::new(0.4, 1.0, -2.0));
        let frame = |name: &str, position_m: Vector3<f64>| FrameTransform {
            timestamp: None,
            parent_frame_id: WORLD.to_owned(),
            child_frame_id: name.to_owned(),
            translation: Some(vector(&position_m)),
            rotation: Some(quaternion(&world_from_n.rotation)),
        };
        let read = |frames: Vec<FrameTransform>| endoscope_of(&FrameTransforms { transforms: frames }.encode_to_vec());
        let position_m = world_from_n.translation.vector;
        let again = read(vec![frame("right.tip", Vector3::zeros()), frame(ENDOSCOPE, position_m)]).unwrap();
        let off = again.inverse() * world_from_n;
        assert!(off.translation.vector.norm() < 1e-12 && off.rotation.angle() < 1e-7, "{off}");
        assert_eq!(read(vec![frame("right.tip", position_m)]), None);
        assert_eq!(read(vec![frame(ENDOSCOPE, Vector3::new(f64::NAN, 0.0, 0.0))]), None);
        assert_eq!(endoscope_of(b"no frames"), None);
    }
}
