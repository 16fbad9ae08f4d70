//! The base's own motions, and their notifications.

use std::time::Instant;

use nima_devices::kinova::messages::{ERROR_DEVICE, JointAngles, KinovaNumber, KinovaPose, Rpc, sub};
use nima_testing::real_time::judged;
use prost::Message as _;

use super::{Client, HOME_DEG, TIMEOUT, arm, of};
use crate::emulators::kinova::{
    forms::{EntityHandle, InverseQuestion, JointSpeed, JointSpeeds},
    interface::{
        ACTION_TOPIC, ARM_STATE_TOPIC, CREATE_SEQUENCE, ENTITY_NOT_FOUND, EXECUTE_ACTION, EXECUTE_REFERENCE,
        EXECUTE_WAYPOINTS, INVERSE_KINEMATICS, JOINT_SPEEDS, LARGE_SPEED, MANUAL_STOP, MOVEMENT_IN_PROGRESS,
        PLAY_SEQUENCE, READ_ACTIONS, READ_SEQUENCES, SEQUENCE_TOPIC, UNSUBSCRIBE, VALIDATE_WAYPOINTS,
    },
    moves::{
        ActionHandle, ActionReport, Actions, AngularWaypoint, CartesianWaypoint, KinovaAction, MoveTask, ReachPose,
        Sequence, SequenceReport, Waypoint, WaypointReport, Waypoints,
    },
};

const fn home() -> ActionHandle {
    ActionHandle { identifier: 2, kind: 7, permission: 1 }
}

#[test]
fn an_action_moves_the_arm_and_tells_its_start_and_end() {
    judged(|| {
        let serving = arm([150.0, 15.0, 170.0, -120.0, 5.0, 50.0, 90.0]);
        let mut client = Client::connect(&serving);
        let known: Actions = client.read(0, READ_ACTIONS, &KinovaNumber { value: 7 });
        let handle = known.actions.iter().find(|action| action.name == "Home").and_then(|action| action.handle);
        assert_eq!(handle, Some(home()));
        let topic = client.subscribe(ACTION_TOPIC);
        client.ask(0, EXECUTE_REFERENCE, &home()).unwrap();
        assert_eq!(client.read::<KinovaNumber>(0, of(16, 13), &()).value, 4, "angular trajectory");
        let busy = Err((ERROR_DEVICE, MOVEMENT_IN_PROGRESS));
        assert_eq!(client.ask(0, EXECUTE_REFERENCE, &home()), busy);
        for event in [4, 1] {
            let report: ActionReport = client.next_report(ACTION_TOPIC, topic);
            assert_eq!((report.event, report.handle, report.abort), (event, Some(home()), 0));
        }
        assert!(client.is_at(HOME_DEG), "{:?}", client.angles_deg());
        client.ask(0, EXECUTE_REFERENCE, &ActionHandle { identifier: 4, ..home() }).unwrap();
        client.ask(0, Rpc::STOP, &()).unwrap();
        assert_eq!(client.next_report::<ActionReport>(ACTION_TOPIC, topic).event, 4);
        let report: ActionReport = client.next_report(ACTION_TOPIC, topic);
        assert_eq!((report.event, report.abort), (2, u32::from(MANUAL_STOP)));
        assert!(!client.is_at([0.0; 7]));
        let far = KinovaAction {
            reach_pose: Some(ReachPose { pose: Some(KinovaPose { x: 2.0, ..KinovaPose::default() }) }),
            ..KinovaAction::default()
        };
        assert_eq!(client.ask(0, EXECUTE_ACTION, &far), Err((3, 56)));
        assert_eq!(client.ask(0, EXECUTE_ACTION, &KinovaAction::default()), Err((3, 46)));
        let mut other = Client::connect(&serving);
        assert_eq!(other.ask(0, UNSUBSCRIBE, &KinovaNumber { value: topic }), Err(ENTITY_NOT_FOUND));
        client.ask(0, UNSUBSCRIBE, &KinovaNumber { value: topic }).unwrap();
        client.ask(0, EXECUTE_REFERENCE, &home()).unwrap();
        client.ask(0, Rpc::EMERGENCY_STOP, &()).unwrap();
        assert_eq!(client.ask(0, EXECUTE_REFERENCE, &home()), Err((3, sub::IN_FAULT)));
        assert!(client.report.is_empty(), "{:?}", client.report);
    });
}

#[test]
fn a_session_that_is_gone_leaves_the_arm_at_rest() {
    judged(|| {
        let serving = arm(HOME_DEG);
        let mut watching = Client::connect(&serving);
        let topic = watching.subscribe(ACTION_TOPIC);
        let mut driving = Client::connect(&serving);
        driving.ask(0, EXECUTE_REFERENCE, &ActionHandle { identifier: 4, ..home() }).unwrap();
        let speeds = JointSpeeds { speeds: (0..7).map(|joint| JointSpeed { joint, value_deg_s: 5.0 }).collect() };
        assert_eq!(watching.ask(0, JOINT_SPEEDS, &speeds), Err((3, sub::NOT_IN_CONTROL)));
        drop(driving);
        assert_eq!(watching.next_report::<ActionReport>(ACTION_TOPIC, topic).event, 4);
        assert_eq!(watching.next_report::<ActionReport>(ACTION_TOPIC, topic).event, 2);
        watching.ask(0, JOINT_SPEEDS, &speeds).unwrap();
        let begun = Instant::now();
        while watching.is_at(HOME_DEG) {
            assert!(begun.elapsed() < TIMEOUT);
        }
        let fast = JointSpeeds { speeds: (0..7).map(|joint| JointSpeed { joint, value_deg_s: 80.0 }).collect() };
        assert_eq!(watching.ask(0, JOINT_SPEEDS, &fast), Err(LARGE_SPEED));
        watching.ask(0, Rpc::STOP, &()).unwrap();
        let state = watching.subscribe(ARM_STATE_TOPIC);
        watching.ask(0, Rpc::SET_SERVOING_MODE, &KinovaNumber { value: 3 }).unwrap();
        assert_eq!(watching.next_report::<KinovaNumber>(ARM_STATE_TOPIC, state).value, 6);
        assert_eq!(watching.ask(0, EXECUTE_REFERENCE, &home()), Err((3, sub::WRONG_SERVOING_MODE)));
    });
}

#[test]
fn a_sequence_is_kept_and_played_task_by_task() {
    judged(|| {
        let serving = arm(HOME_DEG);
        let mut client = Client::connect(&serving);
        let near = KinovaPose { x: 0.456_665, y: -0.05, z: 0.433_724, theta_x: 90.0, theta_y: 0.0, theta_z: 90.0 };
        let reach = KinovaAction { reach_pose: Some(ReachPose { pose: Some(near) }), ..KinovaAction::default() };
        let back = KinovaAction { execute: Some(home()), ..KinovaAction::default() };
        let sequence = Sequence { tasks: [reach, back].map(|action| MoveTask { action: Some(action) }).to_vec() };
        let handle: EntityHandle = client.read(0, CREATE_SEQUENCE, &sequence);
        assert!(!client.ask(0, READ_SEQUENCES, &()).unwrap().is_empty());
        let topic = client.subscribe(SEQUENCE_TOPIC);
        client.ask(0, PLAY_SEQUENCE, &handle).unwrap();
        let report: Vec<(u32, u32)> = (0..6)
            .map(|_| client.next_report::<SequenceReport>(SEQUENCE_TOPIC, topic))
            .map(|report| (report.event, report.task))
            .collect();
        assert_eq!(report, [(6, 0), (4, 0), (5, 0), (4, 1), (5, 1), (1, 1)]);
        assert!(client.is_at(HOME_DEG), "{:?}", client.angles_deg());
        assert_eq!(client.ask(0, PLAY_SEQUENCE, &EntityHandle { identifier: 9, permission: 0 }), Err(ENTITY_NOT_FOUND));
    });
}

#[test]
fn waypoints_are_checked_before_they_are_followed() {
    judged(|| {
        let serving = arm(HOME_DEG);
        let mut client = Client::connect(&serving);
        let angular = |angles_deg: Vec<f32>, duration_s| Waypoint {
            angular: Some(AngularWaypoint { angles_deg, duration_s }),
            cartesian: None,
        };
        let near = angular(vec![0.0, 15.0, 180.0, 230.0, 0.0, 55.0, 95.0], 0.5);
        let pose = KinovaPose { x: 0.45, y: 0.02, z: 0.43, theta_x: 90.0, theta_y: 0.0, theta_z: 90.0 };
        let cartesian = Waypoint { angular: None, cartesian: Some(CartesianWaypoint { pose: Some(pose) }) };
        let hasty = angular(vec![180.0, 15.0, 180.0, 230.0, 0.0, 55.0, 95.0], 0.5);
        let refused = Waypoints { waypoints: vec![near.clone(), hasty] };
        let report: WaypointReport = client.read(0, VALIDATE_WAYPOINTS, &refused);
        let errors = report.errors.unwrap().errors;
        assert_eq!((errors.len(), errors[0].kind, errors[0].waypoint), (1, 3, 1));
        assert_eq!(client.ask(0, EXECUTE_WAYPOINTS, &refused), Err((3, 58)));
        let good = Waypoints { waypoints: vec![near, cartesian] };
        let report: WaypointReport = client.read(0, VALIDATE_WAYPOINTS, &good);
        assert!(report.errors.is_none_or(|errors| errors.errors.is_empty()));
        let topic = client.subscribe(ACTION_TOPIC);
        client.ask(0, EXECUTE_WAYPOINTS, &good).unwrap();
        assert_eq!(client.next_report::<ActionReport>(ACTION_TOPIC, topic).event, 4);
        assert_eq!(client.next_report::<ActionReport>(ACTION_TOPIC, topic).event, 1);
        let reached: KinovaPose = client.read(0, Rpc::MEASURED_POSE, &());
        assert!((reached.x - pose.x).abs() < 1e-3 && (reached.y - pose.y).abs() < 1e-3, "{reached:?}");
        let angles = client.ask(0, INVERSE_KINEMATICS, &InverseQuestion { pose: Some(pose), guess: None });
        assert_eq!(JointAngles::decode(angles.unwrap().as_slice()).unwrap().angles.len(), 7);
    });
}
