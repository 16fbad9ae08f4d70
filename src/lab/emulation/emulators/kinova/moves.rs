//! Messages of actions, waypoints and sequences. Field numbers: `Base.proto` of `Kinovarobotics/ros_kortex`. Angles are in degrees.

use nima_devices::kinova::messages::{JointAngles, KinovaPose};
use prost::Message;

use super::forms::EntityHandle;

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct ActionHandle {
    #[prost(uint32, tag = "1")]
    pub(super) identifier: u32,
    #[prost(uint32, tag = "2")]
    pub(super) kind: u32,
    #[prost(fixed32, tag = "3")]
    pub(super) permission: u32,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct ReachPose {
    #[prost(message, optional, tag = "1")]
    pub(super) pose: Option<KinovaPose>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct ReachAngles {
    #[prost(message, optional, tag = "1")]
    pub(super) angles: Option<JointAngles>,
}

/// An action, with the parameters that can be executed here.
#[derive(Clone, PartialEq, Message)]
pub(super) struct KinovaAction {
    #[prost(message, optional, tag = "1")]
    pub(super) handle: Option<ActionHandle>,
    #[prost(string, tag = "2")]
    pub(super) name: String,
    #[prost(message, optional, tag = "9")]
    pub(super) reach_pose: Option<ReachPose>,
    #[prost(message, optional, tag = "10")]
    pub(super) reach_angles: Option<ReachAngles>,
    #[prost(message, optional, tag = "35")]
    pub(super) execute: Option<ActionHandle>,
    #[prost(message, optional, tag = "41")]
    pub(super) waypoints: Option<Waypoints>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct Actions {
    #[prost(message, repeated, tag = "1")]
    pub(super) actions: Vec<KinovaAction>,
}

/// `ActionNotification`; `SequenceInfoNotification` has other fields.
#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct ActionReport {
    #[prost(uint32, tag = "1")]
    pub(super) event: u32,
    #[prost(message, optional, tag = "2")]
    pub(super) handle: Option<ActionHandle>,
    #[prost(uint32, tag = "5")]
    pub(super) abort: u32,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct SequenceReport {
    #[prost(uint32, tag = "1")]
    pub(super) event: u32,
    #[prost(message, optional, tag = "2")]
    pub(super) handle: Option<EntityHandle>,
    #[prost(uint32, tag = "3")]
    pub(super) task: u32,
    #[prost(uint32, tag = "7")]
    pub(super) abort: u32,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct MoveTask {
    #[prost(message, optional, tag = "2")]
    pub(super) action: Option<KinovaAction>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct Sequence {
    #[prost(message, repeated, tag = "4")]
    pub(super) tasks: Vec<MoveTask>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct AngularWaypoint {
    #[prost(float, repeated, tag = "1")]
    pub(super) angles_deg: Vec<f32>,
    #[prost(float, tag = "3")]
    pub(super) duration_s: f32,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct CartesianWaypoint {
    #[prost(message, optional, tag = "1")]
    pub(super) pose: Option<KinovaPose>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct Waypoint {
    #[prost(message, optional, tag = "2")]
    pub(super) angular: Option<AngularWaypoint>,
    #[prost(message, optional, tag = "3")]
    pub(super) cartesian: Option<CartesianWaypoint>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct Waypoints {
    #[prost(message, repeated, tag = "1")]
    pub(super) waypoints: Vec<Waypoint>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct WaypointError {
    #[prost(uint32, tag = "1")]
    pub(super) kind: u32,
    #[prost(string, tag = "7")]
    pub(super) message: String,
    #[prost(uint32, tag = "8")]
    pub(super) waypoint: u32,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct WaypointErrors {
    #[prost(message, repeated, tag = "1")]
    pub(super) errors: Vec<WaypointError>,
}

/// `WaypointValidationReport`.
#[derive(Clone, PartialEq, Message)]
pub(super) struct WaypointReport {
    #[prost(message, optional, tag = "1")]
    pub(super) errors: Option<WaypointErrors>,
}
