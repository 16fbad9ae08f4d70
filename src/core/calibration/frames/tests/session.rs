//! Guided recording: still poses are recorded, poses in motion are not, and the missing part is reported.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::{rig::*, scenes::*};
use crate::calibration::{CalibrationRecord, Judgement, RecordHead, Verdict, frames::*};

const RATE_HZ: f64 = 60.0;

/// Holds the flange for a second, drifting at this speed, m/s; returns the observed states.
fn hold<C: Calibration>(
    session: &mut FrameSession<C>,
    rig: &mut Rig,
    at: &Isometry3<f64>,
    drift_m_s: f64,
    t_s: &mut f64,
) -> Vec<FramePhase> {
    (0..60)
        .map(|tick| {
            *t_s += 1.0 / RATE_HZ;
            let mut sample = rig.sample(at);
            sample.c_from_other_m = None;
            sample.other_base_from_flange = None;
            let pose = sample.c_from_m.as_mut().unwrap();
            pose.translation.vector.x += drift_m_s * f64::from(tick) / RATE_HZ;
            session.step(&sample, *t_s)
        })
        .collect()
}

#[test]
fn a_guided_tip_session_ends_accepted() {
    let mut rig = Rig::new(5);
    let mut t_s = 0.0;
    let mut session = FrameSession::new(TipSettings::by_tracker());
    assert_eq!(session.coverage(), FrameCoverage { fraction: 0.0, missing: Some(MissingMotion::Poses) });
    let mut before = 0.0;
    for at in in_dimple() {
        let phases = hold(&mut session, &mut rig, at, 0.0, &mut t_s);
        let taken = phases.iter().any(|phase| matches!(phase, FramePhase::Recorded { .. }));
        assert!(taken || phases.contains(&FramePhase::TakenHere), "{phases:?}");
        assert!(!taken || phases.last() == Some(&FramePhase::TakenHere), "one pose is recorded once");
        let coverage = session.coverage();
        assert!((0.0..=1.0).contains(&coverage.fraction) && (coverage.fraction < 1.0) == coverage.missing.is_some());
        before = f64::max(before, coverage.fraction);
        if coverage.missing.is_none() {
            break;
        }
    }
    assert!(before >= 1.0, "{before}");
    let report = session.report().unwrap();
    assert_eq!((report.verdict, report.cause), (Verdict::Accepted, FrameCause::Proven));
    let error_m = (Vector3::from(report.found.unwrap().tip_in_carrier_m) - tip_in(Carrier::Marker)).norm();
    // Each pose is a mean over half a second.
    assert!(error_m < 0.2e-3, "{error_m}");
    let count = session.samples().len();
    assert!(session.undo().is_some() && session.remove(0).is_some() && session.remove(999).is_none());
    assert_eq!(session.samples().len(), count - 2);
}

#[test]
fn a_pose_that_moved_is_not_recorded() {
    for (speed_m_s, name) in [(0.02, "fast"), (0.004, "slow")] {
        let mut rig = Rig::new(6);
        let mut t_s = 0.0;
        let mut session = FrameSession::new(TipSettings::by_tracker());
        let phases = hold(&mut session, &mut rig, &in_dimple()[0], speed_m_s, &mut t_s);
        assert!(session.samples().is_empty(), "{name}");
        assert!(phases.iter().any(|phase| matches!(phase, FramePhase::Moving { .. })), "{name}");
    }
}

#[test]
fn what_is_no_measurement_pauses_the_session() {
    let mut session = FrameSession::new(HandEyeSettings::new(TIP_IN_FLANGE_M));
    let good = Rig::new(7).sample(&in_dimple()[0]);
    assert_eq!(
        session.step(&FrameSample { c_from_m: None, ..good }, 0.0),
        FramePhase::Missing(Some(CalibrationSource::Marker))
    );
    assert_eq!(session.step(&good, f64::NAN), FramePhase::Missing(None));
    let broken = Isometry3::translation(f64::NAN, 0.0, 0.0);
    assert_eq!(session.step(&FrameSample { c_from_m: Some(broken), ..good }, 1.0), FramePhase::Missing(None));
    assert_eq!(session.step(&good, 2.0), FramePhase::Recording { fraction: 0.0 });
    assert_eq!(session.step(&good, 2.0), FramePhase::Missing(None), "the time must rise");
}

#[test]
fn a_marker_that_was_mistaken_for_the_other_is_recorded_and_named() {
    let mut rig = Rig::new(8);
    let mut t_s = 0.0;
    let mut session = FrameSession::new(TipSettings::by_tracker());
    let rest = pose([0.1, 0.2, -1.0], [10.0, 20.0, 30.0]);
    for at in &in_dimple()[..30] {
        for _ in 0..40 {
            t_s += 1.0 / RATE_HZ;
            let sample = rig.sample(at);
            // The instrument's marker is reported as the other's, and the actual other marker lies on a table.
            let c_from_m = Some(rig.noisy(&rest));
            let c_from_other_m = sample.c_from_m;
            session.step(&FrameSample { c_from_m, c_from_other_m, ..sample }, t_s);
        }
    }
    let cause = session.report().unwrap().cause;
    assert_eq!(cause, FrameCause::Mistake { mistake: Mistake::SwappedMarker });
}

#[test]
fn a_view_session_asks_for_one_move_after_the_other() {
    let mut rig = Rig::new(9);
    let mut t_s = 0.0;
    let mut session = FrameSession::new(ViewSettings::by_arm(TIP_IN_FLANGE_M));
    let ends = moved(&mut rig, &all_moves(), 3.0);
    for (count, end) in ends.iter().enumerate() {
        assert_eq!(session.calibration().asked(count), (count > 0).then(|| ViewMove::ALL[count - 1]));
        for _ in 0..40 {
            t_s += 1.0 / RATE_HZ;
            session.step(end, t_s);
        }
        assert_eq!(session.samples().len(), count + 1);
    }
    assert_eq!(session.coverage(), FrameCoverage { fraction: 1.0, missing: None });
    assert_eq!(session.report().unwrap().verdict, Verdict::Accepted);
}

/// Writes the report to a file and reads it back.
fn stored<F: CalibrationResult + PartialEq + std::fmt::Debug>(report: &FrameReport<F>) -> FrameRecord<F> {
    let serials = Serials { arm: Some("A-1".to_owned()), tracker: Some("P9".to_owned()), marker: None };
    let head = RecordHead::new("SN1", "grasper", "2026-11-22T10:00:00Z");
    let record = report.record(head, serials, "good").unwrap();
    let text = toml::to_string(&record).unwrap();
    let read: FrameRecord<F> = toml::from_str(&text).unwrap();
    assert_eq!(read, record, "{text}");
    assert_eq!(read.fault(), None, "{text}");
    assert!(toml::from_str::<FrameRecord<F>>(&format!("unknown = 1\n{text}")).is_err(), "unknown keys are refused");
    read
}

#[test]
fn every_record_comes_back_from_its_file_and_a_broken_one_is_refused() {
    let mut rig = Rig::new(10);
    let mut tip = stored(&TipSettings::by_tracker().fit(&rig.samples(in_dimple(), 20)).unwrap());
    let mut hand_eye = stored(&HandEyeSettings::new(TIP_IN_FLANGE_M).fit(&rig.samples(through_trocar(), 20)).unwrap());
    let mut trocar = stored(&TrocarSettings::by_arm(&arm()).fit(&rig.samples(through_trocar(), 40)).unwrap());
    let points = [[0.0, 0.0], [0.12, 0.0], [0.02, 0.1], [0.1, 0.09]];
    let table = stored(&TableSettings::by_tracker(tip_in(Carrier::Marker)).fit(&touched(&mut rig, &points)).unwrap());
    let mut view = stored(&ViewSettings::by_arm(TIP_IN_FLANGE_M).fit(&moved(&mut rig, &all_moves(), 2.0)).unwrap());
    let mount = UnitQuaternion::identity();
    let weighed = all_weighed(&mut rig, 12, &mount);
    let mut mount = stored(&SensorMount::new(mount, Vector3::z()).fit(&weighed).unwrap());
    assert!(table.judgement().allows());
    tip.found.tip_in_carrier_m[1] = f64::NAN;
    hand_eye.found.base_from_c.rotation_wxyz = [1.0, 1.0, 0.0, 0.0];
    trocar.found.inward = [0.0; 3];
    view.kind = "tip".to_owned();
    mount.judgement = Judgement::new(Verdict::PoorData, "changed by hand");
    let faults = [tip.fault(), hand_eye.fault(), trocar.fault(), view.fault(), mount.fault()];
    assert!(faults.iter().all(Option::is_some), "{faults:?}");
}

#[test]
fn a_refused_result_keeps_its_cause_in_the_record() {
    let mut rig = Rig::new(11);
    let mut samples = rig.samples(in_dimple(), 24);
    for sample in &mut samples {
        // The tip slides by millimetres.
        sample.c_from_m.as_mut().unwrap().translation.vector += rig.vector(0.004);
    }
    let record = stored(&TipSettings::by_tracker().fit(&samples).unwrap());
    assert!(matches!(record.cause, FrameCause::PoorPlace { .. }), "{:?}", record.cause);
    assert!(!record.judgement().allows());
    for mistake in [Mistake::SwappedMarker, Mistake::WrongSign([false, true, false])] {
        let wrong = |sample: &FrameSample| mistake.undone(sample, Carrier::Marker).unwrap();
        let samples: Vec<FrameSample> = rig.samples(in_dimple(), 24).iter().map(wrong).collect();
        let record = stored(&TipSettings::by_tracker().fit(&samples).unwrap());
        assert_eq!(record.cause, FrameCause::Mistake { mistake });
        assert_eq!(record.judgement().verdict, Verdict::PoorData);
    }
}
