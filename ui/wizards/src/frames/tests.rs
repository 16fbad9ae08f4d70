//! The wizards with samples of known frames, from the first step to the rig file and back.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use nima_core::{
    calibration::frames::{Carrier, FrameCause, FramePhase, FrameReport, FrameSample, StoredPose, TableResult},
    frames::from_roll_pitch_yaw_deg,
};
use nima_machine::{
    config::RigConfig,
    rig::{Prompt, Roster, SIDES, Side},
    teleop::{Calibrations, Loop, Timing},
};
use nima_simulation::scene::Scene;

use super::*;
use crate::active_calibrations::ActiveCalibrations;

struct Fixture {
    wizard: FrameWizard,
    active: ActiveCalibrations,
    rig_name: String,
    rig: RigConfig,
    folder: tempfile::TempDir,
    tick: Tick,
}

impl Fixture {
    fn new(kind: FrameKind) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let simulated = RigConfig::load("simulated").unwrap();
        // Records are bound to the simulated rig's sensor, on the emulated rig's arm.
        let active = ActiveCalibrations::load(Some(folder.path()), &simulated, &Scene::load("palpation").unwrap());
        let mut control = Loop::new(&simulated, &[Some(Calibrations::default()), None]).unwrap();
        let (_, [tick, _]) = control.step([None; SIDES], &Timing::default());
        let rig = RigConfig::load("emulated").unwrap();
        let wizard = FrameWizard::new(kind);
        let mut bench = Self { wizard, active, rig_name: "emulated".to_owned(), rig, folder, tick: tick.unwrap() };
        bench.refresh();
        bench
    }

    fn binding(&self) -> Binding {
        self.active.binding_of(&self.rig_name, &self.rig, &Roster::new())
    }

    fn refresh(&mut self) {
        let binding = self.binding();
        self.wizard.refresh(&binding);
    }

    fn hold(&mut self, frames: &FrameSample, seconds: f64) {
        for _ in 0..(seconds / EVERY_S) as usize {
            self.tick.t_s += 1.01 * EVERY_S;
            self.tick.calibration.frames = *frames;
            self.wizard.tick(&self.tick, 1000.0);
        }
    }

    fn next(&mut self) {
        let binding = self.binding();
        assert_eq!(self.wizard.may_go_on(&binding), Ok(()));
        let step = self.wizard.frame.step;
        self.wizard.go_to(step + 1);
        self.refresh();
    }

    fn subject(&self) -> FrameSubject {
        FrameSubject::of(&self.rig, Side::Right, &Roster::new()).unwrap()
    }

    fn save(&mut self) -> Result<(), String> {
        let saving = match self.wizard.made(&self.binding()).unwrap() {
            SaveRequest::Frame(saving) => *saving,
            other => panic!("{other:?}"),
        };
        let (rig, path, words) = self.active.save_frame(saving, &self.rig_name, Some(self.folder.path()))?;
        self.rig = rig;
        self.rig_name = path.display().to_string();
        self.wizard.frame.report_saved(Ok(words), None);
        self.refresh();
        Ok(())
    }

    fn undo(&mut self) {
        let changes: Vec<_> = self.wizard.undoable.iter().cloned().map(RigChange::undone).collect();
        let (_, rig) = self.active.change_rig(&changes, &self.rig_name, Some(self.folder.path())).unwrap();
        self.rig = rig;
        self.refresh();
    }
}

/// Returns a rotation different from those of other numbers: tilts to all sides, and rotations about the shaft.
fn turn(i: u32) -> UnitQuaternion<f64> {
    let i = f64::from(i);
    let tilt = Vector3::new(0.45 * (2.4 * i).sin(), 0.45 * (2.4 * i).cos(), 0.0);
    UnitQuaternion::from_scaled_axis(tilt) * UnitQuaternion::from_scaled_axis(Vector3::z() * 0.8 * (1.7 * i).sin())
}

fn at(place_m: Vector3<f64>, turn: UnitQuaternion<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(place_m.into(), turn)
}

/// Returns the flange with the tip in a dimple.
fn pivoting(tip_m: Vector3<f64>, i: u32) -> FrameSample {
    let dimple_m = Vector3::new(0.3, -0.1, 0.05);
    let down = from_roll_pitch_yaw_deg(&Vector3::new(180.0, 0.0, 0.0));
    let flange = at(dimple_m, turn(i) * down) * Isometry3::translation(-tip_m.x, -tip_m.y, -tip_m.z);
    FrameSample { base_from_flange: Some(flange), ..FrameSample::default() }
}

#[test]
fn a_view_needs_an_endoscope_image() {
    let mut bench = Fixture::new(FrameKind::View);
    let tip_m = bench.subject().tip_in_flange_m();
    bench.hold(&pivoting(tip_m, 0), 0.1);
    assert_eq!(bench.wizard.may_go_on(&bench.binding()), Ok(()));
    bench.rig.endoscope = None;
    assert_eq!(bench.wizard.may_go_on(&bench.binding()), Err(text::wizards::NEEDS_CHECKS.get()), "nothing to look at");
}

#[test]
fn a_tip_is_recorded_judged_written_into_the_rig_file_and_undone() {
    let mut bench = Fixture::new(FrameKind::Tip);
    let before = bench.subject();
    let tip_m = before.tip_in_flange_m() + Vector3::new(0.002, -0.001, 0.003);
    assert_eq!(bench.wizard.may_go_on(&bench.binding()), Err(text::wizards::NEEDS_CHECKS.get()), "no joints yet");
    assert_eq!(bench.wizard.prompt(), Prompt::Rest);
    bench.hold(&pivoting(tip_m, 0), 0.1);
    bench.next();
    for i in 0..40 {
        if bench.wizard.is_complete() {
            break;
        }
        assert_eq!(bench.wizard.prompt(), Prompt::PivotInDimple);
        bench.hold(&pivoting(tip_m, i), 0.7);
        assert_eq!(bench.wizard.taken(), i as usize + 1, "{:?}", bench.wizard.phase);
    }
    assert!(bench.wizard.is_complete());
    assert_eq!(bench.wizard.prompt(), Prompt::Rest, "nothing more is requested");
    bench.hold(&pivoting(tip_m + Vector3::repeat(0.05), 99), 1.0);
    assert_eq!(bench.wizard.taken(), 20, "what happens afterwards is not recorded");
    bench.next();
    let outcome = bench.wizard.outcome().unwrap();
    assert_eq!(outcome.quality().verdict, Verdict::Accepted, "{outcome:?}");
    bench.next();
    assert!(bench.wizard.undoable.is_empty());
    bench.save().unwrap();
    let now = bench.subject();
    assert!((now.tip_in_flange_m() - tip_m).norm() < 2e-5, "{:?}", now.tip_in_flange_m());
    assert!(now.arm.flange_from_s1.rotation.angle_to(&before.arm.flange_from_s1.rotation) < 1e-9);
    assert_eq!(std::path::Path::new(&bench.rig_name), bench.folder.path().join("rigs/emulated-2.toml"));
    let text = std::fs::read_to_string(&bench.rig_name).unwrap();
    assert!(text.contains("# Mirror image of the right arm's mount."), "comments stay");

    assert_eq!(bench.wizard.undoable.len(), 2, "{:?}", bench.wizard.undoable);
    bench.undo();
    assert_eq!(bench.subject().set.mount, before.set.mount);
    bench.wizard.go_to(SAVE);
    bench.refresh();
    assert!(bench.wizard.undoable.is_empty(), "what is undone cannot be undone again");
}

#[test]
fn a_mount_is_recorded_while_the_arm_turns_about_the_vertical() {
    let mut bench = Fixture::new(FrameKind::Mount);
    let subject = bench.subject();
    let mount = subject.arm.flange_from_s1.rotation;
    let up = subject.up_in_base();
    let wrist = |down_s1: Vector3<f64>| nima_core::frames::Wrench { force_n: down_s1 * 4.0, ..Default::default() };
    let pose = |target: &PoseTarget, turned_rad: f64| {
        let vertical = UnitQuaternion::from_scaled_axis(up * turned_rad);
        let base_from_world = subject.arm.world_from_base.rotation.inverse();
        let flange = vertical * base_from_world * target.world_from_s1() * mount.inverse();
        let wrench = wrist(Vector3::from(target.down_s1).normalize());
        FrameSample {
            base_from_flange: Some(at(up * turned_rad, flange)),
            wrench: Some(wrench),
            ..FrameSample::default()
        }
    };
    bench.hold(&pose(&TARGETS[0], 0.0), 0.1);
    bench.next();
    for taken in 0..TARGETS.len() {
        assert_eq!(bench.wizard.target(), TARGETS[taken], "the list in its order");
        for i in 0..70 {
            bench.hold(&pose(&TARGETS[taken], 0.01 * f64::from(i)), 3.0 * EVERY_S);
        }
        assert_eq!(bench.wizard.taken(), taken + 1, "{:?}", bench.wizard.phase);
    }
    assert!(bench.wizard.is_complete());
    bench.next();
    assert_eq!(bench.wizard.outcome().unwrap().quality().verdict, Verdict::Accepted);
    assert!(bench.wizard.numbers().is_empty(), "a mount that agrees changes nothing");
}

/// Flange and marker, with marker and camera in known poses.
fn seen(i: u32, flange_from_m: &Isometry3<f64>, base_from_c: &Isometry3<f64>) -> FrameSample {
    let place_m = Vector3::new(0.4, 0.02 * f64::from(i % 5), 0.3);
    let flange = at(place_m, turn(i));
    let c_from_m = base_from_c.inverse() * flange * flange_from_m;
    FrameSample { base_from_flange: Some(flange), c_from_m: Some(c_from_m), ..FrameSample::default() }
}

#[test]
fn hand_eye_gives_marker_and_camera_and_opens_the_tracker_for_the_trocar() {
    let flange_from_m = at(Vector3::new(0.03, -0.04, 0.08), turn(7));
    let base_from_c = at(Vector3::new(1.3, 0.7, 0.9), turn(3) * turn(5));
    let mut bench = Fixture::new(FrameKind::HandEye);
    assert_eq!(FrameKind::Trocar.other_way_needs(&bench.subject()), Err(texts::NEEDS_HAND_EYE.get()));
    bench.hold(&FrameSample { c_from_m: None, ..seen(0, &flange_from_m, &base_from_c) }, 0.1);
    assert_eq!(bench.wizard.lacks(), Some(CalibrationSource::Marker));
    bench.hold(&seen(0, &flange_from_m, &base_from_c), 0.1);
    bench.next();
    for i in 0..30 {
        bench.hold(&seen(i, &flange_from_m, &base_from_c), 0.7);
    }
    bench.next();
    assert_eq!(bench.wizard.outcome().unwrap().quality().verdict, Verdict::Accepted);
    bench.next();
    bench.save().unwrap();
    let [found, camera] = bench.subject().hand_eye().unwrap();
    let off = [found.inverse() * flange_from_m, camera.inverse() * base_from_c];
    assert!(off.iter().all(|off| off.translation.vector.norm() < 5e-5 && off.rotation.angle() < 5e-5), "{off:?}");
    assert_eq!(FrameKind::Trocar.other_way_needs(&bench.subject()), Ok(()));
    // Two of the keys did not exist: undo removes them again.
    bench.undo();
    assert!(bench.subject().hand_eye().is_none());
    assert!(!std::fs::read_to_string(&bench.rig_name).unwrap().contains("base_from_c_m"));
}

#[test]
fn a_tip_that_leaves_its_dimple_is_refused_and_kept_only_under_a_name() {
    let mut bench = Fixture::new(FrameKind::Tip);
    let tip_m = bench.subject().tip_in_flange_m();
    bench.hold(&pivoting(tip_m, 0), 0.1);
    bench.next();
    for i in 0..24 {
        let slips_m = Vector3::new((3.1 * f64::from(i)).sin(), (1.9 * f64::from(i)).cos(), 0.0) * 0.01;
        bench.hold(&pivoting(tip_m + slips_m, i), 0.7);
    }
    bench.next();
    let quality = bench.wizard.outcome().unwrap().quality();
    assert_ne!(quality.verdict, Verdict::Accepted, "{quality:?}");
    assert_eq!(bench.wizard.proof(), None);
    if bench.wizard.outcome().unwrap().is_found() {
        bench.next();
        let report = bench.save().unwrap_err();
        assert!(report.contains("refused"), "{report}");
        assert_eq!(bench.rig_name, "emulated", "and nothing is written");
    }
}

#[test]
fn a_pause_and_a_new_start_of_the_loop_record_nothing_wrong() {
    let mut bench = Fixture::new(FrameKind::Tip);
    let tip_m = bench.subject().tip_in_flange_m();
    bench.hold(&pivoting(tip_m, 0), 0.1);
    bench.next();
    bench.hold(&pivoting(tip_m, 0), 0.3);
    bench.tick.t_s = 0.0;
    bench.hold(&pivoting(tip_m, 0), 0.4);
    assert_eq!(bench.wizard.taken(), 0, "a pose does not continue after a restart of the loop");
    bench.hold(&pivoting(tip_m, 0), 0.2);
    assert_eq!(bench.wizard.taken(), 1);
    bench.wizard.paused = true;
    bench.hold(&pivoting(tip_m, 1), 1.0);
    assert_eq!((bench.wizard.taken(), bench.wizard.prompt()), (1, Prompt::Rest));
    bench.wizard.paused = false;
    bench.hold(&FrameSample::default(), 0.1);
    assert_eq!(bench.wizard.phase, FramePhase::Missing(Some(CalibrationSource::Flange)));
}

#[test]
fn a_table_moves_the_base_and_leaves_the_trocar_where_it_is_on_the_patient() {
    let bench = Fixture::new(FrameKind::Table);
    let subject = bench.subject();
    let base_from_table = at(Vector3::new(-0.38, 0.02, -0.26), from_roll_pitch_yaw_deg(&Vector3::new(0.5, -0.3, 4.0)));
    let found = TableResult { carrier: Carrier::Flange, from_table: stored(&base_from_table) };
    let report = FrameReport { found: Some(found), ..FrameReport::nothing(6, FrameCause::Proven) };
    let (all, _) = numbers::of(&Outcome::Table(report), &subject, None).unwrap();
    let of =
        |name: &str| Vector3::from_column_slice(&all.iter().find(|number| number.key.ends_with(name)).unwrap().after);
    let world_from_base = at(of("base_m"), from_roll_pitch_yaw_deg(&of("base_deg")));
    assert!((world_from_base * base_from_table).translation.vector.norm() < 1e-12, "the origin is the table's");
    let in_base = |world_from_base: &Isometry3<f64>, trocar_m: Vector3<f64>| {
        world_from_base.inverse() * nalgebra::Point3::from(trocar_m)
    };
    let was = in_base(&subject.arm.world_from_base, subject.set.rcm.trocar_m);
    assert!((in_base(&world_from_base, of("trocar_m")) - was).norm() < 1e-12);
}

fn stored(pose: &Isometry3<f64>) -> StoredPose {
    let q = pose.rotation;
    StoredPose { place_m: pose.translation.vector.into(), rotation_wxyz: [q.w, q.i, q.j, q.k] }
}
