//! All colours, fonts and spacings. Panels use names from here, never a colour value.
//!
//! Red, yellow and cyan are reserved for alarms (IEC 60601-1-8). The two forces differ in lightness as well as in hue,
//! so that colour-blind users and grey prints can distinguish them: measured is ivory, rendered blue.

use std::{cell::Cell, sync::Arc};

use egui::{
    Color32, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, FontTweak, Margin, Stroke, Style, TextStyle,
    Visuals, epaint::Shadow, vec2,
};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ColourPalette {
    /// Background of the window.
    pub background: Color32,
    /// Bars and side panels.
    pub panel: Color32,
    /// A card on a panel.
    pub card: Color32,
    /// Tooltips and menus.
    pub popup: Color32,
    /// A control at rest.
    pub control: Color32,
    /// A control under the pointer.
    pub control_hover: Color32,
    /// Slider rails, empty bars, plot backgrounds.
    pub groove: Color32,
    /// Thin lines.
    pub line: Color32,
    /// Main text.
    pub text: Color32,
    /// Explanatory text.
    pub text_weak: Color32,
    /// The stop button, which must be found at a glance.
    pub stop: Color32,
    /// Selected, or set by the operator.
    pub selected: Color32,
    /// The one button to press next.
    pub primary: Color32,
    /// The force measured at the instrument.
    pub measured: Color32,
    /// The force rendered to the hand.
    pub rendered: Color32,
    /// Reference for comparisons (delayed DFR, the paper's choice).
    pub reference: Color32,
    /// Several lines in one plot: axes x, y, z, or the members of an ensemble. They also differ in lightness.
    pub series: [Color32; 4],
    /// The frame around recorded data only.
    pub past: Color32,
    /// The frame of a rig at another machine, shown without control.
    pub watching: Color32,
    /// The loop runs and renders force.
    pub engaged: Color32,
    /// The loop is at rest.
    pub at_rest: Color32,
    /// High-priority alarm, flashing.
    pub alarm_high: Color32,
    /// Medium-priority alarm, flashing slowly.
    pub alarm_medium: Color32,
    /// Low-priority alarm, steady.
    pub alarm_low: Color32,
}

const fn rgb(hex: u32) -> Color32 {
    Color32::from_rgb((hex >> 16) as u8, (hex >> 8) as u8, hex as u8)
}

/// For a dark room; also for the 3-D view and for alarms, which are dark in both palettes.
pub const DARK: ColourPalette = ColourPalette {
    background: rgb(0x10_1317),
    panel: rgb(0x15_191f),
    card: rgb(0x1c_2129),
    popup: rgb(0x26_2d37),
    control: rgb(0x2b_333e),
    control_hover: rgb(0x37_414e),
    groove: rgb(0x11_151a),
    line: rgb(0x2d_3540),
    text: rgb(0xe6_eaee),
    text_weak: rgb(0xa4_afba),
    stop: rgb(0xff_ffff),
    selected: rgb(0x3f_5d86),
    primary: rgb(0x24_62c8),
    measured: rgb(0xf3_e9d2),
    rendered: rgb(0x6c_9dff),
    reference: rgb(0x8d_97a3),
    series: [rgb(0xf3_e9d2), rgb(0x6c_9dff), rgb(0x63_c28c), rgb(0xc2_7ddc)],
    past: rgb(0xd5_73e4),
    watching: rgb(0xe9_8b3a),
    engaged: rgb(0x63_c28c),
    at_rest: rgb(0xc3_cad2),
    alarm_high: rgb(0xff_5c5c),
    alarm_medium: rgb(0xff_d73d),
    alarm_low: rgb(0x41_d6e0),
};

/// For a bright room and for printing.
pub const LIGHT: ColourPalette = ColourPalette {
    background: rgb(0xf4_f6f8),
    panel: rgb(0xe4_e9ee),
    card: rgb(0xfc_fdfe),
    popup: rgb(0xff_ffff),
    control: rgb(0xdc_e2e9),
    control_hover: rgb(0xcb_d4dd),
    groove: rgb(0xe9_edf1),
    line: rgb(0xc2_cad3),
    text: rgb(0x16_1b21),
    text_weak: rgb(0x4b_5764),
    stop: rgb(0x10_1317),
    selected: rgb(0xa8_c4ec),
    primary: rgb(0x2a_5db0),
    measured: rgb(0x5d_4715),
    rendered: rgb(0x1a_5fd8),
    reference: rgb(0x5e_6974),
    series: [rgb(0x5d_4715), rgb(0x1a_5fd8), rgb(0x18_703f), rgb(0x8a_3ba8)],
    past: rgb(0x93_2fa8),
    watching: rgb(0xa0_4e00),
    engaged: rgb(0x18_703f),
    at_rest: rgb(0x58_626d),
    alarm_high: rgb(0xc9_1f2a),
    alarm_medium: rgb(0x7f_6100),
    alarm_low: rgb(0x00_7280),
};

/// For colour-blind users: green, which looks like red to many of them, is blue or orange here.
const fn safe(of: &ColourPalette, engaged: u32, series: [u32; 2]) -> ColourPalette {
    let [third, fourth] = series;
    ColourPalette { engaged: rgb(engaged), series: [of.series[0], of.series[1], rgb(third), rgb(fourth)], ..*of }
}

pub const DARK_SAFE: ColourPalette = safe(&DARK, 0x56_b4e9, [0xe6_9f00, 0xd7_8fb5]);
pub const LIGHT_SAFE: ColourPalette = safe(&LIGHT, 0x00_5a9c, [0x8a_5200, 0x92_2d6c]);

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
    let regular = unhinted(FontData::from_static(include_bytes!("../../../assets/fonts/Roboto-Regular.ttf")));
    let medium = unhinted(FontData::from_static(include_bytes!("../../../assets/fonts/Roboto-Medium.ttf")));
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

    use nima_testing::contrast::MIN;

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
        for font in [regular(12.5), regular(13.0), regular(14.0), strong(13.0), strong(14.0), strong(15.0)] {
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

    fn contrast(a: Color32, b: Color32) -> f64 {
        let [a, b] = [a, b].map(|colour| [colour.r(), colour.g(), colour.b()]);
        nima_testing::contrast::contrast(a, b)
    }

    /// Returns the colours of a palette in which words and numbers are written.
    fn inks(palette: &ColourPalette) -> Vec<(&'static str, Color32)> {
        let mut inks = vec![
            ("text", palette.text),
            ("text_weak", palette.text_weak),
            ("measured", palette.measured),
            ("rendered", palette.rendered),
            ("reference", palette.reference),
            ("engaged", palette.engaged),
            ("at_rest", palette.at_rest),
            ("alarm_high", palette.alarm_high),
            ("alarm_medium", palette.alarm_medium),
            ("alarm_low", palette.alarm_low),
            ("past", palette.past),
            ("watching", palette.watching),
        ];
        inks.extend(palette.series.map(|colour| ("series", colour)));
        inks
    }

    #[test]
    fn every_colour_is_read_on_every_ground_of_both_palettes() {
        let mut wrong = Vec::new();
        for (name, palette) in
            [("dark", &DARK), ("light", &LIGHT), ("dark safe", &DARK_SAFE), ("light safe", &LIGHT_SAFE)]
        {
            let grounds = [palette.background, palette.panel, palette.card, palette.popup, palette.groove];
            for (ink, colour) in inks(palette) {
                let min = grounds.map(|ground| contrast(colour, ground)).into_iter().fold(f64::INFINITY, f64::min);
                if min < MIN {
                    wrong.push(format!("{name} {ink}: {min:.2}"));
                }
            }
        }
        assert!(wrong.is_empty(), "{wrong:?}");
    }

    /// Returns the colour as a person without red or green cones sees it (Machado et al. 2009, IEEE TVCG 15(6)).
    fn seen(colour: Color32, matrix: &[[f64; 3]; 3]) -> [f64; 3] {
        let linear = [colour.r(), colour.g(), colour.b()].map(|value| (f64::from(value) / 255.0).powf(2.2));
        let row = |row: &[f64; 3]| row.iter().zip(linear).map(|(weight, value)| weight * value).sum::<f64>();
        [0, 1, 2].map(|i| row(&matrix[i]).clamp(0.0, 1.0).powf(1.0 / 2.2))
    }

    #[test]
    fn the_safe_palettes_keep_engaged_and_alarms_apart_for_colour_blind_eyes() {
        const PROTANOPIA: [[f64; 3]; 3] = [
            [0.152_286, 1.052_583, -0.204_868],
            [0.114_503, 0.786_281, 0.099_216],
            [-0.003_882, -0.048_116, 1.051_998],
        ];
        const DEUTERANOPIA: [[f64; 3]; 3] =
            [[0.367_322, 0.860_646, -0.227_968], [0.280_085, 0.672_501, 0.047_413], [-0.011_820, 0.042_940, 0.968_881]];
        let apart = |palette: &ColourPalette| {
            let alarms = [palette.alarm_high, palette.alarm_medium];
            let pairs = [PROTANOPIA, DEUTERANOPIA].into_iter().flat_map(|eye| alarms.map(|alarm| (eye, alarm)));
            let distances = pairs.map(|(eye, alarm)| {
                let [one, other] = [palette.engaged, alarm].map(|colour| seen(colour, &eye));
                one.iter().zip(other).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
            });
            distances.fold(f64::INFINITY, f64::min)
        };
        for (safe, usual) in [(&DARK_SAFE, &DARK), (&LIGHT_SAFE, &LIGHT)] {
            assert!(apart(safe) > 0.35 && apart(safe) > 1.5 * apart(usual), "{} {}", apart(safe), apart(usual));
        }
    }

    #[test]
    fn words_on_controls_and_signs_are_read_too() {
        for palette in [&DARK, &LIGHT, &DARK_SAFE, &LIGHT_SAFE] {
            for control in [palette.control, palette.control_hover] {
                assert!(contrast(palette.text, control) > 7.0 && contrast(palette.text_weak, control) > MIN);
            }
            assert!(contrast(palette.text, palette.selected) > MIN);
            assert!(contrast(DARK.text, palette.primary) > MIN, "the next button");
            for sign in [palette.engaged, palette.alarm_high, palette.stop, palette.at_rest, palette.past] {
                assert!(contrast(palette.background, sign) > MIN, "{sign:?}");
            }
            assert!(contrast(palette.stop, palette.panel) > 10.0, "the stop must be found without looking");
            assert!(contrast(palette.measured, palette.rendered) > 1.4, "the forces differ in lightness too");
        }
        // The alarm strip is dark in both palettes.
        assert!(contrast(DARK.text_weak, DARK.card) > MIN);
    }

    #[test]
    fn words_on_the_field_and_on_a_picture_are_read_whatever_is_below() {
        for below in [Color32::WHITE, FIELD_FAR, FIELD_NEAR] {
            let ground = below.blend(VEIL);
            for (ink, colour) in inks(&DARK) {
                assert!(contrast(colour, ground) >= MIN, "{ink} on {below:?}: {:.2}", contrast(colour, ground));
            }
        }
    }
}
