//! Small parts used by several panels.

use egui::{
    Align, Button, Color32, FontId, Label, Layout, Painter, Pos2, Rect, Response, RichText, Sense, Stroke, TextStyle,
    Ui, Vec2, Vec2b, WidgetText, pos2,
    text::{LayoutJob, TextFormat},
    vec2,
};

use egui_plot::Plot;

use crate::theme;

/// Returns a plot with a fixed range: the pointer does not move it.
pub fn still(plot: Plot<'_>) -> Plot<'_> {
    plot.allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .allow_axis_zoom_drag(false)
        .allow_double_click_reset(false)
        .auto_bounds(Vec2b::FALSE)
        .set_margin_fraction(Vec2::ZERO)
        .show_crosshair(false)
        .grid_color(theme::now().line)
}

/// Draws a card with a heading; `meaning` is its hover text.
pub fn card<R>(
    ui: &mut Ui,
    title: impl Into<String>,
    meaning: impl Into<WidgetText>,
    content: impl FnOnce(&mut Ui) -> R,
) -> R {
    let inner = theme::card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.spacing_mut().item_spacing.y = 4.0;
        ui.label(RichText::new(title).text_style(egui::TextStyle::Heading)).on_hover_text(meaning);
        ui.add_space(2.0);
        content(ui)
    });
    ui.add_space(theme::GAP);
    inner.inner
}

/// Shows `content` at the right of a row, in reading order: in a right-to-left layout the keyboard focus would move
/// backwards.
pub fn at_the_right<R>(ui: &mut Ui, content: impl FnOnce(&mut Ui) -> R) -> R {
    let id = ui.scope_id().with("right");
    let known: Option<f32> = ui.data(|data| data.get_temp(id));
    ui.add_space((ui.available_width() - known.unwrap_or_default()).max(0.0));
    let row = ui.horizontal(content);
    let width = row.response.rect.width();
    if known.is_none_or(|known| (known - width).abs() > 0.5) {
        ui.data_mut(|data| data.insert_temp(id, width));
        ui.ctx().request_discard("width");
    }
    row.inner
}

/// Names a plot for screen readers, with a summary of its content; the summary is built only if a screen
/// reader is active.
pub fn describe(ui: &Ui, plot: &Response, name: &str, summary: impl FnOnce() -> String) {
    plot.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Figure, true, name));
    ui.ctx().accesskit_node_builder(plot.id, |node| node.set_description(summary()));
}

/// Minimum factor by which a font is reduced to fit its text.
const MIN_SIZE: f32 = 0.6;

/// Returns the width of this text in one line.
pub fn width_of(painter: &Painter, words: &str, font: FontId) -> f32 {
    painter.layout_no_wrap(words.to_owned(), font, Color32::PLACEHOLDER).size().x
}

/// This font, smaller if the text is wider than `width`: languages differ in length where the space is fixed.
pub fn fitting(painter: &Painter, words: &str, font: FontId, width: f32) -> FontId {
    let fraction = width / width_of(painter, words, font.clone()).max(1.0);
    // Glyphs are placed on whole pixels, so the width shrinks slightly less than the font size; 0.97 makes up for this.
    let size = if fraction < 1.0 { font.size * (0.97 * fraction).max(MIN_SIZE) } else { font.size };
    FontId { size, ..font }
}

/// Like [`fitting`], for text in a style of the window.
pub fn fitting_style(ui: &Ui, words: &str, style: &TextStyle, width: f32) -> FontId {
    fitting(ui.painter(), words, style.resolve(ui.style()), width)
}

/// Draws a name on the left and its value on the right; `meaning` is their hover text. A long name takes several lines.
pub fn figure(
    ui: &mut Ui,
    name: impl Into<String>,
    value: impl Into<String>,
    meaning: impl Into<WidgetText>,
) -> Response {
    ui.spacing_mut().interact_size.y = 18.0;
    let name = name.into();
    let value = value.into();
    let meaning = meaning.into();
    let row = ui.horizontal(|ui| {
        let room = ui.available_width() - width_of(ui.painter(), &value, theme::strong(14.0)) - 12.0;
        if width_of(ui.painter(), &name, TextStyle::Body.resolve(ui.style())) > room {
            ui.scope(|ui| {
                ui.set_max_width(room.max(40.0));
                ui.add(Label::new(weak(name)).wrap()).on_hover_text(meaning.clone());
            });
        } else {
            ui.label(weak(name)).on_hover_text(meaning.clone());
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.label(RichText::new(value).font(theme::strong(14.0))).on_hover_text(meaning);
        });
    });
    row.response
}

/// Width of the window from which the main buttons have icons.
const ICONS_FROM: f32 = 1280.0;

/// Returns the text of a main button, with an icon before them if the window has room. A button with such words needs
/// their plain text as its accessible name.
pub fn with_icon(ui: &Ui, icon: theme::Icon, words: &str, font: FontId) -> LayoutJob {
    let mut job = LayoutJob::default();
    // The button chooses the colour.
    let format = |font_id, valign| TextFormat { font_id, valign, color: Color32::PLACEHOLDER, ..Default::default() };
    if ui.ctx().content_rect().width() >= ICONS_FROM {
        job.append(icon.codepoint, 0.0, format(theme::icons(font.size + 3.0), Align::Center));
        job.append(words, 5.0, format(font, Align::Center));
    } else {
        job.append(words, 0.0, format(font, Align::Center));
    }
    job
}

/// Returns a button that is highlighted if it is the `next` one to press; at most one button on the screen is.
pub fn next_button(name: impl Into<RichText>, next: bool) -> Button<'static> {
    let name = name.into();
    if next { Button::new(name.color(theme::DARK.text)).fill(theme::now().primary) } else { Button::new(name) }
}

/// Returns explanatory text.
pub fn weak(text: impl Into<String>) -> RichText {
    RichText::new(text).color(theme::now().text_weak)
}

/// Returns small explanatory text.
pub fn small(text: impl Into<String>) -> RichText {
    weak(text).text_style(egui::TextStyle::Small)
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    Ring,
    Disc,
    Square,
    Triangle,
    Octagon,
    /// Done.
    Tick,
}

pub fn sign(painter: &Painter, sign: Sign, centre: Pos2, radius: f32, colour: Color32) {
    match sign {
        Sign::Ring => {
            painter.circle_stroke(centre, radius * 0.85, Stroke::new(radius * 0.3, colour));
        }
        Sign::Disc => {
            painter.circle_filled(centre, radius, colour);
        }
        Sign::Square => {
            painter.rect_filled(Rect::from_center_size(centre, Vec2::splat(radius * 1.7)), 2.0, colour);
        }
        Sign::Triangle => {
            let points = [vec2(0.0, -1.05), vec2(1.1, 0.85), vec2(-1.1, 0.85)].map(|p| centre + p * radius);
            painter.add(egui::Shape::convex_polygon(points.to_vec(), colour, Stroke::NONE));
        }
        Sign::Tick => {
            let points = [vec2(-0.9, 0.0), vec2(-0.25, 0.7), vec2(0.95, -0.75)].map(|p| centre + p * radius);
            painter.add(egui::Shape::line(points.to_vec(), Stroke::new(radius * 0.4, colour)));
        }
        Sign::Octagon => {
            let points = (0..8).map(|i| {
                let angle = std::f32::consts::TAU * (i as f32 + 0.5) / 8.0;
                centre + Vec2::angled(angle) * radius * 1.08
            });
            painter.add(egui::Shape::convex_polygon(points.collect(), colour, Stroke::NONE));
        }
    }
}

/// Allocates space for a symbol in a row and draws it.
pub fn sign_ui(ui: &mut Ui, what: Sign, radius: f32, colour: Color32) -> Response {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(radius * 2.4), Sense::hover());
    sign(ui.painter(), what, rect.center(), radius, colour);
    response
}

/// Draws the symbol of a force next to its name: a line with a cone, or a beaded line with a double cone.
pub fn force_sign(painter: &Painter, palette: &theme::ColourPalette, rect: Rect, rendered: bool) {
    let colour = if rendered { palette.rendered } else { palette.measured };
    let y = rect.center().y;
    let left = rect.left();
    let right = rect.right();
    let cone = |tip: f32| {
        let points = vec![pos2(tip, y), pos2(tip - 9.0, y - 5.0), pos2(tip - 9.0, y + 5.0)];
        painter.add(egui::Shape::convex_polygon(points, colour, Stroke::NONE));
    };
    let stroke = Stroke::new(3.0, colour);
    if rendered {
        for bead in 0..3 {
            let x = left + bead as f32 * 7.0;
            painter.hline(x..=x + 4.5, y, stroke);
        }
        cone(right - 6.0);
    } else {
        painter.hline(left..=right - 8.0, y, stroke);
    }
    cone(right);
}

/// Draws a horizontal bar that fills this fraction of `rect` from the left.
pub fn bar(painter: &Painter, rect: Rect, fraction: f64, colour: Color32) {
    painter.rect_filled(rect, 2.0, theme::now().groove);
    let fraction = if fraction.is_finite() { fraction.clamp(0.0, 1.0) as f32 } else { 1.0 };
    if fraction > 0.0 {
        let filled = Rect::from_min_size(rect.min, vec2((rect.width() * fraction).max(2.0), rect.height()));
        painter.rect_filled(filled, 2.0, colour);
    }
}
