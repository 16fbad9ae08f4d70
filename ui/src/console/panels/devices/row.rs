//! One device: its light, its state, its buttons, and the area opened below it.

use egui::{Button, Color32, Label, RichText, Sense, Ui, Vec2, vec2};
use nima_devices::{ConnectionState, DeviceError, DeviceIdentity, Health};
use nima_machine::rig::RosterEntry;

use super::{DevicesState, RigEdit, choosing, report::report_ui};
use crate::console::{
    live::LiveState,
    text, theme,
    widgets::{Sign, sign, sign_ui, small},
};
use crate::report_text::{loss_text, quoted, role_name};

const BUTTON: Vec2 = vec2(62.0, 22.0);
/// Radius of the light.
const LIGHT: f32 = 8.0;

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
    let (what, colour, words) = standing_text(health);
    ui.horizontal(|ui| {
        sign_ui(ui, what, 5.0, colour);
        ui.label(RichText::new(role_name(entry.role)).font(theme::strong(14.0))).on_hover_text(&entry.driver);
        light_ui(ui, live, entry, place);
    });
    ui.add(Label::new(small(words)).wrap());
    let report = entry.view.report();
    if let Some(words) = report.identity.as_ref().and_then(identity_text) {
        ui.add(Label::new(small(words)).wrap());
    }
    if let Some(trouble) = report.trouble {
        trouble_ui(ui, entry, &trouble);
    }
    buttons_ui(ui, live, state, place);
    if let Some(checkup) = state.result(place) {
        report_ui(ui, checkup);
    }
    let change = entry.part.and_then(|part| choosing::chooser_ui(ui, live, state, part, refused));
    ui.add_space(8.0);
    change
}

/// Returns the name and serial number; `None` if the device reports neither.
pub(super) fn identity_text(identity: &DeviceIdentity) -> Option<String> {
    let DeviceIdentity { product, serial, firmware } = identity;
    (!product.is_empty()).then(|| text::devices::identity(product, serial, firmware))
}

/// Draws the light that shows which device is being moved.
fn light_ui(ui: &mut Ui, live: &LiveState, entry: &RosterEntry, place: usize) {
    let Some(part) = entry.part else { return };
    let motion = live.activity.lit(place).map(|channel| text::devices::motion(part.kind(), channel));
    let (rect, light) = ui.allocate_exact_size(Vec2::splat(LIGHT * 2.4), Sense::hover());
    let name = text::devices::light(&role_name(entry.role), motion.as_deref());
    light.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &name));
    light.on_hover_text(text::devices::LIGHT_HOVER.get());
    let palette = theme::now();
    match &motion {
        Some(motion) => {
            ui.painter().circle_filled(rect.center(), LIGHT * 1.2, palette.text.gamma_multiply(0.25));
            sign(ui.painter(), Sign::Disc, rect.center(), LIGHT * 0.8, palette.text);
            ui.label(RichText::new(motion).font(theme::strong(13.0)).color(palette.text));
        }
        None => sign(ui.painter(), Sign::Ring, rect.center(), LIGHT * 0.8, palette.text_weak),
    }
}

fn trouble_ui(ui: &mut Ui, entry: &RosterEntry, trouble: &DeviceError) {
    ui.add(Label::new(quoted(trouble)).wrap());
    ui.add(Label::new(small(trouble.cure())).wrap());
    if let (DeviceError::DeviceFault { .. }, Some(clear)) = (trouble, &entry.clear_faults) {
        let button = ui.add(Button::new(small(text::devices::CLEAR_FAULTS.get())).min_size(vec2(84.0, 22.0)));
        button.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::Button, true, text::devices::clear_faults_of(&role_name(entry.role)))
        });
        if button.on_hover_text(text::devices::CLEAR_FAULTS_HOVER.get()).clicked() {
            clear.command();
        }
    }
}

/// Draws a small button of one device, named after it.
fn button_ui(ui: &mut Ui, entry: &RosterEntry, words: &str, hover: &str, enabled: bool) -> bool {
    let button = ui.add_enabled(enabled, Button::new(small(words)).min_size(BUTTON));
    button.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::Button, enabled, text::devices::of(words, &role_name(entry.role)))
    });
    button.on_hover_text(hover).clicked()
}

fn buttons_ui(ui: &mut Ui, live: &LiveState, state: &mut DevicesState, place: usize) {
    let entry = &live.roster[place];
    let wanted = live.healths.devices.get(place).is_some_and(|health| health.standing != ConnectionState::Closed);
    ui.horizontal_wrapped(|ui| {
        if let Some(part) = entry.part {
            if button_ui(ui, entry, text::devices::TEST.get(), text::devices::TEST_HOVER.get(), !state.is_testing()) {
                state.begin_test(vec![place], live);
            }
            if button_ui(ui, entry, text::devices::CHOOSE.get(), text::devices::CHOOSE_HOVER.get(), true) {
                choosing::toggle(state, part);
            }
        }
        let words = if wanted { text::devices::DISCONNECT.get() } else { text::devices::CONNECT.get() };
        if button_ui(ui, entry, words, text::devices::CONNECT_HOVER.get(), true) {
            entry.view.want(!wanted);
        }
        if state.is_tested(place) {
            ui.label(small(text::devices::TESTING.get()));
        }
    });
}

fn standing_text(health: &Health) -> (Sign, Color32, String) {
    let figures = || {
        let Health { rate_hz, lost, damaged, refused, outages, longest_outage_s, .. } = *health;
        let delivery = text::devices::delivery(rate_hz, lost, damaged, refused);
        if outages > 0 { delivery + &text::devices::outages(outages, longest_outage_s) } else { delivery }
    };
    match health.standing {
        ConnectionState::Connected => (Sign::Disc, theme::now().engaged, figures()),
        ConnectionState::Opening => (Sign::Ring, theme::now().text, text::devices::OPENING.get().to_owned()),
        ConnectionState::Closed => (Sign::Ring, theme::now().text_weak, text::devices::DISCONNECTED.get().to_owned()),
        ConnectionState::Lost(loss) => {
            (Sign::Triangle, theme::now().alarm_medium, text::devices::lost(loss_text(loss), &figures()))
        }
    }
}
