//! Another device for a part: devices of other parts of the rig, and found devices.

use egui::{Button, Label, TextEdit, Ui, vec2};
use nima_devices::discovery::PluggedDevices;
use nima_machine::{
    config::ChosenDevice,
    rig::{DeviceOffer, RigPart, SearchResult, seek},
};
use nima_screen::{background::BackgroundQuery, live::LiveState, widgets::small};
use nima_words::text;

use super::{DevicesState, RigEdit, row::identity_text};

/// Choice below a part.
#[derive(Debug)]
pub(super) struct Chooser {
    part: RigPart,
    place: String,
    sought: BackgroundQuery<Vec<SearchResult>>,
}

/// Opens or closes the choice of this part.
pub(super) fn toggle(state: &mut DevicesState, part: RigPart) {
    let is_open = state.chooser.as_ref().is_some_and(|chooser| chooser.part == part);
    state.chooser = (!is_open).then(|| Chooser { part, place: String::new(), sought: BackgroundQuery::default() });
}

/// Draws the choice if it is open at this part; returns the requested change.
pub(super) fn chooser_ui(
    ui: &mut Ui,
    live: &LiveState,
    state: &mut DevicesState,
    part: RigPart,
    refused: Option<&str>,
) -> Option<RigEdit> {
    let chooser = state.chooser.as_mut().filter(|chooser| chooser.part == part)?;
    let mut chosen = None;
    ui.indent(part.key(), |ui| {
        chosen = others_ui(ui, live, part, refused);
        if live.rig.devices.as_ref().is_some_and(|devices| devices.emulated) {
            ui.add(Label::new(small(text::devices::EMULATED)).wrap());
            return;
        }
        look_ui(ui, live, chooser);
        for sought in chooser.sought.found().into_iter().flatten() {
            match &sought.found {
                Ok(offer) => {
                    let words = text::devices::found(&words_of(offer), &offer.place);
                    if candidate_ui(ui, &words, refused) {
                        chosen = Some(ChosenDevice::Found(offer.clone()));
                    }
                }
                Err(trouble) => {
                    let words = text::devices::not_there(&sought.place, &nima_words::report_text::quoted(trouble));
                    ui.add(Label::new(small(words)).wrap());
                }
            }
        }
        if chooser.sought.found().is_some_and(Vec::is_empty) {
            ui.label(small(text::devices::NOTHING_FOUND));
        }
    });
    chosen.map(|chosen| RigEdit::Choose(part, chosen))
}

/// Draws the devices of other parts of this kind, to swap with this one.
fn others_ui(ui: &mut Ui, live: &LiveState, part: RigPart, refused: Option<&str>) -> Option<ChosenDevice> {
    let mut chosen = None;
    let mut any = false;
    for entry in &live.roster {
        let Some(other) = entry.part.filter(|other| *other != part && other.kind() == part.kind()) else { continue };
        any = true;
        let identity = entry.view.report().identity.as_ref().and_then(identity_text);
        let identity = identity.as_deref().unwrap_or(text::devices::UNKNOWN_IDENTITY.get());
        if candidate_ui(ui, &text::devices::candidate(identity, other), refused) {
            chosen = Some(ChosenDevice::Of(other));
        }
    }
    if !any {
        ui.label(small(text::devices::NO_OTHER));
    }
    chosen
}

fn candidate_ui(ui: &mut Ui, words: &str, refused: Option<&str>) -> bool {
    let button = Button::new(words).wrap().min_size(vec2(ui.available_width(), 26.0));
    let button = ui.add_enabled(refused.is_none(), button).on_hover_text(text::devices::EXCHANGE_HOVER);
    button.on_disabled_hover_text(refused.unwrap_or_default()).clicked()
}

fn words_of(offer: &DeviceOffer) -> String {
    identity_text(&offer.identity).unwrap_or_else(|| text::devices::UNKNOWN_IDENTITY.get().to_owned())
}

fn look_ui(ui: &mut Ui, live: &LiveState, chooser: &mut Chooser) {
    let Chooser { part, place, sought } = chooser;
    ui.horizontal(|ui| {
        let looking = sought.is_running();
        let words = if looking { text::devices::LOOKING.get() } else { text::devices::LOOK.get() };
        let button = ui.add_enabled(!looking, Button::new(small(words)).min_size(vec2(110.0, 24.0)));
        let field = TextEdit::singleline(place).hint_text(text::devices::PLACE).desired_width(ui.available_width());
        let field = ui.add(field).on_hover_text(text::devices::PLACE_HOVER);
        field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, text::devices::PLACE.get()));
        let button = button.on_hover_text(text::devices::LOOK_HOVER);
        if button.on_disabled_hover_text(text::devices::LOOKS_NOW).clicked()
            && let Some(devices) = live.rig.devices.clone()
        {
            let part = *part;
            let place = place.clone();
            sought.forget();
            sought.begin(ui.ctx(), move || seek(part, &devices, &PluggedDevices::list(), &place));
        }
    });
}
