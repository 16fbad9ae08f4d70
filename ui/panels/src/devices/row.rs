//! One device in one line: its state, light, rate, address and buttons; below it, only what needs attention.

use egui::{Align, Button, Color32, Label, Layout, RichText, Sense, TextStyle, Ui, Vec2, vec2};
use nima_devices::{ConnectionState, DeviceError, DeviceIdentity, Health};
use nima_machine::rig::RosterEntry;
use nima_screen::{
    live::LiveState,
    theme,
    widgets::{Sign, fitting_style, sign, sign_ui, small, weak},
};
use nima_words::{
    report_text::{loss_text, quoted, role_name},
    text,
};

use super::{DevicesState, RigEdit, choosing, rates::rates_ui, report::report_ui};

/// Height of a line.
const HEIGHT: f32 = 24.0;
/// Widths of the columns: sign, name, light, state, rate, rate over time.
const SIGN: f32 = 12.0;
const NAME: f32 = 104.0;
const LIGHT: f32 = 19.0;
const STATE: f32 = 84.0;
const RATE: f32 = 46.0;
const RATES: f32 = 48.0;
/// Widths of the buttons: test, choose, connect or disconnect, copy.
const BUTTONS: [f32; 4] = [50.0, 58.0, 78.0, 62.0];
/// Distance of the columns.
const BETWEEN: f32 = 6.0;
/// An address with less room than this is only in the hover text.
const ADDRESS_MIN: f32 = 60.0;

/// Returns the width that is left for the address.
fn address_width(ui: &Ui) -> f32 {
    let fixed = SIGN + NAME + LIGHT + STATE + RATE + RATES + 6.0 * BETWEEN;
    let buttons: f32 = BUTTONS.iter().map(|width| width + 4.0).sum();
    ui.available_width() - fixed - buttons - BETWEEN
}

/// Draws `content` in a column of this width.
fn cell<R>(ui: &mut Ui, width: f32, content: impl FnOnce(&mut Ui) -> R) -> R {
    ui.allocate_ui_with_layout(vec2(width, HEIGHT), Layout::left_to_right(Align::Center), |ui| {
        ui.set_min_width(width);
        content(ui)
    })
    .inner
}

/// Draws the headings of the columns.
pub(super) fn headings_ui(ui: &mut Ui) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = BETWEEN;
        let address = address_width(ui);
        let heading = |ui: &mut Ui, width: f32, words: &str| {
            cell(ui, width, |ui| ui.add(Label::new(small(words)).truncate()));
        };
        ui.add_space(SIGN + BETWEEN);
        heading(ui, NAME, text::devices::DEVICE.get());
        ui.add_space(LIGHT + BETWEEN);
        heading(ui, STATE, text::devices::STATE.get());
        heading(ui, RATE + BETWEEN + RATES, text::devices::READINGS.get());
        if address >= ADDRESS_MIN {
            heading(ui, address, text::devices::ADDRESS.get());
        }
    });
}

/// Draws a device; returns a requested change of the rig.
pub(super) fn row_ui(
    ui: &mut Ui,
    live: &LiveState,
    state: &mut DevicesState,
    place: usize,
    refused: Option<&str>,
) -> Option<RigEdit> {
    let entry = live.roster.get(place)?;
    let health = live.healths.devices.get(place)?;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = BETWEEN;
        let address = address_width(ui);
        let (what, colour) = sign_of(health.standing);
        sign_ui(ui, what, 5.0, colour);
        cell(ui, NAME, |ui| {
            let name = Label::new(RichText::new(role_name(entry.role)).font(theme::strong(13.5))).truncate();
            ui.add(name).on_hover_text(address_text(entry));
        });
        let motion = light_ui(ui, live, entry, place);
        state_ui(ui, health.standing, motion.as_deref(), state.is_tested(place));
        rate_ui(ui, health);
        rates_ui(ui, vec2(RATES, HEIGHT - 6.0), state.rates.of(place));
        if address >= ADDRESS_MIN {
            let words = address_text(entry);
            cell(ui, address, |ui| ui.add(Label::new(small(&words)).truncate()).on_hover_text(&words));
        }
        buttons_ui(ui, live, state, place);
    });
    if let ConnectionState::Lost(_) = health.standing {
        ui.add(Label::new(small(figures(health))).wrap());
    }
    if let Some(trouble) = entry.view.report().trouble {
        trouble_ui(ui, entry, &trouble);
    }
    if let Some(checkup) = state.result(place) {
        ui.indent(("checkup", place), |ui| report_ui(ui, checkup));
    }
    entry.part.and_then(|part| choosing::chooser_ui(ui, live, state, part, refused))
}

/// Returns the name and serial number; `None` if the device reports neither.
pub(super) fn identity_text(identity: &DeviceIdentity) -> Option<String> {
    let DeviceIdentity { product, serial, firmware } = identity;
    (!product.is_empty()).then(|| text::devices::identity(product, serial, firmware))
}

/// Returns the driver with the address, and the identity if the device reports one.
fn address_text(entry: &RosterEntry) -> String {
    match entry.view.report().identity.as_ref().and_then(identity_text) {
        Some(identity) => format!("{}, {identity}", entry.driver),
        None => entry.driver.clone(),
    }
}

/// Draws the light that shows which device is being moved; returns the motion.
fn light_ui(ui: &mut Ui, live: &LiveState, entry: &RosterEntry, place: usize) -> Option<String> {
    let (rect, light) = ui.allocate_exact_size(Vec2::splat(LIGHT), Sense::hover());
    let part = entry.part?;
    let motion = live.activity.lit(place).map(|channel| text::devices::motion(part.kind(), channel));
    let name = text::devices::light(&role_name(entry.role), motion.as_deref());
    light.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &name));
    light.on_hover_text(text::devices::LIGHT_HOVER);
    let palette = theme::now();
    if motion.is_some() {
        ui.painter().circle_filled(rect.center(), 9.0, palette.text.gamma_multiply(0.25));
        sign(ui.painter(), Sign::Disc, rect.center(), 6.4, palette.text);
    } else {
        sign(ui.painter(), Sign::Ring, rect.center(), 6.4, palette.text_weak);
    }
    motion
}

/// Draws the state; while the device is moved, the motion.
fn state_ui(ui: &mut Ui, standing: ConnectionState, motion: Option<&str>, is_tested: bool) {
    let word = state_word(standing);
    cell(ui, STATE, |ui| {
        let words = if is_tested { text::devices::TESTING.get() } else { motion.unwrap_or(word) };
        let font = fitting_style(ui, words, &TextStyle::Small, STATE);
        ui.add(Label::new(RichText::new(words).font(font)).truncate()).on_hover_text(words);
    });
}

/// Draws the rate; a device that sends nothing has none.
fn rate_ui(ui: &mut Ui, health: &Health) {
    let figures = figures(health);
    cell(ui, RATE, |ui| {
        let words = match health.standing {
            // Zero until the first interval has been counted.
            ConnectionState::Connected if health.rate_hz > 0.0 => format!("{:.0}", health.rate_hz),
            _ => "\u{2013}".to_owned(),
        };
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let rate = ui.label(weak(words));
            rate.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &figures));
            rate.on_hover_text(&figures);
        });
    });
}

fn trouble_ui(ui: &mut Ui, entry: &RosterEntry, trouble: &DeviceError) {
    ui.add(Label::new(quoted(trouble)).wrap());
    ui.add(Label::new(small(trouble.cure())).wrap());
    if let (DeviceError::DeviceFault { .. }, Some(clear)) = (trouble, &entry.clear_faults) {
        let button = ui.add(Button::new(small(text::devices::CLEAR_FAULTS)).min_size(vec2(84.0, 22.0)));
        button.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::Button, true, text::devices::clear_faults_of(&role_name(entry.role)))
        });
        if button.on_hover_text(text::devices::CLEAR_FAULTS_HOVER).clicked() {
            clear.command();
        }
    }
}

/// Draws a small button of one device, named after it, of a width that is the same in every row.
fn button_ui(ui: &mut Ui, entry: &RosterEntry, width: f32, [words, hover]: [&str; 2], enabled: bool) -> bool {
    let font = fitting_style(ui, words, &TextStyle::Small, width - 8.0);
    let button = ui.add_enabled(enabled, Button::new(RichText::new(words).font(font)).min_size(vec2(width, 22.0)));
    button.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::Button, enabled, text::devices::of(words, &role_name(entry.role)))
    });
    button.on_hover_text(hover).on_disabled_hover_text(text::devices::TEST_RUNS).clicked()
}

fn buttons_ui(ui: &mut Ui, live: &LiveState, state: &mut DevicesState, place: usize) {
    let entry = &live.roster[place];
    let Some(health) = live.healths.devices.get(place) else { return };
    let [test, choose, connect, copy] = BUTTONS;
    ui.spacing_mut().item_spacing.x = 4.0;
    ui.spacing_mut().button_padding.x = 4.0;
    if let Some(part) = entry.part {
        let words = [text::devices::TEST.get(), text::devices::TEST_HOVER.get()];
        if button_ui(ui, entry, test, words, !state.is_testing()) {
            state.begin_test(vec![place], live);
        }
        let words = [text::devices::CHOOSE.get(), text::devices::CHOOSE_HOVER.get()];
        if button_ui(ui, entry, choose, words, true) {
            choosing::toggle(state, part);
        }
    } else {
        ui.add_space(test + choose + 8.0);
    }
    let wanted = health.standing != ConnectionState::Closed;
    let words = if wanted { text::devices::DISCONNECT.get() } else { text::devices::CONNECT.get() };
    if button_ui(ui, entry, connect, [words, text::devices::CONNECT_HOVER.get()], true) {
        entry.view.want(!wanted);
    }
    let words = [text::devices::COPY.get(), text::devices::COPY_HOVER.get()];
    if button_ui(ui, entry, copy, words, true) {
        ui.ctx().copy_text(details(entry, health));
    }
}

/// Returns everything that a person who helps from afar needs to know, one fact a line.
fn details(entry: &RosterEntry, health: &Health) -> String {
    let head = [role_name(entry.role), address_text(entry), state_word(health.standing).to_owned(), figures(health)];
    let trouble = entry.view.report().trouble;
    let trouble = trouble.into_iter().flat_map(|trouble| [trouble.to_string(), trouble.cure()]);
    head.into_iter().chain(trouble).collect::<Vec<_>>().join("\n")
}

/// Returns the order of urgency: broken devices first.
pub(super) const fn urgency(standing: ConnectionState) -> u8 {
    match standing {
        ConnectionState::Lost(_) => 0,
        ConnectionState::Opening => 1,
        ConnectionState::Closed => 2,
        ConnectionState::Connected => 3,
    }
}

fn sign_of(standing: ConnectionState) -> (Sign, Color32) {
    match standing {
        ConnectionState::Connected => (Sign::Disc, theme::now().engaged),
        ConnectionState::Opening => (Sign::Ring, theme::now().text),
        ConnectionState::Closed => (Sign::Ring, theme::now().text_weak),
        ConnectionState::Lost(_) => (Sign::Triangle, theme::now().alarm_medium),
    }
}

fn state_word(standing: ConnectionState) -> &'static str {
    match standing {
        ConnectionState::Connected => text::devices::CONNECTED.get(),
        ConnectionState::Opening => text::devices::OPENING.get(),
        ConnectionState::Closed => text::devices::DISCONNECTED.get(),
        ConnectionState::Lost(_) => text::devices::LOST.get(),
    }
}

/// Returns the text for the rate, the losses and the outages, with the cause of a loss.
fn figures(health: &Health) -> String {
    let Health { rate_hz, lost, damaged, refused, outages, longest_outage_s, .. } = *health;
    let delivery = text::devices::delivery(rate_hz, lost, damaged, refused);
    let words = if outages > 0 { delivery + &text::devices::outages(outages, longest_outage_s) } else { delivery };
    match health.standing {
        ConnectionState::Connected => words,
        ConnectionState::Opening => text::devices::OPENING.get().to_owned(),
        ConnectionState::Closed => text::devices::DISCONNECTED.get().to_owned(),
        ConnectionState::Lost(loss) => text::devices::lost(loss_text(loss), &words),
    }
}
