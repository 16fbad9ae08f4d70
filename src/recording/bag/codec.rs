//! Values in ROS 2 messages (CDR): poses, wrenches, transforms, joint states.
//!
//! Source: OMG DDS-XTypes 1.3, "plain CDR version 1", and the definitions of `geometry_msgs` and `sensor_msgs`.

/// A kind of message that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum MessageKind {
    Pose,
    Wrench,
    Transform,
    Joints,
}

/// Names of the schemas, whether they begin with a header, and the field with the values.
const SCHEMAS: [(&str, MessageKind, bool, &str); 7] = [
    ("geometry_msgs/msg/PoseStamped", MessageKind::Pose, true, "pose."),
    ("geometry_msgs/msg/Pose", MessageKind::Pose, false, ""),
    ("geometry_msgs/msg/WrenchStamped", MessageKind::Wrench, true, "wrench."),
    ("geometry_msgs/msg/Wrench", MessageKind::Wrench, false, ""),
    ("geometry_msgs/msg/TransformStamped", MessageKind::Transform, true, "transform."),
    ("geometry_msgs/msg/Transform", MessageKind::Transform, false, ""),
    ("sensor_msgs/msg/JointState", MessageKind::Joints, true, ""),
];

const POSE: [&str; 7] =
    ["position.x", "position.y", "position.z", "orientation.x", "orientation.y", "orientation.z", "orientation.w"];
const WRENCH: [&str; 6] = ["force.x", "force.y", "force.z", "torque.x", "torque.y", "torque.z"];
const TRANSFORM: [&str; 7] =
    ["translation.x", "translation.y", "translation.z", "rotation.x", "rotation.y", "rotation.z", "rotation.w"];
const JOINTS: [&str; 3] = ["position", "velocity", "effort"];
/// Maximum number of joints; a damaged count must not reserve memory.
const JOINTS_MAX: u32 = 256;

/// The number in one message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BagValue {
    /// Time in the header, ns since 1970; `None` without a header or without a time.
    pub(super) stamp_ns: Option<u64>,
    pub(super) number: BagNumber,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum BagNumber {
    /// NaN if the publisher does not know it.
    Given(f64),
    /// The message is about other joints.
    Absent,
}

/// One number of the messages of a topic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct BagField {
    kind: MessageKind,
    is_stamped: bool,
    part: usize,
    joint: Option<JointName>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum JointName {
    Number(usize),
    Name(String),
}

/// Returns examples of the fields of a schema; empty if it cannot be read.
pub(super) fn examples(schema: &str) -> Vec<String> {
    let Some((_, kind, _, prefix)) = SCHEMAS.iter().find(|(name, ..)| *name == schema) else { return Vec::new() };
    let names: &[&str] = match kind {
        MessageKind::Pose => &POSE[..3],
        MessageKind::Wrench => &WRENCH[..3],
        MessageKind::Transform => &TRANSFORM[..3],
        MessageKind::Joints => &["position[0]", "effort.NAME"],
    };
    names.iter().map(|name| format!("{prefix}{name}")).collect()
}

impl BagField {
    /// Finds a field of a schema; `None` if it does not exist.
    pub(super) fn find(schema: &str, path: &str) -> Option<Self> {
        let &(_, kind, is_stamped, prefix) = SCHEMAS.iter().find(|(name, ..)| *name == schema)?;
        let path = path.strip_prefix(prefix)?;
        let place = |names: &[&str]| names.iter().position(|name| *name == path);
        let part = match kind {
            MessageKind::Pose => place(&POSE)?,
            MessageKind::Wrench => place(&WRENCH)?,
            MessageKind::Transform => place(&TRANSFORM)?,
            MessageKind::Joints => return Self::joint(path),
        };
        Some(Self { kind, is_stamped, part, joint: None })
    }

    fn joint(path: &str) -> Option<Self> {
        let split = path.find(['[', '.'])?;
        let (part, rest) = path.split_at(split);
        let part = JOINTS.iter().position(|name| *name == part)?;
        let joint = match rest.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            Some(number) => JointName::Number(number.parse().ok()?),
            None => JointName::Name(rest.strip_prefix('.').filter(|name| !name.is_empty())?.to_owned()),
        };
        Some(Self { kind: MessageKind::Joints, is_stamped: true, part, joint: Some(joint) })
    }

    /// Returns the value in a message; `None` if the message is damaged.
    pub(super) fn read(&self, data: &[u8]) -> Option<BagValue> {
        let mut from = Cdr::new(data)?;
        let stamp_ns = if self.is_stamped { from.header()? } else { 0 };
        if self.kind == MessageKind::Transform && self.is_stamped {
            from.text()?;
        }
        let number = match &self.joint {
            None => {
                from.skip_numbers(self.part)?;
                BagNumber::Given(from.f64()?)
            }
            Some(joint) => from.joint(self.part, joint)?,
        };
        Some(BagValue { stamp_ns: (stamp_ns > 0).then_some(stamp_ns), number })
    }
}

/// A message; positions count from behind its first four bytes.
struct Cdr<'a> {
    bytes: &'a [u8],
    at: usize,
    is_big_endian: bool,
}

impl<'a> Cdr<'a> {
    fn new(data: &'a [u8]) -> Option<Self> {
        let (head, bytes) = data.split_first_chunk::<4>()?;
        let is_big_endian = match head[..2] {
            [0, 0] => true,
            [0, 1] => false,
            _ => return None,
        };
        Some(Self { bytes, at: 0, is_big_endian })
    }

    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        // Numbers are aligned to their size.
        self.at = self.at.checked_next_multiple_of(N)?;
        let taken = self.bytes.get(self.at..)?.first_chunk::<N>()?;
        self.at += N;
        Some(*taken)
    }

    fn u32(&mut self) -> Option<u32> {
        let bytes = self.take()?;
        Some(if self.is_big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }

    fn f64(&mut self) -> Option<f64> {
        let bytes = self.take()?;
        Some(if self.is_big_endian { f64::from_be_bytes(bytes) } else { f64::from_le_bytes(bytes) })
    }

    fn skip_numbers(&mut self, count: usize) -> Option<()> {
        (0..count).try_for_each(|_| self.f64().map(drop))
    }

    /// Returns a text without the zero at its end.
    fn text(&mut self) -> Option<&'a [u8]> {
        let length = self.u32()? as usize;
        let text = self.bytes.get(self.at..self.at.checked_add(length)?)?;
        self.at += length;
        Some(text.strip_suffix(&[0]).unwrap_or(text))
    }

    /// Returns the time in a header, ns; 0 if it has none.
    fn header(&mut self) -> Option<u64> {
        let seconds = self.u32()?.cast_signed();
        let rest_ns = u64::from(self.u32()?);
        self.text()?;
        let seconds = u64::try_from(seconds).ok()?;
        Some(seconds * 1_000_000_000 + rest_ns)
    }

    fn joint(&mut self, part: usize, joint: &JointName) -> Option<BagNumber> {
        let count = self.u32().filter(|count| *count <= JOINTS_MAX)?;
        let mut found = match joint {
            JointName::Number(number) => Some(*number),
            JointName::Name(_) => None,
        };
        for place in 0..count as usize {
            let name = self.text()?;
            if matches!(joint, JointName::Name(wanted) if wanted.as_bytes() == name) {
                found = found.or(Some(place));
            }
        }
        let Some(place) = found else { return Some(BagNumber::Absent) };
        let mut count = self.u32();
        for _ in 0..part {
            self.skip_numbers(count.filter(|count| *count <= JOINTS_MAX)? as usize)?;
            count = self.u32();
        }
        if place >= count? as usize {
            return Some(BagNumber::Absent);
        }
        self.skip_numbers(place)?;
        self.f64().map(BagNumber::Given)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Writes a message with a header, in the given byte order.
    pub(in super::super) struct CdrWriter(pub(in super::super) Vec<u8>, bool);

    impl CdrWriter {
        pub(in super::super) fn new(is_big_endian: bool) -> Self {
            Self(vec![0, u8::from(!is_big_endian), 0, 0], is_big_endian)
        }

        fn align(&mut self, size: usize) {
            while !(self.0.len() - 4).is_multiple_of(size) {
                self.0.push(0);
            }
        }

        pub(in super::super) fn u32(mut self, value: u32) -> Self {
            self.align(4);
            self.0.extend(if self.1 { value.to_be_bytes() } else { value.to_le_bytes() });
            self
        }

        pub(in super::super) fn f64s(mut self, values: &[f64]) -> Self {
            for value in values {
                self.align(8);
                self.0.extend(if self.1 { value.to_be_bytes() } else { value.to_le_bytes() });
            }
            self
        }

        pub(in super::super) fn text(self, text: &str) -> Self {
            let mut all = self.u32(text.len() as u32 + 1);
            all.0.extend(text.bytes().chain([0]));
            all
        }

        pub(in super::super) fn header(self, stamp_ns: u64) -> Self {
            let seconds = (stamp_ns / 1_000_000_000) as u32;
            self.u32(seconds).u32((stamp_ns % 1_000_000_000) as u32).text("base_link")
        }
    }

    #[test]
    fn every_kind_is_read_in_both_byte_orders() {
        let stamp_ns = 1_764_314_756_250_000_000;
        for is_big_endian in [false, true] {
            let stamped = || CdrWriter::new(is_big_endian).header(stamp_ns);
            let read = |schema: &str, path: &str, bytes: &[u8]| {
                let BagValue { stamp_ns, number } = BagField::find(schema, path).unwrap().read(bytes).unwrap();
                let BagNumber::Given(value) = number else { return (stamp_ns, None) };
                (stamp_ns, Some(value))
            };
            let numbers = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
            let pose = stamped().f64s(&numbers).0;
            assert_eq!(read("geometry_msgs/msg/PoseStamped", "pose.position.z", &pose), (Some(stamp_ns), Some(3.0)));
            assert_eq!(read("geometry_msgs/msg/PoseStamped", "pose.orientation.w", &pose), (Some(stamp_ns), Some(7.0)));
            let wrench = stamped().f64s(&numbers[..6]).0;
            assert_eq!(
                read("geometry_msgs/msg/WrenchStamped", "wrench.torque.x", &wrench),
                (Some(stamp_ns), Some(4.0))
            );
            let transform = stamped().text("tool").f64s(&numbers).0;
            let field = "transform.translation.y";
            assert_eq!(read("geometry_msgs/msg/TransformStamped", field, &transform), (Some(stamp_ns), Some(2.0)));
            let joints = stamped().u32(2).text("elbow").text("wrist");
            let joints = joints.u32(2).f64s(&[0.1, 0.2]).u32(0).u32(2).f64s(&[8.0, 9.0]).0;
            let joint = |path: &str| read("sensor_msgs/msg/JointState", path, &joints).1;
            assert_eq!((joint("position[1]"), joint("effort.wrist")), (Some(0.2), Some(9.0)));
            assert_eq!((joint("velocity[0]"), joint("position.knee"), joint("position[2]")), (None, None, None));
            let plain = CdrWriter::new(is_big_endian).f64s(&numbers[..6]).0;
            assert_eq!(read("geometry_msgs/msg/Wrench", "force.y", &plain), (None, Some(2.0)));
        }
        assert_eq!(BagField::find("geometry_msgs/msg/PoseStamped", "pose.position.w"), None);
        assert_eq!(BagField::find("sensor_msgs/msg/Imu", "linear_acceleration.x"), None);
        assert_eq!(BagField::find("sensor_msgs/msg/JointState", "position"), None);
    }

    #[test]
    fn any_bytes_are_survived() {
        let mut random = fastrand::Rng::with_seed(3);
        let fields =
            ["position[0]", "effort.wrist"].map(|path| BagField::find("sensor_msgs/msg/JointState", path).unwrap());
        for _ in 0..20_000 {
            let mut bytes: Vec<u8> = (0..random.usize(..80)).map(|_| random.u8(..) & random.u8(..)).collect();
            bytes.iter_mut().take(4).zip([0, 1, 0, 0]).for_each(|(to, from)| *to = from);
            for field in &fields {
                std::hint::black_box(field.read(&bytes));
            }
        }
    }
}
