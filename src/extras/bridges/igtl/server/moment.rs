//! The state of a loop at one time, and its messages.

use nalgebra::Vector3;
use nima_core::safety::State;
use nima_machine::{
    messages::{Fault, LoopState, Tick},
    rig::{SIDES, Side},
};
use serde_json::{Map, Value, json};

use super::{
    super::{Content, Kind, Matrix, Message, Position, Sensor, Status, StatusCode, Text, Tool, ToolKind, Turned, Unit},
    Outline, StateWords,
};

/// Input of the hub.
#[derive(Clone, Copy, Debug)]
pub(super) enum Told {
    /// A loop begins; its clock started at this time (ns since 1970).
    Begins(u64, Outline),
    /// Its state.
    Moment(Moment),
    /// It has ended.
    Ends,
}

/// The state of a loop at one time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moment {
    /// Time of the loop, s.
    pub(super) t_s: f64,
    pub(super) arms: [Option<Arm>; SIDES],
}

/// An arm pair; positions in m and forces in N, in `world`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arm {
    pub(super) state: LoopState,
    tip_m: Vector3<f64>,
    leader_m: Vector3<f64>,
    measured_n: Vector3<f64>,
    rendered_n: Vector3<f64>,
}

impl Arm {
    pub(super) const fn of(tick: &Tick) -> Self {
        let Tick { state, tip_m, leader_m, measured_n, rendered_n, .. } = *tick;
        Self { state, tip_m, leader_m, measured_n, rendered_n }
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
/// Shafts shorter than this have no direction, m.
const SHORTEST_M: f64 = 1e-3;

pub(super) fn name(side: Side, what: &str) -> String {
    format!("{}.{what}", side.word())
}

/// Writes the messages of a state.
#[derive(Debug)]
pub(super) struct Writer<'a> {
    pub(super) moment: &'a Moment,
    pub(super) outline: &'a Outline,
    pub(super) time_ns: u64,
}

/// A known pose: its name, its known part, position and orientation.
struct Known {
    name: String,
    kind: ToolKind,
    pose: Matrix,
}

impl Writer<'_> {
    /// Appends the messages of this kind. Images and supported types are not part of a state.
    pub(super) fn put(&self, kind: Kind, bytes: &mut Vec<u8>) {
        let mut add = |device: &str, content| Message::new(device, self.time_ns, content).put(bytes);
        match kind {
            Kind::Transform => self.poses().for_each(|known| add(&known.name, Content::Transform(known.pose))),
            Kind::Position => self.poses().for_each(|Known { name, pose, .. }| {
                let turn = Some(quaternion(&pose));
                add(&name, Content::Position(Position { place_mm: pose.0[3], turn }));
            }),
            Kind::Tracking => {
                let tools = self.poses().map(|Known { name, kind, pose }| Tool { name, kind, pose });
                add(BUNDLE, Content::Tracking(tools.collect()));
            }
            Kind::Turned => {
                let turned = |Known { name, kind, pose }: Known| {
                    let place_mm = pose.0[3];
                    let turn = quaternion(&pose);
                    Turned { name, kind, place_mm, turn }
                };
                add(BUNDLE, Content::Turned(self.poses().map(turned).collect()));
            }
            Kind::Sensor => self.arms().for_each(|(side, arm)| {
                for (what, force_n) in [(MEASURED, arm.measured_n), (RENDERED, arm.rendered_n)] {
                    if is_finite(&force_n) {
                        let values = force_n.iter().copied().collect();
                        add(&name(side, what), Content::Sensor(Sensor { status: 0, unit: Unit::NEWTON, values }));
                    }
                }
            }),
            Kind::Text => add(BUNDLE, Content::Text(Text::of(&self.text()))),
            Kind::Status | Kind::Image | Kind::Capability => {}
        }
    }

    /// Appends the status of every arm.
    pub(super) fn put_status(&self, words: StateWords, bytes: &mut Vec<u8>) {
        for (side, arm) in self.arms() {
            let status = status(arm.state, words(arm.state));
            Message::new(&name(side, STATE), self.time_ns, Content::Status(status)).put(bytes);
        }
    }

    fn arms(&self) -> impl Iterator<Item = (Side, &Arm)> {
        Side::ALL.into_iter().zip(&self.moment.arms).filter_map(|(side, arm)| Some((side, arm.as_ref()?)))
    }

    /// Tip and leader of each arm, as far as they are known.
    fn poses(&self) -> impl Iterator<Item = Known> {
        let there = self.arms().filter(|(_, arm)| arm.state != State::Disconnected);
        there
            .flat_map(|(side, arm)| {
                let along = self.outline.trocars_m[side.index()].and_then(|trocar_m| along(&(arm.tip_m - trocar_m)));
                let known = |what, kind, at_m: &Vector3<f64>, turn: Option<[[f32; 3]; 3]>| {
                    let Matrix([x, y, z, place_mm]) = Matrix::at((at_m * 1e3).cast::<f32>().into());
                    let [x, y, z] = turn.unwrap_or([x, y, z]);
                    is_finite(at_m).then(|| Known { name: name(side, what), kind, pose: Matrix([x, y, z, place_mm]) })
                };
                let tip_kind = if along.is_some() { ToolKind::FiveD } else { ToolKind::ThreeD };
                [known(TIP, tip_kind, &arm.tip_m, along), known(LEADER, ToolKind::ThreeD, &arm.leader_m, None)]
            })
            .flatten()
    }

    /// The same as text, for programs without support for sensors and status.
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

/// Status of an arm.
pub(super) fn status(state: LoopState, text: String) -> Status {
    let (code, subcode) = match state {
        State::Disconnected => (StatusCode::ABSENT, 0),
        State::Idle => (StatusCode::OK, 1),
        State::Ready => (StatusCode::OK, 2),
        State::Engaged => (StatusCode::OK, 3),
        State::Clutched => (StatusCode::OK, 4),
        State::Stopped => (StatusCode::PANIC, 5),
        State::Faulted(Fault::SourceSilent | Fault::LinkSilent) => (StatusCode::TIMEOUT, 6),
        State::Faulted(_) => (StatusCode::HARDWARE, 6),
    };
    Status { code, subcode, name: state.word().to_owned(), text }
}

fn is_finite(of: &Vector3<f64>) -> bool {
    of.iter().all(|number| number.is_finite())
}

/// Columns of a rotation whose z axis is the shaft's, pointing out of the tip. The instrument's rotation about its
/// shaft is unknown: the x axis is horizontal.
fn along(shaft_m: &Vector3<f64>) -> Option<[[f32; 3]; 3]> {
    let z = shaft_m.try_normalize(SHORTEST_M).filter(is_finite)?;
    let x = z.cross(&Vector3::z()).try_normalize(1e-6).unwrap_or_else(Vector3::x);
    let y = z.cross(&x);
    Some([x, y, z].map(|axis| axis.cast::<f32>().into()))
}

fn quaternion(Matrix([x, y, z, _]): &Matrix) -> [f32; 4] {
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
            let turn = quaternion(&Matrix([x.cast().into(), y.cast().into(), z.cast().into(), [0.0; 3]]));
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
        let arm = Arm { state: State::Idle, tip_m, leader_m: tip_m, measured_n, rendered_n };
        let moment = Moment { t_s: 1.0, arms: [Some(arm), None] };
        let writer = Writer { moment: &moment, outline: &Outline { trocars_m: [None; SIDES] }, time_ns: 0 };
        let mut bytes = Vec::new();
        writer.put(Kind::Sensor, &mut bytes);
        let has = |name: &str| bytes.windows(name.len()).any(|part| part == name.as_bytes());
        assert!(has("right.rendered") && !has("right.measured"));
        let told: Value = serde_json::from_str(&writer.text()).unwrap();
        assert_eq!(told["right"]["measured_n"], json!([null, null, null]));
        assert_eq!(told["right"]["rendered_n"], json!([0.0, 0.0, 0.0]));
    }

    #[test]
    fn the_worse_the_state_the_worse_the_code() {
        let code = |state| status(state, String::new()).code;
        for state in [State::Idle, State::Ready, State::Engaged, State::Clutched] {
            assert_eq!(code(state), StatusCode::OK);
        }
        assert_eq!(code(State::Stopped), StatusCode::PANIC);
        assert_eq!(code(State::Disconnected), StatusCode::ABSENT);
        assert_eq!(code(State::Faulted(Fault::SourceSilent)), StatusCode::TIMEOUT);
        assert_eq!(code(State::Faulted(Fault::DrivesOff)), StatusCode::HARDWARE);
        assert_eq!(status(State::Faulted(Fault::DrivesOff), "why".to_owned()).text, "why");
    }
}
