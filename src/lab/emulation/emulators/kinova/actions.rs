//! Actions, waypoints and sequences: motions that the base performs by itself, with notifications of their end.

use std::collections::VecDeque;

use nima_devices::{
    ARM_JOINTS,
    kinova::messages::{JointAngle, JointAngles, KinovaNumber, Rpc},
};
use prost::Message as _;

use super::{
    entity_store::EntityStore,
    forms::EntityHandle,
    interface::{
        ACTION_TOPIC, AnswerPayload, ENTITY_NOT_FOUND, EXECUTE_ACTION, EXECUTE_REFERENCE, EXECUTE_WAYPOINTS,
        INVALID_DURATION, INVALID_PARAM, InterfaceError, JOINT_COUNT, OUTSIDE_WORKSPACE, PLAY_SEQUENCE, READ_ACTION,
        READ_ACTIONS, READ_SEQUENCE, READ_SEQUENCES, SEQUENCE_TOPIC, UNSUPPORTED_ACTION, UNSUPPORTED_METHOD,
        VALIDATE_WAYPOINTS, read,
    },
    joint_motion::{KinovaJoints, Leg, goal, leg, reach},
    moves::{
        ActionHandle, ActionReport, Actions, KinovaAction, ReachAngles, Sequence, SequenceReport, Waypoint,
        WaypointError, WaypointErrors, WaypointReport, Waypoints,
    },
    robot::Robot,
    topics::KinovaTopics,
};

/// `ActionType`.
const REACH_JOINT_ANGLES: u32 = 7;
/// `ActionEvent`.
const END: u32 = 1;
const ABORT: u32 = 2;
const START: u32 = 4;
/// `EventIdSequenceInfoNotification`.
const COMPLETED: u32 = 1;
const ABORTED: u32 = 2;
const TASK_STARTED: u32 = 4;
const TASK_COMPLETED: u32 = 5;
const STARTED: u32 = 6;
/// Maximum number of waypoints in a list.
const WAYPOINTS: usize = 1000;

/// Actions that every arm has, with their identifiers.
const OWN: [(u32, &str, [f32; ARM_JOINTS]); 3] = [
    (1, "Retract", [0.0, 340.0, 180.0, 214.0, 0.0, 310.0, 90.0]),
    (2, "Home", [0.0, 15.0, 180.0, 230.0, 0.0, 55.0, 90.0]),
    (4, "Zero", [0.0; ARM_JOINTS]),
];

/// The action in progress.
enum RunningAction {
    Action(ActionHandle),
    Sequence { handle: EntityHandle, task: u32, rest: VecDeque<KinovaAction> },
}

#[derive(Default)]
pub(super) struct Player {
    pub(super) sequences: EntityStore,
    playing: Option<RunningAction>,
}

impl Player {
    /// Answers calls about actions and sequences, except those that create or delete sequences.
    pub(super) fn answer(
        &mut self,
        rpc: Rpc,
        payload: &[u8],
        robot: &mut Robot,
        topics: &mut KinovaTopics,
    ) -> AnswerPayload {
        match rpc {
            READ_SEQUENCE => return self.sequences.get(payload),
            READ_SEQUENCES => return Ok(self.sequences.all()),
            READ_ACTIONS => {
                let kind = read::<KinovaNumber>(payload)?.value;
                let actions = if matches!(kind, 0 | REACH_JOINT_ANGLES) { OWN.map(own).to_vec() } else { Vec::new() };
                return Ok(Actions { actions }.encode_to_vec());
            }
            READ_ACTION => return Ok(referred(&read(payload)?)?.encode_to_vec()),
            VALIDATE_WAYPOINTS => {
                let errors = errors(&read(payload)?, &robot.body().joint_rad);
                return Ok(WaypointReport { errors: Some(WaypointErrors { errors }) }.encode_to_vec());
            }
            EXECUTE_REFERENCE => self.execute(&referred(&read(payload)?)?, robot, topics)?,
            EXECUTE_ACTION => self.execute(&read(payload)?, robot, topics)?,
            EXECUTE_WAYPOINTS => {
                let action = KinovaAction { waypoints: Some(read(payload)?), ..KinovaAction::default() };
                self.execute(&action, robot, topics)?;
            }
            PLAY_SEQUENCE => self.play(payload, robot, topics)?,
            _ => return Err(UNSUPPORTED_METHOD),
        }
        Ok(Vec::new())
    }

    fn execute(
        &mut self,
        action: &KinovaAction,
        robot: &mut Robot,
        topics: &mut KinovaTopics,
    ) -> Result<(), InterfaceError> {
        robot.follow(plan(action, &robot.body().joint_rad)?)?;
        let handle = action.handle.unwrap_or_default();
        topics.report(ACTION_TOPIC, &ActionReport { event: START, handle: Some(handle), abort: 0 });
        self.playing = Some(RunningAction::Action(handle));
        Ok(())
    }

    fn play(&mut self, payload: &[u8], robot: &mut Robot, topics: &mut KinovaTopics) -> Result<(), InterfaceError> {
        let handle = read::<EntityHandle>(payload)?;
        let sequence = read::<Sequence>(&self.sequences.get(payload)?)?;
        let mut rest: VecDeque<KinovaAction> = sequence.tasks.into_iter().filter_map(|task| task.action).collect();
        let first = rest.pop_front().ok_or(INVALID_PARAM)?;
        robot.follow(plan(&first, &robot.body().joint_rad)?)?;
        for event in [STARTED, TASK_STARTED] {
            topics.report(SEQUENCE_TOPIC, &SequenceReport { event, handle: Some(handle), task: 0, abort: 0 });
        }
        self.playing = Some(RunningAction::Sequence { handle, task: 0, rest });
        Ok(())
    }

    /// Reports actions that have ended, and continues a sequence. Returns true when nothing is in progress any more.
    pub(super) fn advance(&mut self, robot: &mut Robot, topics: &mut KinovaTopics) -> bool {
        let Some(ended) = robot.take_end() else { return false };
        match self.playing.take() {
            None => {}
            Some(RunningAction::Action(handle)) => {
                let event = if ended.is_ok() { END } else { ABORT };
                let abort = ended.err().map_or(0, u32::from);
                topics.report(ACTION_TOPIC, &ActionReport { event, handle: Some(handle), abort });
            }
            Some(RunningAction::Sequence { handle, task, rest }) => {
                self.next_task(ended, handle, task, rest, robot, topics);
            }
        }
        self.playing.is_none()
    }

    fn next_task(
        &mut self,
        ended: Result<(), u16>,
        handle: EntityHandle,
        task: u32,
        mut rest: VecDeque<KinovaAction>,
        robot: &mut Robot,
        topics: &mut KinovaTopics,
    ) {
        let mut report = |event, task, abort| {
            topics.report(SEQUENCE_TOPIC, &SequenceReport { event, handle: Some(handle), task, abort });
        };
        if let Err(code) = ended {
            report(ABORTED, task, u32::from(code));
            return;
        }
        report(TASK_COMPLETED, task, 0);
        let Some(next) = rest.pop_front() else {
            report(COMPLETED, task, 0);
            return;
        };
        let task = task + 1;
        match plan(&next, &robot.body().joint_rad).and_then(|legs| robot.follow(legs)) {
            Ok(()) => {
                report(TASK_STARTED, task, 0);
                self.playing = Some(RunningAction::Sequence { handle, task, rest });
            }
            Err((_, code)) => report(ABORTED, task, u32::from(code)),
        }
    }
}

fn own((identifier, name, degrees): (u32, &str, [f32; ARM_JOINTS])) -> KinovaAction {
    let angle = |(joint, value_deg): (usize, f32)| JointAngle { joint: joint as u32, value_deg };
    let angles = JointAngles { angles: degrees.into_iter().enumerate().map(angle).collect() };
    KinovaAction {
        handle: Some(ActionHandle { identifier, kind: REACH_JOINT_ANGLES, permission: 1 }),
        name: name.to_owned(),
        reach_angles: Some(ReachAngles { angles: Some(angles) }),
        ..KinovaAction::default()
    }
}

fn referred(handle: &ActionHandle) -> Result<KinovaAction, InterfaceError> {
    OWN.into_iter().find(|(identifier, ..)| *identifier == handle.identifier).map(own).ok_or(ENTITY_NOT_FOUND)
}

fn plan(action: &KinovaAction, from_rad: &KinovaJoints) -> Result<Vec<Leg>, InterfaceError> {
    let to_rad = if let Some(reached) = &action.reach_angles {
        // The order counts, because the manufacturer's examples omit the joints' numbers.
        let angles = reached.angles.iter().flat_map(|angles| &angles.angles);
        goal(&angles.map(|angle| angle.value_deg).collect::<Vec<_>>(), from_rad)?
    } else if let Some(reached) = &action.reach_pose {
        reach(&reached.pose.ok_or(INVALID_PARAM)?, from_rad)?
    } else if let Some(waypoints) = &action.waypoints {
        return legs(waypoints, from_rad).map_err(|(_, refused)| refused);
    } else if let Some(handle) = &action.execute {
        return plan(&referred(handle)?, from_rad);
    } else {
        return Err(UNSUPPORTED_ACTION);
    };
    Ok(vec![leg(from_rad, to_rad, 0.0)?])
}

/// Returns the path through the waypoints, or which waypoint is impossible, and why.
fn legs(list: &Waypoints, from_rad: &KinovaJoints) -> Result<Vec<Leg>, (usize, InterfaceError)> {
    if !(1..=WAYPOINTS).contains(&list.waypoints.len()) {
        return Err((0, INVALID_PARAM));
    }
    let mut at_rad = *from_rad;
    let mut legs = Vec::new();
    for (index, waypoint) in list.waypoints.iter().enumerate() {
        let next = way(waypoint, &at_rad).map_err(|refused| (index, refused))?;
        at_rad = *next.end_rad();
        legs.push(next);
    }
    Ok(legs)
}

fn way(waypoint: &Waypoint, from_rad: &KinovaJoints) -> Result<Leg, InterfaceError> {
    if let Some(angular) = &waypoint.angular {
        return leg(from_rad, goal(&angular.angles_deg, from_rad)?, f64::from(angular.duration_s));
    }
    let pose = waypoint.cartesian.and_then(|cartesian| cartesian.pose).ok_or(INVALID_PARAM)?;
    leg(from_rad, reach(&pose, from_rad)?, 0.0)
}

/// Returns the report of a list that cannot be followed (`TrajectoryErrorType`).
fn errors(list: &Waypoints, from_rad: &KinovaJoints) -> Vec<WaypointError> {
    let Err((waypoint, refused)) = legs(list, from_rad) else { return Vec::new() };
    let (kind, message) = match refused {
        OUTSIDE_WORKSPACE => (1, "the pose cannot be reached"),
        JOINT_COUNT => (2, "not one angle for each joint"),
        INVALID_DURATION => (3, "the joints cannot be so fast"),
        _ => (0, "the waypoint cannot be followed"),
    };
    vec![WaypointError { kind, message: message.to_owned(), waypoint: waypoint as u32 }]
}
