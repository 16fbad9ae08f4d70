//! A tick allocates nothing: identification and rendering, the whole loop, the simulation.

use nalgebra::Vector3;
use nima_core::{
    impedance::{
        DegreeChoice, Identifier, ImpedanceSettings, IncrementReading, Mode, ModeSet, Recipe, Renderer, Sample,
    },
    signal::DifferentiatorKind,
};
use nima_machine::{
    config::RigConfig,
    messages::Command,
    rig::Rig as _,
    runtime::{TICKS_TAPPED_MAX, TapPayload, tap},
    teleop::{Calibrations, Loop, Timing},
};
use nima_simulation::{Worlds, scene::Scene};
use nima_testing::real_time::alone;

use crate::counting::calls;

fn sample(k: u32) -> Sample {
    let t = f64::from(k) * 1e-3;
    let position_m = Vector3::new((5.0 * t).sin(), (4.0 * t).cos(), (3.0 * t).sin()) * 0.02;
    let mut sample = Sample { t_s: t, position_m, force_n: position_m * 80.0 };
    match k % 500 {
        100 => sample.position_m.y = f64::NAN,
        200 => sample.force_n.z = f64::INFINITY,
        300 => sample.t_s = -1.0,
        _ => {}
    }
    sample
}

/// Runs three seconds of both ends: the delay changes, modes are disabled and enabled, and everything is reset.
#[expect(clippy::unwrap_used, reason = "a test fails by panicking")]
fn run_both_ends(settings: &ImpedanceSettings, words: &str) {
    let mut identifier = Identifier::new(settings).unwrap();
    let mut renderer = Renderer::new(settings).unwrap();
    let before = calls();
    for k in 0..3000 {
        let sample = sample(k);
        identifier.step(&sample);
        renderer.step(&sample.position_m, Some(identifier.parcel()));
        match k {
            1000 => {
                identifier.set_delay(0.3);
                renderer.set_delay(0.3);
            }
            1400 => identifier.compute(ModeSet::only(Mode::Dfr)),
            1700 => identifier.compute(settings.modes),
            2000 => {
                identifier.reset();
                renderer.reset();
            }
            _ => {}
        }
    }
    assert_eq!(calls() - before, 0, "{words}");
}

#[test]
fn identification_and_rendering_allocate_nothing() {
    let _alone = alone();
    let every_key =
        Recipe { reading: IncrementReading::Displacement, choice: DegreeChoice::Next, constant: true, ridge: 3e-3 };
    for differentiator in DifferentiatorKind::ALL {
        for (cross_talk, literal) in [(false, Recipe::default()), (true, every_key)] {
            let modes = ModeSet::ALL;
            let delay_s = 0.05;
            let settings = ImpedanceSettings {
                differentiator,
                cross_talk,
                literal,
                modes,
                delay_s,
                ..ImpedanceSettings::default()
            };
            run_both_ends(&settings, &format!("{differentiator:?}, cross-talk {cross_talk}"));
        }
    }
    let before = calls();
    drop(std::hint::black_box(vec![1_u8; 10]));
    assert_eq!(calls() - before, 2, "the counter counts");
}

#[test]
fn baselines_allocate_nothing() {
    let _alone = alone();
    nima_baselines::provide();
    for mode in Mode::BASELINES {
        let settings = ImpedanceSettings { modes: ModeSet::only(mode), delay_s: 0.05, ..ImpedanceSettings::default() };
        run_both_ends(&settings, mode.name());
    }
}

#[test]
fn a_tick_of_the_whole_loop_and_of_the_simulation_allocates_nothing() {
    let _alone = alone();
    let rig = RigConfig::load("simulated").unwrap();
    let mut control = Loop::new(&rig, &[Some(Calibrations::default()), Some(Calibrations::default())]).unwrap();
    let mut world = Worlds::new(&Scene::load("bimanual").unwrap(), rig.rate_hz);
    // The other end of the tap is read for a while, then neglected, then dropped: none of this may cause an allocation
    // in a tick.
    let (mut tap, end) = tap();
    let mut end = Some(end);
    control.obey(Command::Engage, 0.0);
    let mut before = calls();
    for k in 0..10_000_u32 {
        let now_s = f64::from(k) * 1e-3;
        control.clear_events();
        match k {
            3000 => control.obey(Command::SetDelay(0.3), now_s),
            4000 => control.obey(Command::SetMode(Mode::Literal), now_s),
            5000 => control.obey(Command::Stop, now_s),
            5500 => control.obey(Command::ReleaseStop, now_s),
            6000 => control.obey(Command::Engage, now_s),
            _ => {}
        }
        // Drop samples at intervals, and at the end for long enough to cause a fault.
        let inputs = world.read(now_s).map(|inputs| inputs.filter(|_| k % 1000 > 5 && k < 9000));
        let timing = Timing { now_s, ..Timing::default() };
        let (outputs, ticks) = control.step(inputs, &timing);
        world.write(now_s, &outputs);
        tap.tick(control.events(), &timing, &inputs, &outputs, &ticks);
        if k == 9000 {
            let end = end.take().unwrap();
            assert!(end.entries.waiting() >= TICKS_TAPPED_MAX, "it was full");
            assert!(end.offered() > 9000, "{} were offered", end.offered());
            let freed = calls();
            drop(end);
            before += calls() - freed;
        }
        if let Some(end) = end.as_ref().filter(|_| k < 4000) {
            for entry in end.entries.try_iter() {
                if let TapPayload::Stepped(stepped) = entry.passed {
                    end.give_back(stepped);
                }
            }
        }
    }
    assert_eq!(calls() - before, 0);
}

/// Returns how often the calling thread has given up its processor by itself: it waited, slept or found a lock taken.
#[cfg(target_os = "linux")]
fn waits() -> u64 {
    let status = std::fs::read_to_string("/proc/thread-self/status").unwrap();
    let count = status.lines().find_map(|line| line.strip_prefix("voluntary_ctxt_switches:")).unwrap();
    count.trim().parse().unwrap()
}

#[cfg(target_os = "linux")]
#[test]
fn a_tick_of_the_whole_loop_never_waits() {
    let _alone = alone();
    let rig = RigConfig::load("simulated").unwrap();
    let mut control = Loop::new(&rig, &[Some(Calibrations::default()), Some(Calibrations::default())]).unwrap();
    let mut world = Worlds::new(&Scene::load("bimanual").unwrap(), rig.rate_hz);
    let (mut tap, end) = tap();
    // The other end reads at the same time, and disturbs the loop as much as it can.
    let reader = std::thread::spawn(move || {
        loop {
            match end.entries.try_recv() {
                Some(entry) => {
                    if let TapPayload::Stepped(stepped) = entry.passed {
                        end.give_back(stepped);
                    }
                }
                None if end.entries.has_ended() => return,
                None => std::thread::yield_now(),
            }
        }
    });
    control.obey(Command::Engage, 0.0);
    let mut waited = 0;
    for k in 0..5000_u32 {
        let now_s = f64::from(k) * 1e-3;
        let before = waits();
        control.clear_events();
        let inputs = world.read(now_s);
        let timing = Timing { now_s, ..Timing::default() };
        let (outputs, ticks) = control.step(inputs, &timing);
        world.write(now_s, &outputs);
        tap.tick(control.events(), &timing, &inputs, &outputs, &ticks);
        waited += waits() - before;
    }
    assert_eq!(waited, 0);
    let before = waits();
    std::thread::sleep(std::time::Duration::from_millis(1));
    assert!(waits() > before, "the counter counts");
    drop(tap);
    reader.join().unwrap();
}
