//! A study file created in the form: a template, and its changes.

use std::path::{Path, PathBuf};

use nima_core::{Side, impedance::Mode, task::TaskKind};
use nima_score::{CatalogueDefinition, MEASURES, TaskCriterion, TaskFile};
use nima_simulation::scene::Scene;
use nima_user_study::{
    Breaks, Condition, Excludes, ExclusionRule, MeasureComparison, NotReached, Practice, StudyFile, keys_of,
};

use super::list::folder_of;
use crate::extras::user_studies::{study, text};

/// A study file as the form shows it. Parts that are switched off keep their values.
#[derive(Debug)]
pub(super) struct Draft {
    /// Name of the template.
    pub(super) ready: &'static str,
    pub(super) file: StudyFile,
    /// Scenes to choose from.
    pub(super) scenes: Vec<ScenePlace>,
    /// The task of this study.
    pub(super) task: Option<TaskFile>,
    /// Use only some rings of the scene.
    pub(super) takes_few: bool,
    pub(super) rings: u32,
    /// Measures available in this scene.
    pub(super) measures: Vec<MeasureChoice>,
    pub(super) practises: bool,
    pub(super) practice: Practice,
    /// Practised condition, counted from 0; `None`: each in turn.
    pub(super) under: Option<usize>,
    pub(super) rests: bool,
    pub(super) breaks: Breaks,
    /// Reference condition.
    pub(super) reference: Option<usize>,
}

#[derive(Clone, Debug)]
pub(super) struct ScenePlace {
    /// Built-in name or file.
    pub(super) of: String,
    pub(super) name: String,
    pub(super) about: String,
    /// Task of the study in this scene; `None` if the scene has its own.
    task: Option<TaskFile>,
    kind: TaskKind,
    two_hands: bool,
    /// Number of rings.
    pub(super) rings: u32,
}

/// A measure, with its key and its text.
#[derive(Clone, Debug)]
pub(super) struct MeasureChoice {
    pub(super) key: String,
    pub(super) words: &'static str,
    pub(super) unit: &'static str,
}

impl ScenePlace {
    /// Returns the scene of this name, if it has a task or gets this one.
    fn of(name: &str, task: Option<TaskFile>) -> Option<Self> {
        let scene = Scene::load(name).ok()?;
        let kind = task.as_ref().map(|task| task.kind).or(scene.task.as_ref().map(|task| task.kind))?;
        let rings = scene.objects.as_ref().map_or(0, |objects| objects.rings.len() as u32);
        let (name, of) = (scene.name, name.to_owned());
        Some(Self { of, name, about: scene.description, task, kind, two_hands: scene.left.is_some(), rings })
    }

    fn measures(&self) -> Vec<MeasureChoice> {
        let hands: &[Side] = if self.two_hands { &Side::LEFT_TO_RIGHT } else { &[Side::Right] };
        // A simulated scene does not report objects that leave the image.
        let fits = |one: &&CatalogueDefinition| one.is_of(self.kind, self.two_hands) && one.id != "out_of_view_share";
        let known = |definition: &'static CatalogueDefinition| {
            let of = move |key| MeasureChoice { key, words: definition.words, unit: definition.unit };
            keys_of(definition, hands).into_iter().map(of)
        };
        MEASURES.iter().filter(fits).flat_map(known).collect()
    }
}

/// Returns the task in the scene of this study.
fn task_of(file: &StudyFile) -> Option<TaskFile> {
    TaskFile::of(study::scene_of(file).ok()?.task.as_ref()?).ok()
}

/// Two trials in a row within 150 s without a drop out of view, as in the paper's study.
fn usual_practice() -> Practice {
    let criterion =
        TaskCriterion { time_s: 150.0, drops_out_of_view: 0, consecutive: 2, additional: 0, max_trials: 12 };
    Practice { under: None, not_reached: NotReached::GoOn, criterion }
}

impl Draft {
    /// `None` if no template has this name.
    pub(super) fn of(ready: &'static str) -> Option<Self> {
        let file = study::study_file(ready).ok()?;
        let place = |name: &Option<String>| {
            name.as_ref().and_then(|name| file.conditions.iter().position(|condition| condition.name == *name))
        };
        let practice = file.practice.clone().unwrap_or_else(usual_practice);
        let task = task_of(&file);
        let own = file.task.is_some().then(|| ScenePlace::of(&file.scene, file.task.clone())).flatten();
        let scenes: Vec<ScenePlace> =
            own.into_iter().chain(Scene::names().filter_map(|name| ScenePlace::of(name, None))).collect();
        let measures = scenes.iter().find(|place| place.of == file.scene).map_or_else(Vec::new, ScenePlace::measures);
        Some(Self {
            ready,
            scenes,
            task,
            takes_few: file.rings.is_some(),
            rings: file.rings.unwrap_or(2),
            measures,
            practises: file.practice.is_some(),
            under: place(&practice.under),
            practice,
            rests: file.breaks.is_some(),
            breaks: file.breaks.unwrap_or(Breaks { after_trials: 6, min_s: 180.0 }),
            reference: place(&file.reference),
            file,
        })
    }

    /// Returns the study file in its current state.
    pub(super) fn file(&self) -> StudyFile {
        let name = |at: Option<usize>| Some(self.file.conditions.get(at?)?.name.clone());
        let practice = Practice { under: name(self.under), ..self.practice.clone() };
        StudyFile {
            practice: self.practises.then_some(practice),
            breaks: self.rests.then_some(self.breaks),
            reference: name(self.reference),
            rings: Some(self.rings).filter(|_| self.takes_few),
            ..self.file.clone()
        }
    }

    /// Returns the chosen scene.
    pub(super) fn place_of_scene(&self) -> Option<&ScenePlace> {
        self.scenes.iter().find(|place| place.of == self.file.scene)
    }

    /// Selects another scene, with its task. Measures that are not available there are removed, with the rules that use
    /// them.
    pub(super) fn choose(&mut self, at: usize) {
        let Some(place) = self.scenes.get(at).filter(|place| place.of != self.file.scene).cloned() else { return };
        self.measures = place.measures();
        self.takes_few = false;
        self.file.task = place.task;
        self.file.scene = place.of;
        self.task = task_of(&self.file());
        let known = |key: &String| self.measures.iter().any(|measure| measure.key == *key);
        self.file.secondary.retain(known);
        self.file.exclusion.retain(|rule| known(&rule.measure));
        if !known(&self.file.primary) {
            let ends = self.measures.iter().find(|measure| measure.key == "completion_time_s");
            let first = ends.or(self.measures.first()).map(|measure| measure.key.clone());
            self.file.primary = first.unwrap_or_default();
            self.file.secondary.retain(|key| *key != self.file.primary);
        }
    }

    /// Time limit of a trial, s.
    pub(super) fn limit(&mut self, limit_s: f64) {
        if let Some(task) = &mut self.task {
            task.time_limit_s = limit_s;
            self.file.task = Some(task.clone());
        }
    }

    pub(super) fn add_rule(&mut self) {
        let is = MeasureComparison::Above;
        let exclude = Excludes::Trial;
        let measure = self.file.primary.clone();
        self.file.exclusion.push(ExclusionRule { measure, is, limit: None, exclude, times: 1 });
    }

    /// Adds a condition, which is not yet different from the others.
    pub(super) fn add(&mut self) {
        let delay_ms = self.file.conditions.iter().find_map(|condition| condition.delay_ms).or(Some(0.0));
        self.file.conditions.push(Condition {
            name: text::study_form::NEW_CONDITION.get().to_owned(),
            no_force: false,
            mode: Some(Mode::Best),
            gain: Some(1.0),
            delay_ms,
            own_motion: None,
        });
    }

    /// Adds a condition that does not yet differ from the others.
    pub(super) fn remove(&mut self, gone: usize) {
        self.file.conditions.remove(gone);
        let moved = |at: Option<usize>| at.filter(|at| *at != gone).map(|at| at - usize::from(at > gone));
        self.under = moved(self.under);
        self.reference = moved(self.reference);
    }

    /// Returns a folder for the study that does not exist yet.
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

/// Sets a condition without force.
pub(super) fn without_force(condition: &mut Condition) {
    condition.no_force = true;
    condition.mode = None;
    condition.gain = None;
    condition.own_motion = None;
}

/// Sets the mode of a condition with force.
pub(super) fn with_mode(condition: &mut Condition, mode: Mode) {
    condition.no_force = false;
    condition.mode = Some(mode);
    condition.gain.get_or_insert(1.0);
    condition.delay_ms.get_or_insert(0.0);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::extras::user_studies::study::{READY, mistakes};

    #[test]
    fn a_ready_study_that_nobody_changed_is_what_its_file_says() {
        for ready in READY {
            let draft = Draft::of(ready).unwrap();
            assert_eq!(draft.file(), study::study_file(ready).unwrap());
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
        draft.practises = false;
        draft.rests = false;
        let file = draft.file();
        assert!(file.practice.is_none() && file.breaks.is_none() && file.conditions.len() == 2);
        without_force(&mut draft.file.conditions[1]);
        assert!(mistakes(&draft.file()).is_empty());
        with_mode(&mut draft.file.conditions[1], Mode::Matched);
        assert!(mistakes(&draft.file()).is_empty());
        draft.file.participants = 0;
        draft.file.trials = 0;
        draft.file.name = "DFR".to_owned();
        assert_eq!(mistakes(&draft.file()).len(), 3, "{:?}", mistakes(&draft.file()));
    }

    #[test]
    fn every_scene_with_a_task_can_be_chosen_and_keeps_the_measures_that_it_has() {
        let mut draft = Draft::of("paper").unwrap();
        let names: Vec<String> = draft.scenes.iter().map(|place| place.of.clone()).collect();
        assert_eq!(names, ["rings", "find_lumps", "wire"]);
        let has = |draft: &Draft, key: &str| draft.measures.iter().any(|known| known.key == key);
        assert!(has(&draft, "drops") && has(&draft, "peak_force_n_left") && !has(&draft, "wire_touches"));
        for (at, (name, own)) in names.into_iter().zip(["drops", "lumps_found", "wire_touches"]).enumerate().rev() {
            draft.choose(at);
            assert_eq!(draft.file().scene, name);
            assert!(has(&draft, own), "{name}");
            assert_eq!(mistakes(&draft.file()), [""; 0], "{name}");
            let known = |key: &String| draft.measures.iter().any(|measure| measure.key == *key);
            assert!(draft.file.secondary.iter().chain([&draft.file.primary]).all(known));
        }
        assert!(!draft.file.secondary.contains(&"drops".to_owned()), "the wire had none");
        draft.limit(45.0);
        let file = draft.file();
        let task = file.task.unwrap();
        assert_eq!((task.kind, task.time_limit_s), (TaskKind::PegTransfer, 45.0));
        let short = Draft::of("short").unwrap();
        assert_eq!(short.scenes.len(), 4, "its own scene too");
        assert!(
            has(&short, "mean_force_n_right") && !has(&short, "mean_force_n_left") && !has(&short, "completion_time_s")
        );
    }

    #[test]
    fn a_short_study_goes_to_another_scene_and_back() {
        let mut draft = Draft::of("short").unwrap();
        let before = draft.file();
        draft.choose(1);
        assert_eq!(draft.file().scene, "rings");
        assert!(draft.file().task.is_none(), "that of the scene");
        draft.choose(0);
        assert_eq!((draft.file().scene, draft.file().task), (before.scene, before.task));
    }

    #[test]
    fn a_rule_says_what_it_lacks() {
        let mut draft = Draft::of("paper").unwrap();
        draft.add_rule();
        let last = draft.file.exclusion.len() - 1;
        assert!(mistakes(&draft.file())[0].contains("limit is missing"), "{:?}", mistakes(&draft.file()));
        draft.file.exclusion[last].limit = Some(2.0);
        assert!(mistakes(&draft.file()).is_empty());
        draft.takes_few = true;
        draft.rings = 9;
        assert_eq!(mistakes(&draft.file()), ["rings = 9: scene \"Rings on pegs\" has 6"]);
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
