//! Calibrations taken from the simulated experiments, sample by sample, as a technician would take them.
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use nalgebra::Vector3;
use nima::{
    calibration::{
        Verdict,
        gravity::{
            CheckPass, Compensator, DEFAULT_TIME_CONSTANT_S, Drift, DriftCheck, GravityModel, GravitySession, Phase,
            SessionSettings, StillSettings, TARGETS,
        },
    },
    config::{Flaw, Scene},
    device::{Outputs, Prompt, Rig as _, Sensed},
    frames::WristSample,
    sim::World,
};

/// A simulated rig and its time.
struct Bench {
    world: World,
    t_s: f64,
}

impl Bench {
    fn new(scene: &Scene) -> Self {
        Self { world: World::new(scene, 1000.0), t_s: 0.0 }
    }

    fn sample(&mut self, prompt: Prompt) -> WristSample {
        self.t_s += 1e-3;
        match self.world.exchange(self.t_s, &Outputs { prompt, ..Outputs::SAFE }).unwrap().sensed {
            Sensed::AtWrist(sample) => sample,
            Sensed::AtTip(force_n) => panic!("a calibration scene without a wrist: {force_n}"),
        }
    }
}

/// Follows the session's targets for at most `seconds`; tells the phases that were seen.
fn follow(bench: &mut Bench, session: &mut GravitySession, seconds: f64) -> Vec<Phase> {
    let mut seen: Vec<Phase> = Vec::new();
    for _ in 0..(seconds * 1e3) as u32 {
        let Some(target) = session.target() else { break };
        let sample = bench.sample(Prompt::Hold { kbf_from_s1: target.kbf_from_s1() });
        let phase = session.step(&sample, bench.t_s);
        if !seen.iter().any(|old| std::mem::discriminant(old) == std::mem::discriminant(&phase)) {
            seen.push(phase);
        }
    }
    seen
}

fn calibrate(scene: &Scene) -> (Bench, GravitySession) {
    let (mut bench, mut session) = (Bench::new(scene), GravitySession::new(SessionSettings::default()));
    follow(&mut bench, &mut session, 90.0);
    (bench, session)
}

fn flawed(flaw: Flaw) -> Scene {
    let mut scene = Scene::load("gravity").unwrap();
    scene.person.as_mut().unwrap().flaw = Some(flaw);
    scene
}

fn model_of(session: &GravitySession) -> GravityModel {
    session.report().unwrap().chosen_fit().unwrap().model
}

#[test]
fn a_followed_guide_ends_in_an_accepted_calibration_that_proves_itself() {
    let scene = Scene::load("gravity").unwrap();
    let (mut bench, session) = calibrate(&scene);
    assert_eq!(session.targets_met(), TARGETS.len());
    let report = session.report().unwrap();
    assert_eq!(report.verdict, Verdict::Accepted, "{}", report.reason);
    let wrist = scene.wrist.unwrap();
    assert!((report.mass_kg.unwrap() - wrist.tool_mass_kg).abs() < 0.004, "{:?}", report.mass_kg);
    let com = Vector3::from(report.com_m.unwrap()) - wrist.com_m;
    assert!(com.norm() < 1.5e-3, "{com}");
    let mut pass = CheckPass::new(Compensator::new(model_of(&session), DEFAULT_TIME_CONSTANT_S, 1e-3), 0.25);
    for _ in 0..12_000 {
        pass.step(&bench.sample(Prompt::Wave));
    }
    assert!(pass.result().passed, "{:?}", pass.result());
}

#[test]
fn a_hand_on_the_tool_is_noticed() {
    let mut session = GravitySession::new(SessionSettings::default());
    let seen = follow(&mut Bench::new(&flawed(Flaw::Touches)), &mut session, 90.0);
    let told = seen.iter().any(|phase| matches!(phase, Phase::Disturbed | Phase::Touched { .. }));
    let refused = session.report().map_or(true, |report| report.verdict != Verdict::Accepted);
    assert!(told && refused, "{seen:?} {:?}", session.report());
}

#[test]
fn a_trembling_tool_gives_no_pose_and_one_orientation_gives_one() {
    let mut session = GravitySession::new(SessionSettings::default());
    follow(&mut Bench::new(&flawed(Flaw::Trembles)), &mut session, 20.0);
    assert_eq!(session.poses().len(), 0);
    let seen = follow(&mut Bench::new(&flawed(Flaw::KeepsOneOrientation)), &mut session, 20.0);
    assert_eq!(session.poses().len(), 1);
    assert!(seen.contains(&Phase::TakenHere));
}

#[test]
fn an_accelerometer_that_reads_the_other_way_is_named() {
    let mut scene = Scene::load("gravity").unwrap();
    scene.wrist.as_mut().unwrap().imu.as_mut().unwrap().reads_gravity = true;
    let (_, session) = calibrate(&scene);
    let report = session.report().unwrap();
    assert_eq!(report.verdict, Verdict::PoorData);
    assert!(report.reason.contains("sign"), "{}", report.reason);
}

#[test]
fn without_an_accelerometer_the_arm_serves() {
    let mut scene = Scene::load("gravity").unwrap();
    scene.wrist.as_mut().unwrap().imu = None;
    let mut session = GravitySession::new(SessionSettings { use_arm: true, ..SessionSettings::default() });
    follow(&mut Bench::new(&scene), &mut session, 90.0);
    assert_eq!(session.report().unwrap().verdict, Verdict::Accepted, "{}", session.report().unwrap().reason);
}

#[test]
fn a_drifted_sensor_is_noticed_at_the_start() {
    let mut scene = Scene::load("gravity").unwrap();
    let (_, session) = calibrate(&scene);
    let drift = |scene: &Scene| {
        let mut bench = Bench::new(scene);
        let mut check = DriftCheck::new(model_of(&session), 0.15, StillSettings::default());
        let mut last = Drift::NoSample;
        for _ in 0..3000 {
            let sample = bench.sample(Prompt::Rest);
            last = check.step(&sample, bench.t_s);
        }
        last
    };
    assert!(matches!(drift(&scene), Drift::Ok { .. }), "{:?}", drift(&scene));
    scene.wrist.as_mut().unwrap().force_bias_n.x += 0.4;
    assert!(matches!(drift(&scene), Drift::Drifted { by_n } if by_n > 0.3));
}
