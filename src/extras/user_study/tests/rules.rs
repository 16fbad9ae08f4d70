use super::{AT, TWO, again, due, made, next, trial};
use crate::{EndReason, Label, QuestionnaireAnswers, StudyStep, UserStudy, seal};

fn abort(study: &mut UserStudy, participant: &str) {
    let running = study.begin_trial(participant, true, AT).unwrap();
    study.abort_trial(running, "the sensor came off", None, AT).unwrap();
}

/// Begins a trial and ends the program, as in a power failure.
fn cut(folder: &std::path::Path, mut study: UserStudy, participant: &str) -> UserStudy {
    drop(study.begin_trial(participant, true, AT).unwrap());
    drop(study);
    again(folder)
}

#[test]
fn twelve_trials_with_a_stop_and_a_power_cut_and_nothing_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    let mut study = made(folder.path(), &TWO.replace("trials = 3", "trials = 6"));
    let order = study.plan().participants[0].order.clone();
    for number in 1..=12 {
        match number {
            4 => {
                abort(&mut study, "P01");
                assert_eq!(due(&study, "P01"), (4, 2));
            }
            9 => {
                study = cut(folder.path(), study, "P01");
                assert_eq!(due(&study, "P01"), (9, 2));
            }
            _ => assert_eq!(due(&study, "P01"), (number, 1)),
        }
        trial(&mut study, "P01", 20 + number);
    }
    let progress = study.state().progress("P01").unwrap();
    assert_eq!((progress.trials.len(), progress.interruptions), (12, 2));
    for (made, number) in progress.trials.iter().zip(1_u32..) {
        assert_eq!((made.number, made.label), (number, order[(number as usize - 1) / 6]));
        let time_s = made.measures.as_ref().unwrap()["completion_time_s"];
        assert!((time_s - f64::from(20 + number)).abs() < 1e-9, "{time_s}");
    }
    assert_eq!(study.next("P01").unwrap(), StudyStep::Done { why: EndReason::Finished });
    assert_eq!(study.trials().rows, 12);
}

#[test]
fn an_interrupted_trial_is_repeated_until_its_attempts_are_over() {
    let folder = tempfile::tempdir().unwrap();
    let mut study = made(folder.path(), &format!("attempts = 2\n{TWO}"));
    abort(&mut study, "P01");
    assert_eq!(due(&study, "P01"), (1, 2));
    study = cut(folder.path(), study, "P01");
    assert_eq!(due(&study, "P01"), (2, 1), "without a result");
    let table = study.trials();
    assert_eq!((table.rows, table.missing), (0, vec![("P01".to_owned(), 1)]));
}

#[test]
fn a_short_stall_of_the_computer_consumes_no_attempt() {
    let folder = tempfile::tempdir().unwrap();
    let mut study = made(folder.path(), &format!("attempts = 2\n{TWO}"));
    for attempt in 1..=3 {
        assert_eq!(due(&study, "P01"), (1, attempt));
        let running = study.begin_trial("P01", true, AT).unwrap();
        study.abort_stalled_trial(running, "the loop ended in a fault", None, AT).unwrap();
    }
    abort(&mut study, "P01");
    drop(study);
    let mut study = again(folder.path());
    assert_eq!(due(&study, "P01"), (1, 5), "one of two attempts has been used");
    abort(&mut study, "P01");
    assert_eq!(due(&study, "P01"), (2, 1), "without a result");
    abort(&mut study, "P01");
    abort(&mut study, "P01");
    assert_eq!(due(&study, "P01"), (3, 1), "stalls of an earlier trial give no attempts");
}

#[test]
fn by_the_other_rule_the_session_resumes_with_the_next_trial() {
    let folder = tempfile::tempdir().unwrap();
    let mut study = made(folder.path(), &format!("interrupted = 'resume'\n{TWO}"));
    study = cut(folder.path(), study, "P01");
    assert_eq!(due(&study, "P01"), (2, 1));
    abort(&mut study, "P01");
    assert_eq!(due(&study, "P01"), (3, 1));
    trial(&mut study, "P01", 20);
    let with = |study: &UserStudy| {
        study.state().progress("P01").unwrap().trials.iter().filter(|made| made.ending.is_some()).count()
    };
    assert_eq!(with(&study), 1);
}

const PRACTICE: &str = "
[practice]
not_reached = 'exclude'
[practice.criterion]
time_s = 30.0
consecutive = 2
additional = 1
max_trials = 5
";

#[test]
fn practice_goes_on_to_the_criterion_and_who_does_not_reach_it_is_excluded() {
    let folder = tempfile::tempdir().unwrap();
    let mut study = made(folder.path(), &format!("{TWO}{PRACTICE}"));
    for seconds in [40, 29, 28] {
        assert!(next(&study, "P01").starts_with("practice trial"));
        trial(&mut study, "P01", seconds);
    }
    study = cut(folder.path(), study, "P01");
    assert_eq!((next(&study, "P01").as_str(), due(&study, "P01")), ("practice trial 4, attempt 2", (4, 2)));
    trial(&mut study, "P01", 30);
    assert_eq!(due(&study, "P01"), (1, 1));
    assert!(next(&study, "P01").starts_with("trial 1 under condition"));
    for seconds in [40, 20, 40, 20] {
        trial(&mut study, "P02", seconds);
    }
    (0..3).for_each(|_| abort(&mut study, "P02"));
    assert_eq!(study.next("P02").unwrap(), StudyStep::Done { why: EndReason::Excluded });
    let excluded = study.exclusions();
    assert!(excluded.len() == 1 && excluded[0].why.contains("practice"), "{excluded:?}");
    let learning = study.learning();
    assert_eq!(learning[0].times_s, [40.0, 29.0, 28.0, 30.0].map(Some));
    assert_eq!(
        (learning[1].practice, learning[1].times_s[4]),
        (5, None),
        "a trial that was broken off in every attempt counts"
    );
}

#[test]
fn practice_takes_each_condition_in_turn_or_one_that_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let mut study = made(folder.path(), &format!("{TWO}{PRACTICE}"));
    let mut seen = Vec::new();
    for _ in 0..4 {
        let running = study.begin_trial("P01", true, AT).unwrap();
        assert_eq!(running.label(), None, "practice shows no label");
        seen.push(running.condition().name.clone());
        study.end_trial(running, crate::TrialEnding::Completed, &super::score(50), AT).unwrap();
    }
    assert!(seen[0] != seen[1] && seen[0] == seen[2] && seen[1] == seen[3], "{seen:?}");
    let other = tempfile::tempdir().unwrap();
    let mut study =
        made(other.path(), &format!("{TWO}{}", PRACTICE.replace("not_reached", "under = 'Yak'\nnot_reached")));
    for _ in 0..2 {
        let running = study.begin_trial("P01", true, AT).unwrap();
        assert_eq!(running.condition().name, "Yak");
        study.end_trial(running, crate::TrialEnding::Completed, &super::score(50), AT).unwrap();
    }
}

#[test]
fn breaks_and_questionnaires_come_where_the_file_puts_them() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "{TWO}\n[breaks]\nafter_trials = 2\nleast_s = 60.0\n[questionnaires]\nafter_condition = ['realism']\nat_end = ['sus', 'free_text']"
    );
    let mut study = made(folder.path(), &text);
    let mut steps = Vec::new();
    loop {
        let step = study.next("P01").unwrap();
        steps.push(step.to_string().split(" under").next().unwrap().to_owned());
        match step {
            StudyStep::Trial { .. } => trial(&mut study, "P01", 20),
            StudyStep::Break { min_s } => {
                assert!(study.take_break("P01", 59.0, false, AT).unwrap_err().to_string().contains("60 s"));
                study.take_break("P01", min_s, false, AT).unwrap();
            }
            StudyStep::Questionnaire { questionnaire, after } => {
                let answers = match questionnaire.name() {
                    "realism" => QuestionnaireAnswers::Realism(if after == Some(Label::first(1)[0]) { 2 } else { 6 }),
                    "sus" => QuestionnaireAnswers::Sus([3; 10]),
                    _ => QuestionnaireAnswers::FreeText("good, \"very\" good".to_owned()),
                };
                study.answer("P01", answers, false, AT).unwrap();
            }
            StudyStep::Done { .. } => break,
            other => panic!("{other}"),
        }
    }
    let order = study.plan().participants[0].order.clone();
    let realism = |at: usize| format!("questionnaire realism about condition {}", order[at]);
    let pause = "a break of at least 60 s".to_owned();
    let expected = [
        "trial 1".to_owned(),
        "trial 2".to_owned(),
        pause.clone(),
        "trial 3".to_owned(),
        realism(0),
        "trial 4".to_owned(),
        pause,
        "trial 5".to_owned(),
        "trial 6".to_owned(),
        realism(1),
        "questionnaire sus at the end".to_owned(),
        "questionnaire free_text at the end".to_owned(),
        "nothing: all steps are done".to_owned(),
    ];
    assert_eq!(steps, expected);
    let table = study.questionnaires();
    assert_eq!(table.csv, "participant,condition,simulated,realism\nP01,A,no,2\nP01,B,no,6\n");
}

#[test]
fn rules_and_people_leave_out_trials_and_participants_and_say_why() {
    let folder = tempfile::tempdir().unwrap();
    let rules = "
[[exclusion]]
measure = 'completion_time_s'
is = 'above'
limit = 30.0
exclude = 'trial'
[[exclusion]]
measure = 'completion_time_s'
is = 'below'
limit = 10.0
exclude = 'participant'
times = 2
";
    let mut study = made(folder.path(), &format!("{TWO}{rules}"));
    for (participant, times_s) in
        [("P01", [20, 31, 30, 9, 20, 20]), ("P02", [9, 20, 20, 20, 9, 20]), ("P03", [20, 20, 20, 20, 20, 20])]
    {
        for seconds in times_s {
            trial(&mut study, participant, seconds);
        }
    }
    study.exclude("P03", Some(6), "the phone rang", AT).unwrap();
    let report: Vec<String> =
        study.exclusions().iter().map(|one| format!("{} {:?} {}", one.participant, one.trial, one.why)).collect();
    let expected = [
        "P01 Some(2) completion_time_s above 30",
        "P02 None completion_time_s below 10 in 2 trials or more",
        "P03 Some(6) the phone rang",
    ];
    assert_eq!(report, expected);
    let table = study.trials();
    assert_eq!((table.rows, table.excluded.len()), (5 + 5, 3));
    assert!(
        !table.csv.contains("P02")
            && table.csv.contains("P03,")
            && !table.csv.contains("P01,A,2,")
            && !table.csv.contains("P01,B,2,")
    );
    study.exclude("P03", None, "asked to be taken out", AT).unwrap();
    assert_eq!((study.trials().rows, study.next("P03").unwrap()), (5, StudyStep::Done { why: EndReason::Excluded }));
    drop(study);
    assert_eq!(again(folder.path()).trials().rows, 5, "it is in the journal");
}

#[test]
fn a_study_that_is_not_blind_names_its_conditions_from_the_beginning() {
    let folder = tempfile::tempdir().unwrap();
    let mut study = made(folder.path(), &format!("blind = false\n{TWO}"));
    trial(&mut study, "P01", 20);
    let table = study.trials();
    assert!(table.csv.contains("P01,Zebra,1,") || table.csv.contains("P01,Yak,1,"), "{}", table.csv);
    assert!(table.csv.contains("rms_rendered_n_right"));
    assert!(study.unblind("A", "x", AT).unwrap_err().to_string().contains("not blind"));
}

/// Whether the result of each of these trials is shown to P01.
fn shown(feedback: &str, seconds: &[u32]) -> Vec<bool> {
    let folder = tempfile::tempdir().unwrap();
    let task = "[task]\nname = 'x'\nkind = 'peg_transfer'\nproficiency = { time_s = 30.0 }";
    let text = format!("feedback = '{feedback}'\n{}{task}", TWO.replace("trials = 3", "trials = 8"));
    let mut study = made(folder.path(), &text);
    let mut all = Vec::new();
    for (number, seconds) in seconds.iter().enumerate() {
        // The displayed results follow from the journal alone.
        if number == 5 {
            study = cut(folder.path(), study, "P01");
        }
        trial(&mut study, "P01", *seconds);
        all.push(study.state().progress("P01").unwrap().shows_result());
        let read = UserStudy::read(&folder.path().join("study")).unwrap();
        assert_eq!(read.state().progress("P01").unwrap().shows_result(), all[number]);
    }
    all
}

#[test]
fn results_are_shown_always_or_never_or_less_often_as_skill_comes() {
    let seconds = [40, 40, 40, 40, 20, 20, 20, 20, 20, 20, 20, 20];
    assert_eq!([shown("always", &seconds), shown("never", &seconds)], [vec![true; 12], vec![false; 12]]);
    let fading = shown("fades", &seconds);
    assert_eq!(fading[..4], [true; 4], "{fading:?}");
    assert_eq!(fading[8..].iter().filter(|shown| **shown).count(), 2, "{fading:?}");
}

#[test]
fn a_study_of_an_older_program_shows_every_result() {
    let folder = tempfile::tempdir().unwrap();
    drop(made(folder.path(), TWO));
    let place = |name: &str| folder.path().join("study").join(name);
    let text = |name: &str| std::fs::read_to_string(place(name)).unwrap();
    let mut plan: toml::Table = toml::from_str(&text("study.toml")).unwrap();
    plan.insert("version".to_owned(), 1.into());
    assert!(plan.remove("feedback").is_some());
    // Its commitment covered the assignment only.
    let key = seal::Key::from_hex(&text("study.key")).unwrap();
    let sealed = key.open("conditions", &text("conditions.sealed")).unwrap();
    let mut secret: serde_json::Value = serde_json::from_slice(&sealed).unwrap();
    assert!(secret.as_object_mut().unwrap().remove("rules").is_some());
    let secret = serde_json::to_vec(&secret).unwrap();
    std::fs::write(place("conditions.sealed"), key.seal("conditions", &secret).unwrap()).unwrap();
    let before = plan.insert("commitment".to_owned(), seal::hash(&secret).into()).unwrap();
    let journal = text("journal.jsonl").replace(before.as_str().unwrap(), &seal::hash(&secret));
    std::fs::write(place("journal.jsonl"), journal).unwrap();
    std::fs::write(place("study.toml"), toml::to_string(&plan).unwrap()).unwrap();
    let mut study = again(folder.path());
    trial(&mut study, "P01", 20);
    assert!(study.state().progress("P01").unwrap().shows_result());
}
