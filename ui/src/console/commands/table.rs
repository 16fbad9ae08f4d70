//! The table.

use std::{fmt::Write as _, sync::LazyLock};

use egui::Key;

use super::{Action, Entry, Place, SIZE, SIZES_PERCENT, Stroke, UNDO, With};
use crate::console::{
    desk::Panel, roles::Role, scene3d::extras::Switch, text, text::commands as names, wizards::Which,
};
use crate::language::{self, Language};
use crate::words::within;

type Keys = &'static [Stroke];

/// One key without modifiers.
macro_rules! key {
    ($key:ident) => {
        const { &[Stroke::plain(Key::$key)] }
    };
}

/// Every command, in the order of the palette.
pub fn table() -> &'static [Entry] {
    static ENGLISH: LazyLock<Vec<Entry>> = LazyLock::new(|| made(Language::English));
    static GERMAN: LazyLock<Vec<Entry>> = LazyLock::new(|| made(Language::German));
    static PSEUDO: LazyLock<Vec<Entry>> = LazyLock::new(|| made(Language::Pseudo));
    match language::current() {
        Language::English => &ENGLISH,
        Language::German => &GERMAN,
        Language::Pseudo => &PSEUDO,
    }
}

fn made(language: Language) -> Vec<Entry> {
    let all = || [views(), pages(), screen(), calibration(), traces_and_field(), past(), machine()].concat();
    let english = language::with(Language::English, all);
    let named = language::with(language, all).into_iter().zip(english);
    named.map(|(entry, english)| Entry { english: english.title, ..entry }).collect()
}

fn entry(action: Action, title: impl Into<String>, does: &'static str, keys: Keys, place: Place) -> Entry {
    Entry { action, title: title.into(), english: String::new(), does, keys, place }
}

fn views() -> Vec<Entry> {
    let of = |role: Role| {
        let keys: Keys = match role {
            Role::Surgeon => key!(F1),
            Role::Technician => key!(F2),
            Role::Demo => key!(F3),
        };
        entry(Action::View(role), names::view(role.name()), role.meaning(), keys, Place::Bar)
    };
    Role::ALL.map(of).into()
}

fn pages() -> Vec<Entry> {
    const PALETTE: Keys = &[Stroke { key: Key::P, with: With::Ctrl }];
    vec![
        entry(Action::Glossary, names::GLOSSARY.get(), names::GLOSSARY_DOES.get(), key!(F4), Place::ViewMenu),
        entry(Action::Alarms, names::ALARMS.get(), names::ALARMS_DOES.get(), key!(F5), Place::ViewMenu),
        entry(Action::Rig, names::RIG.get(), names::RIG_DOES.get(), key!(F6), Place::Bar),
        entry(Action::Sessions, names::SESSIONS.get(), names::SESSIONS_DOES.get(), key!(F7), Place::Bar),
        entry(Action::Studies, names::STUDIES.get(), names::STUDIES_DOES.get(), key!(F8), Place::Keys),
        entry(Action::Tour, names::TOUR.get(), names::TOUR_DOES.get(), &[], Place::ViewMenu),
        entry(Action::Palette, names::PALETTE.get(), names::PALETTE_DOES.get(), PALETTE, Place::ViewMenu),
    ]
}

fn screen() -> Vec<Entry> {
    let menu = Place::ViewMenu;
    let [larger, smaller] = SIZE;
    let [undo, redo] = UNDO;
    // Each in itself: who does not read the present language finds the own one.
    let languages = Language::CHOICES
        .map(|one| entry(Action::Language(one), names::language(one.name()), names::LANGUAGE_DOES.get(), &[], menu));
    let mut entries = vec![
        entry(Action::Undo, names::UNDO.get(), names::UNDO_DOES.get(), undo, menu),
        entry(Action::Redo, names::REDO.get(), names::REDO_DOES.get(), redo, menu),
        entry(Action::Light(false), names::DARK.get(), names::DARK_DOES.get(), &[], menu),
        entry(Action::Light(true), names::LIGHT.get(), names::LIGHT_DOES.get(), &[], menu),
        entry(Action::Larger, names::LARGER.get(), names::LARGER_DOES.get(), larger, Place::Keys),
        entry(Action::Smaller, names::SMALLER.get(), names::SMALLER_DOES.get(), smaller, Place::Keys),
    ];
    entries.extend(
        SIZES_PERCENT
            .map(|percent| entry(Action::Size(percent), names::size(percent), names::SIZE_DOES.get(), &[], menu)),
    );
    entries.extend(languages);
    entries.extend(
        Panel::ALL.map(|panel| entry(Action::Panel(panel), names::panel(panel.title()), panel.meaning(), &[], menu)),
    );
    let reset = (names::RESET_LAYOUT.get(), text::menu::RESET_LAYOUT_HOVER.get());
    let (plain, plain_does) = (text::menu::PICTURE_PLAIN.get(), text::menu::PICTURE_PLAIN_HOVER.get());
    let (now, now_does) = (text::menu::FORCES_OF_NOW.get(), text::menu::FORCES_OF_NOW_HOVER.get());
    let (records, records_does) = (text::menu::RECORDS_PICTURE.get(), text::menu::RECORDS_PICTURE_HOVER.get());
    entries.extend([
        entry(Action::ResetLayout, reset.0, reset.1, &[], menu),
        entry(Action::Sound, text::menu::SOUND.get(), text::menu::SOUND_HOVER.get(), &[], menu),
        entry(Action::ForcesOfNow, now, now_does, &[], menu),
        entry(Action::PlainPicture, plain, plain_does, &[], menu),
        entry(Action::RecordsPicture, records, records_does, &[], menu),
    ]);
    entries
}

fn calibration() -> Vec<Entry> {
    let at = Place::Calibration;
    let (back, back_does) = (text::calibrations::CLOSE_WIZARD.get(), text::calibrations::CLOSE_WIZARD_HOVER.get());
    let mut entries = vec![
        entry(Action::Check, text::ready::OPEN.get(), text::ready::MEANING.get(), &[], at),
        entry(Action::Calibrations, text::overview::OPEN.get(), text::overview::MEANING.get(), &[], at),
    ];
    entries.extend(Which::ALL.map(|which| {
        let title = text::calibrations::calibrate(&within(which.name()));
        entry(Action::Calibrate(which), title, which.meaning(), &[], at)
    }));
    entries.push(entry(Action::CloseWizard, back, back_does, &[], at));
    entries
}

fn traces_and_field() -> Vec<Entry> {
    let (last, last_does) = (text::forces::LAST_TEN_SECONDS.get(), text::forces::LAST_TEN_SECONDS_HOVER.get());
    let mut entries = vec![
        entry(Action::Mark, names::MARK.get(), names::MARK_DOES.get(), key!(E), Place::ViewMenu),
        entry(Action::Keep, names::KEEP.get(), names::KEEP_DOES.get(), key!(K), Place::Bar),
        entry(Action::Pause, names::PAUSE.get(), text::forces::PAUSE_HOVER.get(), &[], Place::Traces),
        entry(Action::LastTenSeconds, last, last_does, &[], Place::Traces),
    ];
    entries.extend(
        Switch::ALL.map(|switch| entry(Action::Draws(switch), switch.name(), switch.meaning(), &[], Place::Field)),
    );
    entries.extend([
        entry(Action::Drive, names::DRIVE.get(), names::DRIVE_DOES.get(), key!(M), Place::Field),
        entry(Action::OtherHand, names::OTHER_HAND.get(), names::OTHER_HAND_DOES.get(), key!(H), Place::Field),
        entry(Action::Jaws, names::JAWS.get(), names::JAWS_DOES.get(), key!(G), Place::Field),
        entry(Action::MarkPlace, names::MARK_PLACE.get(), names::MARK_PLACE_DOES.get(), key!(X), Place::Field),
        entry(Action::EndTrial, names::END_TRIAL.get(), names::END_TRIAL_DOES.get(), key!(D), Place::Field),
        entry(Action::BeginTrial, names::BEGIN_TRIAL.get(), names::BEGIN_TRIAL_DOES.get(), key!(N), Place::Field),
        entry(Action::HideForces, names::HIDE_FORCES.get(), names::HIDE_FORCES_DOES.get(), key!(O), Place::Picture),
        entry(Action::Lens, names::LENS.get(), names::LENS_DOES.get(), key!(V), Place::Picture),
    ]);
    entries
}

fn past() -> Vec<Entry> {
    const FINE: [Keys; 2] =
        [&[Stroke { key: Key::ArrowLeft, with: With::Shift }], &[Stroke { key: Key::ArrowRight, with: With::Shift }]];
    let at = Place::Past;
    vec![
        entry(Action::LeavePast, names::LEAVE_PAST.get(), names::LEAVE_PAST_DOES.get(), key!(L), at),
        entry(Action::Play, names::PLAY.get(), names::PLAY_DOES.get(), key!(P), at),
        entry(Action::Step(-1000), names::BACK.get(), names::PLAY_DOES.get(), key!(ArrowLeft), at),
        entry(Action::Step(1000), names::ON.get(), names::PLAY_DOES.get(), key!(ArrowRight), at),
        entry(Action::Step(-10), names::BACK_FINE.get(), names::PLAY_DOES.get(), FINE[0], at),
        entry(Action::Step(10), names::ON_FINE.get(), names::PLAY_DOES.get(), FINE[1], at),
    ]
}

/// Last: nobody should come upon them by accident.
fn machine() -> Vec<Entry> {
    const STOP: Keys = &[Stroke::plain(Key::Space), Stroke::plain(Key::Escape)];
    vec![
        entry(Action::Acknowledge, names::ACKNOWLEDGE.get(), names::ACKNOWLEDGE_DOES.get(), key!(A), Place::Alarms),
        entry(Action::Stop, names::STOP.get(), names::STOP_DOES.get(), STOP, Place::Bar),
        entry(Action::Release, names::RELEASE.get(), names::RELEASE_DOES.get(), &[], Place::Bar),
        entry(Action::Engage, names::ENGAGE.get(), names::ENGAGE_DOES.get(), &[], Place::Bar),
    ]
}

/// The rows of the table in `docs/screen.md`.
pub fn as_markdown() -> String {
    let mut rows = String::new();
    for entry in table() {
        let does = entry.does.lines().next().unwrap_or_default();
        // Writing into a String cannot fail.
        let _ = writeln!(rows, "| {} | {} | {} | {does} |", entry.title, entry.keys_told(), entry.place.name());
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_commands_share_a_name_in_german() {
        let titles = language::with(Language::German, || table().iter().map(|entry| entry.title.clone()));
        let mut titles: Vec<_> = titles.collect();
        titles.sort();
        assert!(titles.windows(2).all(|pair| pair[0] != pair[1]), "{titles:?}");
    }

    #[test]
    fn no_two_commands_share_a_name_an_action_or_a_key() {
        let keys = |entry: &Entry| entry.keys.iter().map(|stroke| stroke.name()).collect::<Vec<_>>();
        for (i, one) in table().iter().enumerate() {
            assert!(!one.title.is_empty() && !one.does.is_empty(), "{one:?}");
            for other in &table()[i + 1..] {
                assert!(one.title != other.title && one.action != other.action, "{one:?} {other:?}");
                assert!(keys(one).iter().all(|key| !keys(other).contains(key)), "{one:?} {other:?}");
            }
        }
    }

    #[test]
    fn a_command_whose_key_is_pressed_for_it_has_one_without_modifiers() {
        for entry in table().iter().filter(|entry| entry.action.is_of_part()) {
            assert!(matches!(entry.keys, [Stroke { with: With::Nothing, .. }]), "{entry:?}");
        }
    }

    #[test]
    fn the_keys_of_the_views_are_those_of_the_roles() {
        for role in Role::ALL {
            let view = Entry::of(Action::View(role)).unwrap();
            assert_eq!(view.keys, [Stroke::plain(role.key())]);
        }
    }

    #[test]
    fn the_document_has_the_table() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/screen.md");
        let document = std::fs::read_to_string(path).unwrap();
        assert!(document.contains(&as_markdown()), "docs/screen.md must contain:\n{}", as_markdown());
        for (keys, does) in names::BY_HAND {
            assert!(document.contains(&format!("| {keys} | {does} |")), "{keys}");
        }
    }
}
