//! The endoscope image with the detected corners, and the map of the covered area.

use egui::{Align2, Color32, Pos2, Rect, Sense, Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2};
use nima_camera::{BoardSight, CELLS, CameraCoverage};
use nima_endoscope::{Checkerboard, DecodedImage};
use nima_screen::{double_buffer::DoubleBuffer, theme, widgets::fitting};

use crate::extras::camera::text as texts;

/// Width of the map, points.
pub(super) const MAP_WIDTH: f32 = 190.0;
const CORNER: f32 = 3.0;
const MARK: f32 = 11.0;

/// The displayed image, uploaded.
#[derive(Default)]
pub(super) struct DisplayedImage {
    screen: DoubleBuffer,
    size_px: Option<[usize; 2]>,
}

impl DisplayedImage {
    pub(super) fn upload(&mut self, ui: &Ui, image: &DecodedImage) {
        self.screen.upload(ui.ctx(), "board", image);
        self.size_px = Some(image.size_px);
    }

    /// Returns whether an image was received.
    pub(super) const fn has_come(&self) -> bool {
        self.size_px.is_some()
    }
}

/// Draws it with this width, with the corners of the board; `marked` is the corner to touch.
pub(super) fn image_ui(
    ui: &mut Ui,
    width: f32,
    shown: &DisplayedImage,
    sight: Option<(&BoardSight, &Checkerboard)>,
    marked: Option<usize>,
    words: &str,
) {
    let [across, down] = shown.size_px.unwrap_or([16, 9]).map(|side| side as f32);
    let (rect, response) = ui.allocate_exact_size(vec2(width, width * down / across), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, words));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 0.0, Color32::BLACK);
    let Some(texture) = shown.screen.id() else { return };
    let uv = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
    painter.image(texture, rect, uv, Color32::WHITE);
    let Some((sight, board)) = sight else { return };
    let at = |index: usize| {
        let place_px = sight.corners_px.get(index)?;
        Some(rect.min + vec2(place_px.x as f32, place_px.y as f32) * (rect.width() / across))
    };
    let per_row = board.corners()[0];
    for index in 0..board.count() {
        // Rows are joined by a line, so that a board read in the wrong direction is noticed.
        if let (Some(from), Some(to)) = (at(index), at(index + 1).filter(|_| (index + 1) % per_row != 0)) {
            painter.line_segment([from, to], Stroke::new(1.0, theme::DARK.measured));
        }
        if let Some(from) = at(index) {
            painter.circle_filled(from, CORNER, Color32::BLACK);
            painter.circle_filled(from, CORNER - 1.0, Color32::WHITE);
        }
    }
    if let Some(place) = marked.and_then(at) {
        painter.circle_stroke(place, MARK, Stroke::new(4.0, Color32::BLACK));
        painter.circle_stroke(place, MARK, Stroke::new(2.0, Color32::WHITE));
    }
}

/// Draws the covered area: bright cells have corners, dark cells have none; nothing is drawn where the image is black.
pub(super) fn coverage_ui(ui: &mut Ui, coverage: &CameraCoverage, size_px: [usize; 2]) {
    let height = MAP_WIDTH * size_px[1] as f32 / size_px[0].max(1) as f32;
    let (rect, response) = ui.allocate_exact_size(vec2(MAP_WIDTH, height + 20.0), Sense::hover());
    let words = texts::covered(coverage.fraction());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, words.clone()));
    response.on_hover_text(texts::COVERAGE_HOVER);
    let painter = ui.painter_at(rect);
    let map = Rect::from_min_size(rect.min, vec2(MAP_WIDTH, height));
    painter.rect_filled(map, 2.0, theme::now().groove);
    let cell = vec2(MAP_WIDTH / CELLS[0] as f32, height / CELLS[1] as f32);
    for (at, corners) in coverage.corners.iter().enumerate() {
        let [column, row] = [at % CELLS[0], at / CELLS[0]].map(|index| index as f32);
        let place = Rect::from_min_size(map.min + vec2(column * cell.x, row * cell.y), cell).shrink(1.0);
        if *corners > 0 {
            painter.rect_filled(place, 1.0, theme::now().measured);
        } else if coverage.lit[at] {
            painter.rect_stroke(place, 1.0, Stroke::new(1.0, theme::now().text_weak), StrokeKind::Inside);
        }
    }
    let below = pos2(map.left(), map.bottom() + 3.0);
    let font = fitting(&painter, &words, theme::regular(12.5), map.width());
    painter.text(below, Align2::LEFT_TOP, words, font, theme::now().text_weak);
}
