//! The technician performs the frame calibrations in virtual time: the sessions get joints, marker, handle and force in
//! the form of the drivers.

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use nima_core::{
    calibration::{
        Verdict,
        frames::{
            Calibration, FrameReport, FrameSample, FrameSession, HandEyeSettings, SensorMount, TableSettings,
            TipSettings, TrocarSettings, ViewSettings,
        },
        gravity::{PoseTarget, TARGETS},
    },
    kinematics::{Arm, view_from_omega},
};
use nima_devices::TrackedTool;
use nima_machine::{
    config::RigConfig,
    rig::{ArmSet, Flaws, Prompt, Side},
};
use nima_simulation::{
    scene::{Flaw, PersonModel, Scene},
    screen::PersonTask,
};

use super::{HandFrame, SideWorld, of_side};
use crate::emulators::{force_dimension::MotorOutput, kinova::BodyCommand};

struct Fixture {
    world: SideWorld,
    arm: Arm,
    set: ArmSet,
    hand: HandFrame,
    t_s: f64,
    frame_s: f64,
    c_from_m: Option<Isometry3<f64>>,
}

impl Fixture {
    fn new(side: Side, flaw: Option<Flaw>) -> Self {
        let rig = RigConfig::load("emulated").unwrap();
        let set = rig.devices.unwrap().arm(side).unwrap().clone();
        let mut scene = Scene::load("peg_transfer").unwrap();
        scene.person = flaw.map(|flaw| PersonModel { flaw: Some(flaw) });
        let hand = HandFrame::of(&rig.teleoperation.mapping());
        let world = of_side(side, &set, &scene, hand, Flaws::default()).unwrap();
        let arm = set.kinematics().unwrap();
        Self { world, arm, set, hand, t_s: 0.0, frame_s: 0.0, c_from_m: None }
    }

    fn sample(&mut self, task: PersonTask, prompt: Prompt) -> FrameSample {
        self.t_s += 1e-3;
        self.world.reads(self.t_s, task, prompt);
        let pose = self.arm.pose(&self.world.ask(self.t_s, &BodyCommand::Rest).joint_rad.into());
        let flange = self.arm.world_from_base().inverse() * pose.chain.world_from_flange;
        if self.t_s >= self.frame_s {
            self.frame_s += 1.0 / 60.0;
            self.c_from_m = match self.world.marker(self.t_s) {
                TrackedTool::Seen { c_from_tool, position_in_c_m, .. } => {
                    Some(Isometry3::from_parts(position_in_c_m.into(), c_from_tool))
                }
                _ => None,
            };
        }
        FrameSample {
            base_from_flange: Some(Isometry3::from_parts(flange.translation, flange.rotation.into())),
            c_from_m: self.c_from_m,
            wrench: Some(self.world.feel(self.t_s).wrench),
            ..FrameSample::from(self.world.hold(self.t_s, &MotorOutput::default()).position_m)
        }
    }

    /// Runs the session with this many samples per pose until everything is covered.
    fn run<C: Calibration>(
        &mut self,
        calibration: C,
        task: PersonTask,
        seconds: f64,
        prompt: impl Fn(&FrameSession<C>) -> Prompt,
    ) -> FrameReport<C::Solution> {
        let mut session = FrameSession::new(calibration);
        let begin_s = self.t_s;
        // The arm is carried to the start of the calibration.
        for _ in 0..6000 {
            self.sample(task, Prompt::Rest);
        }
        while session.coverage().fraction < 1.0 && self.t_s < begin_s + seconds {
            let sample = self.sample(task, prompt(&session));
            session.step(&sample, self.t_s);
        }
        let report = session.report().unwrap();
        println!("{task:?}: {:.0} s, {} poses, {:?}", self.t_s - begin_s, report.poses, report.cause);
        report
    }

    fn tip_in_flange_m(&self) -> Vector3<f64> {
        (self.arm.flange_from_s1() * Point3::new(0.0, 0.0, self.arm.shaft_m())).coords
    }

    fn flange_from_m(&mut self) -> Isometry3<f64> {
        let mount = self.arm.flange_from_s1();
        let flange_from_s1 = Isometry3::from_parts(mount.translation, mount.rotation.into());
        flange_from_s1 * self.world.truth(self.t_s).s1_from_m
    }

    fn base_from(&self, world_m: Vector3<f64>) -> Vector3<f64> {
        (self.arm.world_from_base().inverse() * Point3::from(world_m)).coords
    }
}

/// Calibrates tip, hand-eye and trocar on this arm and compares them with the true values.
fn instrument(side: Side) {
    let mut bench = Fixture::new(side, None);
    let tip = bench.run(TipSettings::by_arm(), PersonTask::Tip, 150.0, |_| Prompt::PivotInDimple);
    assert_eq!(tip.verdict, Verdict::Accepted, "{tip:?}");
    let tip_m = Vector3::from(tip.found.unwrap().tip_in_carrier_m);
    let miss_mm = (tip_m - bench.tip_in_flange_m()).norm() * 1e3;
    println!("{side:?}: tip {miss_mm:.3} mm off");
    assert!(miss_mm <= 0.5, "{side:?}: {miss_mm} mm");

    let hand_eye = bench.run(HandEyeSettings::new(tip_m), PersonTask::HandEye, 150.0, |_| Prompt::Turn);
    assert_eq!(hand_eye.verdict, Verdict::Accepted, "{hand_eye:?}");
    let found = hand_eye.found.unwrap();
    let [miss_mm, miss_deg] = bench.hand_eye_misses(&found.flange_from_m.pose(), &found.base_from_c.pose());
    println!("{side:?}: hand-eye {miss_mm:.3} mm, {miss_deg:.3} degrees off at the tip");
    assert!(miss_mm <= 0.5 && miss_deg <= 0.1, "{side:?}: {miss_mm} mm, {miss_deg} degrees");

    for _ in 0..8000 {
        bench.sample(PersonTask::Surgery, Prompt::Rest);
    }
    let trocar =
        bench.run(TrocarSettings::by_arm(&bench.arm.clone()), PersonTask::Trocar, 120.0, |_| Prompt::PivotInTrocar);
    assert_eq!(trocar.verdict, Verdict::Accepted, "{trocar:?}");
    let truth_m = bench.base_from(bench.set.rcm.trocar_m);
    let miss_mm = (Vector3::from(trocar.found.unwrap().trocar_m) - truth_m).norm() * 1e3;
    println!("{side:?}: trocar {miss_mm:.3} mm off");
    assert!(miss_mm <= 0.5, "{side:?}: {miss_mm} mm");
}

impl Fixture {
    /// Returns the distance between the tracker's and the true position of the tip, in the current pose of the arm.
    fn hand_eye_misses(&mut self, flange_from_m: &Isometry3<f64>, base_from_c: &Isometry3<f64>) -> [f64; 2] {
        let truth = self.world.truth(self.t_s);
        let base = self.arm.world_from_base().inverse();
        let base_from_world = Isometry3::from_parts(base.translation, base.rotation.into());
        let pose = self.arm.pose(&truth.joint_rad.into());
        let flange = pose.chain.world_from_flange;
        let base_from_flange = base_from_world * Isometry3::from_parts(flange.translation, flange.rotation.into());
        let c_from_m =
            truth.world_from_c.inverse() * base_from_world.inverse() * base_from_flange * self.flange_from_m();
        let seen = base_from_c * c_from_m * flange_from_m.inverse();
        let tip = Point3::from(self.tip_in_flange_m());
        let miss_m = (seen * tip - base_from_flange * tip).norm();
        [miss_m * 1e3, seen.rotation.angle_to(&base_from_flange.rotation).to_degrees()]
    }
}

#[test]
fn tip_hand_eye_and_trocar_of_the_right_arm_are_found() {
    instrument(Side::Right);
}

#[test]
fn tip_hand_eye_and_trocar_of_the_left_arm_are_found() {
    instrument(Side::Left);
}

/// Returns the first direction of gravity that has no pose yet.
fn untaken(session: &FrameSession<SensorMount>, flange_from_s1: &UnitQuaternion<f64>, up: &Vector3<f64>) -> PoseTarget {
    let taken = session.samples().iter().filter_map(|sample| sample.base_from_flange);
    let down_s1: Vec<_> = taken.map(|pose| -((pose.rotation * flange_from_s1).inverse() * up)).collect();
    let is_new = |target: &PoseTarget| down_s1.iter().all(|down| down.angle(&Vector3::from(target.down_s1)) > 0.3);
    TARGETS.into_iter().find(is_new).unwrap_or(TARGETS[0])
}

#[test]
fn mount_table_and_view_are_found() {
    let mut bench = Fixture::new(Side::Right, None);
    let mount = bench.arm.flange_from_s1().rotation;
    let up = bench.arm.world_from_base().rotation.inverse() * Vector3::z();
    let active = UnitQuaternion::from_rotation_matrix(&mount);
    let report = bench.run(SensorMount::new(active, up), PersonTask::Gravity, 150.0, |session| Prompt::Hold {
        world_from_s1: untaken(session, &active, &up).world_from_s1(),
    });
    assert_eq!(report.verdict, Verdict::Accepted, "{report:?}");
    let found = report.found.unwrap();
    println!("mount {:.3} degrees off", found.from_active_deg);
    assert!(found.agrees(), "{found:?}");

    let tip_m = bench.tip_in_flange_m();
    let report = bench.run(TableSettings::by_arm(tip_m, up), PersonTask::Table, 90.0, |session| Prompt::Touch {
        point: session.samples().len() as u8,
    });
    assert_eq!(report.verdict, Verdict::Accepted, "{report:?}");
    let from_table = report.found.unwrap().from_table.pose();
    let off_mm = (from_table.translation.vector - bench.base_from(Vector3::zeros())).norm() * 1e3;
    let base = bench.arm.world_from_base().rotation.inverse();
    let off_deg = from_table.rotation.angle_to(&UnitQuaternion::from_rotation_matrix(&base)).to_degrees();
    println!("table {off_mm:.3} mm, {off_deg:.3} degrees off");
    assert!(off_mm < 1.0 && off_deg < 0.6, "{off_mm} mm, {off_deg} degrees");

    let truth = (view_from_omega() * bench.hand.leader_from_world).inverse();
    let view = ViewSettings::by_arm(tip_m);
    let report = bench.run(view, PersonTask::View, 90.0, |session| {
        view.asked(session.samples().len()).map_or(Prompt::Rest, Prompt::MoveTip)
    });
    assert_eq!(report.verdict, Verdict::Accepted, "{report:?}");
    let world_from_view = bench.arm.world_from_base().rotation * report.found.unwrap().from_view().to_rotation_matrix();
    let off_deg = UnitQuaternion::from_rotation_matrix(&world_from_view).angle_to(&truth).to_degrees();
    println!("view {off_deg:.2} degrees off");
    assert!(off_deg < 5.0, "{off_deg} degrees");

    let view = ViewSettings::by_handle();
    let report = bench.run(view, PersonTask::View, 90.0, |session| {
        view.asked(session.samples().len()).map_or(Prompt::Rest, Prompt::MoveHandle)
    });
    assert_eq!(report.verdict, Verdict::Accepted, "{report:?}");
    let leader_from_view = bench.hand.leader_from_world * truth;
    let off_deg = report.found.unwrap().from_view().angle_to(&leader_from_view).to_degrees();
    println!("handle {off_deg:.2} degrees off");
    assert!(off_deg < 5.0, "{off_deg} degrees");
}

#[test]
fn a_technician_who_errs_gets_no_tip() {
    let mut bench = Fixture::new(Side::Right, Some(Flaw::Trembles));
    let report = bench.run(TipSettings::by_arm(), PersonTask::Tip, 30.0, |_| Prompt::PivotInDimple);
    assert_eq!((report.verdict, report.poses), (Verdict::InsufficientMotion, 0), "{report:?}");
    let mut bench = Fixture::new(Side::Right, Some(Flaw::KeepsOneOrientation));
    let report = bench.run(TipSettings::by_arm(), PersonTask::Tip, 30.0, |_| Prompt::PivotInDimple);
    assert!(report.found.is_none() && report.poses < 3, "{report:?}");
}
