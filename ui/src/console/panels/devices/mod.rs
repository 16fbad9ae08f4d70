//! The devices of the rig: state, rate and losses, and for a failed device the cause and the cure.

use egui::{Button, Label, RichText, Ui, vec2};
use nima_devices::{Health, Standing, Trouble};
use nima_machine::rig::{RosterEntry, Side};

use crate::console::{
    live::Live,
    text, theme,
    widgets::{Sign, sign_ui, small, weak},
};

/// The panel; without devices it says that everything is simulated.
pub fn devices_ui(ui: &mut Ui, live: &Live) {
    if live.roster.is_empty() {
        ui.label(weak(text::devices::NONE));
        return;
    }
    for (entry, health) in live.roster.iter().zip(&live.healths.devices) {
        device_ui(ui, entry, health);
    }
    for (side, obstacle) in Side::ALL.into_iter().zip(&live.healths.obstacles) {
        if let Some(obstacle) = obstacle {
            ui.add(Label::new(text::devices::not_to_be_engaged(side.word(), obstacle)).wrap());
        }
    }
}

fn device_ui(ui: &mut Ui, entry: &RosterEntry, health: &Health) {
    let (what, colour, words) = standing_words(health);
    ui.horizontal(|ui| {
        sign_ui(ui, what, 5.0, colour);
        ui.label(RichText::new(&entry.name).font(theme::strong(14.0))).on_hover_text(&entry.driver);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let wanted = !matches!(health.standing, Standing::Closed);
            let text = if wanted { text::devices::DISCONNECT } else { text::devices::CONNECT };
            let button = ui.add(Button::new(small(text)).min_size(vec2(84.0, 22.0)));
            button.widget_info(|| {
                let name = format!("{text} {}", entry.name);
                egui::WidgetInfo::labeled(egui::Role::Button, true, name)
            });
            if button.on_hover_text(text::devices::CONNECT_HOVER).clicked() {
                entry.view.want(!wanted);
            }
        });
    });
    ui.add(Label::new(small(words)).wrap());
    let report = entry.view.report();
    if let Some(identity) = report.identity.filter(|identity| !identity.product.is_empty()) {
        ui.label(small(text::devices::identity(&identity.product, &identity.serial, &identity.firmware)));
    }
    if let Some(trouble) = report.trouble {
        ui.add(Label::new(trouble.to_string()).wrap());
        ui.add(Label::new(small(trouble.cure())).wrap());
        if let (Trouble::DeviceFault { .. }, Some(clear)) = (&trouble, &entry.clear_faults) {
            let button = ui.add(Button::new(small(text::devices::CLEAR_FAULTS)).min_size(vec2(84.0, 22.0)));
            button.widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::Button, true, text::devices::clear_faults_of(&entry.name))
            });
            if button.on_hover_text(text::devices::CLEAR_FAULTS_HOVER).clicked() {
                clear.command();
            }
        }
    }
    ui.add_space(4.0);
}

fn standing_words(health: &Health) -> (Sign, egui::Color32, String) {
    let figures = || {
        let Health { rate_hz, lost, damaged, refused, outages, longest_outage_s, .. } = *health;
        let delivery = text::devices::delivery(rate_hz, lost, damaged, refused);
        if outages > 0 { delivery + &text::devices::outages(outages, longest_outage_s) } else { delivery }
    };
    match health.standing {
        Standing::Connected => (Sign::Disc, theme::now().engaged, figures()),
        Standing::Opening => (Sign::Ring, theme::now().text, text::devices::OPENING.to_owned()),
        Standing::Closed => (Sign::Ring, theme::now().text_weak, text::devices::DISCONNECTED.to_owned()),
        Standing::Lost(loss) => {
            (Sign::Triangle, theme::now().alarm_medium, text::devices::lost(loss.cause(), &figures()))
        }
    }
}
