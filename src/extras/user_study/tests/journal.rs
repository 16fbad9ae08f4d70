use std::fs;

use super::{AT, TWO, again, due, made, next, trial};
use crate::{QuestionnaireAnswers, StudyError, StudyState, StudyStep, UserStudy};

fn journal(folder: &tempfile::TempDir) -> std::path::PathBuf {
    folder.path().join("study/journal.jsonl")
}

#[test]
fn a_torn_last_line_is_dropped_and_told_and_nothing_else_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    let mut study = made(folder.path(), TWO);
    trial(&mut study, "P01", 20);
    trial(&mut study, "P01", 21);
    drop(study);
    let whole = fs::read(journal(&folder)).unwrap();
    let lines: Vec<usize> =
        whole.iter().enumerate().filter(|(_, byte)| **byte == b'\n').map(|(at, _)| at + 1).collect();
    // Every position at which a write can have been cut off in the last line, and zeros, as some file systems leave
    // them.
    let last = lines[lines.len() - 2];
    let cuts = (last..whole.len()).step_by(7).chain([whole.len() - 1]);
    let zeros = [&whole[..last], &[0; 64]].concat();
    for torn in cuts.map(|cut| whole[..cut].to_vec()).chain([zeros]) {
        fs::write(journal(&folder), &torn).unwrap();
        let bytes = (torn.len() - last) as u64;
        let looked = UserStudy::read(&folder.path().join("study")).unwrap();
        assert!(matches!(looked.next("P01").unwrap(), StudyStep::Running { .. }));
        assert_eq!(fs::read(journal(&folder)).unwrap(), torn, "looking changes nothing");
        let study = again(folder.path());
        assert_eq!(study.state().torn, if bytes > 0 { vec![bytes] } else { vec![] });
        let progress = study.state().progress("P01").unwrap();
        assert_eq!(
            (progress.trials.len(), progress.interruptions),
            (1, 1),
            "the first is kept, the second was running"
        );
        assert_eq!(due(&study, "P01"), (2, 2));
        drop(study);
        let kept = fs::read(journal(&folder)).unwrap();
        assert_eq!(kept[..last], whole[..last]);
        assert_eq!(kept.last(), Some(&b'\n'));
        drop(again(folder.path()));
        assert_eq!(fs::read(journal(&folder)).unwrap(), kept, "once");
    }
}

#[test]
fn what_comes_next_is_a_function_of_plan_and_journal_alone() {
    let folder = tempfile::tempdir().unwrap();
    let mut study = made(folder.path(), TWO);
    for participant in ["P02", "P01", "P02"] {
        trial(&mut study, participant, 30);
    }
    let entries: Vec<crate::JournalEntry> =
        fs::read_to_string(journal(&folder)).unwrap().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let of = |count: usize| StudyState::of(study.plan(), &entries[..count]).unwrap();
    for count in 1..=entries.len() {
        for participant in &study.plan().participants {
            assert_eq!(of(count).next(study.plan(), participant), of(count).next(study.plan(), participant));
        }
    }
    let who = study.plan().participant("P02").unwrap();
    assert_eq!(of(entries.len()).next(study.plan(), who), study.next("P02").unwrap());
    let twice: Vec<&crate::JournalEntry> = entries.iter().chain(entries.last()).collect();
    let (line, why) = StudyState::of(study.plan(), twice).unwrap_err();
    assert!(line == entries.len() as u64 && why.contains("had not begun"), "{why}");
}

#[test]
fn a_journal_that_was_changed_is_refused_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let mut study = made(folder.path(), TWO);
    trial(&mut study, "P01", 20);
    drop(study);
    let whole = fs::read_to_string(journal(&folder)).unwrap();
    let lines: Vec<&str> = whole.lines().collect();
    let without = |at: usize| {
        let kept = lines.iter().enumerate().filter(|(line, _)| *line != at).map(|(_, text)| format!("{text}\n"));
        kept.collect::<String>()
    };
    for (text, words) in [
        (without(0), "line 1: it has number 2"),
        (without(1), "line 2: it has number 3"),
        (whole.replace("trial_ended", "trial_won"), "line 4: it is not a journal entry"),
        (
            whole.replace("\"number\":1,\"attempt\":1,\"label\"", "\"number\":2,\"attempt\":1,\"label\""),
            "line 3: it, or a line before it, was changed",
        ),
        (whole.replace("P01", "P09"), "line 2: it, or a line before it, was changed"),
        (whole.replacen("\"completion_time_s\":20", "\"completion_time_s\":19", 1), "line 4: it, or a line"),
        (whole.replacen("\"commitment\":\"", "\"commitment\":\"0", 1), "line 1: it, or a line"),
        (String::new(), "restore it"),
        ("\n".to_owned(), "line 1"),
    ] {
        fs::write(journal(&folder), text).unwrap();
        let report = UserStudy::open(&folder.path().join("study"), AT).unwrap_err().to_string();
        assert!(report.contains(words) && report.lines().count() == 1, "{words}: {report}");
    }
}

#[test]
fn one_program_at_a_time_writes_and_others_may_look() {
    let folder = tempfile::tempdir().unwrap();
    let mut study = made(folder.path(), TWO);
    let report = UserStudy::open(&folder.path().join("study"), AT).unwrap_err();
    assert!(matches!(report, StudyError::InUse { .. }), "{report}");
    let running = study.begin_trial("P01", true, AT).unwrap();
    let mut looking = UserStudy::read(&folder.path().join("study")).unwrap();
    assert!(next(&looking, "P01").contains("has begun"));
    assert!(matches!(looking.note(None, "x", AT), Err(StudyError::ReadOnly)));
    study.abort_trial(running, "a visitor came in", None, AT).unwrap();
    assert_eq!(due(&study, "P01"), (1, 2));
}

#[test]
fn what_is_not_next_is_refused_and_does_not_stand_in_the_journal() {
    let folder = tempfile::tempdir().unwrap();
    let mut study = made(folder.path(), &format!("{TWO}\n[questionnaires]\nafter_condition = ['realism']"));
    let before = fs::read(journal(&folder)).unwrap();
    let refused = |result: Result<(), StudyError>, words: &str| {
        let report = result.unwrap_err().to_string();
        assert!(report.contains(words), "{words}: {report}");
    };
    refused(study.answer("P01", QuestionnaireAnswers::Realism(3), true, AT), "not the next step; do trial 1");
    refused(study.answer("P77", QuestionnaireAnswers::Realism(3), true, AT), "choose one of P01 to P04");
    refused(study.exclude("P01", Some(1), "fell asleep", AT), "has not done trial 1");
    refused(study.exclude("P01", None, " ", AT), "requires a reason");
    refused(study.unblind("", "x", AT), "requires a name");
    assert_eq!(fs::read(journal(&folder)).unwrap(), before);
    (0..3).for_each(|_| trial(&mut study, "P01", 20));
    refused(study.begin_trial("P01", true, AT).map(drop), "questionnaire realism");
    refused(study.answer("P01", QuestionnaireAnswers::Sus([3; 10]), true, AT), "sus is not the next step");
    refused(study.answer("P01", QuestionnaireAnswers::Realism(9), true, AT), "from 1 to 7");
    study.answer("P01", QuestionnaireAnswers::Realism(6), true, AT).unwrap();
    assert_eq!(due(&study, "P01"), (4, 1));
}
