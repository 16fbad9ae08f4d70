//! All colours, fonts and spacings. Panels use names from here, never a colour value.
//!
//! Red, yellow and cyan are reserved for alarms (IEC 60601-1-8). The two forces differ in lightness as well as in hue,
//! so that colour-blind users and grey prints can distinguish them: measured is ivory, rendered blue.

mod palette;

use std::{cell::Cell, sync::Arc};

use egui::{
    Color32, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, FontTweak, Margin, Stroke, Style, TextStyle,
    Visuals, epaint::Shadow, vec2,
};

pub use palette::{ColourPalette, DARK, DARK_SAFE, LIGHT, LIGHT_SAFE};

/// Colours and size of the controls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Look {
    pub light: bool,
    pub colour_blind: bool,
    pub touch: bool,
}

thread_local! {
    // Thread-local: a window uses one thread, whereas tests have many windows on many threads.
    static NOW: Cell<&'static ColourPalette> = const { Cell::new(&DARK) };
}

pub fn now() -> &'static ColourPalette {
    NOW.get()
}

/// Background and outline of text over the 3-D view or the endoscope image: the text stays readable even on white.
pub const VEIL: Color32 = Color32::from_black_alpha(215);

/// Background of the 3-D view, far and near.
pub const FIELD_FAR: Color32 = Color32::from_rgb(0x2b, 0x33, 0x3d);
/// See [`FIELD_FAR`].
pub const FIELD_NEAR: Color32 = Color32::from_rgb(0x13, 0x17, 0x1c);

/// Space between a card's edge and its content.
pub const CARD_PADDING: i8 = 12;
/// Space between cards.
pub const GAP: f32 = 8.0;
/// Smallest size of the stop button; the design requires at least 48.
pub const STOP_SIZE: egui::Vec2 = vec2(132.0, 52.0);

/// Corner radius of cards and controls.
pub const CORNER: CornerRadius = CornerRadius::same(6);

/// Title of a page.
pub const TITLE: f32 = 22.0;
/// Heading of a part of a page.
pub const HEADING: f32 = 16.0;

const STRONG: &str = "strong";

/// Returns the bold font, for figures and headings.
pub fn strong(size: f32) -> FontId {
    FontId::new(size, FontFamily::Name(STRONG.into()))
}

/// Returns the regular font.
pub fn regular(size: f32) -> FontId {
    FontId::proportional(size)
}

/// Sets fonts and style of a context, once.
pub fn apply(ctx: &egui::Context) {
    ctx.set_fonts(fonts());
    ctx.style_mut_of(egui::Theme::Dark, |style| set_style(style, Visuals::dark(), &DARK));
    ctx.style_mut_of(egui::Theme::Light, |style| set_style(style, Visuals::light(), &LIGHT));
    choose(ctx, Look::default());
}

/// Applies fonts and style in a test of a part; returns whether they are active, which is from the second pass on.
pub fn is_applied(ctx: &egui::Context) -> bool {
    let id = egui::Id::unique("applied");
    let is_active = ctx.data(|data| data.get_temp(id)).unwrap_or(false);
    if !is_active {
        apply(ctx);
        ctx.data_mut(|data| data.insert_temp(id, true));
    }
    is_active
}

/// Selects palette and size; call at the start of a frame.
pub fn choose(ctx: &egui::Context, look: Look) {
    NOW.set(match (look.light, look.colour_blind) {
        (false, false) => &DARK,
        (false, true) => &DARK_SAFE,
        (true, false) => &LIGHT,
        (true, true) => &LIGHT_SAFE,
    });
    ctx.set_theme(if look.light { egui::Theme::Light } else { egui::Theme::Dark });
    let height = if look.touch { TOUCH } else { CONTROL };
    if (ctx.global_style().spacing.interact_size.y - height).abs() > 0.5 {
        ctx.all_styles_mut(|style| set_size(style, look.touch));
    }
}

/// Height of a control for a mouse, and for a finger.
const CONTROL: f32 = 26.0;
const TOUCH: f32 = 40.0;

fn set_size(style: &mut Style, touch: bool) {
    let spacing = &mut style.spacing;
    spacing.button_padding = if touch { vec2(12.0, 10.0) } else { vec2(10.0, 5.0) };
    spacing.interact_size = vec2(40.0, if touch { TOUCH } else { CONTROL });
    spacing.slider_rail_height = if touch { 12.0 } else { 6.0 };
    spacing.icon_width = if touch { 26.0 } else { 18.0 };
    spacing.icon_width_inner = if touch { 15.0 } else { 10.0 };
    spacing.scroll.bar_width = if touch { 22.0 } else { egui::style::ScrollStyle::default().bar_width };
}

/// An icon of the font of icons.
pub use egui_material_icons::MaterialIcon as Icon;

/// Returns the font of the icons.
pub fn icons(size: f32) -> FontId {
    FontId::new(size, FontFamily::Name(ICONS.into()))
}

const ICONS: &str = egui_material_icons::FONT_FAMILY_OUTLINED;

/// Roboto, and a font of icons. Roboto has every character of the screen, and one font looks the same on every computer.
fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::empty();
    // Hinting moves the dot of an "i" onto its stem at the sizes of the window.
    let unhinted = |data: FontData| data.tweak(FontTweak { hinting: Some(false), ..FontTweak::default() });
    let regular = unhinted(FontData::from_static(include_bytes!("../../../../assets/fonts/Roboto-Regular.ttf")));
    let medium = unhinted(FontData::from_static(include_bytes!("../../../../assets/fonts/Roboto-Medium.ttf")));
    for (family, name, font) in [
        (FontFamily::Proportional, "roboto", regular.clone()),
        (FontFamily::Monospace, "roboto", regular),
        (FontFamily::Name(STRONG.into()), "roboto-medium", medium),
    ] {
        fonts.font_data.insert(name.to_owned(), Arc::new(font));
        fonts.families.insert(family, vec![name.to_owned()]);
    }
    // Only by its own name: no text may fall back to an icon.
    fonts.font_data.insert(ICONS.to_owned(), Arc::new(egui_material_icons::font_insert().data));
    fonts.families.insert(FontFamily::Name(ICONS.into()), vec![ICONS.to_owned()]);
    fonts
}

fn set_style(style: &mut Style, base: Visuals, palette: &ColourPalette) {
    style.text_styles = [
        (TextStyle::Heading, strong(15.0)),
        (TextStyle::Body, regular(14.0)),
        (TextStyle::Button, regular(14.0)),
        (TextStyle::Small, regular(12.5)),
        (TextStyle::Monospace, FontId::monospace(13.0)),
    ]
    .into();
    style.spacing.item_spacing = vec2(8.0, 6.0);
    set_size(style, false);
    style.spacing.tooltip_width = 340.0;
    style.spacing.menu_margin = Margin::same(10);
    style.interaction.selectable_labels = false;
    style.interaction.tooltip_delay = 0.35;
    style.visuals = visuals(base, palette);
}

fn visuals(mut visuals: Visuals, palette: &ColourPalette) -> Visuals {
    visuals.panel_fill = palette.panel;
    visuals.window_fill = palette.popup;
    visuals.window_stroke = Stroke::new(1.0, palette.line);
    visuals.popup_shadow = Shadow { offset: [0, 4], blur: 12, spread: 0, color: Color32::from_black_alpha(110) };
    visuals.extreme_bg_color = palette.groove;
    visuals.faint_bg_color = palette.card;
    visuals.weak_text_color = Some(palette.text_weak);
    visuals.hyperlink_color = palette.rendered;
    visuals.warn_fg_color = palette.alarm_medium;
    visuals.error_fg_color = palette.alarm_high;
    visuals.selection.bg_fill = palette.selected;
    visuals.selection.stroke = Stroke::new(1.0, palette.text);
    visuals.slider_trailing_fill = true;
    let widgets = &mut visuals.widgets;
    widgets.noninteractive.fg_stroke = Stroke::new(1.0, palette.text);
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, palette.line);
    for (state, fill) in [
        (&mut widgets.inactive, palette.control),
        (&mut widgets.hovered, palette.control_hover),
        (&mut widgets.active, palette.selected),
        (&mut widgets.open, palette.control_hover),
    ] {
        state.bg_fill = fill;
        state.weak_bg_fill = fill;
        state.bg_stroke = Stroke::new(1.0, palette.line);
        state.fg_stroke = Stroke::new(1.5, palette.text);
        state.corner_radius = CORNER;
        state.expansion = 0.0;
    }
    // A slider's rail is painted with this fill; it is slightly lighter than the card, so that it remains visible.
    visuals.widgets.hovered.bg_stroke = Stroke::new(1.0, palette.text_weak);
    visuals
}

/// Returns the frame of a card.
pub fn card() -> egui::Frame {
    egui::Frame::new().fill(now().card).corner_radius(CORNER).inner_margin(Margin::same(CARD_PADDING))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    /// Every non-ASCII character in the console's source, which contains all its texts: none of them may be drawn as an empty
    /// box.
    fn written(folder: &Path, into: &mut std::collections::BTreeSet<char>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                written(&path, into);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                into.extend(std::fs::read_to_string(&path).unwrap().chars().filter(|letter| !letter.is_ascii()));
            }
        }
    }

    #[test]
    fn the_fonts_have_every_character_that_is_shown() {
        let ctx = egui::Context::default();
        apply(&ctx);
        ctx.run_ui(egui::RawInput::default(), |_| {}).textures_delta.clear();
        let mut shown = "°…−·".chars().collect();
        written(&Path::new(env!("CARGO_MANIFEST_DIR")).join(".."), &mut shown);
        assert!(shown.len() > 10, "{shown:?}");
        for font in [regular(14.0), strong(14.0), FontId::monospace(14.0)] {
            let lacks: Vec<char> =
                ctx.fonts_mut(|fonts| shown.iter().filter(|one| !fonts.has_glyph(&font, **one)).copied().collect());
            assert!(lacks.is_empty(), "{font:?} {lacks:?}");
            assert!(!ctx.fonts_mut(|fonts| fonts.has_glyph(&font, '\u{529b}')), "a glyph that no font has");
        }
    }

    #[test]
    fn the_dot_of_an_i_is_apart_from_its_stem() {
        let ctx = egui::Context::default();
        apply(&ctx);
        ctx.run_ui(egui::RawInput::default(), |_| {}).textures_delta.clear();
        // The sizes of the window.
        let light = [11.0, 11.5, 12.0, 12.5, 13.0, 14.0, 15.0, 16.0].map(regular);
        let heavy = [12.0, 12.5, 13.0, 13.5, 14.0, 15.0, 16.0, 17.0, 18.0, 19.0].map(strong);
        for font in light.into_iter().chain(heavy) {
            let darkest = ctx.fonts_mut(|fonts| {
                let galley = fonts.layout_no_wrap("i".to_owned(), font.clone(), Color32::WHITE);
                let place = galley.rows[0].glyphs[0].uv_rect;
                let image = fonts.image();
                let row = |y: u16| {
                    let pixel = |x: u16| image[(usize::from(x), usize::from(y))].a();
                    (place.min[0]..place.max[0]).map(pixel).max().unwrap_or(0)
                };
                // From the dot at the top on; the gap is in the upper half.
                let rows: Vec<u8> = (place.min[1]..place.max[1]).map(row).skip_while(|ink| *ink == 0).collect();
                let upper = &rows[1..rows.len() / 2];
                (*upper.iter().min().unwrap(), *rows.iter().max().unwrap())
            });
            // At 14 points the gap of the strong font lies between two rows of pixels and keeps 63 % of the ink.
            assert!(3 * u32::from(darkest.0) < 2 * u32::from(darkest.1), "{font:?}: {darkest:?}");
        }
    }
}
