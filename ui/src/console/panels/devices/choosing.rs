//! Another device for a part: devices of other parts of the rig, and found devices.

use egui::{Button, Label, TextEdit, Ui, vec2};
use nima_devices::discovery::Plugged;
use nima_machine::{
    config::Chosen,
    rig::{Offer, Part, Sought, seek},
};

use super::{Change, DevicesState, row::identity_words};
use crate::console::{live::Live, start::Looked, text, widgets::small};

/// Choice below a part.
#[derive(Debug)]
pub(super) struct Chooser {
    part: Part,
    place: String,
    sought: Looked<Vec<Sought>>,
}

/// Opens or closes the choice of this part.
pub(super) fn toggle(state: &mut DevicesState, part: Part) {
    let is_open = state.chooser.as_ref().is_some_and(|chooser| chooser.part == part);
    state.chooser = (!is_open).then(|| Chooser { part, place: String::new(), sought: Looked::default() });
}

/// Draws the choice if it is open at this part; returns the requested change.
pub(super) fn chooser_ui(
    ui: &mut Ui,
    live: &Live,
    state: &mut DevicesState,
    part: Part,
    refused: Option<&str>,
) -> Option<Change> {
    let chooser = state.chooser.as_mut().filter(|chooser| chooser.part == part)?;
    let mut chosen = None;
    ui.indent(part.key(), |ui| {
        chosen = others_ui(ui, live, part, refused);
        if live.rig.devices.as_ref().is_some_and(|devices| devices.emulated) {
            ui.add(Label::new(small(text::devices::EMULATED.get())).wrap());
            return;
        }
        look_ui(ui, live, chooser);
        for sought in chooser.sought.found().into_iter().flatten() {
            match &sought.found {
                Ok(offer) => {
                    let words = text::devices::found(&words_of(offer), &offer.place);
                    if candidate_ui(ui, &words, refused) {
                        chosen = Some(Chosen::Found(offer.clone()));
                    }
                }
                Err(trouble) => {
                    let words = text::devices::not_there(&sought.place, &trouble.to_string());
                    ui.add(Label::new(small(words)).wrap());
                }
            }
        }
        if chooser.sought.found().is_some_and(Vec::is_empty) {
            ui.label(small(text::devices::NOTHING_FOUND.get()));
        }
    });
    chosen.map(|chosen| Change::Choose(part, chosen))
}

/// The devices of other parts of this kind, to swap with this one.
fn others_ui(ui: &mut Ui, live: &Live, part: Part, refused: Option<&str>) -> Option<Chosen> {
    let mut chosen = None;
    let mut any = false;
    for entry in &live.roster {
        let Some(other) = entry.part.filter(|other| *other != part && other.kind() == part.kind()) else { continue };
        any = true;
        let identity = entry.view.report().identity.as_ref().and_then(identity_words);
        let identity = identity.as_deref().unwrap_or(text::devices::UNKNOWN_IDENTITY.get());
        if candidate_ui(ui, &text::devices::candidate(identity, other), refused) {
            chosen = Some(Chosen::Of(other));
        }
    }
    if !any {
        ui.label(small(text::devices::NO_OTHER.get()));
    }
    chosen
}

fn candidate_ui(ui: &mut Ui, words: &str, refused: Option<&str>) -> bool {
    let button = Button::new(words).wrap().min_size(vec2(ui.available_width(), 26.0));
    let button = ui.add_enabled(refused.is_none(), button).on_hover_text(text::devices::EXCHANGE_HOVER.get());
    button.on_disabled_hover_text(refused.unwrap_or_default()).clicked()
}

fn words_of(offer: &Offer) -> String {
    identity_words(&offer.identity).unwrap_or_else(|| text::devices::UNKNOWN_IDENTITY.get().to_owned())
}

fn look_ui(ui: &mut Ui, live: &Live, chooser: &mut Chooser) {
    let Chooser { part, place, sought } = chooser;
    ui.horizontal(|ui| {
        let looking = sought.is_running();
        let words = if looking { text::devices::LOOKING.get() } else { text::devices::LOOK.get() };
        let button = ui.add_enabled(!looking, Button::new(small(words)).min_size(vec2(110.0, 24.0)));
        let field =
            TextEdit::singleline(place).hint_text(text::devices::PLACE.get()).desired_width(ui.available_width());
        let field = ui.add(field).on_hover_text(text::devices::PLACE_HOVER.get());
        field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, text::devices::PLACE.get()));
        if button.on_hover_text(text::devices::LOOK_HOVER.get()).clicked()
            && let Some(devices) = live.rig.devices.clone()
        {
            let part = *part;
            let place = place.clone();
            sought.forget();
            sought.begin(ui.ctx(), move || seek(part, &devices, &Plugged::list(), &place));
        }
    });
}
