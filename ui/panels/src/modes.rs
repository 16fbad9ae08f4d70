//! The list of rendering modes: those for everyone, and below a heading those of research.

use egui::{Align, Button, CollapsingHeader, RichText, Ui, WidgetInfo, text::LayoutJob, vec2};
use nima_core::impedance::Mode;
use nima_machine::messages::Command;
use nima_screen::{live::LiveState, outbox::Outbox, theme, widgets::fitting};
use nima_words::{
    report_text::{EVERYDAY, OF_RESEARCH, mode_line, mode_meaning, mode_name},
    text,
};

/// Height of a mode: its name, and one line of meaning.
const ROW: f32 = 34.0;

pub(super) fn modes_ui(ui: &mut Ui, live: &LiveState, outbox: &mut Outbox) {
    for mode in EVERYDAY {
        mode_ui(ui, live, mode, outbox);
    }
    let is_of_research = !EVERYDAY.contains(&live.mode());
    let heading = RichText::new(text::feedback::RESEARCH_MODES).text_style(egui::TextStyle::Small);
    // The mode in use is never out of sight.
    let list = CollapsingHeader::new(heading).id_salt("research_modes").open(is_of_research.then_some(true));
    let list = list.show(ui, |ui| {
        for mode in OF_RESEARCH {
            mode_ui(ui, live, mode, outbox);
        }
        // A baseline method is computed, and offered, only if the rig file names it.
        if let mode @ Mode::Baseline(_) = live.rig.mode {
            mode_ui(ui, live, mode, outbox);
        }
    });
    list.header_response.on_hover_text(text::feedback::RESEARCH_MODES_HOVER);
}

fn mode_ui(ui: &mut Ui, live: &LiveState, mode: Mode, outbox: &mut Outbox) {
    let chosen = live.mode() == mode;
    let name = mode_name(mode);
    let line = mode_line(mode);
    let width = ui.available_width();
    let room = width - 2.0 * ui.spacing().button_padding.x;
    let mut words = LayoutJob::default();
    let format = |font, color| egui::TextFormat { font_id: font, color, ..Default::default() };
    words.append(name, 0.0, format(theme::strong(14.0), theme::now().text));
    let small = fitting(ui.painter(), line, theme::regular(12.5), room);
    let ink = if chosen { theme::now().text } else { theme::now().text_weak };
    words.append(&format!("\n{line}"), 0.0, format(small, ink));
    words.halign = Align::LEFT;
    let button = Button::selectable(chosen, words).frame_when_inactive(true).min_size(vec2(width, ROW));
    let response = ui.add(button.right_text(""));
    response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, chosen, name));
    if response.on_hover_text(mode_meaning(mode)).clicked() {
        outbox.push(Command::SetMode(mode));
    }
}
