//! The published topics, with their CRTK names (<https://crtk-robotics.readthedocs.io>).

use nima_bridges::igtl::{Content, ContentStatus, IgtlMessage, IgtlUnit, Position, SensorContent, StatusCode};
use serde::{Deserialize, Serialize};

/// The frame of all poses and forces.
const WORLD: &str = "world";

/// `builtin_interfaces/msg/Time`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Time {
    sec: i32,
    nanosec: u32,
}

/// `std_msgs/msg/Ros2Header`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Ros2Header {
    stamp: Time,
    frame_id: String,
}

/// `geometry_msgs/msg/LikelihoodPoint` and `Ros2Vector3`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Ros2Vector3 {
    x: f64,
    y: f64,
    z: f64,
}

/// `geometry_msgs/msg/TopicQuaternion`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TopicQuaternion {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}

/// `geometry_msgs/msg/PoseStamped`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PoseStamped {
    header: Ros2Header,
    position: Ros2Vector3,
    orientation: TopicQuaternion,
}

/// `geometry_msgs/msg/WrenchStamped`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WrenchStamped {
    header: Ros2Header,
    force: Ros2Vector3,
    torque: Ros2Vector3,
}

/// `crtk_msgs/msg/OperatingState`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct OperatingState {
    header: Ros2Header,
    state: String,
    is_homed: bool,
    is_busy: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ArmSide {
    Right,
    Left,
}

impl ArmSide {
    pub const ALL: [Self; 2] = [Self::Right, Self::Left];

    pub const fn word(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Left => "left",
        }
    }
}

/// Topic of an arm's sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Ros2Topic {
    MeasuredCp,
    SetpointCp,
    MeasuredCf,
    RenderedCf,
    OperatingState,
}

impl Ros2Topic {
    pub const ALL: [Self; 5] =
        [Self::MeasuredCp, Self::SetpointCp, Self::MeasuredCf, Self::RenderedCf, Self::OperatingState];

    /// Returns the name of the topic, after the name of the arm.
    pub const fn name(self) -> &'static str {
        match self {
            Self::MeasuredCp => "measured_cp",
            Self::SetpointCp => "setpoint_cp",
            Self::MeasuredCf => "measured_cf",
            Self::RenderedCf => "rendered_cf",
            Self::OperatingState => "operating_state",
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub enum TopicData {
    Pose(PoseStamped),
    Wrench(WrenchStamped),
    State(OperatingState),
}

#[derive(Clone, Debug, PartialEq)]
pub struct Ros2Sample {
    pub side: ArmSide,
    pub topic: Ros2Topic,
    pub data: TopicData,
}

impl Ros2Header {
    /// `None` beyond the year 2038, which ROS 2 cannot represent.
    fn at(time_ns: u64) -> Option<Self> {
        let sec = i32::try_from(time_ns / 1_000_000_000).ok()?;
        let stamp = Time { sec, nanosec: (time_ns % 1_000_000_000) as u32 };
        Some(Self { stamp, frame_id: WORLD.to_owned() })
    }
}

/// Returns the samples of a message; empty for messages without a topic.
pub fn samples(message: &IgtlMessage) -> Vec<Ros2Sample> {
    match &message.content {
        Content::Status(status) if status.code == StatusCode::NOT_READY => unknown(message.time_ns),
        _ => sample(message).into_iter().collect(),
    }
}

/// Publishes the states of both arms as unknown; otherwise a late reader would mistake the last states for current
/// ones.
pub fn unknown(time_ns: u64) -> Vec<Ros2Sample> {
    let of = |side| {
        let header = Ros2Header::at(time_ns)?;
        let state = OperatingState { header, state: "UNKNOWN".to_owned(), is_homed: false, is_busy: false };
        Some(Ros2Sample { side, topic: Ros2Topic::OperatingState, data: TopicData::State(state) })
    };
    ArmSide::ALL.into_iter().filter_map(of).collect()
}

fn sample(message: &IgtlMessage) -> Option<Ros2Sample> {
    let (arm, what) = message.device.split_once('.')?;
    let side = ArmSide::ALL.into_iter().find(|side| side.word() == arm)?;
    let header = Ros2Header::at(message.time_ns)?;
    let (topic, data) = match (what, &message.content) {
        ("tip", Content::Position(position)) => (Ros2Topic::MeasuredCp, pose(header, position)),
        ("leader", Content::Position(position)) => (Ros2Topic::SetpointCp, pose(header, position)),
        ("measured", Content::Sensor(sensor)) => (Ros2Topic::MeasuredCf, wrench(header, sensor)?),
        ("rendered", Content::Sensor(sensor)) => (Ros2Topic::RenderedCf, wrench(header, sensor)?),
        ("state", Content::Status(status)) => (Ros2Topic::OperatingState, state(header, status)),
        _ => return None,
    };
    Some(Ros2Sample { side, topic, data })
}

/// ROS uses metres.
fn pose(header: Ros2Header, position: &Position) -> TopicData {
    let [x, y, z] = position.place_mm.map(|mm| f64::from(mm) * 1e-3);
    let [qx, qy, qz, qw] = position.turn.unwrap_or([0.0, 0.0, 0.0, 1.0]).map(f64::from);
    let orientation = TopicQuaternion { x: qx, y: qy, z: qz, w: qw };
    TopicData::Pose(PoseStamped { header, position: Ros2Vector3 { x, y, z }, orientation })
}

/// Torques are not measured.
fn wrench(header: Ros2Header, sensor: &SensorContent) -> Option<TopicData> {
    let [x, y, z] = *sensor.values.as_slice() else { return None };
    let torque = Ros2Vector3::default();
    (sensor.unit == IgtlUnit::NEWTON).then_some(TopicData::Wrench(WrenchStamped {
        header,
        force: Ros2Vector3 { x, y, z },
        torque,
    }))
}

/// Returns the states of CRTK; docs/bridges.md lists the subcodes.
fn state(header: Ros2Header, status: &ContentStatus) -> TopicData {
    let state = match status.subcode {
        3 => "ENABLED",
        2 | 4 => "PAUSED",
        6 => "FAULT",
        _ => "DISABLED",
    };
    let is_homed = status.subcode != 0;
    let is_busy = false;
    TopicData::State(OperatingState { header, state: state.to_owned(), is_homed, is_busy })
}

#[cfg(test)]
mod tests {
    use nima_bridges::igtl::TextContent;

    use super::*;

    fn of(device: &str, content: Content) -> Option<Ros2Sample> {
        samples(&IgtlMessage::new(device, 1_700_000_000_250_000_000, content)).pop()
    }

    #[test]
    fn millimetres_become_metres_and_times_stay() {
        let position = Position { place_mm: [1.0, -2.0, 3.5], turn: Some([0.0, 0.6, 0.0, 0.8]) };
        let Some(Ros2Sample { side: ArmSide::Left, topic: Ros2Topic::MeasuredCp, data: TopicData::Pose(pose) }) =
            of("left.tip", Content::Position(position))
        else {
            panic!()
        };
        assert_eq!(pose.header.stamp, Time { sec: 1_700_000_000, nanosec: 250_000_000 });
        assert!((pose.position.z - 3.5e-3).abs() < 1e-9 && pose.position.y < 0.0, "{pose:?}");
        assert!((pose.orientation.w - 0.8).abs() < 1e-6 && (pose.orientation.y - 0.6).abs() < 1e-6);
    }

    #[test]
    fn forces_need_the_right_unit_and_three_numbers() {
        let force = |unit, values: &[f64]| {
            of("right.measured", Content::Sensor(SensorContent { status: 0, unit, values: values.to_vec() }))
        };
        let Some(Ros2Sample { data: TopicData::Wrench(wrench), topic: Ros2Topic::MeasuredCf, .. }) =
            force(IgtlUnit::NEWTON, &[0.1, 0.2, -0.3])
        else {
            panic!()
        };
        assert_eq!(wrench.force, Ros2Vector3 { x: 0.1, y: 0.2, z: -0.3 });
        assert_eq!(force(IgtlUnit(0), &[0.1, 0.2, -0.3]), None);
        assert_eq!(force(IgtlUnit::NEWTON, &[0.1, 0.2]), None);
    }

    #[test]
    fn states_are_those_of_crtk() {
        let report = |subcode| {
            let status = ContentStatus { code: StatusCode::OK, subcode, name: String::new(), text: String::new() };
            let Some(Ros2Sample { data: TopicData::State(state), .. }) = of("right.state", Content::Status(status))
            else {
                panic!()
            };
            (state.state, state.is_homed)
        };
        let expected = ["DISABLED", "DISABLED", "PAUSED", "ENABLED", "PAUSED", "DISABLED", "FAULT"];
        for (subcode, state) in expected.into_iter().enumerate() {
            assert_eq!(report(subcode as i64), (state.to_owned(), subcode != 0));
        }
    }

    #[test]
    fn without_a_loop_the_last_states_do_not_stay() {
        let status = ContentStatus {
            code: StatusCode::NOT_READY,
            subcode: 0,
            name: String::new(),
            text: "no loop runs".to_owned(),
        };
        let report = samples(&IgtlMessage::new("nima", 1_700_000_000_250_000_000, Content::Status(status)));
        assert_eq!(report, unknown(1_700_000_000_250_000_000));
        assert_eq!(report.iter().map(|sample| sample.side).collect::<Vec<_>>(), ArmSide::ALL);
        assert!(
            report.iter().all(|sample| matches!(&sample.data, TopicData::State(state) if state.state == "UNKNOWN"))
        );
    }

    #[test]
    fn what_has_no_topic_is_left_out() {
        assert_eq!(of("nima", Content::Text(TextContent::of("{}"))), None);
        assert_eq!(of("middle.tip", Content::Position(Position { place_mm: [0.0; 3], turn: None })), None);
        assert_eq!(of("right.tip", Content::Text(TextContent::of("x"))), None);
    }
}
