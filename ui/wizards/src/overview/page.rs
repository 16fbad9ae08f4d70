//! The set-up page: tiles per arm with their state and its reason. Every wizard starts from a tile.

use egui::{
    Align, Button, Color32, Id, Label, Layout, Rect, Response, RichText, Stroke, Ui, UiBuilder, WidgetInfo, vec2,
};
use nima_screen::{
    live::LiveState,
    scene3d::side_name,
    steady_button::{PATIENT_S, SteadyButton},
    theme,
    widgets::{Sign, next_button, sign, small},
};
use nima_words::{report_text::within, text};

use nima_machine::rig::Side;
use nima_recording::store::ReadyRecord;

use super::{
    ArmOverview, following,
    tiles::{SetupStep, SetupTile, StepState, progress_text, tiles},
};
use crate::{GoOn, arm_chip};

/// Smallest width of a tile, and its height.
const TILE: egui::Vec2 = vec2(216.0, 92.0);
/// Lines of a reason that a tile has room for.
const LINES: usize = 3;
/// Width of the coloured edge of a tile.
const EDGE: f32 = 5.0;

/// Draws the page; returns the step to open. `closed`: the reason why no calibration of this arm can be started.
pub fn overview_ui(
    ui: &mut Ui,
    arms: &[ArmOverview],
    live: &LiveState,
    check: Option<&ReadyRecord>,
    closed: &dyn Fn(Side) -> Option<&'static str>,
) -> Option<SetupStep> {
    ui.label(RichText::new(text::overview::TITLE).font(theme::strong(theme::TITLE)));
    ui.label(small(text::overview::MEANING));
    ui.add_space(theme::GAP);
    if arms.is_empty() {
        ui.label(text::calibrations::NOT_NEEDED);
    }
    let arms_tiles: Vec<Vec<SetupTile>> = arms.iter().map(|arm| tiles(arm, live, check)).collect();
    let mut wish = following_ui(ui, arms, closed);
    if !arms.is_empty() {
        ui.label(RichText::new(progress_text(&arms_tiles)).font(theme::strong(15.0)));
        ui.add_space(theme::GAP);
    }
    for (arm, tiles) in arms.iter().zip(&arms_tiles) {
        let head = arm.wrist.as_ref().map_or_else(
            || text::calibrations::SENSOR_NOT_CONNECTED.get().to_owned(),
            |wrist| text::overview::of_arm(&wrist.serial_number, &wrist.tool),
        );
        ui.horizontal(|ui| {
            arm_chip(ui, arm.side);
            ui.label(RichText::new(head).font(theme::strong(theme::HEADING)));
        });
        wish = tiles_ui(ui, side_name(arm.side), tiles, closed(arm.side)).or(wish);
        ui.add_space(theme::GAP);
    }
    wish
}

/// Draws the button that opens the next calibration.
fn following_ui(ui: &mut Ui, arms: &[ArmOverview], closed: &dyn Fn(Side) -> Option<&'static str>) -> Option<SetupStep> {
    let wanted = following(arms, None)?;
    let closed = closed(wanted.side);
    let label = GoOn::Calibrate(wanted).words();
    let may = closed.map_or(Ok(()), Err);
    let button = SteadyButton { id: Id::unique("following"), label: &label, meaning: "", may, waits_s: PATIENT_S };
    let wants = button.ui(ui, |name, enabled| {
        next_button(RichText::new(name).font(theme::strong(15.0)), enabled).min_size(vec2(300.0, 34.0))
    });
    ui.label(small(closed.unwrap_or(text::calibrations::SETS_IDLE.get())));
    ui.add_space(theme::GAP);
    wants.then_some(SetupStep::Calibrate(wanted))
}

/// Draws the tiles of an arm in rows of equal width; returns the step of the pressed one.
fn tiles_ui(ui: &mut Ui, arm: &str, tiles: &[SetupTile], closed: Option<&str>) -> Option<SetupStep> {
    let gap = theme::GAP;
    ui.spacing_mut().item_spacing = vec2(gap, gap);
    let columns = (((ui.available_width() + gap) / (TILE.x + gap)) as usize).max(1);
    let width = (ui.available_width() + gap) / columns as f32 - gap;
    let mut wish = None;
    for row in tiles.chunks(columns) {
        ui.horizontal(|ui| {
            for tile in row {
                if tile_ui(ui, arm, tile, width, closed) {
                    wish = Some(tile.step);
                }
            }
        });
    }
    wish
}

/// Draws a tile as one button; returns whether it was pressed.
fn tile_ui(ui: &mut Ui, arm: &str, tile: &SetupTile, width: f32, closed: Option<&str>) -> bool {
    // The devices can be inspected in every state of the loop.
    let closed = closed.filter(|_| tile.step != SetupStep::Devices);
    let verb = verb(tile);
    let name = text::overview::button(verb, arm, &within(tile.name));
    let may = closed.map_or(Ok(()), Err);
    let id = Id::unique(("tile", &name));
    let meaning = format!("{}\n{}", tile.name, tile.why);
    let button = SteadyButton { id, label: verb, meaning: &meaning, may, waits_s: PATIENT_S };
    let look = |_, _| Button::new("").min_size(vec2(width, TILE.y)).fill(theme::now().card);
    let (button, wants) = button.show(ui, look);
    button.widget_info(|| WidgetInfo::labeled(egui::Role::Button, button.enabled(), name.as_str()));
    content_ui(ui, tile, verb, &button);
    wants
}

fn verb(tile: &SetupTile) -> &'static str {
    match tile.step {
        SetupStep::Devices => text::overview::SHOW.get(),
        SetupStep::Check => text::overview::RUN.get(),
        SetupStep::Calibrate(_) if tile.why == text::overview::NEVER.get() => text::overview::MAKE.get(),
        SetupStep::Calibrate(_) => text::overview::REDO.get(),
    }
}

/// Draws name, reason and verb over the button.
fn content_ui(ui: &mut Ui, tile: &SetupTile, verb: &str, button: &Response) {
    let (what, colour) = look(tile.state);
    let rect = button.rect;
    let edge = Rect::from_min_size(rect.min, vec2(EDGE, rect.height()));
    ui.painter().rect_filled(edge, theme::CORNER, colour);
    if button.hovered() {
        let stroke = Stroke::new(1.0, theme::now().text_weak);
        ui.painter().rect_stroke(rect, theme::CORNER, stroke, egui::StrokeKind::Inside);
    }
    let title = rect.left_top() + vec2(EDGE + 14.0, 16.0);
    sign(ui.painter(), what, title, 6.0, colour);
    let inside = Rect::from_min_max(rect.min + vec2(EDGE + 26.0, 6.0), rect.max - vec2(8.0, 6.0));
    let mut place = ui.new_child(UiBuilder::new().max_rect(inside).layout(Layout::top_down(Align::Min)));
    place.set_clip_rect(inside.intersect(ui.clip_rect()));
    place.spacing_mut().item_spacing.y = 2.0;
    place.add(Label::new(RichText::new(tile.name).font(theme::strong(14.0))).truncate());
    let lines: Vec<&str> = tile.why.lines().collect();
    let shown = if lines.len() > LINES { LINES - 1 } else { lines.len() };
    for line in &lines[..shown] {
        // A short reason has room for two lines; of a long one each line is cut, and the hover text has the rest.
        let label = Label::new(small(*line));
        place.add(if lines.len() < LINES { label.wrap() } else { label.truncate() });
    }
    if shown < lines.len() {
        place.add(Label::new(small(text::overview::more(lines.len() - shown))).truncate());
    }
    let ink = if button.enabled() { theme::now().text } else { theme::now().text_weak };
    ui.painter().text(inside.right_bottom(), egui::Align2::RIGHT_BOTTOM, verb, theme::strong(12.5), ink);
}

fn look(state: StepState) -> (Sign, Color32) {
    let palette = theme::now();
    match state {
        StepState::Done => (Sign::Disc, palette.engaged),
        StepState::Doubtful => (Sign::Triangle, palette.alarm_medium),
        StepState::Missing => (Sign::Octagon, palette.alarm_high),
    }
}
