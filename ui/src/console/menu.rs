//! The View menu: appearance of the console, saved between sessions.

use egui::{
    Button, Context, DragValue, Id, PopupCloseBehavior, RichText, ScrollArea, Slider, TextEdit, TextStyle, Ui,
    WidgetInfo,
    containers::menu::{MenuButton, MenuConfig},
    vec2,
};
use nima_panels::{
    roles::Role,
    settings::{CROP_MAX_PERCENT, ConsoleSettings, ImageSettings},
    tiles::{Arrangement, PanelId, PanelLayout},
};
use nima_screen::{
    alarms::strip::Alarms,
    widgets::{fitting_style, with_icon},
};
use nima_words::{
    language::{Language, Text},
    text,
};

use egui_material_icons::icons;

use crate::console::commands::{Action, CommandEntry, SIZES_PERCENT};

/// Size that every view needs, in points; a scale without room for it is not used.
const NEEDED: egui::Vec2 = vec2(1100.0, 680.0);

/// Minimum size of a button next to its name: the menu must fit into the smallest window.
const CHOICE: egui::Vec2 = vec2(84.0, 24.0);

/// Draws the menu in the top bar; returns the chosen command. `can_undo`: whether undo and redo are possible.
pub(super) fn menu_ui(
    ui: &mut Ui,
    settings: &mut ConsoleSettings,
    alarms: &mut Alarms,
    can_undo: [bool; 2],
) -> Option<Action> {
    let mut wanted = None;
    let font = TextStyle::Button.resolve(ui.style());
    let words = with_icon(ui, icons::ICON_DASHBOARD_CUSTOMIZE, text::menu::VIEW.get(), font);
    let button = Button::new(words).min_size(vec2(52.0, 30.0));
    // A click into the name of a layout must not close the menu; a command closes it.
    let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let menu = MenuButton::from_button(button).config(config);
    // A small window has no room for the whole menu, which must leave the bar free.
    let height = ui.ctx().content_rect().height() - 80.0;
    let (response, _) = menu.ui(ui, |ui| {
        // Without a minimum, a menu shows less than the window has room for.
        ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
            wanted = content_ui(ui, settings, alarms, can_undo);
        });
        if wanted.is_some() {
            ui.close();
        }
    });
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, text::menu::VIEW.get()));
    response.on_hover_text(text::menu::VIEW_HOVER);
    wanted
}

fn content_ui(ui: &mut Ui, settings: &mut ConsoleSettings, alarms: &mut Alarms, can_undo: [bool; 2]) -> Option<Action> {
    let mut wanted = None;
    ui.set_width(300.0);
    ui.horizontal(|ui| {
        ui.label(text::menu::PALETTE);
        for (name, light) in [(text::menu::DARK.get(), false), (text::menu::LIGHT.get(), true)] {
            let button = Button::selectable(settings.light == light, name).frame_when_inactive(true);
            if ui.add(button.min_size(CHOICE)).clicked() {
                wanted = Some(Action::Light(light));
            }
        }
    });
    wanted = wanted.or(switch_ui(ui, settings.colour_blind, Action::ColourBlind));
    wanted = wanted.or(languages_ui(ui, settings.language));
    ui.add_space(4.0);
    ui.label(text::menu::SIZE);
    ui.horizontal(|ui| {
        for percent in SIZES_PERCENT {
            let chosen = settings.scale_percent == percent;
            if ui.add(Button::selectable(chosen, format!("{percent} %")).frame_when_inactive(true)).clicked() {
                wanted = Some(Action::Size(percent));
            }
        }
    });
    ui.label(nima_screen::widgets::small(text::menu::SIZE_NOTE.get()));
    wanted = wanted.or(switch_ui(ui, settings.touch, Action::Touch));
    ui.add_space(6.0);
    if settings.role == Role::Technician {
        wanted = wanted.or(layouts_ui(ui, settings));
        wanted = wanted.or(panels_ui(ui, &settings.layout));
        ui.add_space(6.0);
    }
    wanted = wanted.or(sound_ui(ui, settings.sound, alarms));
    ui.add_space(6.0);
    wanted = wanted.or(image_ui(ui, settings));
    ui.add_space(6.0);
    ui.horizontal(|ui| {
        for action in [Action::Alarms, Action::Glossary, Action::Tour] {
            wanted = wanted.or(entry_ui(ui, action, 0.0));
        }
    });
    wanted = wanted.or(entry_ui(ui, Action::Palette, 300.0));
    ui.horizontal(|ui| {
        let nothing = [text::commands::NOTHING_TO_UNDO, text::commands::NOTHING_TO_REDO];
        for ((action, why), can) in [Action::Undo, Action::Redo].into_iter().zip(nothing).zip(can_undo) {
            wanted = wanted.or(entry_unless_ui(ui, action, 0.0, (!can).then_some(why)));
        }
    });
    wanted = wanted.or(entry_ui(ui, Action::Mark, 300.0));
    wanted
}

/// Draws a command with its keys, on a button of at least this width; returns the command when pressed.
fn entry_ui(ui: &mut Ui, action: Action, width: f32) -> Option<Action> {
    entry_unless_ui(ui, action, width, None)
}

/// Like [`entry_ui`], disabled for this reason if there is one.
fn entry_unless_ui(ui: &mut Ui, action: Action, width: f32, closed: Option<Text>) -> Option<Action> {
    let entry = CommandEntry::of(action)?;
    let button = Button::new(entry.with_keys()).min_size(vec2(width, 30.0));
    let button = ui.add_enabled(closed.is_none(), button).on_hover_text(entry.does);
    button.on_disabled_hover_text(closed.map_or("", Text::get)).clicked().then_some(action)
}

/// Draws the languages by their own names; returns the command of the pressed one.
fn languages_ui(ui: &mut Ui, now: Language) -> Option<Action> {
    let mut wanted = None;
    ui.horizontal(|ui| {
        ui.label(text::menu::LANGUAGE).on_hover_text(text::commands::LANGUAGE_DOES);
        for language in Language::CHOICES {
            let button = Button::selectable(now == language, language.name()).frame_when_inactive(true);
            if ui.add(button.min_size(CHOICE)).clicked() {
                wanted = Some(Action::Language(language));
            }
        }
    });
    wanted
}

/// Draws a switch in its current state; returns its command when pressed.
fn switch_ui(ui: &mut Ui, mut on: bool, action: Action) -> Option<Action> {
    let entry = CommandEntry::of(action)?;
    ui.checkbox(&mut on, entry.title.as_str()).on_hover_text(entry.does).changed().then_some(action)
}

/// Draws the switch for alarm sounds, and the reason if they cannot be played.
fn sound_ui(ui: &mut Ui, on: bool, alarms: &mut Alarms) -> Option<Action> {
    let wanted = switch_ui(ui, on, Action::Sound);
    if let Some(trouble) = alarms.sound.trouble() {
        ui.add(egui::Label::new(nima_screen::widgets::small(trouble)).wrap());
    }
    wanted
}

/// Draws the display settings of the endoscope image, and whether it is recorded.
fn image_ui(ui: &mut Ui, settings: &mut ConsoleSettings) -> Option<Action> {
    ui.label(text::menu::IMAGE);
    let image = &mut settings.image;
    ui.add(Slider::new(&mut image.brightness_percent, -50..=50).text(text::menu::BRIGHTNESS.get()).suffix(" %"));
    ui.add(
        Slider::new(&mut image.contrast_percent, 25..=400)
            .logarithmic(true)
            .text(text::menu::CONTRAST.get())
            .suffix(" %"),
    );
    ui.add(
        Slider::new(&mut image.gamma_percent, 25..=400).logarithmic(true).text(text::menu::GAMMA.get()).suffix(" %"),
    );
    ui.horizontal(|ui| {
        ui.label(text::menu::CROP).on_hover_text(text::menu::CROP_HOVER);
        for (percent, edge) in image.crop_percent.iter_mut().zip(text::menu::EDGES.map(Text::get)) {
            let value = DragValue::new(percent).range(0..=CROP_MAX_PERCENT).suffix(" %");
            let response = ui.add(value).on_hover_text(edge);
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::SpinButton, true, edge));
        }
    });
    let forces = switch_ui(ui, image.forces_of_now, Action::ForcesOfNow);
    let plain = ImageSettings { forces_of_now: image.forces_of_now, ..ImageSettings::default() };
    let is_plain = *image == plain;
    let plain = entry_unless_ui(ui, Action::PlainPicture, 300.0, is_plain.then_some(text::commands::IS_PLAIN));
    forces.or(plain).or(switch_ui(ui, settings.records_image, Action::RecordsPicture))
}

/// Draws the built-in layouts and the user's own ones; returns the command of the pressed one.
fn layouts_ui(ui: &mut Ui, settings: &mut ConsoleSettings) -> Option<Action> {
    let mut wanted = None;
    ui.label(text::menu::LAYOUT).on_hover_text(text::menu::LAYOUT_HOVER);
    ui.horizontal(|ui| {
        for one in Arrangement::ALL {
            let chosen = settings.layout.looks_like(&PanelLayout::built_in(one));
            let button = Button::selectable(chosen, one.name()).frame_when_inactive(true);
            let response = ui.add(button.min_size(CHOICE));
            // A panel may have the same name.
            let name = text::commands::layout(one.name());
            response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, chosen, name.as_str()));
            if response.on_hover_text(one.meaning()).clicked() {
                wanted = Some(Action::Arrange(one));
            }
        }
    });
    own_layouts_ui(ui, settings);
    save_layout_ui(ui, settings);
    wanted
}

fn own_layouts_ui(ui: &mut Ui, settings: &mut ConsoleSettings) {
    let mut removed = None;
    for saved in &settings.layouts {
        ui.horizontal(|ui| {
            let chosen = settings.layout.looks_like(&saved.layout);
            let button = Button::selectable(chosen, saved.name.as_str()).frame_when_inactive(true).truncate();
            if ui.add(button.min_size(vec2(264.0, 26.0))).clicked() {
                settings.layout = saved.layout.clone();
                ui.close();
            }
            let name = text::menu::remove_layout(&saved.name);
            let remove = ui.add(Button::new("\u{d7}").min_size(vec2(26.0, 26.0)));
            remove.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, name.as_str()));
            if remove.on_hover_text(name.as_str()).clicked() {
                removed = Some(saved.name.clone());
            }
        });
    }
    if let Some(name) = removed {
        settings.layouts.retain(|saved| saved.name != name);
    }
}

/// Draws the name under which the present layout is saved.
fn save_layout_ui(ui: &mut Ui, settings: &mut ConsoleSettings) {
    let id = Id::unique("layout_name");
    let mut name: String = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    ui.horizontal(|ui| {
        let hint = text::menu::LAYOUT_NAME.get();
        let field = ui.add(TextEdit::singleline(&mut name).hint_text(hint).char_limit(40).desired_width(196.0));
        field.widget_info(|| WidgetInfo::labeled(egui::Role::TextInput, true, hint));
        let named = !name.trim().is_empty();
        let save = ui.add_enabled(named, Button::new(text::menu::SAVE_LAYOUT).min_size(vec2(76.0, 26.0)));
        let save = save.on_hover_text(text::menu::SAVE_LAYOUT_HOVER);
        if save.on_disabled_hover_text(text::menu::NAME_LAYOUT_FIRST).clicked() {
            settings.save_layout(name.trim());
            name.clear();
        }
    });
    ui.data_mut(|data| data.insert_temp(id, name));
}

/// Switches for the panels.
fn panels_ui(ui: &mut Ui, layout: &PanelLayout) -> Option<Action> {
    let mut wanted = None;
    ui.label(text::menu::PANELS).on_hover_text(text::menu::PANELS_HOVER);
    for pair in PanelId::built().collect::<Vec<_>>().chunks(2) {
        ui.horizontal(|ui| {
            for panel in pair {
                wanted = wanted.or(panel_ui(ui, layout, *panel));
            }
        });
    }
    wanted.or(entry_ui(ui, Action::ResetLayout, 300.0))
}

/// Draws the switches of a panel: whether it is open, and whether it is in a separate window.
fn panel_ui(ui: &mut Ui, layout: &PanelLayout, panel: PanelId) -> Option<Action> {
    ui.spacing_mut().item_spacing.x = 3.0;
    let open = layout.is_open(panel);
    let size = vec2(118.0, 26.0);
    let font = fitting_style(ui, panel.title(), &TextStyle::Button, size.x - 2.0 * ui.spacing().button_padding.x);
    let name = RichText::new(panel.title()).font(font);
    let response = ui.add_sized(size, Button::selectable(open, name).frame_when_inactive(true));
    let meaning = if open { text::menu::PANEL_OPEN_HOVER.get() } else { text::menu::PANEL_CLOSED_HOVER.get() };
    if response.on_hover_text(format!("{}\n{meaning}", panel.meaning())).clicked() {
        return Some(Action::Panel(panel));
    }
    let in_window = layout.is_window(panel);
    let icon = RichText::new(icons::ICON_OPEN_IN_NEW.codepoint).font(nima_screen::theme::icons(16.0));
    let window = ui.add(Button::selectable(in_window, icon).frame_when_inactive(true).min_size(vec2(26.0, 26.0)));
    let name = text::commands::window(panel.title());
    window.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, in_window, name.as_str()));
    let meaning = format!("{name}\n{}", text::tiles::OPEN_WINDOW_HOVER.get());
    window.on_hover_text(meaning).clicked().then_some(Action::Window(panel))
}

/// Applies the settings; call at the start of a frame.
pub(super) fn apply(ctx: &Context, settings: &ConsoleSettings) {
    nima_screen::theme::choose(ctx, settings.look());
    ctx.options_mut(|options| options.zoom_with_keyboard = false);
    let window = ctx.content_rect().size() * ctx.zoom_factor();
    let room = (window / NEEDED).min_elem().max(1.0);
    let factor = (f32::from(settings.scale_percent) / 100.0).min(room);
    if (factor - ctx.zoom_factor()).abs() > 1e-3 {
        ctx.set_zoom_factor(factor);
    }
}
