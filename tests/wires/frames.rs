//! Frame calibrations over the emulated interfaces: the drivers' readings in the ticks, compared with the emulators'
//! true state.
use std::time::Duration;

use nalgebra::{Isometry3, Point3, Vector3};
use nima_core::{
    calibration::{
        Verdict,
        frames::{Calibration, FrameReport, FrameSession, HandEyeSettings, TipSettings, TrocarSettings},
    },
    kinematics::Arm,
};
use nima_machine::rig::{Prompt, Side};
use nima_simulation::screen::PersonTask;
use nima_testing::real_time::{alone, judged};
use nima_tests::emulated::{elsewhere, started};

use super::technician::Fixture;

const SIDE: Side = Side::Right;

/// Lets the technician work until no data are missing; if the machine is too busy, the test is not judged.
fn run<C: Calibration>(
    bench: &mut Fixture,
    calibration: C,
    task: PersonTask,
    prompt: Prompt,
) -> FrameReport<C::Solution> {
    let mut session = FrameSession::new(calibration);
    // The technician carries the arm to the start.
    bench.show(SIDE, task, Prompt::Rest);
    bench.rests(SIDE);
    bench.show(SIDE, task, prompt);
    let complete = bench.until(SIDE, Duration::from_secs(150), |_, tick| {
        if tick.index % 4 == 0 {
            session.step(&tick.calibration.frames, tick.t_s);
        }
        session.coverage().fraction >= 1.0
    });
    assert!(complete, "{task:?}: {:?} after {} poses", session.coverage(), session.samples().len());
    let report = session.report().unwrap();
    println!("{task:?}: {} poses, held out {:?}", report.poses, report.held_out);
    assert_eq!(report.verdict, Verdict::Accepted, "{task:?}: {:?}", report.cause);
    report
}

fn pose(isometry: &nalgebra::IsometryMatrix3<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(isometry.translation, isometry.rotation.into())
}

/// Determines the poses of the tracker and the marker by rotating an instrument whose tip is known.
fn find_hand_eye(bench: &mut Fixture, arm: &Arm, tip_m: Vector3<f64>) {
    let found = run(bench, HandEyeSettings::new(tip_m), PersonTask::HandEye, Prompt::Turn).found.unwrap();
    let known = bench.rig.truth(SIDE).unwrap();
    let flange = arm.pose(&known.joint_rad.into()).chain.world_from_flange;
    let base_from_world = pose(arm.world_from_base()).inverse();
    let base_from_flange = base_from_world * pose(&flange);
    let flange_from_m = pose(arm.flange_from_s1()) * known.s1_from_m;
    let c_from_m = (base_from_world * known.world_from_c).inverse() * base_from_flange * flange_from_m;
    let seen = found.base_from_c.pose() * c_from_m * found.flange_from_m.pose().inverse();
    let tip = Point3::from(true_tip_m(arm));
    let miss_mm = (seen * tip - base_from_flange * tip).norm() * 1e3;
    let miss_deg = seen.rotation.angle_to(&base_from_flange.rotation).to_degrees();
    println!("hand-eye: {miss_mm:.3} mm, {miss_deg:.3} degrees off at the tip");
    assert!(miss_mm <= 0.5 && miss_deg <= 0.1, "{miss_mm} mm, {miss_deg} degrees");
}

/// In the flange's frame.
fn true_tip_m(arm: &Arm) -> Vector3<f64> {
    (arm.flange_from_s1() * Point3::new(0.0, 0.0, arm.shaft_m())).coords
}

#[test]
#[ignore = "two minutes in real time: `./dev walk` runs it"]
fn tip_hand_eye_and_trocar_are_found_within_half_a_millimetre() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let truth = elsewhere(folder.path());
    let set = truth.arm(SIDE).unwrap();
    let arm = Arm::new(&set.mount).unwrap();
    // The loop's rig file is wrong about the tip and about the trocar, and lacks the tracker's pose.
    let mut believed = truth.clone();
    let wrong = believed.right.as_mut().unwrap();
    wrong.mount.shaft_m += 0.006;
    wrong.mount.sensor_m.x += 0.003;
    wrong.rcm.trocar_m.y += 0.004;
    judged(|| {
        let mut bench = Fixture::start(started(&truth), &believed);
        let tip = run(&mut bench, TipSettings::by_arm(), PersonTask::Tip, Prompt::PivotInDimple);
        let tip_m = Vector3::from(tip.found.unwrap().tip_in_carrier_m);
        let miss_mm = (tip_m - true_tip_m(&arm)).norm() * 1e3;
        println!("tip: {miss_mm:.3} mm off");
        assert!(miss_mm <= 0.5, "{miss_mm} mm");

        find_hand_eye(&mut bench, &arm, tip_m);

        // With the instrument in its trocar again.
        bench.show(SIDE, PersonTask::Surgery, Prompt::Rest);
        bench.rests(SIDE);
        let trocar =
            run(&mut bench, TrocarSettings::by_arm(&arm), PersonTask::Trocar, Prompt::PivotInTrocar).found.unwrap();
        let base_from_world = pose(arm.world_from_base()).inverse();
        let true_m = base_from_world * Point3::from(set.rcm.trocar_m);
        let miss_mm = (Vector3::from(trocar.trocar_m) - true_m.coords).norm() * 1e3;
        println!("trocar: {miss_mm:.3} mm off");
        assert!(miss_mm <= 0.5, "{miss_mm} mm");
    });
}
