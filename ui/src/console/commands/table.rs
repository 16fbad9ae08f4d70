use std::sync::LazyLock;

use egui::Key;
use nima_panels::{
    roles::Role,
    tiles::{Arrangement, PanelId},
};
use nima_screen::scene3d::extras::MenuSwitch;
use nima_wizards::WizardKind;
use nima_words::{
    language::{self, Language, Text},
    report_text::within,
    text::{self, commands as names},
};

use super::{Action, CommandEntry, CommandPlace, KeyModifiers, SIZE, SIZES_PERCENT, Stroke, UNDO};
use crate::extras::{self, Extra};

type CommandKeys = &'static [Stroke];

/// One key without modifiers.
macro_rules! key {
    ($key:ident) => {
        const { &[Stroke::plain(Key::$key)] }
    };
}

/// Returns every command, in the order of the palette.
pub fn table() -> &'static [CommandEntry] {
    static ENGLISH: LazyLock<Vec<CommandEntry>> = LazyLock::new(|| made(Language::English));
    static GERMAN: LazyLock<Vec<CommandEntry>> = LazyLock::new(|| made(Language::German));
    static PSEUDO: LazyLock<Vec<CommandEntry>> = LazyLock::new(|| made(Language::Pseudo));
    match language::current() {
        Language::English => &ENGLISH,
        Language::German => &GERMAN,
        Language::Pseudo => &PSEUDO,
    }
}

fn made(language: Language) -> Vec<CommandEntry> {
    let all = || [views(), pages(), screen(), calibration(), traces_and_field(), past(), machine()].concat();
    let english = language::with(Language::English, all);
    let named = language::with(language, all).into_iter().zip(english);
    named.map(|(entry, english)| CommandEntry { english: english.title, ..entry }).collect()
}

fn entry(action: Action, (title, does): (Text, Text), keys: CommandKeys, place: CommandPlace) -> CommandEntry {
    named(action, title.get(), does.get(), keys, place)
}

/// Returns a command whose name is built from other texts.
fn named(
    action: Action,
    title: impl Into<String>,
    does: &'static str,
    keys: CommandKeys,
    place: CommandPlace,
) -> CommandEntry {
    CommandEntry { action, title: title.into(), english: String::new(), does, keys, place }
}

fn views() -> Vec<CommandEntry> {
    let of = |role: Role| {
        let keys: CommandKeys = match role {
            Role::Surgeon => key!(F1),
            Role::Technician => key!(F2),
            Role::Demo => key!(F3),
        };
        named(Action::View(role), names::view(role.name()), role.meaning(), keys, CommandPlace::Bar)
    };
    Role::ALL.map(of).into()
}

fn pages() -> Vec<CommandEntry> {
    const PALETTE: CommandKeys = &[Stroke { key: Key::P, with: KeyModifiers::Ctrl }];
    let mut entries = vec![
        entry(Action::Glossary, names::GLOSSARY, key!(F4), CommandPlace::ViewMenu),
        entry(Action::Alarms, names::ALARMS, key!(F5), CommandPlace::ViewMenu),
        entry(Action::Rig, names::RIG, key!(F6), CommandPlace::Bar),
        entry(Action::Sessions, names::SESSIONS, key!(F7), CommandPlace::Bar),
    ];
    if extras::part(Extra::page).is_some() {
        entries.push(entry(Action::Studies, names::STUDIES, key!(F8), CommandPlace::Keys));
    }
    entries.extend([
        entry(Action::Tour, names::TOUR, &[], CommandPlace::ViewMenu),
        entry(Action::Palette, names::PALETTE, PALETTE, CommandPlace::ViewMenu),
    ]);
    entries
}

fn screen() -> Vec<CommandEntry> {
    let menu = CommandPlace::ViewMenu;
    let [larger, smaller] = SIZE;
    let [undo, redo] = UNDO;
    // Each language is listed by its own name, so that users who cannot read the current one can find theirs.
    let languages = Language::CHOICES
        .map(|one| named(Action::Language(one), names::language(one.name()), names::LANGUAGE_DOES.get(), &[], menu));
    let mut entries = vec![
        entry(Action::Undo, names::UNDO, undo, menu),
        entry(Action::Redo, names::REDO, redo, menu),
        entry(Action::Light(false), names::DARK, &[], menu),
        entry(Action::Light(true), names::LIGHT, &[], menu),
        entry(Action::ColourBlind, (text::menu::COLOUR_BLIND, text::menu::COLOUR_BLIND_HOVER), &[], menu),
        entry(Action::Touch, (text::menu::TOUCH, text::menu::TOUCH_HOVER), &[], menu),
        entry(Action::Larger, names::LARGER, larger, CommandPlace::Keys),
        entry(Action::Smaller, names::SMALLER, smaller, CommandPlace::Keys),
    ];
    entries.extend(
        SIZES_PERCENT
            .map(|percent| named(Action::Size(percent), names::size(percent), names::SIZE_DOES.get(), &[], menu)),
    );
    entries.extend(languages);
    entries.extend(
        PanelId::built()
            .map(|panel| named(Action::Panel(panel), names::panel(panel.title()), panel.meaning(), &[], menu)),
    );
    let in_window = text::tiles::OPEN_WINDOW_HOVER.get();
    entries.extend(
        PanelId::built().map(|panel| named(Action::Window(panel), names::window(panel.title()), in_window, &[], menu)),
    );
    entries.extend(
        Arrangement::ALL.map(|one| named(Action::Arrange(one), names::layout(one.name()), one.meaning(), &[], menu)),
    );
    entries.extend([
        entry(Action::ResetLayout, (names::RESET_LAYOUT, text::menu::RESET_LAYOUT_HOVER), &[], menu),
        entry(Action::Sound, (text::menu::SOUND, text::menu::SOUND_HOVER), &[], menu),
        entry(Action::ForcesOfNow, (text::menu::FORCES_OF_NOW, text::menu::FORCES_OF_NOW_HOVER), &[], menu),
        entry(Action::PlainPicture, (text::menu::IMAGE_PLAIN, text::menu::IMAGE_PLAIN_HOVER), &[], menu),
        entry(Action::RecordsPicture, (text::menu::RECORDS_IMAGE, text::menu::RECORDS_IMAGE_HOVER), &[], menu),
    ]);
    entries
}

fn calibration() -> Vec<CommandEntry> {
    let at = CommandPlace::Calibration;
    let mut entries = vec![
        entry(Action::Check, (text::ready::OPEN, text::ready::MEANING), &[], at),
        entry(Action::Calibrations, (text::overview::OPEN, text::overview::MEANING), &[], at),
    ];
    entries.extend(WizardKind::built().map(|which| {
        let title = text::calibrations::calibrate(&within(which.name()));
        named(Action::Calibrate(which), title, which.meaning(), &[], at)
    }));
    entries.push(entry(
        Action::CloseWizard,
        (text::calibrations::CLOSE_WIZARD, text::calibrations::CLOSE_WIZARD_HOVER),
        &[],
        at,
    ));
    entries
}

fn traces_and_field() -> Vec<CommandEntry> {
    let mut entries = vec![
        entry(Action::Mark, names::MARK, key!(E), CommandPlace::ViewMenu),
        entry(Action::Keep, names::KEEP, key!(K), CommandPlace::Bar),
        entry(Action::Pause, (names::PAUSE, text::traces::PAUSE_HOVER), &[], CommandPlace::Traces),
        entry(
            Action::LastTenSeconds,
            (text::traces::LAST_TEN_SECONDS, text::traces::LAST_TEN_SECONDS_HOVER),
            &[],
            CommandPlace::Traces,
        ),
    ];
    entries.extend(
        MenuSwitch::ALL
            .map(|switch| named(Action::Draws(switch), switch.name(), switch.meaning(), &[], CommandPlace::Field)),
    );
    entries.extend([
        entry(Action::Drive, names::DRIVE, key!(M), CommandPlace::Field),
        entry(Action::OtherHand, names::OTHER_HAND, key!(H), CommandPlace::Field),
        entry(Action::Jaws, names::JAWS, key!(G), CommandPlace::Field),
        entry(Action::MarkPlace, names::MARK_PLACE, key!(X), CommandPlace::Field),
        entry(Action::EndTrial, names::END_TRIAL, key!(D), CommandPlace::Field),
        entry(Action::BeginTrial, names::BEGIN_TRIAL, key!(N), CommandPlace::Field),
        entry(Action::HideForces, names::HIDE_FORCES, key!(O), CommandPlace::Picture),
        entry(Action::Lens, names::LENS, key!(V), CommandPlace::Picture),
    ]);
    entries
}

fn past() -> Vec<CommandEntry> {
    const FINE: [CommandKeys; 2] = [
        &[Stroke { key: Key::ArrowLeft, with: KeyModifiers::Shift }],
        &[Stroke { key: Key::ArrowRight, with: KeyModifiers::Shift }],
    ];
    let at = CommandPlace::Past;
    vec![
        entry(Action::LeavePast, names::LEAVE_PAST, key!(L), at),
        entry(Action::Play, (names::PLAY, names::PLAY_DOES), key!(P), at),
        entry(Action::Step(-1000), (names::BACK, names::PLAY_DOES), key!(ArrowLeft), at),
        entry(Action::Step(1000), (names::ON, names::PLAY_DOES), key!(ArrowRight), at),
        entry(Action::Step(-10), (names::BACK_FINE, names::PLAY_DOES), FINE[0], at),
        entry(Action::Step(10), (names::ON_FINE, names::PLAY_DOES), FINE[1], at),
    ]
}

/// Last, so that no one reaches these commands by accident.
fn machine() -> Vec<CommandEntry> {
    const STOP: CommandKeys = &[Stroke::plain(Key::Space), Stroke::plain(Key::Escape)];
    vec![
        entry(Action::Acknowledge, names::ACKNOWLEDGE, key!(A), CommandPlace::Alarms),
        entry(Action::Stop, names::STOP, STOP, CommandPlace::Bar),
        entry(Action::Release, names::RELEASE, &[], CommandPlace::Bar),
        entry(Action::Engage, names::ENGAGE, &[], CommandPlace::Bar),
    ]
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
        let keys = |entry: &CommandEntry| entry.keys.iter().map(|stroke| stroke.name()).collect::<Vec<_>>();
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
            assert!(matches!(entry.keys, [Stroke { with: KeyModifiers::Nothing, .. }]), "{entry:?}");
        }
    }

    #[test]
    fn the_keys_of_the_views_are_those_of_the_roles() {
        for role in Role::ALL {
            let view = CommandEntry::of(Action::View(role)).unwrap();
            assert_eq!(view.keys, [Stroke::plain(role.key())]);
        }
    }

    /// `docs/reference/commands.md`, from the table.
    fn page() -> String {
        let row = |entry: &CommandEntry| {
            let does = entry.does.lines().next().unwrap_or_default();
            format!("| {} | {} | {} | {does} |\n", entry.title, entry.keys_text(), entry.place.name())
        };
        let commands: Vec<String> = table().iter().map(row).collect();
        let by_hand = names::BY_HAND.map(|(keys, does)| format!("| {keys} | {does} |\n"));
        format!(
            "# All commands and keys\n\n\
             Every command of the window. [Screen and keys](../screen.md#find-a-command) says how to find one.\n\n\
             This page is generated: change `ui/src/console/commands/table.rs`, then run `NIMA_WRITE_DOCS=1 cargo test -p nima-console --lib \
             the_page_of_the_commands`.\n\n\
             | command | key | where | effect |\n|---|---|---|---|\n{}\n\
             Keys and gestures that are not commands:\n\n| key | effect |\n|---|---|\n{}",
            commands.concat(),
            by_hand.concat()
        )
    }

    /// `NIMA_WRITE_DOCS=1` writes the page.
    #[test]
    fn the_page_of_the_commands_is_up_to_date() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/reference/commands.md");
        if std::env::var_os("NIMA_WRITE_DOCS").is_some() {
            std::fs::write(&path, page()).unwrap();
        }
        let written = std::fs::read_to_string(&path).unwrap_or_default();
        assert_eq!(written, page(), "{}: run with NIMA_WRITE_DOCS=1", path.display());
    }
}
