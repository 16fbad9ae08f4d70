use std::{fs, path::Path};

use super::{AT, TWO, again, file, made, score, score_with, trial};
use crate::{StudyError, TrialEnding, UserStudy, order, seal};

/// Returns all names and bytes under a folder.
fn everything(folder: &Path) -> Vec<u8> {
    let mut all = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        all.extend(path.to_string_lossy().bytes());
        let mut content = if path.is_dir() { everything(&path) } else { fs::read(&path).unwrap() };
        if path.extension().is_some_and(|end| end == "sealed")
            && path.parent().is_some_and(|at| at.ends_with("sessions"))
        {
            // A megabyte of random bytes contains "yak" by chance; the longer names are enough here.
            content.retain(|byte| !byte.eq_ignore_ascii_case(&b'y'));
        }
        all.extend(content);
    }
    all
}

fn found(folder: &Path) -> Vec<&'static str> {
    let all = String::from_utf8_lossy(&everything(folder)).to_lowercase();
    let words = ["zebra", "yak", "anchored", "no_force", "137.5", "0.1375", "0.8125", "1.625"];
    words.into_iter().filter(|word| all.contains(word)).collect()
}

#[test]
fn nothing_in_the_folder_tells_the_conditions_before_the_unblinding_and_everything_after() {
    let folder = tempfile::tempdir().unwrap();
    let mut study = made(folder.path(), &format!("record = true\n{TWO}"));
    trial(&mut study, "P01", 20);
    let running = study.begin_trial("P01", true, AT).unwrap();
    fs::write(running.session().unwrap(), "mode = anchored, delay 137.5").unwrap();
    assert!(!format!("{running:?} {study:?}").to_lowercase().contains("anchored"));
    study.end_trial(running, TrialEnding::Completed, &score(21), AT).unwrap();
    let table = study.trials();
    assert!(table.csv.contains("P01,A,") || table.csv.contains("P01,B,"), "{}", table.csv);
    assert!(!table.csv.contains("rendered"), "{}", table.csv);
    assert!(study.opened().is_none() && found(folder.path()).is_empty(), "{:?}", found(folder.path()));

    study.unblind("A. Person", "all have finished", AT).unwrap();
    let table = study.trials();
    assert!(table.csv.contains(",peak_rendered_n_right") && table.csv.contains(",1.625"), "{}", table.csv);
    let order = &study.plan().participants[0].order;
    let name = |label| study.opened().unwrap().condition(label).unwrap().name.clone();
    let row = table.csv.lines().nth(1).unwrap();
    assert!(row.starts_with(&format!("P01,{},1,yes,", name(order[0]))), "{row}");
    assert_eq!(found(folder.path()).len(), 6, "the session too: {:?}", found(folder.path()));
    let unblinding = study.state().unblinding.clone().unwrap();
    assert_eq!((unblinding.trials_before, unblinding.complete, unblinding.who.as_str()), (2, false, "A. Person"));
    assert!(study.unblind("B. Person", "again", AT).unwrap_err().to_string().contains("A. Person"));
    trial(&mut study, "P02", 20);
    let after = |study: &UserStudy| study.state().progress("P02").unwrap().trials[0].unblinded;
    assert!(after(&study), "what is made after it is marked");
    drop(study);
    assert!(after(&again(folder.path())));
}

#[test]
fn the_commitment_is_the_hash_of_what_is_opened_later() {
    let folder = tempfile::tempdir().unwrap();
    let mut study = made(folder.path(), TWO);
    let commitment = study.plan().commitment.clone();
    study.unblind("A", "end", AT).unwrap();
    let opened = fs::read(folder.path().join("study/conditions.json")).unwrap();
    assert_eq!(seal::hash(&opened), commitment);
    // BLAKE2b-256 of "abc", as b2sum -l 256 prints it.
    assert_eq!(seal::hash(b"abc"), "bddd813c634239723171ef3fee98579b94964e3bb1cb3e427262c8c068d52319");
    let other = tempfile::tempdir().unwrap();
    assert_ne!(made(other.path(), TWO).plan().commitment, commitment, "the salt is another one");
}

#[test]
fn an_assignment_or_a_plan_that_was_changed_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join("study").join(name);
    drop(made(folder.path(), TWO));
    let other = tempfile::tempdir().unwrap();
    drop(made(other.path(), TWO));
    let refused = |words: &str| {
        for report in [
            UserStudy::read(&folder.path().join("study")).unwrap_err(),
            UserStudy::open(&folder.path().join("study"), AT).unwrap_err(),
        ] {
            assert!(report.to_string().contains(words) && report.to_string().lines().count() == 1, "{report}");
        }
    };
    let whole = fs::read_to_string(place("conditions.sealed")).unwrap();
    let last = whole.trim_end().chars().last().unwrap();
    let changed = whole.trim_end().trim_end_matches(last).to_owned() + if last == '0' { "1" } else { "0" };
    for broken in [changed, whole[..whole.len() / 2].to_owned(), "zz".to_owned(), String::new()] {
        fs::write(place("conditions.sealed"), broken).unwrap();
        refused("conditions.sealed");
    }
    // Another study's assignment with its key.
    for name in ["conditions.sealed", "study.key"] {
        fs::remove_file(place(name)).unwrap();
        fs::copy(other.path().join("study").join(name), place(name)).unwrap();
    }
    refused("does not match the commitment");
    let text = fs::read_to_string(place("study.toml")).unwrap();
    let theirs = fs::read_to_string(other.path().join("study/study.toml")).unwrap();
    let line = |text: &str| text.lines().find(|line| line.starts_with("commitment")).unwrap().to_owned();
    fs::write(place("study.toml"), text.replace(&line(&text), &line(&theirs))).unwrap();
    refused("one of the two files was changed");
    fs::remove_file(place("study.key")).unwrap();
    refused("study.key");
}

#[test]
fn labels_follow_from_the_seed_and_without_one_they_differ() {
    let labels = |text: &str| {
        let folder = tempfile::tempdir().unwrap();
        let mut study = made(folder.path(), text);
        let orders: Vec<_> = study.plan().participants.clone();
        study.unblind("A", "end", AT).unwrap();
        let labels: Vec<String> = study.opened().unwrap().labels().map(|(_, name)| name.to_owned()).collect();
        (labels, orders)
    };
    assert_eq!(labels(TWO), labels(TWO));
    let many = TWO.replace("participants = 4", "participants = 40");
    let without = many.replace("seed = 5\n", "");
    assert_ne!(labels(&without).1, labels(&without).1, "2^20 orders");
    let swapped =
        (0..20).filter(|seed| labels(&TWO.replace("seed = 5", &format!("seed = {seed}"))).0[0] == "Zebra").count();
    assert!((3..=17).contains(&swapped), "{swapped} of 20");
    assert!(!file(TWO).participants.is_multiple_of(3) && order::williams(2).len() == 2);
}

#[test]
fn long_texts_are_sealed_in_pieces_that_cannot_be_changed_exchanged_or_cut_off() {
    let key = seal::Key::new().unwrap();
    for length in [0, 1, 65_535, 65_536, 65_537, 200_000] {
        let plain: Vec<u8> = (0..length).map(|at: u32| (at % 251) as u8).collect();
        let mut sealed = Vec::new();
        key.seal_stream("session", plain.as_slice(), &mut sealed).unwrap();
        let open = |key: &seal::Key, purpose: &str, sealed: &[u8]| {
            let mut opened = Vec::new();
            key.open_stream(purpose, sealed, &mut opened).map(|()| opened)
        };
        assert_eq!(open(&key, "session", &sealed).unwrap(), plain);
        assert!(open(&key, "measures", &sealed).is_err(), "another purpose");
        assert!(open(&seal::Key::new().unwrap(), "session", &sealed).is_err(), "another key");
        for at in [0, 10, 24, sealed.len() / 2, sealed.len() - 1] {
            let mut changed = sealed.clone();
            changed[at] ^= 1;
            assert!(open(&key, "session", &changed).is_err(), "byte {at} of {}", sealed.len());
        }
        for cut in [0, 23, 24, sealed.len() - 1, sealed.len().saturating_sub(16)] {
            assert!(open(&key, "session", &sealed[..cut]).is_err(), "cut at {cut} of {}", sealed.len());
        }
        if length >= 200_000 {
            let head = 24;
            let piece = 65_536 + 16;
            assert!(open(&key, "session", &sealed[..head + 2 * piece]).is_err(), "whole pieces are missing");
            let mut exchanged = sealed.clone();
            exchanged[head..head + 2 * piece].rotate_left(piece);
            assert!(open(&key, "session", &exchanged).is_err());
        }
    }
}

#[test]
fn a_folder_with_something_in_it_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("thesis.txt"), "years").unwrap();
    let report = UserStudy::create(folder.path(), &file(TWO), "", AT).unwrap_err();
    assert!(matches!(report, StudyError::Exists { .. }), "{report}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    assert!(UserStudy::read(folder.path()).unwrap_err().to_string().contains("study.toml"));
    let empty = folder.path().join("empty");
    fs::create_dir(&empty).unwrap();
    UserStudy::create(&empty, &file(TWO), "", AT).unwrap();
    UserStudy::read(&empty).unwrap();
}

#[test]
fn a_recording_that_a_power_cut_left_open_is_sealed_when_the_study_is_opened_again() {
    let folder = tempfile::tempdir().unwrap();
    let mut study = made(folder.path(), &format!("record = true\n{TWO}"));
    let running = study.begin_trial("P01", true, AT).unwrap();
    let session = running.session().unwrap().to_owned();
    fs::write(&session, "mode = anchored, delay 137.5").unwrap();
    drop((running, study));
    assert_eq!(found(folder.path()), ["anchored", "137.5"], "until then it can be read");
    let mut study = again(folder.path());
    assert!(!session.exists() && found(folder.path()).is_empty(), "{:?}", found(folder.path()));
    study.unblind("A", "end", AT).unwrap();
    assert_eq!(fs::read_to_string(session).unwrap(), "mode = anchored, delay 137.5");
}

#[test]
fn a_recording_that_cannot_be_sealed_costs_neither_a_result_nor_the_study() {
    let folder = tempfile::tempdir().unwrap();
    let mut study = made(folder.path(), &format!("record = true\n{TWO}"));
    let mut blocked = Vec::new();
    for number in 1..=2 {
        let running = study.begin_trial("P01", true, AT).unwrap();
        let session = running.session().unwrap().to_owned();
        fs::write(&session, "mode = anchored, delay 137.5").unwrap();
        // A file cannot replace a folder: the sealing fails after the recording was read, as on a full disk.
        let sealed = session.with_extension("mcap.sealed");
        fs::create_dir(&sealed).unwrap();
        blocked.push((session, sealed));
        if number == 1 {
            study.end_trial(running, TrialEnding::Completed, &score(20), AT).unwrap();
        } else {
            study.abort_trial(running, "the sensor came off", None, AT).unwrap();
        }
        let trouble = study.take_trouble().unwrap();
        assert!(trouble.contains("cannot encrypt") && trouble.contains(".mcap.sealed"), "{trouble}");
    }
    drop(study);
    let mut study = again(folder.path());
    assert!(study.take_trouble().is_some_and(|trouble| trouble.contains("open the study again")));
    let progress = study.state().progress("P01").unwrap();
    assert_eq!((study.trials().rows, progress.trials.len(), progress.interruptions), (1, 1, 1));
    fs::remove_dir(&blocked[0].1).unwrap();
    drop(study);
    let mut study = again(folder.path());
    assert!(study.take_trouble().is_some() && blocked[0].1.is_file(), "one failure does not prevent the other");
    fs::remove_dir(&blocked[1].1).unwrap();
    drop(study);
    let mut study = again(folder.path());
    assert_eq!(study.take_trouble(), None);
    assert!(blocked.iter().all(|(session, sealed)| !session.exists() && sealed.is_file()));
    assert!(found(folder.path()).is_empty(), "{:?}", found(folder.path()));
}

/// Returns everything about the trials that does not need the key: the lines of the journal without digits, which stand
/// for times, numbers and hashes, and the lengths of lines and files.
fn readable(folder: &Path) -> Vec<(String, usize)> {
    let journal = fs::read_to_string(folder.join("study/journal.jsonl")).unwrap();
    let letters = |line: &str| line.chars().filter(|one| !one.is_ascii_hexdigit()).collect::<String>();
    let ends = journal.lines().filter(|line| line.contains("trial_ended") || line.contains("trial_aborted"));
    let mut all: Vec<_> = ends.map(|line| (letters(line), line.len())).collect();
    let mut sessions: Vec<_> = fs::read_dir(folder.join("study/sessions"))
        .unwrap()
        .map(|entry| entry.unwrap())
        .map(|entry| (letters(&entry.file_name().to_string_lossy()), entry.metadata().unwrap().len() as usize))
        .collect();
    sessions.sort();
    all.extend(sessions);
    all
}

#[test]
fn a_trial_with_force_reads_like_one_without() {
    let run = |force_n: f64, session: usize, details: &str| {
        let folder = tempfile::tempdir().unwrap();
        let mut study = made(folder.path(), &format!("record = true\n{TWO}"));
        for number in 0..6 {
            let running = study.begin_trial("P01", true, AT).unwrap();
            // This size remains of a session after compression.
            fs::write(running.session().unwrap(), vec![7; session + number]).unwrap();
            if number == 5 {
                study.abort_trial(running, "the loop ended in a fault", Some(details), AT).unwrap();
            } else {
                study.end_trial(running, TrialEnding::Completed, &score_with(20, force_n), AT).unwrap();
            }
        }
        (readable(folder.path()), folder, study)
    };
    let (with, folder, mut study) = run(1.625, 3_150_000, "the energy gate has closed for 2 s");
    let (without, ..) = run(0.0, 2_950_000, "the arm reported a fault");
    assert_eq!(with.len(), 12);
    assert_eq!(with, without, "a classifier has nothing to go by");
    study.unblind("A", "end", AT).unwrap();
    let sessions = fs::read_dir(folder.path().join("study/sessions")).unwrap();
    let mut sizes: Vec<_> = sessions.map(|entry| entry.unwrap().metadata().unwrap().len()).collect();
    sizes.sort_unstable();
    assert_eq!(sizes, [0, 1, 2, 3, 4, 5].map(|more| 3_150_000 + more), "without the padding");
}

#[test]
fn a_shorter_recording_is_padded_like_the_longest_before_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut study = made(folder.path(), &format!("record = true\n{TWO}"));
    let mut sizes = Vec::new();
    for session in [5_000_000, 100_000, 3_000_000] {
        let running = study.begin_trial("P01", true, AT).unwrap();
        let plain = running.session().unwrap().to_owned();
        fs::write(&plain, vec![7; session]).unwrap();
        study.end_trial(running, TrialEnding::Completed, &score(20), AT).unwrap();
        sizes.push(fs::metadata(format!("{}.sealed", plain.display())).unwrap().len());
    }
    assert!(sizes[0] > 8 << 20 && sizes.iter().all(|size| *size == sizes[0]), "{sizes:?}");
}

#[test]
fn a_sealed_text_is_valid_for_its_own_trial_only() {
    let folder = tempfile::tempdir().unwrap();
    let mut study = made(folder.path(), &format!("record = true\n{TWO}"));
    let mut plain = Vec::new();
    for _ in 0..2 {
        let running = study.begin_trial("P01", true, AT).unwrap();
        plain.push(running.session().unwrap().to_owned());
        fs::write(&plain[plain.len() - 1], "a session").unwrap();
        study.end_trial(running, TrialEnding::Completed, &score(20), AT).unwrap();
    }
    let sealed = |number: u32, attempt: u32| {
        let trial = crate::TrialId { phase: crate::TrialPhase::Trial, number, attempt };
        (trial, study.state().progress("P01").unwrap().trials[number as usize - 1].withheld.clone())
    };
    let [(first, of_first), (second, of_second)] = [sealed(1, 1), sealed(2, 1)];
    let ended = |trial, withheld| crate::StudyEvent::TrialEnded {
        participant: "P01".to_owned(),
        trial,
        ending: TrialEnding::Completed,
        measures: crate::TrialMeasures::new(),
        withheld,
        session: None,
    };
    study.check_sealed(&ended(first, of_first.clone())).unwrap();
    study.check_sealed(&ended(second, of_second)).unwrap();
    assert!(study.check_sealed(&ended(second, of_first)).unwrap_err().contains("not of this trial"));
    let names = plain.iter().map(|path| format!("{}.sealed", path.display())).collect::<Vec<_>>();
    fs::rename(&names[0], folder.path().join("swap")).unwrap();
    fs::rename(&names[1], &names[0]).unwrap();
    fs::rename(folder.path().join("swap"), &names[1]).unwrap();
    assert!(study.unblind("A", "end", AT).unwrap_err().to_string().contains("changed"));
}

#[test]
fn the_commitment_covers_the_rules_of_the_study() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join("study").join(name);
    drop(made(folder.path(), TWO));
    for (name, from, to) in [
        ("study.toml", "primary = \"completion_time_s\"", "primary = \"trial_time_s\""),
        ("study.toml", "attempts = 3", "attempts = 4"),
        ("study.toml", "version = 3", "version = 2"),
        ("scene.toml", "scene", "arena"),
    ] {
        let whole = fs::read_to_string(place(name)).unwrap();
        assert!(whole.contains(from), "{whole}");
        fs::write(place(name), whole.replacen(from, to, 1)).unwrap();
        let refused = UserStudy::read(&folder.path().join("study")).unwrap_err().to_string();
        assert!(refused.contains(name) && refused.contains("was changed after the study was created"), "{refused}");
        fs::write(place(name), whole).unwrap();
    }
    UserStudy::read(&folder.path().join("study")).unwrap();
}
