//! The View menu: appearance of the console, saved between sessions.

use crate::console::text;
use egui::{Button, Context, DragValue, Slider, Ui, vec2};

use super::{
    alarms::strip::Alarms,
    desk::{Layout, Panel},
    help::Help,
    roles::Role,
    settings::{CROP_MOST_PERCENT, PictureSettings, SCALES, Settings},
};

/// Size that every view needs, in points; a larger scale than the window has space for is not used.
const NEEDED: egui::Vec2 = vec2(1100.0, 680.0);
const STEPS_PERCENT: [u16; 5] = [100, 125, 150, 175, 200];

/// The menu in the top bar. Returns true when the operator marks this moment.
pub(super) fn menu_ui(ui: &mut Ui, settings: &mut Settings, help: &mut Help, alarms: &mut Alarms) -> bool {
    let mut marks = false;
    let button = Button::new(text::menu::VIEW).min_size(vec2(52.0, 30.0));
    let menu = egui::containers::menu::MenuButton::from_button(button);
    let (response, _) = menu.ui(ui, |ui| {
        ui.set_width(300.0);
        ui.label(text::menu::PALETTE);
        ui.horizontal(|ui| {
            for (name, light) in [(text::menu::DARK, false), (text::menu::LIGHT, true)] {
                let button = Button::selectable(settings.light == light, name).frame_when_inactive(true);
                if ui.add(button.min_size(vec2(96.0, 30.0))).clicked() {
                    settings.light = light;
                }
            }
        });
        ui.add_space(6.0);
        ui.label(text::menu::SIZE);
        ui.horizontal(|ui| {
            for percent in STEPS_PERCENT {
                let chosen = settings.scale_percent == percent;
                if ui.add(Button::selectable(chosen, format!("{percent} %")).frame_when_inactive(true)).clicked() {
                    settings.scale_percent = percent;
                }
            }
        });
        ui.label(super::widgets::small(text::menu::SIZE_NOTE));
        ui.add_space(6.0);
        if settings.role == Role::Technician {
            panels_ui(ui, &mut settings.layout);
            ui.add_space(6.0);
        }
        sound_ui(ui, settings, alarms);
        ui.add_space(6.0);
        picture_ui(ui, settings);
        ui.add_space(6.0);
        ui.horizontal(|ui| {
            if ui.add(Button::new(text::menu::ALARMS).min_size(vec2(96.0, 30.0))).clicked() {
                alarms.list = true;
            }
            if ui.add(Button::new(text::menu::GLOSSARY).min_size(vec2(110.0, 30.0))).clicked() {
                help.glossary = true;
            }
            if ui.add(Button::new(text::menu::TOUR).min_size(vec2(82.0, 30.0))).clicked() {
                help.begin_tour();
            }
        });
        let mark = ui.add(Button::new(text::menu::MARK).min_size(vec2(300.0, 30.0)));
        marks = mark.on_hover_text(text::menu::MARK_HOVER).clicked();
    });
    response.on_hover_text(text::menu::VIEW_HOVER);
    marks
}

/// Switch for alarm sounds, and why they cannot be played.
fn sound_ui(ui: &mut Ui, settings: &mut Settings, alarms: &mut Alarms) {
    let meaning = text::menu::SOUND_HOVER;
    ui.checkbox(&mut settings.sound, text::menu::SOUND).on_hover_text(meaning);
    if let Some(trouble) = alarms.sound.trouble() {
        ui.add(egui::Label::new(super::widgets::small(trouble)).wrap());
    }
}

/// How the endoscope's picture is shown, and whether it is recorded.
fn picture_ui(ui: &mut Ui, settings: &mut Settings) {
    ui.label(text::menu::PICTURE);
    let picture = &mut settings.picture;
    ui.add(Slider::new(&mut picture.brightness_percent, -50..=50).text(text::menu::BRIGHTNESS).suffix(" %"));
    ui.add(
        Slider::new(&mut picture.contrast_percent, 25..=400).logarithmic(true).text(text::menu::CONTRAST).suffix(" %"),
    );
    ui.add(Slider::new(&mut picture.gamma_percent, 25..=400).logarithmic(true).text(text::menu::GAMMA).suffix(" %"));
    ui.horizontal(|ui| {
        ui.label(text::menu::CROP).on_hover_text(text::menu::CROP_HOVER);
        for (percent, edge) in picture.crop_percent.iter_mut().zip(text::menu::EDGES) {
            let value = DragValue::new(percent).range(0..=CROP_MOST_PERCENT).suffix(" %");
            let response = ui.add(value).on_hover_text(edge);
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::SpinButton, true, edge));
        }
    });
    ui.checkbox(&mut picture.forces_of_now, text::menu::FORCES_OF_NOW).on_hover_text(text::menu::FORCES_OF_NOW_HOVER);
    let plain = PictureSettings { forces_of_now: picture.forces_of_now, ..PictureSettings::default() };
    if ui.add_enabled(*picture != plain, Button::new(text::menu::PICTURE_PLAIN).min_size(vec2(300.0, 26.0))).clicked() {
        *picture = plain;
    }
    let records = ui.checkbox(&mut settings.records_picture, text::menu::RECORDS_PICTURE);
    records.on_hover_text(text::menu::RECORDS_PICTURE_HOVER);
}

/// Switches for the panels on the desk.
fn panels_ui(ui: &mut Ui, layout: &mut Layout) {
    ui.label(text::menu::PANELS).on_hover_text(text::menu::PANELS_HOVER);
    for pair in Panel::ALL.chunks(2) {
        ui.horizontal(|ui| {
            for panel in pair {
                let open = layout.is_open(*panel);
                let button = Button::selectable(open, panel.title()).frame_when_inactive(true);
                let response = ui.add(button.min_size(vec2(146.0, 26.0)));
                let meaning = if open { text::menu::PANEL_OPEN_HOVER } else { text::menu::PANEL_CLOSED_HOVER };
                if response.on_hover_text(format!("{}\n{meaning}", panel.meaning())).clicked() {
                    layout.toggle(*panel);
                }
            }
        });
    }
    let reset = ui.add(Button::new(text::menu::RESET_LAYOUT).min_size(vec2(300.0, 26.0)));
    if reset.on_hover_text(text::menu::RESET_LAYOUT_HOVER).clicked() {
        *layout = Layout::default();
    }
}

/// Applies the settings; call at the start of a frame.
pub(super) fn apply(ctx: &Context, settings: &mut Settings) {
    super::theme::choose(ctx, settings.light);
    ctx.options_mut(|options| options.zoom_with_keyboard = false);
    let step = ctx.input_mut(|input| {
        let more = input.consume_shortcut(&egui::gui_zoom::kb_shortcuts::ZOOM_IN)
            || input.consume_shortcut(&egui::gui_zoom::kb_shortcuts::ZOOM_IN_SECONDARY);
        let less = input.consume_shortcut(&egui::gui_zoom::kb_shortcuts::ZOOM_OUT);
        i32::from(more) - i32::from(less)
    });
    let wanted = i32::from(settings.scale_percent) + 25 * step;
    settings.scale_percent =
        wanted.clamp(i32::from(*SCALES.start()), i32::from(*SCALES.end())).unsigned_abs().try_into().unwrap_or(100);
    let window = ctx.content_rect().size() * ctx.zoom_factor();
    let room = (window / NEEDED).min_elem().max(1.0);
    let factor = (f32::from(settings.scale_percent) / 100.0).min(room);
    if (factor - ctx.zoom_factor()).abs() > 1e-3 {
        ctx.set_zoom_factor(factor);
    }
}
