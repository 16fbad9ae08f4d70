//! Effects of real devices' flaws on the network that infers the force at the tip, in virtual time.

use std::{path::PathBuf, sync::atomic::AtomicBool};

use nima_core::{
    calibration::{Verdict, correspondence::Correspondence},
    tip_force::{Estimator, OriginCheck, TrainingSettings},
};
use nima_machine::rig::{Flaws, Prompt};
use nima_recording::tip_force::{DataSet, RecorderPhase, Selection, TipForceRecorder};

use nima_simulation::screen::PersonTask;

use super::tests::{FLAWS, Fitted, Fixture, fitted, live};

/// Rows required by the wizard, and rows of its check: with contact, then without.
const ROWS: usize = 16_000;
const CHECK: [usize; 2] = [5000, 2000];
/// Number of rows with contact, and number of rows without contact that follow them.
const SPELL: [usize; 2] = [3000, 900];
const TICKS_MAX: usize = 300_000;

/// Records until there are this many rows; `is_free` returns whether the technician is instructed to avoid contact in a
/// row.
fn recorded(
    bench: &mut Fixture,
    fitted: &Fitted,
    known: &Correspondence,
    rows: usize,
    is_free: impl Fn(usize) -> bool,
) -> DataSet {
    let mut recorder = TipForceRecorder::new(*known);
    let mut gravity = live(fitted.gravity);
    let mut prompt = Prompt::Rest;
    for _ in 0..TICKS_MAX {
        let (sample, wrench) = bench.felt(&mut gravity, PersonTask::TipForce, prompt);
        prompt = match recorder.step(bench.now_s(), Some(&wrench), &sample) {
            RecorderPhase::Resting { .. } => Prompt::Rest,
            _ if is_free(recorder.rows()) => Prompt::WorkFree,
            _ => Prompt::Work,
        };
        if recorder.rows() >= rows {
            break;
        }
    }
    let mut text = Vec::new();
    recorder.write(&mut text).unwrap();
    DataSet::parse(&[(PathBuf::from("virtual.csv"), text)], &Selection::default()).unwrap()
}

/// Records, trains and checks like the wizard; `None` if gravity or correspondence were refused.
fn checked(flaws: Flaws) -> Option<OriginCheck> {
    let (mut bench, fitted) = fitted(flaws)?;
    let known = fitted.correspondence?;
    let data = recorded(&mut bench, &fitted, &known, ROWS, |row| row % (SPELL[0] + SPELL[1]) >= SPELL[0]);
    let model =
        nima_training::train_model(&data, &TrainingSettings::default(), [None, None], &AtomicBool::new(false), &|_| ());
    let proof = recorded(&mut bench, &fitted, &known, CHECK.iter().sum(), |row| row >= CHECK[0]);
    let (check, _) = nima_training::check(&mut Estimator::new(model.unwrap()), &proof).unwrap();
    Some(check)
}

/// Prints a column of the table of flaws in docs/results/devices.md.
#[test]
#[ignore = "minutes: trains a network for each flaw; `./dev figures` runs it"]
fn figures_of_flaws_and_the_network() {
    for (name, flaws) in FLAWS {
        let Some(check) = checked(flaws) else {
            println!("{name}: refused before");
            continue;
        };
        let max = |of: [f64; 3]| of.into_iter().fold(0.0, |max: f64, one| max.max(one.abs()));
        println!(
            "{name}: {:?} ({}); error {:.3} N, without contact {:.3} N mean, {:.3} N sd, in doubt {:.1} %",
            check.judgement.verdict,
            check.judgement.reason,
            max(check.mae_n),
            max(check.free_mean_n),
            max(check.free_sd_n),
            100.0 * check.doubt_fraction
        );
        assert!(name != "none" || check.judgement.verdict == Verdict::Accepted, "{check:?}");
    }
}
