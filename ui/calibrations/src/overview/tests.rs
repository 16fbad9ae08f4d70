//! Tests of the list of calibrations: saved ones with age and verdict, missing ones, and unusable ones.

use nima_core::calibration::{RecordHead, Verdict, gravity::GravityRecord};
use nima_machine::{config::RigConfig, ready::ReadyPoint, rig::Side};
use nima_recording::store::{CheckedItem, PointOutcome, READY_CHECK, ReadyRecord, Store, utc_now};
use nima_simulation::scene::Scene;
use nima_tests::gravity::gravity;
use nima_words::report_text::check_name;

use super::{ActiveCalibrations, ArmOverview, OverviewLine, following, found_since, made_text, overview, verdict_text};
use crate::{CalibrationTarget, WizardKind, frames::FrameKind};

fn listed(store: &Store) -> Vec<super::ArmOverview> {
    let rig = RigConfig::load("simulated").unwrap();
    let scene = Scene::load("palpation").unwrap();
    overview(&ActiveCalibrations::load(Some(store.folder()), &rig, &scene), &rig, "simulated")
}

#[test]
fn what_was_made_stands_with_age_and_verdict_and_what_was_not_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path().join("calibrations"));
    store.save(&gravity()).unwrap();
    let arms = listed(&store);
    let [arm] = &arms[..] else { panic!("{arms:?}") };
    assert_eq!(arm.wrist.as_ref().unwrap().serial_number, "SIM-S1-0001");
    let which: Vec<_> = arm.lines.iter().map(|line| line.wanted.which).collect();
    assert_eq!(
        which,
        [WizardKind::Gravity, WizardKind::Correspondence, WizardKind::TipForce],
        "a simulated arm has no frames"
    );
    let kept = arm.lines[0].kept.as_ref().unwrap().as_ref().unwrap();
    assert!(made_text(kept).ends_with(", less than a day old"), "{}", made_text(kept));
    assert!(verdict_text(kept).starts_with("Accepted, held-out error 0.0"), "{}", verdict_text(kept));
    assert!(arm.lines[0].since.contains("being checked"), "{}", arm.lines[0].since);
    assert_eq!(arm.lines[1].kept, Ok(None));
}

#[test]
fn an_old_one_an_overridden_one_and_a_damaged_one_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path().join("calibrations"));
    let mut record = gravity();
    record.head = RecordHead::new(&record.head.sensor, &record.head.tool, "2026-01-02T10:00:00Z");
    record.judgement.verdict = Verdict::PoorData;
    record.judgement.override_by("Ada Lovelace", Some("bench test"));
    store.save(&record).unwrap();
    let arms = listed(&store);
    let kept = arms[0].lines[0].kept.as_ref().unwrap().as_ref().unwrap();
    assert!(made_text(kept).starts_with("2026-01-02, ") && made_text(kept).ends_with(" days old"));
    assert!(verdict_text(kept).ends_with("accepted by Ada Lovelace"), "{}", verdict_text(kept));
    std::fs::write(store.path::<GravityRecord>(&record.head.sensor).unwrap(), "kind = 3").unwrap();
    let arms = listed(&store);
    assert!(arms[0].lines[0].kept.is_err(), "{:?}", arms[0].lines[0]);
}

#[test]
fn a_ready_check_tells_what_has_changed_since_if_it_was_later() {
    let item = CheckedItem {
        check: check_name(ReadyPoint::Trocar(Side::Left)),
        outcome: PointOutcome::Passed,
        value: Some(0.31),
        limit: Some(1.0),
        unit: Some("mm".to_owned()),
        cause: None,
        cure: None,
    };
    let check = ReadyRecord {
        kind: READY_CHECK.to_owned(),
        date: "2026-08-21T10:20:30Z".to_owned(),
        software: String::new(),
        rig: String::new(),
        rig_file: String::new(),
        by: String::new(),
        passed: true,
        took_s: 0.0,
        devices: Vec::new(),
        items: vec![item],
    };
    let since = |side, date: &str| found_since(Some(&check), ReadyPoint::Trocar(side), date);
    let words = Some("ready check on 2026-08-21: 0.31 mm, limit 1.00".to_owned());
    assert_eq!(since(Side::Left, "2026-08-20T10:20:30Z"), words);
    assert_eq!(since(Side::Left, &utc_now()), None, "calibrated after the check");
    assert_eq!(since(Side::Right, "2026-08-20T10:20:30Z"), None);
}

#[test]
fn what_is_to_be_calibrated_next_is_the_first_that_is_not_in_order_after_what_was_made() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path().join("calibrations"));
    store.save(&gravity()).unwrap();
    let [good, missing] = [listed(&store)[0].lines[0].kept.clone(), Ok(None)];
    let wanted = |side, which| CalibrationTarget { side, which, by_handle: false };
    let tip = WizardKind::Frame(FrameKind::Tip);
    let arm = |side, kept: [&Result<_, _>; 2]| ArmOverview {
        side,
        wrist: None,
        lines: [tip, WizardKind::Gravity]
            .into_iter()
            .zip(kept)
            .map(|(which, kept)| OverviewLine { wanted: wanted(side, which), kept: kept.clone(), since: String::new() })
            .collect(),
    };
    let right = Side::Right;
    let left = Side::Left;
    let next = |right_kept, left_kept, after| following(&[arm(right, right_kept), arm(left, left_kept)], after);
    assert_eq!(next([&missing, &good], [&good, &missing], None), Some(wanted(right, tip)));
    let after = |side, which| Some(wanted(side, which));
    assert_eq!(next([&good, &good], [&missing, &missing], after(right, tip)), after(left, tip));
    assert_eq!(next([&missing, &good], [&good, &good], after(left, WizardKind::Gravity)), after(right, tip));
    // A calibration accepted without proof is not suggested again at once.
    assert_eq!(next([&good, &missing], [&good, &good], after(right, WizardKind::Gravity)), None);
    assert_eq!(next([&good; 2], [&good; 2], None), None);
}
