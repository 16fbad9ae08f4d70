//! A loop with every calibration active: the network for the tip force, with its uncertainty and its fallback.

use std::sync::atomic::AtomicBool;

use nima_core::{
    calibration::{Judgement, Verdict},
    tip_force::{Fallback, FeatureSettings, ForceModel, LiveTipForce, OriginCheck, TrainingSettings},
};
use nima_machine::{
    config::RigConfig,
    messages::{Command, ForceSource},
    rig::{Prompt, Side},
    teleop::Calibrations,
};
use nima_simulation::SimulationPlan;
use nima_study::validation::{
    experiment::SimulatedExperiment,
    isolation::{PriorCalibrations, record as recorded},
};
use nima_training::train_model;

use crate::bench::record;

const SOMEBODY: &str = "Dr Somebody";

/// Returns a network that was accepted by a person although it was not proven.
fn network(known: &PriorCalibrations) -> ForceModel {
    let scene = SimulatedExperiment::scene("isolation", 3).unwrap();
    let data = recorded(&scene, known, FeatureSettings::default(), 6000, 7.0).unwrap().data(None).unwrap();
    let settings = TrainingSettings { members: 2, epochs: Some(10), ..TrainingSettings::default() };
    let mut model = train_model(&data, &settings, [None, None], &AtomicBool::new(false), &|_| {}).unwrap();
    let judgement = Judgement {
        override_by: Some(SOMEBODY.to_owned()),
        override_reason: Some(format!("{SOMEBODY} was in a hurry")),
        ..Judgement::new(Verdict::PoorData, "too few rows")
    };
    model.origin.check = Some(OriginCheck {
        judgement,
        date: "2026-11-23T08:00:00Z".to_owned(),
        rows: 1,
        mae_n: [0.1; 3],
        sd_n: [0.1; 3],
        free_mean_n: [0.0; 3],
        free_sd_n: [0.0; 3],
        doubt_fraction: 0.0,
    });
    model
}

#[test]
fn a_network_in_force_replays_to_the_bit_and_tells_no_name_of_a_person() {
    let known = PriorCalibrations::calibrate(3).unwrap();
    let model = network(&known);
    for fallback in [Fallback::WristForce, Fallback::HoldAndFade] {
        let tip_force = Some(LiveTipForce::new(model.clone(), fallback).unwrap());
        let plan = SimulationPlan {
            rig: RigConfig::load("simulated").unwrap(),
            scene: SimulatedExperiment::scene("isolation", 4).unwrap(),
            calibrations: [
                Calibrations { gravity: Some(known.gravity), tip_force, ..Calibrations::default() },
                Calibrations::default(),
            ],
            engage: false,
        };
        let mut by_network = 0;
        let mut by_fallback = 0;
        let mut unknown_s = 0.0;
        let kept = record(&plan, 8.0, |tick| {
            // A force that is held or faded does not count as measured, nor does the link deliver it as measured.
            let is_known = tick.force.source.is_known();
            unknown_s = if is_known { 0.0 } else { unknown_s + 1e-3 };
            assert_eq!(tick.known_n().is_some(), is_known);
            assert!(
                unknown_s <= tick.delay_s + 2e-3 || tick.rendering.delayed_n.iter().all(|x| x.is_nan()),
                "{tick:?}"
            );
            by_network += u32::from(tick.force.source == ForceSource::Network);
            by_fallback += u32::from(matches!(tick.force.source, ForceSource::InDoubt { .. }));
            match tick.index {
                50 => Some(Command::Prompt(Side::Right, Prompt::Work)),
                6000 => Some(Command::Prompt(Side::Right, Prompt::WorkFree)),
                _ => None,
            }
        });
        assert!(by_network > 1000 && by_fallback > 30, "{by_network} by the network, {by_fallback} by the fallback");
        let outcome = kept.replayed(|_| {}).unwrap();
        assert_eq!((outcome.ticks, outcome.differs, outcome.closed), (8000, None, true), "{fallback:?}");
        let tells = |name: &[u8]| kept.0.iter().any(|message| message.windows(name.len()).any(|part| part == name));
        assert!(tells(b"(withheld)") && !tells(SOMEBODY.as_bytes()));
    }
}
