//! The one place for colours, type and spacing. Panels name a token, never a colour.
//!
//! Red, yellow and cyan are kept for alarms (IEC 60601-1-8) and mean nothing else. The two forces differ in lightness
//! as much as in hue, so that they stay apart for colour-blind eyes and on a grey print: measured is ivory, rendered blue.

use std::sync::Arc;

use egui::{
    Color32, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, Margin, Stroke, Style, TextStyle, Visuals,
    epaint::Shadow, vec2,
};

/// Behind everything.
pub const BACKGROUND: Color32 = Color32::from_rgb(0x10, 0x13, 0x17);
/// Bars and side panels.
pub const PANEL: Color32 = Color32::from_rgb(0x15, 0x19, 0x1f);
/// A card on a panel.
pub const CARD: Color32 = Color32::from_rgb(0x1c, 0x21, 0x29);
/// Tooltips and menus.
pub const POPUP: Color32 = Color32::from_rgb(0x26, 0x2d, 0x37);
/// A control at rest.
pub const CONTROL: Color32 = Color32::from_rgb(0x2b, 0x33, 0x3e);
/// A control under the pointer.
pub const CONTROL_HOVER: Color32 = Color32::from_rgb(0x37, 0x41, 0x4e);
/// Ground of the 3-D view, far and near.
pub const FIELD_FAR: Color32 = Color32::from_rgb(0x2b, 0x33, 0x3d);
/// See [`FIELD_FAR`].
pub const FIELD_NEAR: Color32 = Color32::from_rgb(0x13, 0x17, 0x1c);
/// A groove: slider rails, empty bars, plot grounds.
pub const GROOVE: Color32 = Color32::from_rgb(0x11, 0x15, 0x1a);
/// Hairlines.
pub const LINE: Color32 = Color32::from_rgb(0x2d, 0x35, 0x40);
/// Text that is read first.
pub const TEXT: Color32 = Color32::from_rgb(0xe6, 0xea, 0xee);
/// Text that explains; 5.5:1 on a card.
pub const TEXT_WEAK: Color32 = Color32::from_rgb(0x9d, 0xa8, 0xb4);
/// The one thing on the screen that must be found without looking: the stop button.
pub const STOP: Color32 = Color32::from_rgb(0xff, 0xff, 0xff);
/// What is selected or set by the operator.
pub const SELECTED: Color32 = Color32::from_rgb(0x3f, 0x5d, 0x86);
/// The force measured at the instrument.
pub const MEASURED: Color32 = Color32::from_rgb(0xf3, 0xe9, 0xd2);
/// The force rendered to the hand.
pub const RENDERED: Color32 = Color32::from_rgb(0x6c, 0x9d, 0xff);
/// What our own figures are compared with (delayed DFR, the paper's choice).
pub const REFERENCE: Color32 = Color32::from_rgb(0x87, 0x91, 0x9d);
/// Lines that stand side by side: axes x, y, z, or the members of an ensemble. They differ in lightness too.
pub const SERIES: [Color32; 4] =
    [MEASURED, RENDERED, Color32::from_rgb(0x63, 0xc2, 0x8c), Color32::from_rgb(0xc0, 0x7a, 0xd8)];
/// The loop runs and feeds force back.
pub const ENGAGED: Color32 = Color32::from_rgb(0x63, 0xc2, 0x8c);
/// The loop is at rest.
pub const AT_REST: Color32 = Color32::from_rgb(0xc3, 0xca, 0xd2);
/// High-priority alarm, flashing.
pub const ALARM_HIGH: Color32 = Color32::from_rgb(0xff, 0x4d, 0x4d);
/// Medium-priority alarm, flashing slowly.
pub const ALARM_MEDIUM: Color32 = Color32::from_rgb(0xff, 0xd7, 0x3d);
/// Low-priority alarm, steady.
pub const ALARM_LOW: Color32 = Color32::from_rgb(0x41, 0xd6, 0xe0);

/// Space between a card's edge and its content.
pub const CARD_PADDING: i8 = 12;
/// Space between cards.
pub const GAP: f32 = 8.0;
/// Height and least width of the stop button; the design asks for 48 at least.
pub const STOP_SIZE: egui::Vec2 = vec2(132.0, 52.0);

/// Corners of cards and controls.
pub const CORNER: CornerRadius = CornerRadius::same(6);

const STRONG: &str = "strong";

/// The heavier cut, for figures and headings.
pub fn strong(size: f32) -> FontId {
    FontId::new(size, FontFamily::Name(STRONG.into()))
}

/// The normal cut.
pub fn regular(size: f32) -> FontId {
    FontId::proportional(size)
}

/// Sets fonts and style of a context, once.
pub fn apply(ctx: &egui::Context) {
    ctx.set_fonts(fonts());
    ctx.set_theme(egui::Theme::Dark);
    ctx.all_styles_mut(set_style);
}

fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::default();
    let regular = FontData::from_static(include_bytes!("../../../assets/fonts/Roboto-Regular.ttf"));
    let medium = FontData::from_static(include_bytes!("../../../assets/fonts/Roboto-Medium.ttf"));
    fonts.font_data.insert("roboto".to_owned(), Arc::new(regular));
    fonts.font_data.insert("roboto-medium".to_owned(), Arc::new(medium));
    let fallback = fonts.families.entry(FontFamily::Proportional).or_default();
    let mut strong = fallback.clone();
    fallback.insert(0, "roboto".to_owned());
    strong.insert(0, "roboto-medium".to_owned());
    fonts.families.insert(FontFamily::Name(STRONG.into()), strong);
    fonts
}

fn set_style(style: &mut Style) {
    style.text_styles = [
        (TextStyle::Heading, strong(15.0)),
        (TextStyle::Body, regular(14.0)),
        (TextStyle::Button, regular(14.0)),
        (TextStyle::Small, regular(12.5)),
        (TextStyle::Monospace, FontId::monospace(13.0)),
    ]
    .into();
    style.spacing.item_spacing = vec2(8.0, 6.0);
    style.spacing.button_padding = vec2(10.0, 5.0);
    style.spacing.interact_size = vec2(40.0, 26.0);
    style.spacing.slider_rail_height = 6.0;
    style.spacing.tooltip_width = 340.0;
    style.spacing.icon_width = 18.0;
    style.spacing.icon_width_inner = 10.0;
    style.spacing.menu_margin = Margin::same(10);
    style.interaction.selectable_labels = false;
    style.interaction.tooltip_delay = 0.35;
    style.visuals = visuals();
}

fn visuals() -> Visuals {
    let mut visuals = Visuals::dark();
    visuals.panel_fill = PANEL;
    visuals.window_fill = POPUP;
    visuals.window_stroke = Stroke::new(1.0, LINE);
    visuals.popup_shadow = Shadow { offset: [0, 4], blur: 12, spread: 0, color: Color32::from_black_alpha(110) };
    visuals.extreme_bg_color = GROOVE;
    visuals.faint_bg_color = CARD;
    visuals.weak_text_color = Some(TEXT_WEAK);
    visuals.hyperlink_color = RENDERED;
    visuals.warn_fg_color = ALARM_MEDIUM;
    visuals.error_fg_color = ALARM_HIGH;
    visuals.selection.bg_fill = SELECTED;
    visuals.selection.stroke = Stroke::new(1.0, TEXT);
    visuals.slider_trailing_fill = true;
    let widgets = &mut visuals.widgets;
    widgets.noninteractive.fg_stroke = Stroke::new(1.0, TEXT);
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, LINE);
    for (state, fill) in [
        (&mut widgets.inactive, CONTROL),
        (&mut widgets.hovered, CONTROL_HOVER),
        (&mut widgets.active, SELECTED),
        (&mut widgets.open, CONTROL_HOVER),
    ] {
        state.bg_fill = fill;
        state.weak_bg_fill = fill;
        state.bg_stroke = Stroke::new(1.0, LINE);
        state.fg_stroke = Stroke::new(1.5, TEXT);
        state.corner_radius = CORNER;
        state.expansion = 0.0;
    }
    // The rail of a slider is painted with the resting fill: a little lighter than the card, so that it is seen.
    visuals.widgets.hovered.bg_stroke = Stroke::new(1.0, TEXT_WEAK);
    visuals
}

/// Frame of a card.
pub fn card() -> egui::Frame {
    egui::Frame::new().fill(CARD).corner_radius(CORNER).inner_margin(Margin::same(CARD_PADDING))
}
