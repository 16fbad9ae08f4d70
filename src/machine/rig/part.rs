//! The parts of a rig: the uses of its devices, and their tables in a rig file.

use std::fmt;

use super::{FollowerSettings, LeaderSettings, RigSettings, SensorSettings, Side};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RigPart {
    Handle(Side),
    Arm(Side),
    /// The force sensor on the arm of this side: calibrations are bound to it.
    Sensor(Side),
    Servos(Side),
    TissueSensor,
    Tracker,
    Pedal,
}

/// Role of a device in its rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeviceRole {
    /// A part of the rig; on a simulated rig, a device that replaces this part.
    Part(RigPart),
    /// A cap that controls a simulated rig.
    Cap,
}

impl DeviceRole {
    /// Returns the name in files and in English text: `left sensor`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Part(part) => part.name(),
            Self::Cap => "cap",
        }
    }
}

/// A device, given by its role and its model. Displayed as `right handle (Force Dimension)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DeviceName {
    pub role: DeviceRole,
    /// One of [`RigPart::makes`]; `None` if the role has only one make.
    pub make: Option<&'static str>,
}

impl fmt::Display for DeviceName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.role.name())?;
        self.make.map_or(Ok(()), |make| write!(f, " ({make})"))
    }
}

/// Kind of part: devices of one kind can replace each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PartKind {
    Handle,
    Arm,
    Sensor,
    Servos,
    Tracker,
    Pedal,
}

impl PartKind {
    /// Kinds of which each side has one.
    pub const OF_A_SIDE: [Self; 4] = [Self::Handle, Self::Arm, Self::Sensor, Self::Servos];

    /// Returns the part of this kind on a side; `None` for a kind that both sides share.
    pub const fn of(self, side: Side) -> Option<RigPart> {
        match self {
            Self::Handle => Some(RigPart::Handle(side)),
            Self::Arm => Some(RigPart::Arm(side)),
            Self::Sensor => Some(RigPart::Sensor(side)),
            Self::Servos => Some(RigPart::Servos(side)),
            // Both sides share one, so the side alone does not identify it.
            Self::Tracker | Self::Pedal => None,
        }
    }
}

impl RigPart {
    /// Every part, in the order of the roster.
    pub const ALL: [Self; 11] = [
        Self::Handle(Side::Right),
        Self::Arm(Side::Right),
        Self::Sensor(Side::Right),
        Self::Servos(Side::Right),
        Self::Handle(Side::Left),
        Self::Arm(Side::Left),
        Self::Sensor(Side::Left),
        Self::Servos(Side::Left),
        Self::TissueSensor,
        Self::Tracker,
        Self::Pedal,
    ];

    pub const fn kind(self) -> PartKind {
        match self {
            Self::Handle(_) => PartKind::Handle,
            Self::Arm(_) => PartKind::Arm,
            Self::Sensor(_) | Self::TissueSensor => PartKind::Sensor,
            Self::Servos(_) => PartKind::Servos,
            Self::Tracker => PartKind::Tracker,
            Self::Pedal => PartKind::Pedal,
        }
    }

    pub const fn side(self) -> Option<Side> {
        match self {
            Self::Handle(side) | Self::Arm(side) | Self::Sensor(side) | Self::Servos(side) => Some(side),
            Self::TissueSensor | Self::Tracker | Self::Pedal => None,
        }
    }

    /// Returns the name on the screen and in messages: `right handle`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Handle(Side::Right) => "right handle",
            Self::Handle(Side::Left) => "left handle",
            Self::Arm(Side::Right) => "right arm",
            Self::Arm(Side::Left) => "left arm",
            Self::Sensor(Side::Right) => "right sensor",
            Self::Sensor(Side::Left) => "left sensor",
            Self::Servos(Side::Right) => "right servos",
            Self::Servos(Side::Left) => "left servos",
            Self::TissueSensor => "tissue sensor",
            Self::Tracker => "tracker",
            Self::Pedal => "pedal",
        }
    }

    /// Returns the makes that the program supports.
    pub const fn makes(self) -> &'static [&'static str] {
        match self.kind() {
            PartKind::Handle => LeaderSettings::MAKERS,
            PartKind::Arm => FollowerSettings::MAKERS,
            PartKind::Sensor => SensorSettings::MAKERS,
            PartKind::Servos => &["DYNAMIXEL"],
            PartKind::Tracker => &["NDI"],
            PartKind::Pedal => &[],
        }
    }

    /// Returns the device of this part in a rig with these devices.
    pub(crate) fn device(self, devices: &RigSettings) -> DeviceName {
        DeviceName { role: DeviceRole::Part(self), make: self.make(devices) }
    }

    /// Returns the make in a rig with these devices, one of [`RigPart::makes`].
    fn make(self, devices: &RigSettings) -> Option<&'static str> {
        let set = self.side().and_then(|side| devices.arm(side));
        let chosen = match self {
            Self::Handle(_) => set.map(|set| set.handle.maker()),
            Self::Arm(_) => set.map(|set| set.arm.maker()),
            Self::Sensor(_) => set.map(|set| set.sensor.maker()),
            Self::TissueSensor => devices.tissue_sensor.as_ref().map(SensorSettings::maker),
            Self::Servos(_) | Self::Tracker | Self::Pedal => None,
        };
        chosen.or_else(|| self.makes().first().copied())
    }

    /// Returns whether the rig uses the default make here, which is searched for automatically.
    pub(super) fn has_usual_make(self, devices: &RigSettings) -> bool {
        self.make(devices) == self.makes().first().copied()
    }

    /// Returns the key of the table in a rig file.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Handle(Side::Right) => "devices.right.handle",
            Self::Handle(Side::Left) => "devices.left.handle",
            Self::Arm(Side::Right) => "devices.right.arm",
            Self::Arm(Side::Left) => "devices.left.arm",
            Self::Sensor(Side::Right) => "devices.right.sensor",
            Self::Sensor(Side::Left) => "devices.left.sensor",
            Self::Servos(Side::Right) => "devices.right.servos",
            Self::Servos(Side::Left) => "devices.left.servos",
            Self::TissueSensor => "devices.tissue_sensor",
            Self::Tracker => "devices.tracker",
            Self::Pedal => "devices.pedal",
        }
    }

    /// Returns whether a rig with these devices has the part at this machine.
    pub const fn is_in(self, devices: &RigSettings) -> bool {
        let is_here = match self {
            Self::Handle(_) | Self::Pedal => devices.ends.have_leader(),
            _ => devices.ends.have_follower(),
        };
        is_here && self.is_listed(devices)
    }

    const fn is_listed(self, devices: &RigSettings) -> bool {
        match self {
            Self::Handle(side) | Self::Arm(side) | Self::Sensor(side) => devices.arm(side).is_some(),
            Self::Servos(side) => match devices.arm(side) {
                Some(set) => set.servos.is_some(),
                None => false,
            },
            Self::TissueSensor => devices.tissue_sensor.is_some(),
            Self::Tracker => devices.tracker.is_some(),
            Self::Pedal => devices.pedal.is_some(),
        }
    }
}
