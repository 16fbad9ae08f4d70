//! Display of alarms: a strip below the top bar, and the list of recent alarms.
//!
//! The strip shows the most urgent alarm (the first if several are equal) with time, cause and remedy, and the number of the
//! others. Without an alarm it shows the last refused command, or the next step. Its height never changes: otherwise an
//! alarm would move every control under the pointer.

use egui::{
    Button, Color32, Context, FontId, Frame, Label, Margin, Panel, Rect, RichText, ScrollArea, Sense, Stroke,
    TextStyle, Ui, UiBuilder, Window, vec2,
};
use nima_words::text;

use super::{
    AlarmPriority, Signs, judge,
    log::{AlarmEntry, AlarmLog, AlarmMoment},
    sound::Sound,
};
use crate::{
    theme,
    widgets::{Sign, at_the_right, fitting, fitting_style, sign, sign_ui, small, weak},
};

/// Height of the strip: two lines of text.
const HEIGHT: f32 = 40.0;
/// Width of the strip's buttons.
const BUTTONS: f32 = 270.0;
const BUTTON: egui::Vec2 = vec2(124.0, 30.0);

/// The log of alarms, and the open parts of their display.
#[derive(Debug, Default)]
pub struct Alarms {
    pub log: AlarmLog,
    /// Whether the list is open.
    pub list: bool,
    pub sound: Sound,
}

impl Alarms {
    /// Updates the alarms, plays their sound if enabled, and shows the strip; `loop_s` is the time on the loop's clock,
    /// `next` the next step of the operator, and `refused` a command that was just refused, with the remedy.
    pub fn strip_ui(
        &mut self,
        ui: &mut Ui,
        signs: &Signs,
        loop_s: Option<f64>,
        sounds: bool,
        next: &str,
        refused: Option<&[String; 2]>,
    ) {
        let time_s = ui.input(|input| input.time);
        self.log.update(&judge(signs), &AlarmMoment::now(loop_s, time_s));
        let calls = self.log.calls();
        self.sound.step(calls.filter(|_| sounds), time_s);
        let live = self.log.live();
        let first = live.first().map(|&first| first.clone());
        if let Some(change_s) = calls.and_then(|priority| priority.until_change_s(time_s)) {
            // Slightly later than the change, so that the colour has changed by then.
            ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(change_s + 2e-3));
        }
        let colour = first.as_ref().map(|first| calls.unwrap_or(first.alarm.priority).colour(time_s, calls.is_some()));
        let unseen = self.log.has_unseen();
        let others = live.len().saturating_sub(1);
        let frame = Frame::new()
            .fill(if colour.is_some() { theme::DARK.card } else { theme::now().panel })
            .stroke(colour.map_or(Stroke::NONE, |colour| Stroke::new(2.0, colour)))
            .inner_margin(Margin::symmetric(14, 1))
            .outer_margin(Margin { left: 1, right: 1, top: 0, bottom: 1 });
        let mut acknowledged = false;
        let mut opened = false;
        // Large controls for touch need more.
        let height = HEIGHT.max(ui.spacing().interact_size.y + 4.0);
        Panel::top("alarms").exact_size(height).resizable(false).frame(frame).show(ui, |ui| {
            ui.horizontal_centered(|ui| {
                match (&first, colour) {
                    (Some(first), Some(colour)) => opened |= words_ui(ui, first, others, colour),
                    _ => quiet_ui(ui, next, refused),
                }
                at_the_right(ui, |ui| {
                    // Invisible without an alarm, so that its neighbour keeps its place and its identity.
                    let mut of_alarm = UiBuilder::new();
                    of_alarm.invisible = first.is_none();
                    ui.scope_builder(of_alarm, |ui| {
                        let seen = ui.add_enabled(unseen, button(ui, text::alarms::ACKNOWLEDGE.get()));
                        let seen = seen
                            .on_hover_text(text::alarms::ACKNOWLEDGE_HOVER)
                            .on_disabled_hover_text(text::alarms::ACKNOWLEDGED_HOVER);
                        acknowledged = seen.clicked();
                    });
                    let all = ui.add(button(ui, text::alarms::SHOW_ALL.get()));
                    opened |= all.on_hover_text(text::alarms::SHOW_ALL_HOVER).clicked();
                });
            });
        });
        if acknowledged {
            self.log.acknowledge();
        }
        self.list |= opened;
    }

    /// Shows the list in `room`.
    pub fn list_ui(&mut self, ctx: &Context, room: Rect) {
        let window =
            Window::new(text::alarms::LIST_TITLE.get()).open(&mut self.list).constrain_to(room).collapsible(false);
        let size = vec2(560.0, (room.height() - 90.0).min(460.0));
        window.default_pos(room.center_top() + vec2(-280.0, 16.0)).fixed_size(size).show(ctx, |ui| {
            ui.label(small(text::alarms::LIST_NOTE));
            let any = self.log.newest_first().next().is_some();
            let copy = ui.add_enabled(any, Button::new(text::alarms::COPY));
            let copy = copy.on_hover_text(text::alarms::COPY_HOVER);
            if copy.on_disabled_hover_text(text::alarms::LIST_EMPTY).clicked() {
                ui.copy_text(self.log.active_first().map(entry_text).collect());
            }
            ui.add_space(4.0);
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                if self.log.newest_first().next().is_none() {
                    ui.label(weak(text::alarms::LIST_EMPTY));
                }
                for entry in self.log.active_first() {
                    entry_ui(ui, entry);
                }
            });
        });
    }
}

/// Returns a button of the strip, with letters that fit into it.
fn button(ui: &Ui, words: &'static str) -> Button<'static> {
    let room = BUTTON.x - 2.0 * ui.spacing().button_padding.x;
    Button::new(RichText::new(words).font(fitting_style(ui, words, &TextStyle::Button, room))).min_size(BUTTON)
}

/// Draws the strip without an alarm.
fn quiet_ui(ui: &mut Ui, next: &str, refused: Option<&[String; 2]>) {
    let (rect, _) = ui.allocate_exact_size(vec2(24.0, 30.0), Sense::hover());
    sign(ui.painter(), Sign::Ring, rect.center(), 6.0, theme::now().text_weak);
    let room = (ui.available_width() - BUTTONS).max(240.0);
    ui.vertical(|ui| {
        ui.set_width(room);
        ui.spacing_mut().item_spacing.y = 0.0;
        ui.spacing_mut().interact_size.y = 0.0;
        let line = |ui: &mut Ui, words: &str, font: FontId, colour: Color32| {
            let font = fitting(ui.painter(), words, font, room);
            ui.add(Label::new(RichText::new(words).font(font).color(colour)).truncate());
        };
        if let Some([because, cure]) = refused {
            line(ui, because, theme::strong(14.0), theme::now().text);
            line(ui, cure, theme::regular(13.0), theme::now().text_weak);
            return;
        }
        ui.horizontal(|ui| {
            ui.label(RichText::new(text::top_bar::NIMA_CONSOLE).font(theme::strong(15.0)));
            ui.label(small(text::top_bar::RESEARCH_ONLY));
        });
        line(ui, next, theme::regular(13.0), theme::now().text_weak);
    });
}

/// Draws the alarm in the strip; returns true if it was clicked.
fn words_ui(ui: &mut Ui, first: &AlarmEntry, others: usize, colour: Color32) -> bool {
    let (rect, _) = ui.allocate_exact_size(vec2(24.0, 30.0), Sense::hover());
    sign(ui.painter(), Sign::Triangle, rect.center(), 9.0, colour);
    let width = (ui.available_width() - BUTTONS).max(240.0);
    let words = ui.vertical(|ui| {
        ui.set_width(width);
        ui.spacing_mut().item_spacing.y = 1.0;
        let more = if others > 0 { text::alarms::others(others) } else { String::new() };
        let seen = if first.acknowledged { text::alarms::ACKNOWLEDGED_REMARK.get() } else { "" };
        let alarm = &first.alarm;
        let cause =
            text::alarms::pinned(alarm.priority.word(), &alarm.cause, &first.began.time, &(seen.to_owned() + &more));
        // Hovering over a text that is still too long shows all of it.
        let line = |ui: &mut Ui, words: &str, font: FontId, colour: Color32| {
            let font = fitting(ui.painter(), words, font, width);
            ui.add(Label::new(RichText::new(words).font(font).color(colour)).truncate());
        };
        line(ui, &cause, theme::strong(14.0), theme::DARK.text);
        line(ui, &alarm.cure, theme::regular(13.0), theme::DARK.text_weak);
    });
    // Not in the Tab order, because the button next to it does the same.
    ui.interact(words.response.rect, ui.scope_id().with("alarm"), Sense::CLICK).clicked()
}

fn entry_ui(ui: &mut Ui, entry: &AlarmEntry) {
    let ink = if entry.ended.is_none() { theme::now().text } else { theme::now().text_weak };
    ui.horizontal(|ui| {
        let (what, colour) = sign_of(entry);
        sign_ui(ui, what, 6.0, colour);
        ui.add(Label::new(small(heading(entry))).wrap());
    });
    ui.add(Label::new(RichText::new(&entry.alarm.cause).font(theme::strong(14.0)).color(ink)).wrap());
    ui.add(Label::new(weak(&entry.alarm.cure)).wrap());
    ui.add_space(6.0);
}

/// Returns the symbol of an alarm: filled with the colour of its priority while its cause is present.
fn sign_of(entry: &AlarmEntry) -> (Sign, Color32) {
    if entry.ended.is_some() {
        return (Sign::Ring, theme::now().text_weak);
    }
    let priority = entry.alarm.priority;
    let what = match priority {
        AlarmPriority::High => Sign::Octagon,
        AlarmPriority::Medium => Sign::Triangle,
        AlarmPriority::Low => Sign::Disc,
    };
    (what, priority.ink())
}

/// Returns an alarm as text for the clipboard.
fn entry_text(entry: &AlarmEntry) -> String {
    format!("{}\n{}\n{}\n\n", heading(entry), entry.alarm.cause, entry.alarm.cure)
}

/// Returns the times of an alarm, its priority and its state.
fn heading(entry: &AlarmEntry) -> String {
    let AlarmEntry { alarm, began, ended, acknowledged } = entry;
    let at = |moment: &AlarmMoment| {
        moment.loop_s.map_or_else(|| moment.time.clone(), |loop_s| format!("{} ({loop_s:.1} s)", moment.time))
    };
    let until = ended.as_ref().map_or_else(|| text::alarms::NOW.get().to_owned(), &at);
    let mut standing = if ended.is_some() { text::alarms::ENDED.get() } else { text::alarms::PRESENT.get() }.to_owned();
    if *acknowledged {
        standing.push_str(text::alarms::ACKNOWLEDGED_REMARK.get());
    }
    text::alarms::entry(&at(began), &until, alarm.priority.word(), &standing)
}
