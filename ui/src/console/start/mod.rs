//! The start page: choose or create a rig, choose a scene, see connected and missing devices.

mod addresses;
mod choices;
mod devices;
mod endoscope;
mod looking;
mod making;
mod welcome;

use std::path::{Path, PathBuf};

use egui::{Align, Button, CentralPanel, Frame, Label, Layout, Margin, RichText, ScrollArea, TextEdit, Ui, vec2};
use nima_machine::{config::RigConfig, messages::LoopState};
use nima_panels::rig_choice::RigChoice;
use nima_screen::{
    live::LiveState,
    picking::{Kind, Picking},
    theme,
    widgets::{card, next_button, small, weak},
};
use nima_words::{
    language::Text,
    text::{self, of_files::of_file},
};

use addresses::ExampleAddresses;
pub(crate) use choices::drawn_anew;
use choices::{ChoiceEntry, Lists};
use endoscope::EndoscopeCard;
use looking::{DeviceAnswers, PluggedIn};
use welcome::Welcome;
pub(in crate::console) use welcome::WelcomeChoice;

/// Height of a button that takes a whole row.
const ROW: f32 = 40.0;

#[derive(Debug)]
pub struct StartPage {
    /// The page for newcomers.
    pub(super) welcome: Welcome,
    chosen: RigChoice,
    folder: Option<PathBuf>,
    lists: Lists,
    /// The chosen rig, as long as its file has not changed.
    rig: Option<RigConfig>,
    new_name: String,
    report: Option<String>,
    plugged: PluggedIn,
    answers: DeviceAnswers,
    addresses: ExampleAddresses,
    endoscope: EndoscopeCard,
    /// The chosen rig's file may have changed.
    is_stale: bool,
    picking: Option<Picking>,
}

/// The user's request on the page.
#[derive(Debug)]
pub(super) enum StartRequest {
    Start(RigChoice),
    /// Show the page of an extra.
    Page,
    Leave,
}

/// Input for drawing the page.
pub(super) struct StartInputs<'a> {
    pub(super) live: &'a LiveState,
    /// The running rig and scene.
    pub(super) running: &'a RigChoice,
    pub(super) recent: &'a [RigChoice],
    /// A rig is being started.
    pub(super) is_starting: bool,
    /// State of the running rig's endoscope, and remedy.
    pub(super) image: Option<[String; 2]>,
    /// Name and purpose of the page of an extra.
    pub(super) page: Option<[&'static str; 2]>,
}

impl StartPage {
    pub(super) fn new(chosen: RigChoice) -> Self {
        Self {
            welcome: Welcome::default(),
            chosen,
            folder: None,
            lists: Lists::default(),
            rig: None,
            new_name: String::new(),
            report: None,
            plugged: PluggedIn::default(),
            answers: DeviceAnswers::default(),
            addresses: ExampleAddresses::default(),
            endoscope: EndoscopeCard::default(),
            is_stale: true,
            picking: None,
        }
    }

    /// Reads everything again for the page; the running rig is selected.
    pub(super) fn open(&mut self, running: &RigChoice, recent: &[RigChoice]) {
        self.report = None;
        self.is_stale = true;
        self.read(running, recent);
        self.choose(running.clone());
    }

    /// Shows this text below the button.
    pub(super) fn notify(&mut self, report: Option<String>) {
        self.report = report;
    }

    pub(super) fn report(&self) -> Option<&str> {
        self.report.as_deref()
    }

    pub(super) fn set_folder(&mut self, folder: Option<&Path>) {
        self.folder = folder.map(Path::to_path_buf);
    }

    fn read(&mut self, running: &RigChoice, recent: &[RigChoice]) {
        let used: Vec<_> = recent.iter().chain([running]).cloned().collect();
        self.lists = Lists::read(self.folder.as_deref(), &used);
    }

    fn choose(&mut self, choice: RigChoice) {
        if choice.rig != self.chosen.rig || self.is_stale {
            self.answers.forget();
            let rig = RigConfig::load(&choice.rig).ok();
            self.endoscope.choose(rig.as_ref());
            self.is_stale = false;
            self.rig = rig;
        }
        self.chosen = choice;
    }

    /// Draws the page; returns the user's request.
    pub(super) fn ui(&mut self, ui: &mut Ui, now: &StartInputs<'_>) -> Option<StartRequest> {
        let mut request = None;
        let frame = Frame::new().inner_margin(Margin::symmetric(14, 8));
        CentralPanel::default().frame(frame).show(ui, |ui| {
            let height = ui.available_height() - 66.0;
            ui.horizontal_top(|ui| {
                let width = (ui.available_width() - 2.0 * theme::GAP) / 3.0;
                ui.spacing_mut().item_spacing.x = theme::GAP;
                column(ui, "rigs", vec2(width, height), |ui| self.rigs_ui(ui, now));
                column(ui, "scenes", vec2(width, height), |ui| self.scenes_ui(ui));
                column(ui, "devices", vec2(width, height), |ui| self.devices_ui(ui, now));
            });
            ui.add_space(6.0);
            request = self.foot_ui(ui, now);
        });
        request
    }

    /// Returns whether the page of an extra is requested.
    fn elsewhere_ui(&mut self, ui: &mut Ui, now: &StartInputs<'_>) -> bool {
        let mut wants_page = false;
        // Place the buttons at the right edge, below the shortest column.
        let corner = ui.max_rect().right_top() - vec2(theme::STOP_SIZE.x, 0.0);
        let place = egui::Rect::from_min_size(corner, theme::STOP_SIZE);
        if let Some([name, meaning]) = now.page {
            let place = place.translate(vec2(-theme::STOP_SIZE.x - theme::GAP, 0.0));
            let page = Button::new(name).wrap();
            let page = ui.add_enabled_ui(!now.is_starting, |ui| ui.put(place, page)).inner;
            wants_page = page.on_hover_text(meaning).on_disabled_hover_text(text::commands::IS_STARTING).clicked();
        }
        let button = Button::new(text::start::ELSEWHERE);
        let button = ui.add_enabled_ui(self.picking.is_none(), |ui| ui.put(place, button)).inner;
        let button = button.on_hover_text(text::start::ELSEWHERE_HOVER);
        if button.on_disabled_hover_text(text::start::ELSEWHERE_IS_OPEN).clicked() {
            let kind = Kind { name: text::start::RIG_FILES.get(), endings: &["toml"] };
            let folder = self.folder.as_deref();
            self.picking = Some(Picking::open(ui.ctx(), text::start::ELSEWHERE.get(), kind, folder));
        }
        wants_page
    }

    fn rigs_ui(&mut self, ui: &mut Ui, now: &StartInputs<'_>) {
        let mut chosen = None;
        card(ui, text::start::RIGS, text::start::RIGS_HOVER, |ui| {
            let others: Vec<_> = now.recent.iter().filter(|choice| *choice != now.running).collect();
            if !others.is_empty() {
                ui.label(small(text::start::RECENT));
            }
            for choice in others {
                let words = self.words_of(choice);
                if row_ui(ui, self.chosen == *choice, true, &words, "").clicked() {
                    chosen = Some(choice.clone());
                }
            }
            for (heading, own) in [(text::start::BUILT_IN.get(), false), (text::start::YOURS.get(), true)] {
                let rigs: Vec<_> = self.lists.rigs.iter().filter(|entry| entry.own == own).collect();
                if !rigs.is_empty() {
                    ui.label(small(heading));
                }
                for entry in rigs {
                    if entry_ui(ui, entry, self.chosen.rig == entry.key, now.running.rig == entry.key) {
                        chosen = Some(self.chosen.with_rig(&entry.key));
                    }
                }
            }
        });
        if let Some(path) = Picking::take(&mut self.picking) {
            let picked = self.chosen.with_rig(&path.display().to_string());
            self.read(now.running, &[now.recent, std::slice::from_ref(&picked)].concat());
            chosen = Some(picked);
        }
        if let Some(chosen) = chosen {
            self.choose(chosen);
        }
        card(ui, text::start::NEW_NAME, text::start::MAKE_HOVER, |ui| {
            let width = ui.available_width();
            let field = ui.add_sized(vec2(width, 28.0), TextEdit::singleline(&mut self.new_name));
            field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, text::start::NEW_NAME.get()));
            let make = ui.add(Button::new(text::start::MAKE).min_size(vec2(width, 32.0)));
            if make.on_hover_text(text::start::MAKE_HOVER).clicked() {
                self.make(now);
            }
        });
    }

    fn make(&mut self, now: &StartInputs<'_>) {
        match making::make(self.folder.as_deref(), &self.chosen.rig, &self.new_name) {
            Ok(path) => {
                self.report = Some(text::start::made(&path));
                self.new_name.clear();
                self.read(now.running, now.recent);
                self.choose(RigChoice { rig: path.display().to_string(), ..self.chosen.clone() });
            }
            Err(report) => self.report = Some(report),
        }
    }

    /// Returns the text for rig and scene; a real arm has no scene.
    fn words_of(&self, choice: &RigChoice) -> String {
        let rig = name_in(&self.lists.rigs, &choice.rig);
        if self.has_real_arm(choice) {
            return rig.to_owned();
        }
        format!("{rig}, {}", name_in(&self.lists.scenes, &choice.scene))
    }

    fn has_real_arm(&self, choice: &RigChoice) -> bool {
        self.lists.rigs.iter().any(|entry| entry.key == choice.rig && entry.real_arm)
    }

    fn scenes_ui(&mut self, ui: &mut Ui) {
        card(ui, text::start::SCENES, text::start::SCENES_HOVER, |ui| {
            if self.has_real_arm(&self.chosen) {
                ui.add(Label::new(text::start::NO_SCENE).wrap());
                return;
            }
            for entry in &self.lists.scenes {
                if entry_ui(ui, entry, self.chosen.scene == entry.key, false) {
                    self.chosen.scene.clone_from(&entry.key);
                }
            }
        });
    }

    /// Call while the page is not shown.
    pub(super) fn rest(&mut self) {
        self.endoscope.close();
    }

    /// Returns the reason why the chosen rig and scene cannot be started now.
    fn why_not_started(&self, now: &StartInputs<'_>) -> Option<Text> {
        let usable = |list: &[ChoiceEntry], key: &str| list.iter().any(|entry| entry.key == key && entry.usable);
        let is_usable = usable(&self.lists.rigs, &self.chosen.rig) && usable(&self.lists.scenes, &self.chosen.scene);
        if now.is_starting {
            Some(text::commands::IS_STARTING)
        } else if now.live.state() == LoopState::Engaged && is_real(&now.live.rig) {
            Some(text::start::ENGAGED)
        } else {
            (!is_usable).then_some(text::start::UNUSABLE)
        }
    }

    fn foot_ui(&mut self, ui: &mut Ui, now: &StartInputs<'_>) -> Option<StartRequest> {
        let mut request = None;
        ui.horizontal(|ui| {
            let same = self.chosen == *now.running;
            let why = self.why_not_started(now);
            let words = if same { text::start::START_AGAIN.get() } else { text::start::START.get() };
            let name = RichText::new(words).font(theme::strong(17.0));
            let button = next_button(name, !same).min_size(theme::STOP_SIZE);
            let button = ui.add_enabled(why.is_none(), button).on_hover_text(text::start::START_HOVER);
            if button.on_disabled_hover_text(why.map_or("", Text::get)).clicked() {
                request = Some(StartRequest::Start(self.chosen.clone()));
            }
            let back = Button::new(text::start::BACK).min_size(theme::STOP_SIZE);
            let back = ui.add_enabled(!now.is_starting, back).on_hover_text(text::start::BACK_HOVER);
            if back.on_disabled_hover_text(text::commands::IS_STARTING).clicked() {
                request = Some(StartRequest::Leave);
            }
            ui.vertical(|ui| {
                ui.label(RichText::new(self.words_of(&self.chosen)).font(theme::strong(15.0)));
                if now.is_starting {
                    ui.label(weak(text::start::STARTING));
                }
                if let Some(report) = &self.report {
                    ui.add(Label::new(report).wrap());
                }
            });
            if self.elsewhere_ui(ui, now) {
                request = Some(StartRequest::Page);
            }
        });
        request
    }
}

/// Returns whether a person may be at the handle and a patient below the arm.
pub(super) fn is_real(rig: &RigConfig) -> bool {
    !rig.is_harmless()
}

fn name_in<'a>(list: &'a [ChoiceEntry], key: &'a str) -> &'a str {
    list.iter().find(|entry| entry.key == key).map_or(key, |entry| of_file(&entry.name))
}

fn column(ui: &mut Ui, name: &str, size: egui::Vec2, content: impl FnOnce(&mut Ui)) {
    ui.allocate_ui_with_layout(size, Layout::top_down(Align::Min), |ui| {
        ScrollArea::vertical().id_salt(name).auto_shrink(false).max_height(size.y).show(ui, |ui| {
            ui.set_width(size.x - 8.0);
            content(ui);
        });
    });
}

fn row_ui(ui: &mut Ui, chosen: bool, usable: bool, name: &str, about: &str) -> egui::Response {
    let button = Button::selectable(chosen, name).frame_when_inactive(true);
    let button = ui.add_enabled(usable, button.min_size(vec2(ui.available_width(), ROW * 0.75)));
    if about.is_empty() { button } else { button.on_hover_text(about).on_disabled_hover_text(about) }
}

fn entry_ui(ui: &mut Ui, entry: &ChoiceEntry, chosen: bool, running: bool) -> bool {
    let clicked = row_ui(ui, chosen, entry.usable, of_file(&entry.name), &entry.key).clicked();
    let about = of_file(&entry.about);
    let words = if running { format!("{}. {about}", text::start::RUNNING.get()) } else { about.to_owned() };
    ui.add(Label::new(small(words)).wrap());
    ui.add_space(4.0);
    clicked
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_start_says_what_is_missing() {
        let plan = nima_tests::plan("peg_transfer");
        let live = LiveState::new(plan.rig, plan.scene);
        let running = RigChoice::default();
        let now = |is_starting| StartInputs {
            live: &live,
            running: &running,
            recent: &[],
            is_starting,
            image: None,
            page: None,
        };
        let mut page = StartPage::new(running.clone());
        assert_eq!(page.why_not_started(&now(false)), Some(text::start::UNUSABLE), "in no list");
        page.open(&running, &[]);
        assert_eq!(page.why_not_started(&now(false)), None);
        assert_eq!(page.why_not_started(&now(true)), Some(text::commands::IS_STARTING));
    }
}
