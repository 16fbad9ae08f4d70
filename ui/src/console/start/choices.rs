//! The rigs and scenes to choose from: built-in ones, those in the user's folders, and recently used ones.

use std::{
    path::Path,
    time::{SystemTime, UNIX_EPOCH},
};

use nima_machine::config::RigConfig;
use nima_panels::rig_choice::{RigChoice, has_real_arm};
use nima_simulation::scene::Scene;
use nima_words::text;

use crate::extras;

/// Returns the scene with its hidden parts at new places, so that a trainee cannot learn them.
pub(crate) fn drawn_anew(scene: Scene) -> Scene {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let lot = since.as_secs().wrapping_mul(1_000_003).wrapping_add(u64::from(since.subsec_nanos()));
    // Six digits, so that a person can write the seed down.
    scene.drawn_anew(lot % 1_000_000)
}

/// One entry of a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ChoiceEntry {
    /// Name or path, as in [`RigChoice`].
    pub(super) key: String,
    pub(super) name: String,
    pub(super) about: String,
    pub(super) usable: bool,
    /// Whether it is in the user's folder.
    pub(super) own: bool,
    /// A rig whose arm is real: it works on its own field, whatever scene is drawn.
    pub(super) real_arm: bool,
}

/// Both lists, as last read.
#[derive(Clone, Debug, Default)]
pub(super) struct Lists {
    pub(super) rigs: Vec<ChoiceEntry>,
    pub(super) scenes: Vec<ChoiceEntry>,
}

impl Lists {
    /// Reads the user's files in `folder` in addition to the built-in ones. Files of these choices are listed too, wherever
    /// they are.
    pub(super) fn read(folder: Option<&Path>, used: &[RigChoice]) -> Self {
        let rigs = keys(
            RigConfig::names().filter(|name| extras::emulates() || !is_emulated(name)),
            folder.map(|folder| folder.join("rigs")).as_deref(),
            used.iter().map(|one| &one.rig),
        );
        let scenes = keys(
            Scene::names(),
            folder.map(|folder| folder.join("scenes")).as_deref(),
            used.iter().map(|one| &one.scene),
        );
        Self { rigs: rigs.into_iter().map(rig).collect(), scenes: scenes.into_iter().map(scene).collect() }
    }
}

/// Returns whether this built-in rig consists of emulated devices.
fn is_emulated(rig: &str) -> bool {
    RigConfig::load(rig).is_ok_and(|rig| rig.devices.is_some_and(|devices| devices.emulated))
}

/// Returns the keys of one list, each with whether it belongs to the user.
fn keys<'a>(
    built_in: impl Iterator<Item = &'static str>,
    folder: Option<&Path>,
    used: impl Iterator<Item = &'a String>,
) -> Vec<(String, bool)> {
    let mut keys: Vec<_> = built_in.map(|name| (name.to_owned(), false)).collect();
    let mut own: Vec<_> =
        folder.iter().flat_map(std::fs::read_dir).flatten().flatten().map(|entry| entry.path()).collect();
    own.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
    own.sort();
    keys.extend(own.into_iter().map(|path| (path.display().to_string(), true)));
    for key in used {
        if keys.iter().all(|(known, _)| known != key) {
            keys.push((key.clone(), true));
        }
    }
    keys
}

fn rig((key, own): (String, bool)) -> ChoiceEntry {
    match RigConfig::load(&key) {
        Ok(rig) => {
            let about = rig.devices.as_ref().map_or_else(
                || if rig.has_real_hand() { text::start::LED.get() } else { text::start::SIMULATED.get() }.to_owned(),
                |devices| text::start::of_devices(rig.probes().len(), devices.emulated),
            );
            let real_arm = has_real_arm(&rig);
            ChoiceEntry { key, name: rig.name, about, usable: true, own, real_arm }
        }
        Err(error) => unusable(key, &error, own),
    }
}

fn scene((key, own): (String, bool)) -> ChoiceEntry {
    match Scene::load(&key) {
        Ok(scene) => {
            ChoiceEntry { key, name: scene.name, about: scene.description, usable: true, own, real_arm: false }
        }
        Err(error) => unusable(key, &error, own),
    }
}

fn unusable(key: String, error: &dyn std::error::Error, own: bool) -> ChoiceEntry {
    let about = text::start::unusable(&nima_words::report_text::chain(error));
    ChoiceEntry { name: key.clone(), key, about, usable: false, own, real_arm: false }
}

#[cfg(test)]
mod tests {
    use nima_machine::config::RigFile;
    use nima_words::{
        language::{self, Language},
        text::of_files::of_file,
    };

    use super::*;

    fn choice(rig: &str) -> RigChoice {
        RigChoice { rig: rig.to_owned(), scene: "bimanual".to_owned() }
    }

    #[test]
    fn the_last_choice_is_first_and_none_stands_twice() {
        let mut recent = Vec::new();
        for rig in ["a", "b", "a", "c", "d", "e", "f"] {
            choice(rig).remember(&mut recent);
        }
        assert_eq!(recent, ["f", "e", "d", "c", "a"].map(choice));
    }

    #[test]
    fn another_rig_brings_its_own_scene_unless_one_was_chosen() {
        let first = RigChoice::default();
        let two_arms = first.with_rig("emulated");
        assert_eq!(two_arms, RigChoice { rig: "emulated".to_owned(), scene: "bimanual".to_owned() });
        assert_eq!(two_arms.with_rig("simulated"), first);
        let chosen = RigChoice { scene: "palpation".to_owned(), ..first };
        assert_eq!(chosen.with_rig("emulated").scene, "palpation");
        assert_eq!(chosen.with_rig("paper").scene, "bimanual", "no scene is chosen for a real arm");
    }

    #[test]
    fn built_in_rigs_and_scenes_are_named_in_the_language_of_the_window() {
        let lists = Lists::read(None, &[]);
        let rigs = lists.rigs.iter().map(|entry| &entry.name);
        let words = rigs.chain(lists.scenes.iter().flat_map(|entry| [&entry.name, &entry.about]));
        let missing: Vec<_> = words.filter(|words| in_german(words) == **words).collect();
        assert!(missing.is_empty(), "{missing:?}");
        assert_eq!(in_german("Knee of Ada"), "Knee of Ada", "a name given by a user stays");
    }

    fn in_german(words: &str) -> String {
        language::with(Language::German, || of_file(words).to_owned())
    }

    #[test]
    fn a_file_that_cannot_be_used_is_listed_with_its_cause() {
        let folder = tempfile::tempdir().unwrap();
        let rigs = folder.path().join("rigs");
        RigFile::of("simulated").unwrap().save(&rigs.join("good.toml")).unwrap();
        std::fs::write(rigs.join("bad.toml"), "rate_hz = \"much\"\n").unwrap();
        std::fs::write(rigs.join("notes.txt"), "").unwrap();
        let lists = Lists::read(Some(folder.path()), &[choice("/no/such/rig.toml")]);
        let own: Vec<_> = lists.rigs.iter().filter(|entry| entry.own).collect();
        assert_eq!(own.iter().map(|entry| entry.usable).collect::<Vec<_>>(), [false, true, false]);
        assert!(own[0].about.contains("rate_hz") || own[0].about.contains("line 1"), "{}", own[0].about);
        assert!(own[2].about.contains("/no/such/rig.toml"), "{}", own[2].about);
        assert!(lists.scenes.iter().all(|entry| entry.usable && !entry.own && !entry.about.is_empty()));
        assert_eq!(Lists::read(None, &[]).rigs.len(), RigConfig::names().count());
    }
}
