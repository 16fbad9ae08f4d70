//! The Calibration panel: active calibrations between wrist sensor and tip force, shown in every view, and buttons that open
//! the wizards.

use egui::{Button, Id, Label, RichText, TextStyle, Ui, vec2};
use nima_machine::{
    messages::{ForceSource, LoopState},
    rig::Side,
};
use nima_screen::{
    live::LiveState,
    scene3d::side_name,
    steady_button::{PATIENT_S, SteadyButton},
    theme,
    widgets::{Sign, fitting_style, next_button, sign_ui, small, weak},
};
use nima_wizards::{WizardKind, active_calibrations::ActiveCalibrations};
use nima_words::{
    language::Text,
    report_text::{ShortText as _, sentence, within},
    text,
};

use crate::panel::{Panel, PanelContext, PanelSize};

/// Height of the source of the force.
const SOURCE_HEIGHT: f32 = 38.0;

/// A request of the technician.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CalibrationWish {
    Open(WizardKind),
    Check,
    List,
    /// Select the wrist sensor of this arm.
    Choose(Side),
    /// Return to the normal view.
    Close,
}

/// The page next to the panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CalibrationPage {
    Wizard(WizardKind),
    Check,
    All,
}

#[derive(Debug, Default)]
pub struct CalibrationsPanel;

impl Panel for CalibrationsPanel {
    const NAME: Text = text::calibrations::NAME;
    const MEANING: Text = text::calibrations::MEANING;
    const SIZE: PanelSize = PanelSize::KNOBS;
    const ACTS: bool = true;

    fn ui(&mut self, ui: &mut Ui, at: &mut PanelContext<'_>) {
        at.wishes.calibration = calibrations_ui(ui, at.live, at.active, None, text::calibrations::CLOSE_WIZARD);
    }
}

/// Draws the panel; `open` is the page next to it, and `back` names the way back from it.
pub fn calibrations_ui(
    ui: &mut Ui,
    live: &LiveState,
    active: &ActiveCalibrations,
    open: Option<CalibrationPage>,
    back: Text,
) -> Option<CalibrationWish> {
    let closed = text::calibrations::closed(live.state_for(active.side()));
    let mut wish = rig_ui(ui, live, closed, open);
    ui.add_space(2.0);
    source_ui(ui, live, active.side());
    for report in active.report() {
        ui.label(report);
    }
    ui.add_space(4.0);
    if live.is_bimanual() {
        wish = side_ui(ui, active.side()).or(wish);
    }
    // Only an arm with joints has frames.
    let has_arm = live.rig.devices.is_some();
    let offered = |which: &WizardKind| match which {
        WizardKind::Camera => live.rig.endoscope.is_some(),
        _ => has_arm || which.scene().is_some(),
    };
    for which in WizardKind::built().filter(offered) {
        let text = text::calibrations::calibrate(&within(which.name()));
        let is_open = open == Some(CalibrationPage::Wizard(which));
        let size = vec2(ui.available_width(), 28.0);
        let meaning = text::calibrations::opens(which.meaning());
        let id = Id::unique(("calibrate", which.name()));
        let may = closed.map_or(Ok(()), Err);
        let button = SteadyButton { id, label: &text, meaning: &meaning, may, waits_s: PATIENT_S };
        let look = |text: String| Button::selectable(is_open, text).frame_when_inactive(true).min_size(size);
        if is_open {
            ui.add_enabled(false, look(text.clone())).on_disabled_hover_text(text::calibrations::IS_OPEN);
        } else if button.ui(ui, |text, _| look(text)) {
            wish = Some(CalibrationWish::Open(which));
        }
    }
    if open.is_some() {
        let back = Button::new(back.get()).min_size(vec2(ui.available_width(), 32.0));
        if ui.add(back).on_hover_text(text::calibrations::CLOSE_WIZARD_HOVER).clicked() {
            wish = Some(CalibrationWish::Close);
        }
    }
    // Placed below the buttons, which must not move under the pointer when a sensor connects or disconnects.
    ui.add_space(4.0);
    for line in active.lines() {
        ui.label(small(line));
    }
    wish
}

/// Draws the controls for the whole rig: the ready check and the list of all calibrations. On a rig with devices, the
/// required one is highlighted before engaging. `closed`: the reason why no wizard of the selected arm can be opened.
fn rig_ui(
    ui: &mut Ui,
    live: &LiveState,
    closed: Option<&str>,
    open: Option<CalibrationPage>,
) -> Option<CalibrationWish> {
    let mut wish = None;
    let check_closed = text::calibrations::closed(live.state());
    let next = next_page(live).filter(|_| live.rig.devices.is_some() && open.is_none());
    let width = (ui.available_width() - ui.spacing().item_spacing.x) / 2.0;
    ui.horizontal(|ui| {
        for (page, name, meaning, opens) in [
            (
                CalibrationPage::Check,
                text::ready::OPEN.get(),
                text::calibrations::opens(text::ready::MEANING.get()),
                CalibrationWish::Check,
            ),
            (
                CalibrationPage::All,
                text::overview::OPEN.get(),
                text::overview::MEANING.get().to_owned(),
                CalibrationWish::List,
            ),
        ] {
            let is_open = open == Some(page);
            let next = next == Some(page);
            let room = width - 2.0 * ui.spacing().button_padding.x;
            let font = fitting_style(ui, name, &TextStyle::Button, room);
            let look = |name: String| {
                let name = RichText::new(name).font(font);
                next_button(name, next).selected(is_open).frame_when_inactive(true).min_size(vec2(width, 28.0))
            };
            if is_open {
                ui.add_enabled(false, look(name.to_owned())).on_disabled_hover_text(text::calibrations::IS_OPEN);
                continue;
            }
            let may = check_closed.filter(|_| page == CalibrationPage::Check).map_or(Ok(()), Err);
            let id = Id::unique(("page", name));
            let button = SteadyButton { id, label: name, meaning: &meaning, may, waits_s: PATIENT_S };
            if button.ui(ui, |name, _| look(name)) {
                wish = Some(opens);
            }
        }
    });
    // One line in every state, so that the buttons below do not move under the pointer.
    let words = closed.unwrap_or(text::calibrations::SETS_IDLE.get());
    let font = fitting_style(ui, words, &TextStyle::Small, ui.available_width());
    ui.add(Label::new(weak(words).font(font)).truncate());
    wish
}

/// Returns the page to complete before an idle rig can be engaged: a missing calibration, then the ready check. If the
/// force is unknown for another reason, neither helps.
fn next_page(live: &LiveState) -> Option<CalibrationPage> {
    let is_idle = live.state() == LoopState::Idle;
    let mut sources = live.ticks.iter().flatten().filter(|_| is_idle).map(|tick| tick.force.source);
    let first = sources.clone().find(|source| !source.is_usable()).or_else(|| sources.next())?;
    match first {
        ForceSource::Uncalibrated | ForceSource::Poisoned => Some(CalibrationPage::All),
        source if !source.is_usable() => None,
        _ => live.is_unchecked.then_some(CalibrationPage::Check),
    }
}

/// Draws the selection of the arm to calibrate; returns the selected arm.
fn side_ui(ui: &mut Ui, now: Side) -> Option<CalibrationWish> {
    let mut wish = None;
    ui.horizontal(|ui| {
        for side in Side::LEFT_TO_RIGHT {
            let name = text::calibrations::arm(side_name(side));
            let button = Button::selectable(now == side, name).frame_when_inactive(true).min_size(vec2(104.0, 26.0));
            let chosen = ui.add(button).on_hover_text(text::calibrations::ARM_TO_CALIBRATE).clicked();
            if chosen && now != side {
                wish = Some(CalibrationWish::Choose(side));
            }
        }
    });
    wish
}

fn source_ui(ui: &mut Ui, live: &LiveState, side: Side) {
    let tick = live.tick_of(side).or_else(|| live.first_tick());
    let source = tick.map_or(ForceSource::NoSample, |tick| tick.force.source);
    let sure = matches!(source, ForceSource::AtTip | ForceSource::Network);
    let (what, colour) = if sure { (Sign::Disc, theme::now().engaged) } else { (Sign::Triangle, theme::now().text) };
    // Reserve two lines: a reason may need them, and must not move the buttons when it appears.
    ui.scope(|ui| {
        ui.set_min_height(SOURCE_HEIGHT);
        ui.horizontal(|ui| {
            sign_ui(ui, what, 5.0, colour);
            let words = RichText::new(text::calibrations::source(source.words())).font(theme::strong(14.0));
            ui.add(Label::new(words).wrap()).on_hover_text(sentence(source.words()));
        });
    });
    if let Some(unsure) = source.doubt() {
        ui.label(small(sentence(unsure.words())));
    }
}

#[cfg(test)]
mod tests {
    use nima_machine::config::RigConfig;
    use nima_simulation::{SimulationPlan, run_virtual, scene::Scene};

    use super::*;

    #[test]
    fn a_device_lost_at_one_arm_does_not_close_the_wizards_of_the_other() {
        let rig = RigConfig::load("simulated").unwrap();
        let scene = Scene::load("bimanual").unwrap();
        let plan =
            SimulationPlan { rig: rig.clone(), scene: scene.clone(), calibrations: Default::default(), engage: false };
        let mut live = LiveState::new(rig, scene);
        run_virtual(&plan, 0.1, |tick| {
            live.ticks[tick.side.index()] = Some(*tick);
            None
        })
        .unwrap();
        live.ticks[Side::Left.index()].as_mut().unwrap().state = LoopState::Disconnected;
        let closed = |side| text::calibrations::closed(live.state_for(side));
        assert_eq!(live.state(), LoopState::Disconnected);
        assert_eq!(closed(Side::Right), None);
        assert!(closed(Side::Left).is_some());
    }

    #[test]
    fn a_button_leads_to_the_calibrations_only_where_one_is_missing() {
        let rig = RigConfig::load("simulated").unwrap();
        let scene = Scene::load("peg_transfer").unwrap();
        let plan =
            SimulationPlan { rig: rig.clone(), scene: scene.clone(), calibrations: Default::default(), engage: false };
        let mut live = LiveState::new(rig, scene);
        assert_eq!(next_page(&live), None);
        run_virtual(&plan, 0.1, |tick| {
            live.ticks[0] = Some(*tick);
            None
        })
        .unwrap();
        let mut next = |source: ForceSource, is_unchecked| {
            live.is_unchecked = is_unchecked;
            live.ticks[0].as_mut().unwrap().force.source = source;
            next_page(&live)
        };
        for source in ForceSource::UNUSABLE {
            let is_calibration = matches!(source, ForceSource::Uncalibrated | ForceSource::Poisoned);
            assert_eq!(next(source, true), is_calibration.then_some(CalibrationPage::All), "{source:?}");
        }
        assert_eq!(
            [true, false].map(|unchecked| next(ForceSource::Wrist, unchecked)),
            [Some(CalibrationPage::Check), None]
        );
    }
}
