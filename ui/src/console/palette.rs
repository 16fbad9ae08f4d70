//! The command palette: all commands that are available here, found by name.
//!
//! A command runs as from its button or key. Commands that lead towards motion and force need a confirmation, because a word
//! and Enter are typed faster than a button is found.

use egui::{
    Align, Align2, Button, Context, Id, Key, Label, Order, Rect, RichText, ScrollArea, TextEdit, Ui, Window, vec2,
};
use nima_screen::{
    theme,
    widgets::{small, weak},
};
use nima_words::text::commands::{FOOT, NONE_FOUND, ONCE_MORE, PALETTE, SEARCH, hover};

use crate::console::commands::{Action, Availability, CommandEntry};

const WIDTH: f32 = 560.0;
const ROW: f32 = 28.0;

/// A command, and its availability.
pub(super) type PaletteRow = (&'static CommandEntry, Availability);

#[derive(Debug, Default)]
pub(super) struct CommandPalette {
    open: Option<Search>,
    chosen: Option<Action>,
}

#[derive(Debug, Default)]
struct Search {
    words: String,
    /// The row that Enter runs; the first available one until an arrow key was pressed.
    at: Option<usize>,
    /// A command that waits for confirmation.
    asked: Option<Action>,
}

impl CommandPalette {
    pub(super) const fn is_open(&self) -> bool {
        self.open.is_some()
    }

    pub(super) fn toggle(&mut self) {
        self.open = if self.is_open() { None } else { Some(Search::default()) };
    }

    pub(super) fn close(&mut self) {
        self.open = None;
    }

    /// Returns the command chosen since the last frame.
    pub(super) const fn take(&mut self) -> Option<Action> {
        self.chosen.take()
    }

    /// Draws the palette into `room` with these rows.
    pub(super) fn ui(&mut self, ctx: &Context, room: Rect, rows: &[PaletteRow]) {
        let Some(search) = &mut self.open else { return };
        let field = Id::unique("palette_field");
        let keys = PaletteKeys::take(ctx);
        let window = Window::new(PALETTE.0.get()).title_bar(false).resizable(false).movable(false).constrain_to(room);
        let window = window.order(Order::Foreground).fixed_size(vec2(WIDTH.min(room.width() - 24.0), 0.0));
        let window = window.anchor(Align2::CENTER_TOP, vec2(0.0, 8.0));
        let mut wanted = None;
        let shown = window.show(ctx, |ui| {
            let edit = TextEdit::singleline(&mut search.words).id(field).hint_text(SEARCH);
            let edit = ui.add(edit.desired_width(f32::INFINITY).font(theme::regular(16.0)));
            ctx.accesskit_node_builder(edit.id, |node| node.set_label(SEARCH.get()));
            if edit.changed() {
                search.at = None;
                search.asked = None;
            }
            edit.request_focus();
            let found = found(&search.words, rows);
            search.step(&keys, &found);
            wanted = search.list_ui(ui, &found, &keys, room.height() - 150.0);
            ui.label(small(FOOT));
        });
        let inside = shown.is_some_and(|shown| {
            let pressed =
                ctx.input(|input| input.pointer.any_pressed().then(|| input.pointer.interact_pos()).flatten());
            pressed.is_none_or(|at| shown.response.rect.contains(at))
        });
        if let Some(action) = wanted {
            if action.leads_to_force() && search.asked != Some(action) {
                search.asked = Some(action);
                return;
            }
            self.chosen = Some(action);
            ctx.request_repaint();
        }
        if wanted.is_some() || !inside {
            ctx.memory_mut(|memory| memory.surrender_focus(field));
            self.close();
        }
    }
}

/// Keys of the list, which its text field does not get.
#[derive(Debug)]
struct PaletteKeys {
    by: isize,
    enter: bool,
}

impl PaletteKeys {
    fn take(ctx: &Context) -> Self {
        ctx.input_mut(|input| {
            let mut pressed = |key| input.consume_key(egui::Modifiers::NONE, key);
            let up = pressed(Key::ArrowUp);
            let down = pressed(Key::ArrowDown);
            Self { by: isize::from(down) - isize::from(up), enter: pressed(Key::Enter) }
        })
    }
}

impl Search {
    /// Moves to the next available row.
    fn step(&mut self, keys: &PaletteKeys, found: &[PaletteRow]) {
        let possible: Vec<usize> = (0..found.len()).filter(|&i| found[i].1 == Availability::Can).collect();
        let at = self.at.and_then(|at| possible.iter().position(|&i| i == at)).unwrap_or(0);
        let last = possible.len().saturating_sub(1);
        let next = at.saturating_add_signed(keys.by).min(last);
        if keys.by != 0 {
            self.asked = None;
        }
        self.at = possible.get(next).copied();
    }

    /// Draws the rows; returns the command to run.
    fn list_ui(&self, ui: &mut Ui, found: &[PaletteRow], keys: &PaletteKeys, height: f32) -> Option<Action> {
        let mut wanted = None;
        let height = height.clamp(120.0, 480.0);
        // The window is only as high as its content, so the list must set its own height.
        let list = ScrollArea::vertical().max_height(height).min_scrolled_height(height).auto_shrink([false, true]);
        list.show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 2.0;
            if found.is_empty() {
                ui.label(weak(NONE_FOUND));
            }
            for (i, (entry, reach)) in found.iter().enumerate() {
                let is_at = self.at == Some(i);
                let response = row_ui(ui, entry, *reach, is_at);
                if response.clicked() || is_at && keys.enter {
                    wanted = Some(entry.action);
                }
                if is_at && keys.by != 0 {
                    response.scroll_to_me(Some(Align::Center));
                }
                if self.asked == Some(entry.action) {
                    ui.label(RichText::new(ONCE_MORE).font(theme::strong(14.0)));
                }
            }
        });
        wanted
    }
}

fn row_ui(ui: &mut Ui, entry: &CommandEntry, reach: Availability, is_at: bool) -> egui::Response {
    // Weak text would be unreadable on the selection colour.
    let ink = if is_at { theme::now().text } else { theme::now().text_weak };
    let keys = RichText::new(entry.keys_text()).color(ink);
    let button = Button::selectable(is_at, entry.title.as_str()).right_text(keys).truncate();
    let can = reach == Availability::Can;
    let response = ui.add_enabled(can, button.min_size(vec2(ui.available_width(), ROW)));
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::MenuItem, can, is_at, &entry.title));
    if let Availability::Cannot(why) = reach {
        ui.indent(entry.title.as_str(), |ui| ui.add(Label::new(small(why)).wrap()));
    }
    response.on_hover_text(hover(entry.does, entry.place.name()))
}

/// Returns the rows whose names contain every word, best match first. Among equal matches available rows come first,
/// in the order of the table.
fn found(words: &str, rows: &[PaletteRow]) -> Vec<PaletteRow> {
    let words: Vec<String> = words.split_whitespace().map(str::to_lowercase).collect();
    let rank = |(entry, _): &PaletteRow| words.iter().try_fold(0, |sum, word| Some(sum + rank(word, entry)?));
    let mut found: Vec<(usize, PaletteRow)> = rows.iter().filter_map(|row| Some((rank(row)?, *row))).collect();
    found.sort_by_key(|(rank, (_, reach))| (*rank, !words.is_empty() && *reach != Availability::Can));
    found.into_iter().map(|(_, row)| row).collect()
}

/// Returns the quality of a match; 0 is best. A word can match a key, the start of a word in the name, a part of the
/// name, or the start of a word in the meaning.
fn rank(word: &str, entry: &CommandEntry) -> Option<usize> {
    let begins = |text: &str| {
        let text = text.to_lowercase();
        text.split(|letter: char| !letter.is_alphanumeric()).position(|other| other.starts_with(word))
    };
    let is_key = entry.keys.iter().any(|stroke| stroke.name().to_lowercase() == word);
    let within = || entry.title.to_lowercase().contains(word).then_some(20);
    let by_title = || begins(&entry.title).or_else(within);
    is_key.then_some(0).or_else(by_title).or_else(|| begins(entry.does).or_else(|| begins(&entry.english)).map(|_| 40))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::console::commands::table;
    use nima_panels::roles::Role;
    use nima_words::language::{self, Language};

    fn all() -> Vec<PaletteRow> {
        table().iter().map(|entry| (entry, Availability::Can)).collect()
    }

    fn first(words: &str) -> Option<Action> {
        found(words, &all()).first().map(|(entry, _)| entry.action)
    }

    #[test]
    fn a_command_is_found_by_its_name_its_key_the_beginnings_of_its_words_and_its_meaning() {
        for entry in table() {
            assert_eq!(first(&entry.title), Some(entry.action), "{}", entry.title);
        }
        assert_eq!(first("f7"), Some(Action::Sessions));
        assert_eq!(first("rese lay"), Some(Action::ResetLayout));
        assert_eq!(first("SESSIONS rec"), Some(Action::Sessions));
        assert_eq!(first("printing"), Some(Action::Light(true)));
        assert_eq!(first("xylophone"), None);
        assert_eq!(found("", &all()).len(), table().len());
    }

    #[test]
    fn in_german_a_command_is_found_by_its_german_and_by_its_english_name() {
        let first = |words: &str| language::with(Language::German, || first(words));
        assert_eq!((first("sitzungen"), first("recorded sessions")), (Some(Action::Sessions), Some(Action::Sessions)));
        assert_eq!((first("halt"), first("stop")), (Some(Action::Stop), Some(Action::Stop)));
    }

    #[test]
    fn what_cannot_be_done_comes_after_what_fits_as_well() {
        let can = Action::View(Role::ALL[2]);
        let reach = |action| if action == can { Availability::Can } else { Availability::Cannot("") };
        let rows: Vec<PaletteRow> = table().iter().map(|entry| (entry, reach(entry.action))).collect();
        assert_eq!(found("view", &rows)[0].0.action, can);
        assert_ne!(found("", &rows)[0].0.action, can, "without words the table's order stays");
    }
}
