use std::{fmt::Write as _, path::Path};

use super::*;
use crate::Findings as _;

fn written(path: &Path, text: &str) -> Trials {
    std::fs::write(path, text).unwrap();
    Trials { path: path.to_owned(), measures: Vec::new(), reference: None, confidence: 0.95, power: None }
}

fn run(trials: &Trials) -> TrialReport {
    trials.run(&mut |_, _, _| ()).unwrap()
}

/// Twelve participants, three trials under each of three conditions: 50 s, 10 s less under `matched`, 2 s less under `dfr`; forces that do not differ.
fn study() -> String {
    let mut rng = fastrand::Rng::with_seed(11);
    let mut noise = move || (0..12).map(|_| rng.f64()).sum::<f64>() - 6.0;
    let mut text = "participant,condition,trial,time_s,force_n\n".to_owned();
    for participant in 0..12 {
        let skill_s = 6.0 * noise();
        for (condition, less_s) in [("none", 0.0), ("dfr", 2.0), ("matched", 10.0)] {
            for trial in 1..=3 {
                let time_s = 50.0 + skill_s - less_s + 2.0 * noise();
                let force_n = 2.0 + 0.3 * noise();
                writeln!(text, "p{participant},{condition},{trial},{time_s},{force_n}").unwrap();
            }
        }
    }
    text
}

#[test]
fn a_difference_that_is_there_is_found_and_one_that_is_not_there_is_not() {
    let folder = tempfile::tempdir().unwrap();
    let trials = Trials {
        reference: Some("none".to_owned()),
        power: Some(0.8),
        ..written(&folder.path().join("trials.csv"), &study())
    };
    let report = run(&trials);
    assert_eq!((report.trials, report.participants, report.conditions.len()), (108, 12, 3));
    let [time, force] = report.measures.as_slice() else { panic!("{report:?}") };
    assert_eq!((time.design, time.complete, time.pairs.len()), (TrialDesign::Within, 12, 3));
    let pair = |of: &OfMeasure, first: &str| of.pairs.iter().find(|pair| pair.first == first).unwrap().clone();
    let matched = pair(time, "matched");
    assert_eq!((matched.second.as_str(), matched.participants), ("none", [12, 12]));
    assert!(matched.difference.interval.contains(-10.0) && matched.p_holm < 0.01, "{matched:?}");
    assert!(matched.rank_effect < -0.95 && matched.needed.is_some_and(|needed| needed < 12), "{matched:?}");
    assert!(time.friedman.as_ref().unwrap().p < 0.001);
    let mixed = time.mixed.as_ref().unwrap();
    let effect = mixed.effects.iter().find(|effect| effect.name == "matched").unwrap();
    assert!(effect.interval.contains(-10.0) && effect.p < 1e-6, "{effect:?}");
    assert!(mixed.icc > 0.6 && mixed.effects.iter().any(|effect| effect.name == "trial"));
    assert!(pair(force, "matched").p_holm > 0.05 && force.friedman.as_ref().unwrap().p > 0.05, "{force:?}");
    let text = report.text();
    assert!(text.contains("| matched - none | 12 |") && text.contains("participants needed"), "{text}");
    let files = report.files();
    assert!(files[1].1.lines().count() == 1 + 6 && files[2].1.contains("friedman.test"), "{files:?}");
}

#[test]
fn groups_of_different_people_are_compared_as_groups() {
    let folder = tempfile::tempdir().unwrap();
    let text = "participant,condition,drops\na,new,1\nb,new,2\nc,new,0\nd,new,1\ne,old,4\nf,old,6\ng,old,5\nh,old,3\n";
    let report = run(&written(&folder.path().join("trials.csv"), text));
    let measure = &report.measures[0];
    assert_eq!(
        (measure.design, measure.friedman.is_none(), measure.mixed.is_none()),
        (TrialDesign::Between, true, true)
    );
    let pair = &measure.pairs[0];
    // 8 of 8 apart: 2 of the 70 permutations.
    assert!((pair.p - 2.0 / 70.0).abs() < 1e-9 && (pair.rank_effect - 1.0).abs() < 1e-12, "{pair:?}");
    assert_eq!((pair.first.as_str(), pair.second.as_str()), ("old", "new"));
}

#[test]
fn what_cannot_be_compared_is_said_and_the_rest_is_there() {
    let folder = tempfile::tempdir().unwrap();
    let text = "participant,condition,same,time_s\na,x,1,5\na,y,1,4\nb,x,1,6\nb,y,1,5.5\nc,x,1,7\nc,y,1,6\nd,y,1,\n";
    let report = run(&written(&folder.path().join("trials.csv"), text));
    let [same, time] = report.measures.as_slice() else { panic!("{report:?}") };
    assert!(same.pairs.is_empty() && same.notes.iter().any(|note| note.contains("all the same")), "{:?}", same.notes);
    assert_eq!((time.missing, time.pairs[0].participants), (1, [3, 3]));
    assert!(report.text().contains("Not computed:"), "{}", report.text());
    let one = run(&written(&folder.path().join("one.csv"), "participant,condition,t\na,x,1\nb,x,2\n"));
    assert_eq!((one.measures[0].design, one.measures[0].pairs.len()), (TrialDesign::Single, 0));
}

#[test]
fn an_unknown_reference_names_the_known_ones() {
    let folder = tempfile::tempdir().unwrap();
    let trials = Trials { reference: Some("z".to_owned()), ..written(&folder.path().join("trials.csv"), &study()) };
    let report = trials.run(&mut |_, _, _| ()).unwrap_err().to_string();
    assert!(report.contains("\"z\"") && report.contains("dfr, matched, none"), "{report}");
}
