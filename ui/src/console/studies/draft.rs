//! A study file that is made by clicks: a ready one, and what of it was changed.

use std::path::{Path, PathBuf};

use nima_core::impedance::Mode;
use nima_score::Criterion;
use nima_user_study::{Breaks, Condition, NotReached, Practice, StudyFile};

use super::list::folder_of;
use crate::{console::text, user_study};

/// A study file as the form has it. Parts that are switched off keep their figures.
#[derive(Debug)]
pub(super) struct Draft {
    /// Name of the ready study.
    pub(super) ready: &'static str,
    pub(super) file: StudyFile,
    /// Name of what is done.
    pub(super) task: String,
    pub(super) practises: bool,
    pub(super) practice: Practice,
    /// Which condition is practised, counted from 0; each in turn without one.
    pub(super) under: Option<usize>,
    pub(super) rests: bool,
    pub(super) breaks: Breaks,
    /// Which condition the others are compared with.
    pub(super) reference: Option<usize>,
}

/// Two trials in a row within 150 s without a drop out of view, as in the study of the paper.
fn usual_practice() -> Practice {
    let criterion = Criterion { time_s: 150.0, drops_out_of_view: 0, consecutive: 2, additional: 0, max_trials: 12 };
    Practice { under: None, not_reached: NotReached::GoOn, criterion }
}

impl Draft {
    /// A ready study; `None` if there is none of this name.
    pub(super) fn of(ready: &'static str) -> Option<Self> {
        let file = user_study::study_file(ready).ok()?;
        let place = |name: &Option<String>| {
            name.as_ref().and_then(|name| file.conditions.iter().position(|condition| condition.name == *name))
        };
        let practice = file.practice.clone().unwrap_or_else(usual_practice);
        let task = user_study::scene_of(&file).ok().and_then(|scene| scene.task);
        Some(Self {
            ready,
            task: task.map_or_else(String::new, |task| task.name),
            practises: file.practice.is_some(),
            under: place(&practice.under),
            practice,
            rests: file.breaks.is_some(),
            breaks: file.breaks.unwrap_or(Breaks { after_trials: 6, least_s: 180.0 }),
            reference: place(&file.reference),
            file,
        })
    }

    /// The study file as it is now.
    pub(super) fn file(&self) -> StudyFile {
        let name = |at: Option<usize>| Some(self.file.conditions.get(at?)?.name.clone());
        let practice = Practice { under: name(self.under), ..self.practice.clone() };
        StudyFile {
            practice: self.practises.then_some(practice),
            breaks: self.rests.then_some(self.breaks),
            reference: name(self.reference),
            ..self.file.clone()
        }
    }

    /// One condition more, which is not yet different from others.
    pub(super) fn add(&mut self) {
        let delay_ms = self.file.conditions.iter().find_map(|condition| condition.delay_ms).or(Some(0.0));
        self.file.conditions.push(Condition {
            name: text::studies::NEW_CONDITION.to_owned(),
            no_force: false,
            mode: Some(Mode::Best),
            gain: Some(1.0),
            delay_ms,
            own_motion: None,
        });
    }

    /// One condition less; what pointed to it points to none.
    pub(super) fn remove(&mut self, gone: usize) {
        self.file.conditions.remove(gone);
        let moved = |at: Option<usize>| at.filter(|at| *at != gone).map(|at| at - usize::from(at > gone));
        (self.under, self.reference) = (moved(self.under), moved(self.reference));
    }

    /// A folder for it that is not there yet.
    pub(super) fn place(&self, data: &Path) -> PathBuf {
        let letters = self.file.name.trim().to_lowercase().chars().take(40).collect::<String>();
        let words: Vec<&str> =
            letters.split(|letter: char| !letter.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
        let name = if words.is_empty() { self.ready.to_owned() } else { words.join("-") };
        let folder = folder_of(data);
        let numbered = (2..).map(|number| folder.join(format!("{name}-{number}")));
        std::iter::once(folder.join(&name))
            .chain(numbered)
            .find(|place| place.symlink_metadata().is_err())
            .unwrap_or(folder)
    }
}

/// The hand feels no force under this condition.
pub(super) fn without_force(condition: &mut Condition) {
    (condition.no_force, condition.mode, condition.gain, condition.own_motion) = (true, None, None, None);
}

/// The force of this condition is made in this way.
pub(super) fn with_mode(condition: &mut Condition, mode: Mode) {
    (condition.no_force, condition.mode) = (false, Some(mode));
    condition.gain.get_or_insert(1.0);
    condition.delay_ms.get_or_insert(0.0);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::user_study::{READY, mistakes};

    #[test]
    fn a_ready_study_that_nobody_changed_is_what_its_file_says() {
        for ready in READY {
            let draft = Draft::of(ready).unwrap();
            assert_eq!(draft.file(), user_study::study_file(ready).unwrap());
            assert_eq!(mistakes(&draft.file()), [""; 0]);
        }
    }

    #[test]
    fn conditions_come_and_go_and_what_is_switched_off_is_gone_from_the_file() {
        let mut draft = Draft::of("paper").unwrap();
        assert_eq!(draft.reference, Some(2));
        draft.add();
        assert!(mistakes(&draft.file()).is_empty(), "{:?}", mistakes(&draft.file()));
        draft.add();
        assert!(mistakes(&draft.file())[0].contains("two conditions are called"), "{:?}", mistakes(&draft.file()));
        draft.remove(4);
        draft.remove(0);
        assert_eq!(draft.file().reference.as_deref(), Some("No force"), "the reference follows its condition");
        draft.remove(1);
        assert_eq!(draft.file().reference, None);
        (draft.practises, draft.rests) = (false, false);
        let file = draft.file();
        assert!(file.practice.is_none() && file.breaks.is_none() && file.conditions.len() == 2);
        without_force(&mut draft.file.conditions[1]);
        assert!(mistakes(&draft.file()).is_empty());
        with_mode(&mut draft.file.conditions[1], Mode::Matched);
        assert!(mistakes(&draft.file()).is_empty());
        (draft.file.participants, draft.file.trials, draft.file.name) = (0, 0, "DFR".to_owned());
        assert_eq!(mistakes(&draft.file()).len(), 3, "{:?}", mistakes(&draft.file()));
    }

    #[test]
    fn a_new_study_never_takes_the_place_of_another() {
        let folder = tempfile::tempdir().unwrap();
        let draft = Draft::of("short").unwrap();
        let first = draft.place(folder.path());
        assert_eq!(first, folder.path().join("studies/short-trial-of-a-study"));
        std::fs::create_dir_all(&first).unwrap();
        assert_eq!(draft.place(folder.path()), folder.path().join("studies/short-trial-of-a-study-2"));
    }
}
