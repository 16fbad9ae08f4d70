use nalgebra::{UnitQuaternion, Vector3};
use nima_core::impedance::{Mode, ModeSet, ParameterPack, SLOTS};

use super::{
    MESSAGE_MAX,
    follower_message::{FollowerMessage, FollowerSide},
    leader_message::{Intent, LeaderMessage, LeaderSide},
    leader_there::is_same_delay,
};
use crate::{
    messages::{FarStop, ForceSource},
    rig::SIDES,
};

fn follower_side() -> FollowerSide {
    let mut packed = ParameterPack { slot: Mode::Matched.index() as u8, len: 90, ..ParameterPack::NONE };
    packed.numbers.iter_mut().take(90).enumerate().for_each(|(i, number)| *number = i as f32 - 7.5);
    FollowerSide {
        tip_m: Vector3::new(0.0125, -0.25, 0.5),
        world_from_jaws: Some(UnitQuaternion::from_euler_angles(0.3, -2.0, 3.0)),
        grip_n: Some(1.5),
        powered: true,
        is_obstructed: false,
        stop: Some(FarStop::LoopStalled),
        source: ForceSource::Network,
        force_n: Vector3::new(-1.0, 2.0, 0.5),
        fresh: true,
        resting: false,
        modes: ModeSet::only(Mode::Best),
        packed: Some(packed),
        errors_n: Some([0.25; SLOTS]),
    }
}

fn follower_message() -> FollowerMessage {
    let right = follower_side();
    let left = FollowerSide { packed: None, errors_n: None, world_from_jaws: None, grip_n: None, stop: None, ..right };
    FollowerMessage { t_s: 12.345, sides: [Some(right), Some(left)] }
}

fn leader_message() -> LeaderMessage {
    let right = LeaderSide {
        intent: Intent::Follow,
        engagements: 255,
        releases: 3,
        tip_m: Vector3::new(0.0125, -0.25, 0.5),
        world_from_jaws: Some(UnitQuaternion::from_euler_angles(0.3, -2.0, 3.0)),
        gripper_rad: Some(0.25),
    };
    let left = LeaderSide { intent: Intent::Stop, world_from_jaws: None, gripper_rad: None, ..right };
    LeaderMessage { t_s: 12.345, delay_ticks: 144, mode: Mode::Best, compares: true, sides: [Some(right), Some(left)] }
}

fn turned_rad(one: Option<UnitQuaternion<f64>>, other: Option<UnitQuaternion<f64>>) -> f64 {
    one.zip(other).map_or(f64::INFINITY, |(one, other)| one.angle_to(&other))
}

#[test]
fn messages_arrive_as_they_were_sent() {
    let mut buffer = [0; MESSAGE_MAX];
    let sent = follower_message();
    let bytes = sent.pack(&mut buffer).unwrap();
    println!("{} bytes from the follower, {} with parameters", sent_without_parameters(), bytes.len());
    let mut got = FollowerMessage::unpack(bytes).unwrap();
    let [Some(now), Some(then)] = [got.sides[0], sent.sides[0]] else { panic!() };
    assert!(turned_rad(now.world_from_jaws, then.world_from_jaws) < 1e-5);
    // The quaternion is the same rotation, but its numbers differ.
    got.sides[0] = Some(FollowerSide { world_from_jaws: then.world_from_jaws, tip_m: then.tip_m, ..now });
    got.sides[1] = got.sides[1].map(|side| FollowerSide { tip_m: then.tip_m, ..side });
    assert_eq!(got, sent);
    assert!((now.tip_m - then.tip_m).norm() < 1e-7);

    let sent = leader_message();
    let bytes = sent.pack(&mut buffer).unwrap();
    println!("{} bytes from the operator", bytes.len());
    let mut got = LeaderMessage::unpack(bytes).unwrap();
    let [Some(now), Some(then)] = [got.sides[0], sent.sides[0]] else { panic!() };
    assert!(turned_rad(now.world_from_jaws, then.world_from_jaws) < 1e-5);
    assert!((now.tip_m - then.tip_m).norm() < 1e-7);
    for side in got.sides.iter_mut().flatten() {
        side.tip_m = then.tip_m;
    }
    got.sides[0] = got.sides[0].map(|side| LeaderSide { world_from_jaws: then.world_from_jaws, ..side });
    assert_eq!(got, sent);
}

fn sent_without_parameters() -> usize {
    let mut message = follower_message();
    message.sides.iter_mut().flatten().for_each(|side| (side.packed, side.errors_n) = (None, None));
    message.pack(&mut [0; MESSAGE_MAX]).unwrap().len()
}

#[test]
fn a_delay_that_jitter_moves_is_the_same_to_what_learns_over_it() {
    for (learnt, now, is_same) in [(0, 2, true), (0, 3, false), (200, 191, true), (200, 210, true), (200, 211, false)] {
        assert_eq!(is_same_delay(learnt, now), is_same, "{learnt} {now}");
    }
}

#[test]
fn a_message_that_does_not_fit_is_none() {
    for room in 0..200 {
        assert!(follower_message().pack(&mut vec![0; room]).is_none());
    }
    assert_eq!(SIDES, 2);
}

/// Any input is either a message of finite numbers or refused.
fn take(bytes: &[u8]) {
    if let Some(message) = LeaderMessage::unpack(bytes) {
        assert!(message.t_s.is_finite() && message.sides.iter().flatten().all(|side| side.tip_m.norm().is_finite()));
    }
    if let Some(message) = FollowerMessage::unpack(bytes) {
        let finite = |side: &FollowerSide| {
            side.force_n.norm().is_finite()
                && side.tip_m.norm().is_finite()
                && side.packed.is_none_or(|packed| packed.used().iter().all(|number| number.is_finite()))
        };
        assert!(message.sides.iter().flatten().all(finite));
    }
}

/// Random bytes, and messages with some changed bytes.
fn fuzz(rounds: usize, seed: u64) {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut buffer = [0; MESSAGE_MAX];
    for _ in 0..rounds {
        let length = random.usize(0..600);
        random.fill(&mut buffer[..length]);
        take(&buffer[..length]);
        let of_follower = random.bool();
        let length = if of_follower {
            follower_message().pack(&mut buffer).unwrap().len()
        } else {
            leader_message().pack(&mut buffer).unwrap().len()
        };
        for _ in 0..random.usize(1..4) {
            buffer[random.usize(0..length)] = random.u8(..);
        }
        take(&buffer[..random.usize(0..=length)]);
    }
}

#[test]
fn what_is_damaged_is_a_message_of_numbers_or_none() {
    fuzz(20_000, 1);
}

#[test]
#[ignore = "`./dev fuzz` runs it for as long as told"]
fn fuzz_messages() {
    nima_testing::fuzz::rounds(|seed| fuzz(200_000, seed));
}
