//! The devices of the rig: identification, connection, test, and assignment to parts.
//!
//! A table with one line per device, broken ones first. The window carries out a [`RigEdit`] of the rig: it writes the rig
//! file and restarts the machine.

mod choosing;
mod rates;
mod report;
mod row;

use std::time::Instant;

use egui::{Button, Frame, Label, Margin, RichText, Ui, vec2};
use nima_devices::Health;
use nima_machine::{
    config::ChosenDevice,
    messages::LoopState,
    rig::{
        Gauges, PartKind, RigPart, Side,
        checkup::{BLOCKS, Checkup, TestSubject},
    },
};
use nima_screen::{
    live::{LiveState, ScreenSource},
    theme,
    widgets::{small, weak},
};
use nima_words::{
    language::Text,
    report_text::{obstacle_text, side_word},
    text,
};

use crate::panel::{Panel, PanelContext, PanelSize};

use choosing::Chooser;
use rates::RateHistory;
use row::{headings_ui, row_ui, urgency};

/// A test without data for this time is aborted.
const TEST_MAX: std::time::Duration = std::time::Duration::from_secs(6);

/// A requested change of the rig.
#[derive(Clone, Debug)]
pub enum RigEdit {
    /// Swap the devices of this kind between right and left.
    ExchangeSides(PartKind),
    /// Use another device for this part.
    Choose(RigPart, ChosenDevice),
}

/// A running test.
#[derive(Debug)]
struct Test {
    /// Indices in the roster.
    places: Vec<usize>,
    /// Number of the first block.
    from: u64,
    began: std::time::Instant,
}

#[derive(Debug, Default)]
pub struct DevicesState {
    test: Option<Test>,
    results: Vec<(usize, Checkup)>,
    chooser: Option<Chooser>,
    report: Option<String>,
    rates: RateHistory,
    /// Indices in the roster, in the order of the rows.
    order: Vec<usize>,
    /// State of the endoscope and remedy; `None` for a rig without one.
    pub image: Option<[String; 2]>,
    pub is_starting: bool,
    /// The panel was drawn in the last frame: lights are updated while the window rests.
    pub is_seen: bool,
}

impl DevicesState {
    /// Shows this text at the top of the panel.
    pub fn notify(&mut self, report: String) {
        self.report = Some(report);
    }

    /// Discards all data about the previous devices.
    pub fn begin_anew(&mut self) {
        self.test = None;
        self.chooser = None;
        self.results.clear();
        self.order.clear();
    }

    /// Records the rates of the devices; call it in every frame.
    pub fn sample(&mut self, live: &LiveState) {
        self.rates.sample(&live.healths.devices, Instant::now());
    }

    /// Puts broken devices first. While the pointer is on the rows they stay: none may move under it.
    fn sort(&mut self, healths: &[Health], is_pointed_at: bool) {
        if self.order.len() == healths.len() && is_pointed_at {
            return;
        }
        self.order = (0..healths.len()).collect();
        self.order.sort_by_key(|place| urgency(healths[*place].standing));
    }

    /// Returns whether a test is running, which needs every block of data.
    pub const fn is_testing(&self) -> bool {
        self.test.is_some()
    }

    fn begin_test(&mut self, places: Vec<usize>, live: &LiveState) {
        self.results.retain(|(place, _)| !places.contains(place));
        self.report = None;
        self.test = Some(Test { places, from: live.blocks_counted, began: std::time::Instant::now() });
    }

    fn is_tested(&self, place: usize) -> bool {
        self.test.as_ref().is_some_and(|test| test.places.contains(&place))
    }

    fn result(&self, place: usize) -> Option<&Checkup> {
        self.results.iter().find(|(at, _)| *at == place).map(|(_, result)| result)
    }

    /// Ends a test that has its data.
    fn follow_test(&mut self, live: &LiveState) {
        let Some(test) = &self.test else { return };
        if live.blocks_counted < test.from + BLOCKS as u64 {
            if test.began.elapsed() > TEST_MAX {
                self.test = None;
                self.notify(text::devices::TEST_BROKEN_OFF.get().to_owned());
            }
            return;
        }
        let Some(test) = self.test.take() else { return };
        let blocks: Vec<&Gauges> = {
            let newest = (live.blocks_counted - test.from) as usize;
            let skip = live.blocks.len().saturating_sub(newest);
            live.blocks.iter().skip(skip).take(BLOCKS).map(AsRef::as_ref).collect()
        };
        for place in test.places {
            let part = live.roster.get(place).and_then(|entry| entry.part);
            let subject = part.and_then(|part| TestSubject::of(part, place, &live.rig, &blocks));
            let checkup = subject.and_then(|subject| Checkup::of(&subject));
            self.results.extend(checkup.map(|checkup| (place, checkup)));
        }
    }
}

/// Returns the reason why the rig cannot be changed now.
pub fn why_not_to_change(live: &LiveState, is_starting: bool) -> Option<&'static str> {
    if is_starting {
        return Some(text::devices::STARTING.get());
    }
    live.ticks.iter().flatten().find_map(|tick| match tick.state {
        LoopState::Ready | LoopState::Engaged | LoopState::Clutched => Some(text::devices::ENGAGED.get()),
        LoopState::Stopped => Some(text::devices::STOPPED.get()),
        LoopState::Idle | LoopState::Disconnected | LoopState::Faulted(_) => None,
    })
}

/// Lets lines wrap at the visible width: the table of devices is wider than a narrow window and scrolls.
pub fn wrap_to_visible(ui: &mut Ui) {
    let visible = ui.clip_rect().right() - ui.min_rect().left();
    ui.set_max_width(ui.available_width().min(visible - 16.0));
}

/// Draws the panel; for a rig without devices it says that everything is simulated. Returns a requested change of the
/// rig.
#[derive(Debug, Default)]
pub struct DevicesPanel;

impl Panel for DevicesPanel {
    const NAME: Text = text::devices::NAME;
    const MEANING: Text = text::devices::MEANING;
    const SIZE: PanelSize = PanelSize::list(590.0);

    fn ui(&mut self, ui: &mut Ui, at: &mut PanelContext<'_>) {
        if at.live.is_shown_only() {
            devices_then_ui(ui, at.live);
        } else {
            ui.add_enabled_ui(!at.is_locked, |ui| at.wishes.devices = devices_ui(ui, at.live, &mut at.panels.devices));
        }
    }
}

/// Draws the devices of a recorded session or of another machine, and a note on data that are missing here.
fn devices_then_ui(ui: &mut Ui, live: &LiveState) {
    let elsewhere = live.of == ScreenSource::Elsewhere;
    Frame::new().inner_margin(Margin::same(8)).show(ui, |ui| {
        wrap_to_visible(ui);
        if live.devices_then.is_empty() {
            ui.label(if elsewhere { text::monitor::SIMULATED.get() } else { text::playback::SIMULATED.get() });
        }
        for (name, standing) in &live.devices_then {
            ui.label(text::playback::device(*name, *standing));
        }
        ui.add_space(6.0);
        ui.label(weak(if elsewhere {
            text::monitor::NOT_OF_DEVICES.get()
        } else {
            text::playback::NOT_OF_DEVICES.get()
        }));
    });
}

pub fn devices_ui(ui: &mut Ui, live: &LiveState, state: &mut DevicesState) -> Option<RigEdit> {
    state.is_seen = true;
    if live.roster.is_empty() {
        ui.scope(|ui| {
            wrap_to_visible(ui);
            ui.label(weak(text::devices::NONE));
            ui.add(Label::new(small(text::devices::NONE_TO_CONNECT)).wrap());
        });
        image_ui(ui, state);
        return None;
    }
    state.follow_test(live);
    let refused = why_not_to_change(live, state.is_starting);
    let mut change = head_ui(ui, live, state, refused);
    if let Some(report) = &state.report {
        ui.add(Label::new(report).wrap());
    }
    ui.add_space(4.0);
    let is_pointed_at = ui.ui_contains_pointer();
    state.sort(&live.healths.devices, is_pointed_at);
    headings_ui(ui);
    for place in state.order.clone() {
        change = row_ui(ui, live, state, place, refused).or(change);
    }
    for (side, obstacle) in Side::ALL.into_iter().zip(&live.healths.obstacles) {
        if let Some(obstacle) = obstacle {
            ui.add(Label::new(text::devices::not_to_be_engaged(side_word(side), &obstacle_text(obstacle))).wrap());
        }
    }
    image_ui(ui, state);
    change
}

/// Draws the endoscope, which the loop does not use.
fn image_ui(ui: &mut Ui, state: &DevicesState) {
    let Some([report, cure]) = &state.image else { return };
    ui.add_space(6.0);
    ui.label(small(text::endoscope_view::ENDOSCOPE));
    ui.add(Label::new(RichText::new(report)).wrap());
    if !cure.is_empty() {
        ui.add(Label::new(weak(cure)).wrap());
    }
}

/// Draws what is above the devices: explanation of the lights, the test of all devices, the swaps.
fn head_ui(ui: &mut Ui, live: &LiveState, state: &mut DevicesState, refused: Option<&str>) -> Option<RigEdit> {
    ui.add(Label::new(weak(text::devices::WHICH)).wrap());
    let mut change = None;
    let both = |kind: PartKind| {
        let has = |side| live.roster.iter().any(|entry| entry.part.is_some() && entry.part == kind.of(side));
        Side::ALL.into_iter().all(has)
    };
    let kinds: Vec<_> = PartKind::OF_A_SIDE.into_iter().filter(|kind| both(*kind)).collect();
    ui.horizontal_wrapped(|ui| {
        let parts: Vec<_> = (0..live.roster.len()).filter(|place| live.roster[*place].part.is_some()).collect();
        let button = Button::new(RichText::new(text::devices::TEST_ALL)).min_size(vec2(84.0, 26.0));
        let button = ui.add_enabled(!state.is_testing() && !parts.is_empty(), button);
        let why = if parts.is_empty() { text::devices::NOTHING_TO_TEST } else { text::devices::TEST_RUNS };
        if button.on_hover_text(text::devices::TEST_HOVER).on_disabled_hover_text(why).clicked() {
            state.begin_test(parts, live);
        }
        if !kinds.is_empty() {
            ui.add_space(8.0);
            ui.label(small(text::devices::EXCHANGE));
        }
        for kind in kinds {
            let button = Button::new(small(text::devices::kind(kind))).min_size(vec2(58.0, 26.0));
            let button = ui.add_enabled(refused.is_none(), button);
            button.widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::Button, refused.is_none(), text::devices::exchange(kind))
            });
            let button = button.on_hover_text(text::devices::EXCHANGE_HOVER);
            if button.on_disabled_hover_text(refused.unwrap_or_default()).clicked() {
                change = Some(RigEdit::ExchangeSides(kind));
            }
        }
    });
    if let Some(refused) = refused {
        ui.add(Label::new(RichText::new(text::devices::not_changeable(refused)).color(theme::now().text_weak)).wrap());
    }
    change
}

#[cfg(test)]
mod tests {
    use nima_devices::{ConnectionState, Loss};

    use super::*;

    #[test]
    fn broken_devices_are_first_and_no_row_moves_under_the_pointer() {
        let health = |standing| {
            let mut health = Health::opening();
            health.standing = standing;
            health
        };
        let connected = health(ConnectionState::Connected);
        let lost = health(ConnectionState::Lost(Loss::Silent));
        let mut state = DevicesState::default();
        state.sort(&[connected, health(ConnectionState::Closed), connected, lost], true);
        assert_eq!(state.order, [3, 1, 0, 2]);
        state.sort(&[lost, connected, connected, connected], true);
        assert_eq!(state.order, [3, 1, 0, 2], "a person may be about to press a button");
        state.sort(&[lost, connected, connected, connected], false);
        assert_eq!(state.order, [0, 1, 2, 3]);
    }
}
