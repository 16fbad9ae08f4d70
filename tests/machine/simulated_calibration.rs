//! Calibrations from the simulated experiments, sample by sample, as a technician would record them.
use nalgebra::{UnitVector3, Vector3};
use nima_core::{
    calibration::{
        Verdict,
        correspondence::{self, CorrespondenceReport, CorrespondenceSession},
        gravity::{
            CheckPass, Compensator, DEFAULT_TIME_CONSTANT_S, DriftCheck, GravityDrift, GravityModel, GravityPhase,
            GravitySession, GravitySessionSettings, NotChecked, Precheck, StillSettings, TARGETS,
        },
    },
    frames::{WristSample, from_roll_pitch_yaw_deg},
};
use nima_machine::rig::{Outputs, Prompt, SensedForce};
use nima_simulation::{
    World,
    scene::{Flaw, Scene},
};

struct Fixture {
    world: World,
    t_s: f64,
}

impl Fixture {
    fn new(scene: &Scene) -> Self {
        Self { world: World::new(scene, 1000.0), t_s: 0.0 }
    }

    fn sample(&mut self, prompt: Prompt) -> WristSample {
        self.t_s += 1e-3;
        match self.world.exchange(self.t_s, &Outputs { prompt, ..Outputs::SAFE }).unwrap().sensed {
            SensedForce::AtWrist(sample) => sample,
            sensed => panic!("a calibration scene without a wrist: {sensed:?}"),
        }
    }
}

/// Follows the session's targets for at most `seconds`; returns the phases that occurred.
fn follow(bench: &mut Fixture, session: &mut GravitySession, seconds: f64) -> Vec<GravityPhase> {
    let mut seen: Vec<GravityPhase> = Vec::new();
    for _ in 0..(seconds * 1e3) as u32 {
        let Some(target) = session.target() else { break };
        let sample = bench.sample(Prompt::Hold { world_from_s1: target.world_from_s1() });
        let phase = session.step(&sample, bench.t_s);
        if !seen.iter().any(|old| std::mem::discriminant(old) == std::mem::discriminant(&phase)) {
            seen.push(phase);
        }
    }
    seen
}

fn calibrate(scene: &Scene) -> (Fixture, GravitySession) {
    let mut bench = Fixture::new(scene);
    let mut session = GravitySession::new(GravitySessionSettings::default());
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
    let mut session = GravitySession::new(GravitySessionSettings::default());
    let seen = follow(&mut Fixture::new(&flawed(Flaw::Touches)), &mut session, 90.0);
    let reported = seen.iter().any(|phase| matches!(phase, GravityPhase::Disturbed | GravityPhase::Touched { .. }));
    let refused = session.report().map_or(true, |report| report.verdict != Verdict::Accepted);
    assert!(reported && refused, "{seen:?} {:?}", session.report());
}

#[test]
fn a_trembling_tool_gives_no_pose_and_one_orientation_gives_one() {
    let mut session = GravitySession::new(GravitySessionSettings::default());
    follow(&mut Fixture::new(&flawed(Flaw::Trembles)), &mut session, 20.0);
    assert_eq!(session.poses().len(), 0);
    let seen = follow(&mut Fixture::new(&flawed(Flaw::KeepsOneOrientation)), &mut session, 20.0);
    assert_eq!(session.poses().len(), 1);
    assert!(seen.contains(&GravityPhase::TakenHere));
}

#[test]
fn an_accelerometer_that_reads_the_other_way_is_named() {
    let mut scene = Scene::load("gravity").unwrap();
    scene.wrist.as_mut().unwrap().imu.as_mut().unwrap().reads_gravity = true;
    let (_, mut session) = calibrate(&scene);
    let report = session.report().unwrap();
    assert_eq!(report.verdict, Verdict::PoorData);
    assert!(report.reason.contains("sign"), "{}", report.reason);
    session.set_imu_sign(-1);
    let cured = session.report().unwrap();
    assert_eq!(cured.verdict, Verdict::Accepted, "the poses taken serve with the other sign: {}", cured.reason);
}

#[test]
fn without_an_accelerometer_the_arm_gives_the_orientation() {
    let mut scene = Scene::load("gravity").unwrap();
    scene.wrist.as_mut().unwrap().imu = None;
    let mut session =
        GravitySession::new(GravitySessionSettings { use_arm: true, ..GravitySessionSettings::default() });
    follow(&mut Fixture::new(&scene), &mut session, 90.0);
    assert_eq!(session.report().unwrap().verdict, Verdict::Accepted, "{}", session.report().unwrap().reason);
}

/// Returns the result of the drift check after `seconds` in this scene, with this instruction, idle or not.
fn drift(session: &GravitySession, scene: &Scene, prompt: Prompt, idle: bool, seconds: f64) -> GravityDrift {
    let record = session.report().unwrap().record("S", "T", "2026-01-31T12:00:00Z").unwrap();
    let mut bench = Fixture::new(scene);
    let mut check = DriftCheck::new(record.model, record.drift_limit_n(), StillSettings::default());
    for _ in 0..(seconds * 1e3) as u32 {
        let sample = bench.sample(prompt);
        check.step(Some(&sample), idle, bench.t_s);
    }
    check.drift()
}

#[test]
fn a_bias_that_moved_is_noticed_at_the_start_and_one_that_did_not_is_fine() {
    let mut scene = Scene::load("gravity").unwrap();
    let (_, session) = calibrate(&scene);
    let at_rest = |scene: &Scene, seconds| drift(&session, scene, Prompt::Rest, true, seconds);
    assert_eq!(at_rest(&scene, 1.5), GravityDrift::Waiting, "not before the sensor has settled");
    assert!(matches!(at_rest(&scene, 4.0), GravityDrift::Fine { by_n } if by_n < 0.05), "{:?}", at_rest(&scene, 4.0));
    for (axis, step_n) in [(0, 0.4), (1, -0.4), (2, 0.25)] {
        let mut moved = scene.clone();
        moved.wrist.as_mut().unwrap().force_bias_n[axis] += step_n;
        let found = at_rest(&moved, 6.0);
        assert!(matches!(found, GravityDrift::Moved { by_n } if (by_n - f64::abs(step_n)).abs() < 0.05), "{found:?}");
    }
    scene.wrist.as_mut().unwrap().force_bias_n.x += 0.03;
    assert!(
        matches!(at_rest(&scene, 4.0), GravityDrift::Fine { .. }),
        "a step within the noise of the model does not count as drift"
    );
}

#[test]
fn a_tool_that_moves_or_is_touched_or_used_is_not_checked() {
    let scene = Scene::load("gravity").unwrap();
    let (_, session) = calibrate(&scene);
    let not_checked = |scene: &Scene, prompt, idle, seconds| match drift(&session, scene, prompt, idle, seconds) {
        GravityDrift::NotChecked(why) => why,
        other => panic!("{other:?}"),
    };
    assert_eq!(not_checked(&scene, Prompt::Wave, true, 9.0), NotChecked::Moving);
    let hold = Prompt::Hold { world_from_s1: TARGETS[0].world_from_s1() };
    assert_eq!(not_checked(&flawed(Flaw::Touches), hold, true, 12.0), NotChecked::Touched);
    assert_eq!(not_checked(&scene, Prompt::Rest, false, 4.0), NotChecked::Engaged);
    let in_the_body = Scene::load("palpation").unwrap();
    assert_eq!(not_checked(&in_the_body, Prompt::Rest, true, 4.0), NotChecked::InTrocar);
}

#[test]
fn a_hand_taken_off_the_tool_takes_the_bad_verdict_back() {
    let scene = Scene::load("gravity").unwrap();
    let (_, session) = calibrate(&scene);
    let mut bench = Fixture::new(&scene);
    let mut check = DriftCheck::new(model_of(&session), 0.15, StillSettings::default());
    let mut run = |push_n: f64, silent: bool, seconds: f64| {
        for _ in 0..(seconds * 1e3) as u32 {
            let mut sample = bench.sample(Prompt::Rest);
            sample.raw.force_n.y += push_n;
            check.step(Some(&sample).filter(|_| !silent), true, bench.t_s);
        }
        check.drift()
    };
    assert_eq!(run(0.0, true, 8.0), GravityDrift::NotChecked(NotChecked::NoSample));
    let sample = Fixture::new(&scene).sample(Prompt::Rest);
    let mut hung = DriftCheck::new(model_of(&session), 0.15, StillSettings::default());
    (0..8000).for_each(|tick| _ = hung.step(Some(&sample), true, f64::from(tick) * 1e-3));
    assert_eq!(hung.drift(), GravityDrift::NotChecked(NotChecked::NoSample), "a reading that hangs is not still");
    assert!(matches!(run(0.6, false, 4.0), GravityDrift::Moved { by_n } if by_n > 0.5));
    assert!(matches!(run(0.0, true, 1.0), GravityDrift::Moved { .. }), "silence takes no verdict back");
    assert!(matches!(run(0.0, false, 3.0), GravityDrift::Fine { .. }));
    assert!(matches!(run(0.6, false, 4.0), GravityDrift::Fine { .. }), "one good verdict is enough for a start");
}

/// Returns the root mean square per axis of the remaining force without contact, N.
fn left_n(model: GravityModel, time_constant_s: f64, samples: &[WristSample]) -> f64 {
    let mut compensator = Compensator::new(model, time_constant_s, 1e-3);
    let squares: f64 = samples.iter().map(|s| compensator.step(s).unwrap().force_n.norm_squared()).sum();
    (squares / (3 * samples.len()) as f64).sqrt()
}

#[test]
fn the_low_pass_of_the_accelerometer_leaves_less_of_the_force_still_and_in_motion() {
    let (mut bench, session) = calibrate(&Scene::load("gravity").unwrap());
    let mut take = |prompt, seconds: f64| -> Vec<WristSample> {
        (0..(seconds * 1e3) as u32).map(|_| bench.sample(prompt)).collect()
    };
    for (what, prompt) in [("still", Prompt::Rest), ("in motion", Prompt::Wave)] {
        take(prompt, 3.0);
        let samples = take(prompt, 15.0);
        let left = [0.0, 0.001, DEFAULT_TIME_CONSTANT_S, 0.005, 0.02].map(|s| left_n(model_of(&session), s, &samples));
        println!("{what}: {left:.5?} N without, at 1, 2, 5 and 20 ms");
        assert!(left[2] < left[0], "{what}: {left:?}");
    }
}

#[test]
fn the_simulated_sensor_passes_the_check_before_the_first_pose_and_worse_ones_do_not() {
    let checked = |edit: fn(&mut Scene)| {
        let mut scene = Scene::load("gravity").unwrap();
        edit(&mut scene);
        let mut bench = Fixture::new(&scene);
        let mut precheck = Precheck::new(GravitySessionSettings::default());
        for _ in 0..2000 {
            let sample = bench.sample(Prompt::Rest);
            precheck.step(Some(&sample), bench.t_s);
        }
        precheck
    };
    let good = checked(|_| {});
    assert!(good.passed(1000.0), "{:?}", good.checks(1000.0));
    assert!(!good.passed(2000.0), "half of the rate that the loop needs");
    assert!(!checked(|scene| scene.wrist.as_mut().unwrap().force_noise_n = 0.2).passed(1000.0));
    assert!(!checked(|scene| scene.wrist.as_mut().unwrap().imu = None).passed(1000.0));
}

/// Pushes as the session requests until `pushes` are recorded or `seconds` are over; gravity is calibrated in its own
/// scene.
fn push(flaw: Option<Flaw>, pushes: usize, seconds: f64) -> CorrespondenceSession {
    let gravity = model_of(&calibrate(&Scene::load("gravity").unwrap()).1);
    let mut gravity = Compensator::new(gravity, DEFAULT_TIME_CONSTANT_S, 1e-3);
    let mut scene = Scene::load("correspondence").unwrap();
    scene.person.as_mut().unwrap().flaw = flaw;
    let mut bench = Fixture::new(&scene);
    let mut session = CorrespondenceSession::new(correspondence::CorrespondenceSessionSettings::default());
    let mut prompt = Prompt::Rest;
    for _ in 0..(seconds * 1e3) as u32 {
        let sample = bench.sample(prompt);
        let f1_n = gravity.step(&sample).map(|wrench| wrench.force_n);
        let phase = session.step(f1_n, &sample, bench.t_s);
        if session.pushes() == pushes {
            break;
        }
        if !matches!(
            phase,
            correspondence::CorrespondencePhase::Resting { .. } | correspondence::CorrespondencePhase::Missing(_)
        ) {
            let all = correspondence::TARGETS;
            let target = session.target().unwrap_or(all[session.pushes() % all.len()]);
            prompt = Prompt::Push { direction: UnitVector3::new_normalize(target.push_in_world) };
        }
    }
    session
}

fn pushed(flaw: Flaw) -> CorrespondenceReport {
    let session = push(Some(flaw), 18, 60.0);
    assert_eq!(session.pushes(), 18, "{:?}", session.phase());
    session.report().unwrap()
}

#[test]
fn a_person_who_pushes_as_asked_finds_the_rotation_of_the_sensor_under_the_tissue() {
    let session = push(None, 9, 40.0);
    assert!(session.target().is_none(), "nine pushes as asked for meet all directions: {:?}", session.target());
    let report = session.report().unwrap();
    assert_eq!(report.verdict, Verdict::Accepted, "{}", report.reason);
    let sensor = Scene::load("correspondence").unwrap().tissue_sensor.unwrap();
    let c_from_s2 = from_roll_pitch_yaw_deg(&sensor.world_from_c_deg).inverse()
        * from_roll_pitch_yaw_deg(&sensor.world_from_s2_deg);
    let solution = report.solution.unwrap();
    let off_deg = solution.rotation().angle_to(&c_from_s2).to_degrees();
    println!("{off_deg:.3} deg off, told {:.3} deg; {:?}", solution.uncertainty_deg, solution.agreement);
    assert!(off_deg < 0.5, "{off_deg} degrees off, told {}", solution.uncertainty_deg);
}

#[test]
fn pushes_along_a_line_or_in_a_plane_are_called_so() {
    for (flaw, words) in [(Flaw::PushesOneLine, "one line"), (Flaw::PushesOnePlane, "one plane")] {
        let report = pushed(flaw);
        assert_eq!(report.verdict, Verdict::InsufficientMotion, "{flaw:?}: {}", report.reason);
        assert!(report.reason.contains(words), "{flaw:?}: {}", report.reason);
    }
}

#[test]
fn somebody_who_leans_on_the_stand_is_not_accepted() {
    let report = pushed(Flaw::LeansOnTheStand);
    assert_ne!(report.verdict, Verdict::Accepted, "{}", report.reason);
    assert!(
        report.reason.contains("contradict") || report.reason.contains("error on held-out pushes"),
        "{}",
        report.reason
    );
}
