//! Sensors with one defect each: the right line must report it, with cause and remedy.

use nalgebra::UnitQuaternion;

use super::*;
use crate::calibration::gravity::{GravitySessionSettings, tests::Tool};

const RATE_HZ: f64 = 1000.0;

/// Returns one and a half seconds of data from a still sensor, modified by `edit` (whose argument is the number of the
/// tick).
fn seen(
    settings: GravitySessionSettings,
    mut edit: impl FnMut(u32, &mut Tool, WristSample) -> Option<WristSample>,
) -> Precheck {
    let mut precheck = Precheck::new(settings);
    let mut tool = Tool::new(5, 0.4);
    for tick in 0..1500 {
        let mut sample = tool.sample(UnitQuaternion::from_euler_angles(0.3, 0.2, 0.1), 0.03, 1e-3);
        sample.acceleration_m_s2 = sample.acceleration_m_s2.map(|a| a + tool.vector(0.03));
        let sample = edit(tick, &mut tool, sample);
        precheck.step(sample.as_ref(), f64::from(tick) * 1e-3);
    }
    precheck
}

fn line(precheck: &Precheck, name: &str) -> PrecheckResult {
    precheck.checks(RATE_HZ).into_iter().find(|check| check.name == name).unwrap()
}

/// Asserts that the line of this name has failed, and that its cause and remedy contain these texts.
fn assert_bad(precheck: &Precheck, name: &str, in_cause: &str, in_cure: &str) {
    let CheckState::Bad { cause, cure } = line(precheck, name).state else {
        panic!("{name} is not bad: {:?}", precheck.checks(RATE_HZ));
    };
    assert!(cause.contains(in_cause) && cure.contains(in_cure), "{name}: {cause}; {cure}");
    assert!(!precheck.passed(RATE_HZ));
}

#[test]
fn a_good_sensor_passes_with_its_figures() {
    let precheck = seen(GravitySessionSettings::default(), |_, _, sample| Some(sample));
    assert!(precheck.passed(RATE_HZ), "{:?}", precheck.checks(RATE_HZ));
    assert!(line(&precheck, "rate").measured.starts_with("1000 Hz"), "{:?}", line(&precheck, "rate"));
    let figure = |name| line(&precheck, name).measured.split(' ').next().unwrap().parse::<f64>().unwrap();
    assert!((figure("force noise") - 0.03).abs() < 0.004, "{}", figure("force noise"));
    assert!((figure("accelerometer noise") - 0.03).abs() < 0.004, "{}", figure("accelerometer noise"));
    let fresh = Precheck::new(GravitySessionSettings::default());
    assert!(fresh.checks(RATE_HZ).iter().all(|check| check.state == CheckState::Waiting));
}

#[test]
fn a_sensor_that_is_silent_hangs_or_is_slow_is_told_apart() {
    let settings = GravitySessionSettings::default();
    assert_bad(&seen(settings, |_, _, _| None), "sensor", "no sample", "power");
    let mut first = None;
    let hung = seen(settings, move |_, _, sample| Some(*first.get_or_insert(sample)));
    assert_bad(&hung, "sensor", "same reading", "off and on");
    assert_bad(&hung, "rate", "0 Hz of the loop's 1000 Hz", "output rate");
    assert_eq!(line(&hung, "force noise").state, CheckState::Waiting, "nothing new, nothing reported");
    let mut held = None;
    let slow = seen(settings, move |tick, _, sample| {
        if tick % 2 == 0 {
            held = Some(sample);
        }
        held
    });
    assert_eq!(line(&slow, "sensor").state, CheckState::Good);
    assert_bad(&slow, "rate", "500 Hz of", "output rate");
}

#[test]
fn numbers_that_are_not_finite_are_counted() {
    let poisoned = seen(GravitySessionSettings::default(), |tick, _, mut sample| {
        if tick % 100 == 0 {
            sample.raw.force_n.y = f64::NAN;
        }
        Some(sample)
    });
    assert_bad(&poisoned, "sensor", "5 of 500 samples", "cable");
}

#[test]
fn noise_is_named_where_it_is_and_does_not_pass_as_motion() {
    let settings = GravitySessionSettings::default();
    let noisy = |size_n: f64| {
        seen(settings, move |_, tool, mut sample| {
            sample.raw.force_n += tool.vector(size_n);
            Some(sample)
        })
    };
    assert_bad(&noisy(0.15), "force noise", "0.15", "shield");
    // So much noise that the tool never seems still.
    assert_bad(&noisy(1.0), "force noise", "plausible", "shield");
    let shaken = seen(settings, |_, tool, mut sample| {
        sample.acceleration_m_s2 = sample.acceleration_m_s2.map(|a| a + tool.vector(0.3));
        Some(sample)
    });
    assert_bad(&shaken, "accelerometer noise", "0.3", "motors");
    assert_eq!(line(&shaken, "gravity").state, CheckState::Good);
}

#[test]
fn a_dead_axis_a_wrong_unit_and_a_missing_source_are_named() {
    let settings = GravitySessionSettings::default();
    let dead = seen(settings, |_, _, mut sample| {
        sample.raw.force_n.z = 17.0;
        Some(sample)
    });
    assert_bad(&dead, "force noise", "same value", "range");
    let in_g = seen(settings, |_, _, mut sample| {
        sample.acceleration_m_s2 = sample.acceleration_m_s2.map(|a| a * 0.2);
        Some(sample)
    });
    assert_bad(&in_g, "gravity", "1.96 m/s^2", "units");
    let without = |mut sample: WristSample| {
        sample.acceleration_m_s2 = None;
        Some(sample)
    };
    assert_bad(
        &seen(settings, |_, _, sample| without(sample)),
        "orientation",
        "accelerometer",
        "the arm's orientation",
    );
    let by_arm = seen(GravitySessionSettings { use_arm: true, ..settings }, |_, _, sample| without(sample));
    assert!(by_arm.passed(RATE_HZ), "{:?}", by_arm.checks(RATE_HZ));
    let lost = seen(GravitySessionSettings { use_arm: true, ..settings }, |_, _, mut sample| {
        sample.world_from_s1 = None;
        Some(sample)
    });
    assert_bad(&lost, "orientation", "arm", "connect");
}

#[test]
fn a_hand_on_the_tool_is_no_noise() {
    let swayed = seen(GravitySessionSettings::default(), |tick, _, mut sample| {
        sample.raw.force_n.x += 0.8 * (f64::from(tick) * 0.03).sin();
        Some(sample)
    });
    assert_bad(&swayed, "stillness", "is not still", "release the tool");
    assert_eq!(line(&swayed, "force noise").state, CheckState::Waiting);
    assert_eq!(line(&swayed, "sensor").state, CheckState::Good);
}

#[test]
fn ticks_that_did_not_reach_the_screen_are_no_slow_sensor() {
    let mut precheck = Precheck::new(GravitySessionSettings::default());
    let mut tool = Tool::new(6, 0.4);
    for tick in 0..3000 {
        let sample = tool.sample(UnitQuaternion::identity(), 0.03, 1e-3);
        // A display that drops 100 ms out of every 300.
        if tick % 300 < 200 {
            precheck.step(Some(&sample), f64::from(tick) * 1e-3);
        }
    }
    assert_eq!(line(&precheck, "rate").state, CheckState::Good, "{:?}", line(&precheck, "rate"));
}
