//! The state of a loop at one time, and its messages.

use nalgebra::Vector3;
use nima_core::safety::InterlockState;
use nima_machine::{
    messages::{Fault, LoopState, Tick, TickPositions},
    rig::{SIDES, Side},
};
use serde_json::{Map, Value, json};

use super::{
    super::{
        Content, ContentKind, ContentStatus, IgtlMessage, IgtlUnit, PoseMatrix, Position, QuaternionTool,
        SensorContent, StatusCode, TextContent, ToolKind, TrackingTool,
    },
    LoopOutline, StateText,
};

/// Input of the hub.
#[derive(Clone, Copy, Debug)]
pub(super) enum HubMessage {
    /// A loop starts; its clock started at this time (ns since 1970).
    Begins(u64, LoopOutline),
    /// Its clock started at this time, as its clock and UTC relate now.
    Clock(u64),
    /// State of the loop.
    Moment(LoopMoment),
    /// The loop has ended.
    Ends,
}

/// The state of a loop at one time.
#[derive(Clone, Copy, Debug)]
pub(super) struct LoopMoment {
    /// Time of the loop, s.
    pub(super) t_s: f64,
    pub(super) arms: [Option<IgtlArm>; SIDES],
}

/// An arm pair; positions in m and forces in N, in `world`.
#[derive(Clone, Copy, Debug)]
pub(super) struct IgtlArm {
    pub(super) state: LoopState,
    tip_m: Vector3<f64>,
    leader_m: Vector3<f64>,
    measured_n: Vector3<f64>,
    rendered_n: Vector3<f64>,
}

impl IgtlArm {
    pub(super) const fn of(tick: &Tick) -> Self {
        let Tick { state, positions: TickPositions { tip_m, leader_m }, measured_n, rendering, .. } = *tick;
        Self { state, tip_m, leader_m, measured_n, rendered_n: rendering.rendered_n }
    }
}

/// Names of the messages of a side, as in `right.tip`.
pub(super) const TIP: &str = "tip";
const LEADER: &str = "leader";
const MEASURED: &str = "measured";
const RENDERED: &str = "rendered";
const STATE: &str = "state";
/// The device of the bundles, and of the text.
pub(super) const BUNDLE: &str = "nima";
/// Shafts shorter than this have no direction, m. A direction computed from less is mostly noise.
const SHORTEST_M: f64 = 1e-3;

pub(super) fn name(side: Side, what: &str) -> String {
    format!("{}.{what}", side.word())
}

/// Writes the messages of a state.
#[derive(Debug)]
pub(super) struct IgtlWriter<'a> {
    pub(super) moment: &'a LoopMoment,
    pub(super) outline: &'a LoopOutline,
    pub(super) time_ns: u64,
}

/// A known pose: its name, its known part, position and orientation.
struct KnownPose {
    name: String,
    kind: ToolKind,
    pose: PoseMatrix,
}

impl IgtlWriter<'_> {
    /// Appends the messages of this kind. Images and supported types are not part of a state.
    pub(super) fn put(&self, kind: ContentKind, bytes: &mut Vec<u8>) {
        let mut add = |device: &str, content| IgtlMessage::new(device, self.time_ns, content).put(bytes);
        match kind {
            ContentKind::Transform => self.poses().for_each(|known| add(&known.name, Content::Transform(known.pose))),
            ContentKind::Position => self.poses().for_each(|KnownPose { name, pose, .. }| {
                let turn = Some(quaternion(&pose));
                add(&name, Content::Position(Position { place_mm: pose.0[3], turn }));
            }),
            ContentKind::Tracking => {
                let tools = self.poses().map(|KnownPose { name, kind, pose }| TrackingTool { name, kind, pose });
                add(BUNDLE, Content::Tracking(tools.collect()));
            }
            ContentKind::Turned => {
                let turned = |KnownPose { name, kind, pose }: KnownPose| {
                    let place_mm = pose.0[3];
                    let turn = quaternion(&pose);
                    QuaternionTool { name, kind, place_mm, turn }
                };
                add(BUNDLE, Content::Turned(self.poses().map(turned).collect()));
            }
            ContentKind::Sensor => self.arms().for_each(|(side, arm)| {
                for (what, force_n) in [(MEASURED, arm.measured_n), (RENDERED, arm.rendered_n)] {
                    if is_finite(&force_n) {
                        let values = force_n.iter().copied().collect();
                        add(
                            &name(side, what),
                            Content::Sensor(SensorContent { status: 0, unit: IgtlUnit::NEWTON, values }),
                        );
                    }
                }
            }),
            ContentKind::Text => add(BUNDLE, Content::Text(TextContent::of(&self.text()))),
            ContentKind::Status | ContentKind::Image | ContentKind::Capability => {}
        }
    }

    /// Appends the status of every arm.
    pub(super) fn put_status(&self, words: StateText, bytes: &mut Vec<u8>) {
        for (side, arm) in self.arms() {
            let status = status(arm.state, words(arm.state));
            IgtlMessage::new(&name(side, STATE), self.time_ns, Content::Status(status)).put(bytes);
        }
    }

    fn arms(&self) -> impl Iterator<Item = (Side, &IgtlArm)> {
        Side::ALL.into_iter().zip(&self.moment.arms).filter_map(|(side, arm)| Some((side, arm.as_ref()?)))
    }

    /// Returns the known tip and leader poses of each arm.
    fn poses(&self) -> impl Iterator<Item = KnownPose> {
        let there = self.arms().filter(|(_, arm)| arm.state != InterlockState::Disconnected);
        there
            .flat_map(|(side, arm)| {
                let along = self.outline.trocars_m[side.index()].and_then(|trocar_m| along(&(arm.tip_m - trocar_m)));
                let known = |what, kind, position_m: &Vector3<f64>, turn: Option<[[f32; 3]; 3]>| {
                    let PoseMatrix([x, y, z, place_mm]) = PoseMatrix::at((position_m * 1e3).cast::<f32>().into());
                    let [x, y, z] = turn.unwrap_or([x, y, z]);
                    is_finite(position_m).then(|| KnownPose {
                        name: name(side, what),
                        kind,
                        pose: PoseMatrix([x, y, z, place_mm]),
                    })
                };
                let tip_kind = if along.is_some() { ToolKind::FiveD } else { ToolKind::ThreeD };
                [known(TIP, tip_kind, &arm.tip_m, along), known(LEADER, ToolKind::ThreeD, &arm.leader_m, None)]
            })
            .flatten()
    }

    /// Returns the same as text, for programs without support for sensors and status.
    fn text(&self) -> String {
        let mut all = Map::from_iter([("t_s".to_owned(), json!(self.moment.t_s))]);
        for (side, arm) in self.arms() {
            let numbers = |of: &Vector3<f64>| Value::from(of.as_slice());
            let arm = json!({
                STATE: arm.state.word(),
                "tip_mm": numbers(&(arm.tip_m * 1e3)),
                "leader_mm": numbers(&(arm.leader_m * 1e3)),
                "measured_n": numbers(&arm.measured_n),
                "rendered_n": numbers(&arm.rendered_n),
            });
            all.insert(side.word().to_owned(), arm);
        }
        Value::Object(all).to_string()
    }
}

/// Returns the status of an arm.
pub(super) fn status(state: LoopState, text: String) -> ContentStatus {
    let (code, subcode) = match state {
        InterlockState::Disconnected => (StatusCode::ABSENT, 0),
        InterlockState::Idle => (StatusCode::OK, 1),
        InterlockState::Ready => (StatusCode::OK, 2),
        InterlockState::Engaged => (StatusCode::OK, 3),
        InterlockState::Clutched => (StatusCode::OK, 4),
        InterlockState::Stopped => (StatusCode::PANIC, 5),
        InterlockState::Faulted(Fault::SourceSilent | Fault::LinkSilent) => (StatusCode::TIMEOUT, 6),
        InterlockState::Faulted(_) => (StatusCode::HARDWARE, 6),
    };
    ContentStatus { code, subcode, name: state.word().to_owned(), text }
}

fn is_finite(of: &Vector3<f64>) -> bool {
    of.iter().all(|number| number.is_finite())
}

/// Returns the columns of a rotation whose z axis is the shaft's, pointing out of the tip. The instrument's rotation
/// about its shaft is unknown: the x axis is horizontal.
fn along(shaft_m: &Vector3<f64>) -> Option<[[f32; 3]; 3]> {
    let z = shaft_m.try_normalize(SHORTEST_M).filter(is_finite)?;
    let x = z.cross(&Vector3::z()).try_normalize(1e-6).unwrap_or_else(Vector3::x);
    let y = z.cross(&x);
    Some([x, y, z].map(|axis| axis.cast::<f32>().into()))
}

fn quaternion(PoseMatrix([x, y, z, _]): &PoseMatrix) -> [f32; 4] {
    let columns = [x, y, z].map(|column| Vector3::from(*column));
    let rotation = nalgebra::Rotation3::from_matrix_unchecked(nalgebra::Matrix3::from_columns(&columns));
    let turn = nalgebra::UnitQuaternion::from_rotation_matrix(&rotation);
    [turn.i, turn.j, turn.k, turn.w]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_z_axis_of_a_tip_points_out_of_its_shaft() {
        for shaft_m in [Vector3::new(0.01, -0.02, -0.1), Vector3::new(0.0, 0.0, -0.2), Vector3::new(0.1, 0.0, 0.0)] {
            let [x, y, z] = along(&shaft_m).unwrap().map(|axis| Vector3::from(axis).cast::<f64>());
            assert!((z - shaft_m.normalize()).norm() < 1e-6, "{z}");
            assert!((x.cross(&y) - z).norm() < 1e-6 && x.z.abs() < 1e-6, "right-handed, and level: {x} {y}");
            let turn = quaternion(&PoseMatrix([x.cast().into(), y.cast().into(), z.cast().into(), [0.0; 3]]));
            let turn = nalgebra::Quaternion::new(turn[3], turn[0], turn[1], turn[2]).cast::<f64>();
            let turned = nalgebra::UnitQuaternion::new_normalize(turn) * Vector3::z();
            assert!((turned - z).norm() < 1e-5, "{turned}");
        }
        assert_eq!(along(&Vector3::zeros()), None);
        assert_eq!(along(&Vector3::new(f64::NAN, 0.0, 1.0)), None);
    }

    #[test]
    fn an_unknown_force_is_left_out_and_never_zero() {
        let tip_m = Vector3::zeros();
        let rendered_n = Vector3::zeros();
        let measured_n = nima_machine::messages::UNKNOWN_N;
        let arm = IgtlArm { state: InterlockState::Idle, tip_m, leader_m: tip_m, measured_n, rendered_n };
        let moment = LoopMoment { t_s: 1.0, arms: [Some(arm), None] };
        let writer = IgtlWriter { moment: &moment, outline: &LoopOutline { trocars_m: [None; SIDES] }, time_ns: 0 };
        let mut bytes = Vec::new();
        writer.put(ContentKind::Sensor, &mut bytes);
        let has = |name: &str| bytes.windows(name.len()).any(|part| part == name.as_bytes());
        assert!(has("right.rendered") && !has("right.measured"));
        let report: Value = serde_json::from_str(&writer.text()).unwrap();
        assert_eq!(report["right"]["measured_n"], json!([null, null, null]));
        assert_eq!(report["right"]["rendered_n"], json!([0.0, 0.0, 0.0]));
    }

    #[test]
    fn the_worse_the_state_the_worse_the_code() {
        let code = |state| status(state, String::new()).code;
        for state in [InterlockState::Idle, InterlockState::Ready, InterlockState::Engaged, InterlockState::Clutched] {
            assert_eq!(code(state), StatusCode::OK);
        }
        assert_eq!(code(InterlockState::Stopped), StatusCode::PANIC);
        assert_eq!(code(InterlockState::Disconnected), StatusCode::ABSENT);
        assert_eq!(code(InterlockState::Faulted(Fault::SourceSilent)), StatusCode::TIMEOUT);
        assert_eq!(code(InterlockState::Faulted(Fault::DrivesOff)), StatusCode::HARDWARE);
        assert_eq!(status(InterlockState::Faulted(Fault::DrivesOff), "why".to_owned()).text, "why");
    }
}
