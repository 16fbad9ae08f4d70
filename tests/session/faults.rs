//! Disturbances during a session: faults, lost devices, activated calibrations; gaps; and the effect of a flipped bit.

use std::{
    thread,
    time::{Duration, Instant},
};

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::{
    calibration::gravity::{GravityModel, GravityParameters, GravitySource},
    frames::{GRAVITY_M_S2, Wrench, WristSample},
    kinematics::HandPose,
};
use nima_devices::{ConnectionState, Loss, SlotView};
use nima_machine::{
    config::SchedulingClass,
    messages::{Command, Fault, ForceSource, LoopState},
    rig::{DeviceEvent, Inputs, Outputs, Rig, RigPart, RosterEntry, SIDES, SensedForce, Side},
    runtime::{self, Assembly, RuntimeClock, tap},
    teleop::{Calibrations, Timing},
};
use nima_session::{
    digest::TickStage,
    journal::{BlockWriter, JournalBlock, JournalEncoder, JournalMessage, JournalStart, TickNote, decode},
    replay::{Differs, JournalGap, ReplayError},
};
use nima_simulation::Worlds;
use nima_tests::plan;

use crate::bench::{JournalMessages, record, record_on, start_of};

/// A world whose measurements are occasionally corrupted.
struct Spoilt<F> {
    worlds: Worlds,
    spoil: F,
}

impl<F: FnMut(f64, &mut [Option<Inputs>; SIDES]) + Send> Rig for Spoilt<F> {
    fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
        let mut inputs = self.worlds.read(now_s);
        (self.spoil)(now_s, &mut inputs);
        inputs
    }

    fn write(&mut self, now_s: f64, outputs: &[Outputs; SIDES]) {
        self.worlds.write(now_s, outputs);
    }
}

#[test]
fn faults_are_replayed_with_their_causes() {
    type Spoil = fn(f64, &mut [Option<Inputs>; SIDES]);
    let spoils: [(&str, Spoil); 5] = [
        ("silent", |t_s, inputs| {
            if (2.0..2.1).contains(&t_s) {
                *inputs = [None; SIDES];
            }
        }),
        ("not a number", |t_s, inputs| {
            if let (true, Some(right)) = ((2.0..2.2).contains(&t_s), &mut inputs[0]) {
                right.tip_m.x = f64::NAN;
            }
        }),
        ("frozen", |t_s, inputs| {
            if let (true, Some(right)) = (t_s > 2.0, &mut inputs[0]) {
                right.sensed = SensedForce::AtTip(Vector3::new(0.1, 0.2, 1.3));
            }
        }),
        ("handle jumps", |t_s, inputs| {
            if let (true, Some(right)) = (t_s > 2.0, &mut inputs[0]) {
                right.hand.position_m.y += 0.1;
            }
        }),
        ("drives off", |t_s, inputs| {
            if let (true, Some(right)) = ((2.0..3.0).contains(&t_s), &mut inputs[0]) {
                right.powered = false;
            }
        }),
    ];
    for (name, spoil) in spoils {
        let plan = plan("bimanual");
        let worlds = Worlds::new(&plan.scene, plan.rig.rate_hz);
        let assembly = Assembly { rig: Box::new(Spoilt { worlds, spoil }), ..plan.simulated().unwrap() };
        let kept = record_on(&plan, assembly, 5.0, |tick| match tick.index {
            3500 => Some(Command::ReleaseStop),
            4000 => Some(Command::Engage),
            _ => None,
        });
        let mut faults = Vec::new();
        let outcome = kept
            .replayed(|tick| {
                if let LoopState::Faulted(fault) = tick.state {
                    faults.push(fault);
                }
            })
            .unwrap();
        assert_eq!((outcome.ticks, outcome.differs), (5000, None), "{name}");
        faults.dedup();
        assert!(faults.iter().any(|fault| *fault != Fault::OtherArm), "{name}: {faults:?}");
    }
}

/// An arm at rest with a wrist sensor that connects, disconnects and connects again.
struct AtWrist {
    t_s: f64,
    events: Vec<(f64, ConnectionState)>,
}

impl Rig for AtWrist {
    fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
        self.t_s = now_s;
        let force_n = Vector3::new(0.3 * now_s.sin(), 0.0, -0.4 * GRAVITY_M_S2 + 1e-3 * now_s);
        let sample = WristSample {
            acceleration_m_s2: Some(Vector3::new(1e-3 * now_s, 0.0, GRAVITY_M_S2)),
            world_from_s1: Some(UnitQuaternion::identity()),
            ..WristSample::of(Wrench { force_n, torque_nm: Vector3::zeros() })
        };
        let right = Inputs {
            hand: HandPose::at(Vector3::new(1e-6 * now_s, 0.0, 0.0)),
            tip_m: Vector3::new(0.0, 1e-7 * now_s, 0.0),
            sensed: SensedForce::AtWrist(sample),
            powered: true,
            ..Inputs::NOTHING
        };
        [Some(right), None]
    }

    fn write(&mut self, _: f64, _: &[Outputs; SIDES]) {}

    fn event(&mut self) -> Option<DeviceEvent> {
        let due = self.events.first().filter(|(at_s, _)| *at_s <= self.t_s)?;
        let event = DeviceEvent { t_s: self.t_s, device: 0, standing: due.1, of_side: [true, false] };
        self.events.remove(0);
        Some(event)
    }
}

fn calibrated(mass_kg: f64) -> Calibrations {
    let s1_from_source_wxyz = [1.0, 0.0, 0.0, 0.0];
    let parameters =
        GravityParameters::Physical { mass_kg, s1_from_source_wxyz, bias_n: [0.1, 0.2, 0.3], torque: None };
    Calibrations {
        gravity: Some(GravityModel { source: GravitySource::Imu, imu_sign: 1, parameters }),
        ..Calibrations::default()
    }
}

#[test]
fn calibrations_put_in_force_while_the_loop_runs_are_in_the_journal() {
    let mut plan = plan("peg_transfer");
    plan.engage = false;
    let roster = vec![RosterEntry::of(RigPart::Sensor(Side::Right), "", SlotView::default())];
    let lost = ConnectionState::Lost(Loss::Disconnected);
    let events = vec![(0.2, ConnectionState::Connected), (1.5, lost), (2.0, ConnectionState::Connected)];
    let rig = Box::new(AtWrist { t_s: 0.0, events });
    let (tap, end) = tap();
    let start = start_of(&plan);
    let reader = thread::spawn(move || JournalMessages::of(&start, &end));
    let assembly = Assembly {
        rig,
        roster,
        clock: RuntimeClock::Simulated { speed: 5.0 },
        scheduling: SchedulingClass::Ordinary,
        tap: Some(tap),
        ..plan.simulated().unwrap()
    };
    let handle = runtime::start(assembly).unwrap();
    let mut seen = None;
    let mut t_s = 0.0;
    let mut asked = false;
    let begin = Instant::now();
    while t_s < 3.5 && begin.elapsed() < Duration::from_mins(2) {
        let change = handle.wrist_change(Side::Right);
        if change.is_there() && seen != Some(change) {
            // Use a different mass each time.
            let mass_kg = if seen.is_none() { 0.4 } else { 0.39 };
            seen = handle.activate(change, &calibrated(mass_kg)).then_some(change);
        }
        handle.drain_ticks(|tick| t_s = tick.t_s);
        if t_s > 0.8 && !asked {
            asked = handle.send(Command::Engage);
        }
        thread::sleep(Duration::from_millis(5));
    }
    handle.stop_and_join().unwrap();
    let kept = reader.join().unwrap();
    let messages: Vec<_> = kept.0.iter().map(|bytes| decode(bytes).unwrap().1).collect();
    let calibrations = messages.iter().filter(|message| matches!(message, JournalMessage::Calibrations { .. })).count();
    assert!(calibrations >= 2, "{calibrations} calibrations in the journal");
    let mut sources = Vec::new();
    let mut states = Vec::new();
    let outcome = kept
        .replayed(|tick| {
            sources.push(tick.force.source);
            states.push(tick.state);
        })
        .unwrap();
    sources.dedup();
    states.dedup();
    assert_eq!((outcome.differs, outcome.hole, outcome.closed), (None, None, true));
    assert!(outcome.ticks > 3000, "{outcome:?}");
    let none = ForceSource::Unidentified;
    let wrist = ForceSource::Wrist;
    assert!(sources.ends_with(&[none, wrist, none, wrist]), "{sources:?}");
    let lost = LoopState::Faulted(Fault::DeviceLost { device: 0, loss: Loss::Disconnected });
    assert!(states.contains(&LoopState::Engaged) && states.contains(&lost), "{states:?}");
    // Without the calibrations the replay reports an error instead of continuing.
    let mut without = JournalMessages(kept.0.clone());
    without.0.retain(|bytes| !matches!(decode(bytes), Ok((_, JournalMessage::Calibrations { .. }))));
    assert!(matches!(without.replayed(|_| {}), Err(ReplayError::Missing { .. })));
}

#[test]
fn a_hole_is_told_and_nothing_behind_it_is_compared() {
    let plan = plan("peg_transfer");
    let mut control = plan.control().unwrap();
    let (mut tap, end) = tap();
    let reader = thread::spawn({
        let start = start_of(&plan);
        // Read too late for the capacity of the queue.
        move || {
            thread::sleep(Duration::from_millis(300));
            JournalMessages::of(&start, &end)
        }
    });
    for k in 0..10_000_u32 {
        let timing = Timing { now_s: f64::from(k) * 1e-3, ..Timing::default() };
        let (outputs, ticks) = control.step([None; SIDES], &timing);
        tap.tick(control.events(), &timing, &[None; SIDES], &outputs, &ticks);
        control.clear_events();
        if k == 6000 {
            thread::sleep(Duration::from_millis(600));
        }
    }
    drop(tap);
    let outcome = reader.join().unwrap().replayed(|_| {}).unwrap();
    let Some(JournalGap { tick, lost }) = outcome.hole else { panic!("{outcome:?}") };
    assert_eq!((outcome.ticks, outcome.differs), (tick, None));
    assert!((2000..3000).contains(&tick) && lost > 3000, "{outcome:?}");
}

/// Returns the same journal with a modification of the block with this number, including correct checksums.
fn forged(kept: &JournalMessages, which: usize, change: impl Fn(&mut JournalBlock)) -> JournalMessages {
    let mut encoder = JournalEncoder::default();
    let mut start = None::<JournalStart>;
    let mut blocks = Vec::new();
    for bytes in &kept.0 {
        match decode(bytes).unwrap().1 {
            JournalMessage::Start(report) => start = Some(report),
            JournalMessage::Block(block) => blocks.push(block),
            JournalMessage::Calibrations { .. } | JournalMessage::End(_) => {}
        }
    }
    let mut messages = vec![encoder.start(&start.unwrap()).unwrap()];
    change(&mut blocks[which]);
    let mut writer = BlockWriter::default();
    for block in &blocks {
        for (i, row) in block.rows.iter().enumerate() {
            let noted = block.noted.iter().filter(|(before, _)| *before == i);
            noted.for_each(|(_, noted)| writer.note(*noted));
            writer.tick(row);
        }
        messages.push(encoder.block(&mut writer));
    }
    JournalMessages(messages)
}

#[test]
fn a_changed_bit_of_an_input_is_found_at_its_tick_and_stage_even_with_right_checksums() {
    let kept = record(&plan("peg_transfer"), 5.0, |_| None);
    let same = forged(&kept, 12, |_| {}).replayed(|_| {}).unwrap();
    assert_eq!((same.ticks, same.differs, same.closed), (5000, None, false), "without the end it was not closed");
    let nudged = forged(&kept, 12, |block| {
        let Some(Inputs { sensed: SensedForce::AtTip(force_n), .. }) = &mut block.rows[34].inputs[0] else { panic!() };
        force_n.y = f64::from_bits(force_n.y.to_bits() ^ 1);
    });
    let Some(Differs { tick, place, .. }) = nudged.replayed(|_| {}).unwrap().differs else { panic!("not found") };
    assert_eq!((tick, place), (12 * 200 + 34, Some((Side::Right, TickStage::ForcePath))));
    let moved = forged(&kept, 12, |block| {
        let Some(Inputs { hand, .. }) = &mut block.rows[34].inputs[0] else { panic!() };
        hand.position_m.z += 1e-4;
    });
    let differs = moved.replayed(|_| {}).unwrap().differs.unwrap();
    assert_eq!(differs.tick, 12 * 200 + 34);
    assert_ne!(differs.place, Some((Side::Right, TickStage::ForcePath)), "the handle changes no measured force");
    let commanded = forged(&kept, 12, |block| {
        let operation = runtime::Operation::Command { command: Command::Stop, t_s: 2.4 };
        block.noted.push((34, TickNote::Operation(operation)));
    });
    assert_eq!(commanded.replayed(|_| {}).unwrap().differs.unwrap().tick, 12 * 200 + 34);
}
