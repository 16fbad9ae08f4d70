//! Tests: every possible input of the loop is read back bit for bit; all other data are rejected.

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, UnitVector3, Vector3};
use nima_core::{
    calibration::frames::{FrameSample, ViewMove},
    frames::{Wrench, WristSample},
    impedance::{Mode, ModeSet, PACKED_MAX, ParameterPack, SLOTS},
    kinematics::{ArmStartError, HandPose},
    safety::{RawReading, RawReadings},
    tip_force::{Fallback, Unsure},
};
use nima_devices::{ConnectionState, Loss};
use nima_machine::{
    config::RigConfig,
    messages::{Command, FarStop, ForceSource, Watchdog},
    rig::{
        AwaitedDevice, DeviceEvent, EngageBlocker, Inputs, PlannedTip, Prompt, RemoteIdentification, SensedForce, Side,
        SideSwap, Switches, TaskAction, ViewOrientation,
    },
    runtime::Operation,
    teleop::{Calibrations, LoopOrigin, Timing},
};
use proptest::prelude::*;

use super::{
    BLOCK, BlockWriter, JournalEncoder, JournalEnd, JournalError, JournalMessage, JournalStart, TickNote, TickRow,
    VERSION, decode,
};
use crate::{
    codec::{BlockColumns, ToWords as _},
    digest::{DigestCheck, STAGES},
};

/// Generates numbers that a working or faulty device may return. Compared by their bits.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![4 => -10.0..10.0_f64, 1 => any::<u64>().prop_map(f64::from_bits), 1 => Just(0.0), 1 => Just(-0.0)]
}

fn vector() -> impl Strategy<Value = Vector3<f64>> {
    [number(), number(), number()].prop_map(Vector3::from)
}

fn rotation() -> impl Strategy<Value = UnitQuaternion<f64>> {
    [number(), number(), number(), number()]
        .prop_map(|[w, x, y, z]| UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z)))
}

fn pose() -> impl Strategy<Value = Isometry3<f64>> {
    (vector(), rotation())
        .prop_map(|(position_m, turned)| Isometry3::from_parts(Translation3::from(position_m), turned))
}

fn maybe<T: std::fmt::Debug>(value: impl Strategy<Value = T>) -> impl Strategy<Value = Option<T>> {
    proptest::option::of(value)
}

fn wrench() -> impl Strategy<Value = Wrench> {
    (vector(), vector()).prop_map(|(force_n, torque_nm)| Wrench { force_n, torque_nm })
}

fn sensed() -> BoxedStrategy<SensedForce> {
    let turned = (maybe(rotation()), maybe(rotation()), maybe(rotation()));
    let sample = (wrench(), maybe(vector()), turned, maybe(number()), maybe(vector()));
    let at_wrist = sample.prop_map(|(raw, acceleration_m_s2, turned, insertion_m, tissue_n)| {
        let (world_from_s1, world_from_m, m_from_c) = turned;
        let sample =
            WristSample { raw, acceleration_m_s2, world_from_s1, world_from_m, m_from_c, insertion_m, tissue_n };
        SensedForce::AtWrist(sample)
    });
    prop_oneof![vector().prop_map(SensedForce::AtTip), at_wrist, identified().prop_map(SensedForce::FarEnd)].boxed()
}

fn frames() -> BoxedStrategy<FrameSample> {
    ([maybe(pose()), maybe(pose()), maybe(pose()), maybe(pose()), maybe(pose())], maybe(wrench()))
        .prop_map(
            |([base_from_flange, other_base_from_flange, c_from_m, c_from_other_m, leader_from_handle], wrench)| {
                FrameSample {
                    base_from_flange,
                    other_base_from_flange,
                    c_from_m,
                    c_from_other_m,
                    leader_from_handle,
                    wrench,
                }
            },
        )
        .boxed()
}

fn obstacle() -> BoxedStrategy<EngageBlocker> {
    let start = prop_oneof![
        number().prop_map(|period_s| ArmStartError::Period { period_s }),
        (number(), number())
            .prop_map(|(shaft_m, insertion_max_m)| ArmStartError::ShortShaft { shaft_m, insertion_max_m }),
        any::<usize>().prop_map(|joint| ArmStartError::NotFinite { joint }),
        (any::<usize>(), number(), number()).prop_map(|(joint, angle_deg, limit_deg)| ArmStartError::AtLimit {
            joint,
            angle_deg,
            limit_deg
        }),
        (number(), number()).prop_map(|(miss_m, max_m)| ArmStartError::BesideTrocar { miss_m, max_m }),
        number().prop_map(|insertion_m| ArmStartError::NotInserted { insertion_m }),
    ];
    let exchanged =
        [SideSwap::Handles, SideSwap::Arms, SideSwap::Sensors, SideSwap::Servos, SideSwap::Markers, SideSwap::Trocars];
    prop_oneof![
        start.prop_map(EngageBlocker::Start),
        prop_oneof![Just(AwaitedDevice::Servos), Just(AwaitedDevice::Markers)].prop_map(EngageBlocker::Waiting),
        proptest::sample::select(exchanged.to_vec()).prop_map(EngageBlocker::Exchanged),
        Just(EngageBlocker::FarEnd),
        Just(EngageBlocker::OneHandle),
        Just(EngageBlocker::OneArm),
        Just(EngageBlocker::OneSensor),
    ]
    .boxed()
}

fn identified() -> BoxedStrategy<RemoteIdentification> {
    let sources = [
        ForceSource::AtTip,
        ForceSource::InDoubt { unsure: Unsure::Missing, fallback: Fallback::HoldAndFade },
        ForceSource::Poisoned,
    ];
    let times = (number(), number(), vector());
    let flags = (any::<bool>(), any::<bool>(), maybe(proptest::sample::select(FarStop::ALL.to_vec())));
    let modes = proptest::sample::select(Mode::ALL.into_iter().chain(Mode::BASELINES).collect::<Vec<_>>());
    let numbers = proptest::collection::vec(any::<f32>(), PACKED_MAX);
    (times, proptest::sample::select(sources.to_vec()), flags, modes, any::<[u8; 2]>(), numbers)
        .prop_map(|((t_s, delay_s, force_n), source, (fresh, resting, stop), mode, [slot, len], numbers)| {
            RemoteIdentification {
                t_s,
                delay_s,
                force_n,
                source,
                fresh,
                resting,
                modes: ModeSet::only(mode),
                errors_n: fresh.then(|| [numbers[0]; SLOTS]),
                packed: ParameterPack { slot, len, numbers: numbers.try_into().unwrap() },
                stop,
            }
        })
        .boxed()
}

fn reading<const N: usize>() -> BoxedStrategy<RawReading<N>> {
    let channels = proptest::collection::vec(number(), N);
    (channels, maybe(number()), number())
        .prop_map(|(channels, device_s, arrival_s)| RawReading {
            channels: channels.try_into().unwrap(),
            device_s,
            arrival_s,
        })
        .boxed()
}

fn inputs() -> BoxedStrategy<Inputs> {
    let hand = (vector(), maybe(rotation()), maybe(number()), maybe(number()));
    let tip = (vector(), maybe(vector()), maybe(rotation()), sensed());
    let view = prop_oneof![
        Just(ViewOrientation::Fixed),
        Just(ViewOrientation::Unseen),
        rotation().prop_map(ViewOrientation::Seen)
    ];
    let age = (number(), number());
    let rest = (view, frames(), any::<bool>(), maybe(any::<bool>()), any::<bool>(), maybe(obstacle()), age);
    let raw = (maybe(reading()), maybe(reading()), maybe(reading()));
    let raw = raw.prop_map(|(handle, arm, sensor)| RawReadings { handle, arm, sensor });
    (hand, tip, rest, raw)
        .prop_map(|(hand, tip, rest, raw)| {
            let (position_m, orientation, gripper_rad, grip_n) = hand;
            let (tip_m, planned_m, world_from_jaws, sensed) = tip;
            let (view, frames, clutch, presence, powered, obstacle, (age_s, silent_s)) = rest;
            Inputs {
                hand: HandPose { position_m, orientation },
                gripper_rad,
                grip_n,
                tip_m,
                planned: PlannedTip(planned_m),
                world_from_jaws,
                sensed,
                view,
                frames,
                switches: Switches { clutch, presence },
                powered,
                obstacle,
                age_s,
                silent_s,
                raw,
            }
        })
        .boxed()
}

fn row() -> BoxedStrategy<TickRow> {
    let timing = (number(), number(), number(), maybe(number()), any::<u64>());
    let check = (any::<u64>(), any::<[[u16; STAGES]; 2]>());
    (timing, maybe(inputs()), maybe(inputs()), check)
        .prop_map(|(timing, right, left, (all, stages))| {
            let (now_s, wake_s, work_s, sample_to_force_s, missed_now) = timing;
            let timing = Timing { now_s, wake_s, work_s, sample_to_force_s, missed_now };
            TickRow { timing, inputs: [right, left], check: DigestCheck { all, stages } }
        })
        .boxed()
}

fn side() -> impl Strategy<Value = Side> {
    prop_oneof![Just(Side::Right), Just(Side::Left)]
}

fn prompt() -> BoxedStrategy<Prompt> {
    let plain = [
        Prompt::Rest,
        Prompt::Wave,
        Prompt::Work,
        Prompt::WorkFree,
        Prompt::PivotInDimple,
        Prompt::Turn,
        Prompt::PivotInTrocar,
    ];
    prop_oneof![
        proptest::sample::select(plain.to_vec()),
        rotation().prop_map(|world_from_s1| Prompt::Hold { world_from_s1 }),
        vector().prop_map(|direction| Prompt::Push { direction: UnitVector3::new_unchecked(direction) }),
        any::<u8>().prop_map(|point| Prompt::Touch { point }),
        proptest::sample::select(ViewMove::ALL.to_vec()).prop_map(Prompt::MoveTip),
        proptest::sample::select(ViewMove::ALL.to_vec()).prop_map(Prompt::MoveHandle),
    ]
    .boxed()
}

fn command() -> BoxedStrategy<Command> {
    let modes: Vec<Mode> = Mode::ALL.into_iter().chain(Mode::BASELINES).collect();
    let plain = [Command::Engage, Command::Rest, Command::Stop, Command::ReleaseStop, Command::Shutdown];
    let of_number = [
        Command::SetGain as fn(f64) -> Command,
        Command::SetGainAboveOne,
        Command::SetDelay,
        Command::SetDeadBand,
        Command::SetScale,
    ];
    let of_bool = [
        Command::Compare as fn(bool) -> Command,
        Command::SetStaticHold,
        Command::LetGo,
        Command::SetGovernor,
        Command::Checked,
    ];
    prop_oneof![
        proptest::sample::select(plain.to_vec()),
        proptest::sample::select(modes).prop_map(Command::SetMode),
        (0..of_number.len(), number()).prop_map(move |(i, value)| of_number[i](value)),
        (0..of_bool.len(), any::<bool>()).prop_map(move |(i, value)| of_bool[i](value)),
        (side(), prompt()).prop_map(|(side, prompt)| Command::Prompt(side, prompt)),
        (side(), maybe(vector())).prop_map(|(side, guide_m)| Command::Guide(side, guide_m)),
        (side(), maybe(number())).prop_map(|(side, grip_rad)| Command::Grip(side, grip_rad)),
        (side(), proptest::sample::select(TaskAction::ALL.to_vec())).prop_map(|(side, act)| Command::Task(side, act)),
        side().prop_map(Command::EngageOne),
        proptest::sample::select(Watchdog::ALL.to_vec()).prop_map(Command::TestWatchdog),
    ]
    .boxed()
}

fn noted() -> BoxedStrategy<TickNote> {
    let loss = prop_oneof![
        Just(Loss::Disconnected),
        Just(Loss::Silent),
        Just(Loss::Corrupt),
        Just(Loss::Implausible),
        any::<u32>().prop_map(|code| Loss::Device { code }),
    ];
    let standing = prop_oneof![
        Just(ConnectionState::Closed),
        Just(ConnectionState::Opening),
        Just(ConnectionState::Connected),
        loss.prop_map(ConnectionState::Lost),
    ];
    let event = (number(), any::<u8>(), standing, any::<[bool; 2]>())
        .prop_map(|(t_s, device, standing, of_side)| DeviceEvent { t_s, device, standing, of_side });
    let operation = prop_oneof![
        (command(), number()).prop_map(|(command, t_s)| Operation::Command { command, t_s }),
        event.prop_map(Operation::Device),
        side().prop_map(Operation::Suspend),
        (side(), any::<u64>()).prop_map(|(side, number)| Operation::Calibrations { side, number }),
        (number(), number()).prop_map(|(silent_s, t_s)| Operation::Stall { silent_s, t_s }),
    ];
    prop_oneof![operation.prop_map(TickNote::Operation), any::<u64>().prop_map(|lost| TickNote::Hole { lost })].boxed()
}

/// Returns the steps of a block: the entries before each row, and the row.
fn steps() -> impl Strategy<Value = Vec<(Vec<TickNote>, TickRow)>> {
    proptest::collection::vec((proptest::collection::vec(noted(), 0..3), row()), 0..12)
}

fn encoded(steps: &[(Vec<TickNote>, TickRow)]) -> Vec<u8> {
    let mut writer = BlockWriter::default();
    for (noted, row) in steps {
        for noted in noted {
            writer.note(*noted);
        }
        writer.tick(row);
    }
    JournalEncoder::default().block(&mut writer)
}

fn start() -> JournalStart {
    let rig = RigConfig::load("simulated").unwrap();
    JournalStart {
        program: "test".into(),
        origin: LoopOrigin { rig, calibrations: [Some(Calibrations::default()), None], suspended: true },
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn a_block_comes_back_to_the_bit(steps in steps()) {
        let (number, message) = decode(&encoded(&steps)).unwrap();
        let JournalMessage::Block(block) = message else { panic!("{message:?}") };
        prop_assert_eq!((number, block.first_tick, block.rows.len()), (0, 0, steps.len()));
        // NaN is not equal to itself, so compare the bits.
        let mut again = BlockWriter::default();
        let mut noted = block.noted.iter().peekable();
        for (i, row) in block.rows.iter().enumerate() {
            while let Some((_, noted)) = noted.next_if(|(before, _)| *before <= i) {
                again.note(*noted);
            }
            again.tick(row);
        }
        prop_assert_eq!(JournalEncoder::default().block(&mut again), encoded(&steps));
        for (row, (_, given)) in block.rows.iter().zip(&steps) {
            prop_assert_eq!(format!("{row:?}"), format!("{given:?}"));
        }
        let report: Vec<_> = block.noted.iter().map(|(_, noted)| format!("{noted:?}")).collect();
        let given: Vec<_> = steps.iter().flat_map(|(noted, _)| noted).map(|noted| format!("{noted:?}")).collect();
        prop_assert_eq!(report, given);
    }

    #[test]
    fn a_mutated_block_does_not_panic_and_is_refused(
        steps in steps(),
        at in any::<prop::sample::Index>(),
        bit in 0..8_u8,
        cut in any::<prop::sample::Index>(),
    ) {
        let whole = encoded(&steps);
        let mut flipped = whole.clone();
        flipped[at.index(whole.len())] ^= 1 << bit;
        prop_assert!(decode(&flipped).is_err());
        prop_assert!(decode(&whole[..cut.index(whole.len())]).is_err());
        // With a corrected checksum the result is an error or another block, never a panic.
        let crc = crc32fast::hash(&flipped[10..]).to_le_bytes();
        flipped[6..10].copy_from_slice(&crc);
        decode(&flipped).ok();
    }
}

/// The loop uses only the orientation of the image. The marker's position is in the plotted frames, and older journals
/// are read as before.
#[test]
fn of_an_endoscopes_marker_the_journal_keeps_how_the_picture_is_turned() {
    let world_from_view = UnitQuaternion::from_euler_angles(0.3, -0.2, 2.0);
    let world_from_n = Isometry3::translation(0.1, 0.2, 0.3);
    let row = |view: ViewOrientation| TickRow {
        timing: Timing { now_s: 1.0, wake_s: 0.0, work_s: 0.0, sample_to_force_s: None, missed_now: 0 },
        inputs: [Some(Inputs { view, ..Inputs::NOTHING }), None],
        check: DigestCheck { all: 0, stages: [[0; STAGES]; 2] },
    };
    let seen_at = ViewOrientation::SeenAt { world_from_view, world_from_n };
    let seen = ViewOrientation::Seen(world_from_view);
    let bytes = encoded(&[(Vec::new(), row(seen_at))]);
    assert_eq!(bytes, encoded(&[(Vec::new(), row(seen))]));
    let Ok((_, JournalMessage::Block(block))) = decode(&bytes) else { panic!("no block") };
    assert_eq!(block.rows[0].inputs[0].unwrap().view, seen);
}

#[test]
fn what_is_no_journal_of_this_version_is_named() {
    let mut bytes = JournalEncoder::default().start(&start()).unwrap();
    assert!(matches!(decode(&bytes), Ok((0, JournalMessage::Start(_)))));
    bytes[20] ^= 4;
    assert_eq!(decode(&bytes).unwrap_err(), JournalError::Damaged);
    bytes[4] = VERSION as u8 + 1;
    assert_eq!(decode(&bytes).unwrap_err(), JournalError::Version { found: VERSION + 1 });
    assert_eq!(decode(b"time,force\n0,1\n").unwrap_err(), JournalError::Foreign);
    assert_eq!(decode(&[]).unwrap_err(), JournalError::Foreign);
}

#[test]
fn a_block_of_the_version_before_is_read_without_the_commanded_tips() {
    let rows = [2.0, 3.0].map(|tip_m| TickRow {
        timing: Timing::default(),
        inputs: [Some(Inputs { tip_m: Vector3::repeat(tip_m), ..Inputs::NOTHING }), None],
        check: DigestCheck { all: 7, stages: [[1; STAGES]; 2] },
    });
    let mut columns = BlockColumns::default();
    for row in &rows {
        columns.next_row();
        row.put(&mut columns);
    }
    // The first tick, and the numbers of rows and entries.
    let mut bytes = vec![9, 2, 0];
    columns.pack(&mut bytes);
    let mut message = JournalEncoder::default().message(BLOCK, &bytes);
    message[4] = 5;
    let Ok((_, JournalMessage::Block(block))) = decode(&message) else { panic!("no block") };
    assert_eq!((block.first_tick, block.rows.as_slice()), (9, &rows[..]));
}

#[test]
fn a_journal_of_the_version_before_is_replayed_with_its_forces() {
    let earlier = |bytes: &[u8]| {
        let Ok((_, JournalMessage::Start(read))) = decode(bytes) else { panic!("no start") };
        read.origin.rig.identification.earlier_forces
    };
    let mut bytes = JournalEncoder::default().start(&start()).unwrap();
    assert!(!earlier(&bytes));
    bytes[4] = 5;
    assert!(earlier(&bytes));
    let Ok((_, JournalMessage::Start(read))) = decode(&bytes) else { panic!("no start") };
    assert!(earlier(&JournalEncoder::default().start(&read).unwrap()), "also after a part of it was written again");
    bytes[4] = 4;
    assert_eq!(decode(&bytes).unwrap_err(), JournalError::Version { found: 4 });
}

#[test]
fn every_rig_comes_back_as_it_was() {
    for name in RigConfig::names() {
        let rig = RigConfig::load(name).unwrap();
        let origin = LoopOrigin { rig: rig.clone(), ..start().origin };
        let bytes = JournalEncoder::default()
            .start(&JournalStart { origin, ..start() })
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        let (_, JournalMessage::Start(JournalStart { origin, program })) = decode(&bytes).unwrap() else {
            panic!("{name}")
        };
        assert_eq!((origin.rig, program.as_str()), (rig, "test"), "{name}");
        assert!(origin.suspended && origin.calibrations[0].is_some() && origin.calibrations[1].is_none(), "{name}");
    }
}

#[test]
fn the_end_comes_back() {
    let mut encoder = JournalEncoder::default();
    encoder.start(&start()).unwrap();
    let end = JournalEnd { ticks: 1 << 40, lost: 7 };
    assert!(matches!(decode(&encoder.end(&end)), Ok((1, JournalMessage::End(report))) if report == end));
}
