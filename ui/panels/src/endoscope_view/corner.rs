//! The corner of the image: its age and rate, and a remark about the drawn forces.

use std::time::{Duration, Instant};

use egui::{Align2, Painter, Rect};
use nima_endoscope::{Camera, FrameHealth};
use nima_screen::theme;
use nima_words::text;

use super::{
    EndoscopeView, NewestFrame,
    banner::{MARGIN, plate},
    stereo,
};

/// Update interval of the figures, so that they can be read.
const FIGURES_EVERY: Duration = Duration::from_millis(250);

#[derive(Clone, Copy)]
pub(super) struct Corner<'a> {
    /// Screen positions of the tips.
    pub(super) tips: &'a [egui::Pos2],
    /// The image is current, and has the size for which the forces are drawn.
    pub(super) fits: bool,
    pub(super) camera: Option<&'a Camera>,
}

impl EndoscopeView {
    pub(super) fn corner_ui(
        &mut self,
        painter: &Painter,
        view: Rect,
        Corner { tips, fits, camera }: Corner<'_>,
        look: Option<&NewestFrame>,
        now: Instant,
    ) {
        let Some(look) = look.filter(|look| look.image.is_some()) else { return };
        if self.shown.as_ref().is_none_or(|(at, _)| now.duration_since(*at) >= FIGURES_EVERY) {
            let age = look.age.unwrap_or_default();
            let figures = if look.standing == FrameHealth::Still {
                text::endoscope_view::STILL.get().to_owned()
            } else if self.projector.is_some() {
                text::endoscope_view::recorded(age)
            } else {
                text::endoscope_view::figures(age, look.rate_hz)
            };
            self.shown = Some((now, figures));
        }
        let has_lens = self.wanted.as_ref().is_some_and(|wanted| wanted.camera.is_some());
        let forces = match (camera, self.hides_forces, self.off_px()) {
            (None, ..) if self.mount.is_some() => text::endoscope_view::NO_MARKER.get().to_owned(),
            (None, ..) if has_lens => text::endoscope_view::NO_PLACE.get().to_owned(),
            (None, ..) => text::endoscope_view::NO_CAMERA.get().to_owned(),
            // On an outdated image, the forces would be drawn in the wrong place.
            _ if !fits => String::new(),
            (_, true, _) => text::endoscope_view::FORCES_HIDDEN.get().to_owned(),
            (_, false, Some(off_px)) => text::endoscope_view::forces_off(off_px),
            (_, false, None) if self.settings.forces_of_now && self.projector.is_none() => {
                text::endoscope_view::FORCES_AHEAD.get().to_owned()
            }
            (_, false, None) => text::endoscope_view::FORCES_DRAWN.get().to_owned(),
        };
        let zoom = if self.aim.is_zoomed() { text::endoscope_view::zoomed(self.aim.zoom) } else { String::new() };
        let figures = self.shown.as_ref().map(|(_, figures)| figures.as_str()).unwrap_or_default();
        let half = self.wanted.as_ref().map_or("", |endoscope| stereo::report(self.view, endoscope));
        let weak = theme::DARK.text_weak;
        let is_wanted = self.wanted.as_ref().is_some_and(|wanted| wanted.record);
        let is_missing = is_wanted && self.feed.as_ref().is_some_and(|feed| !feed.is_recordable());
        let unrecorded = if is_missing { text::endoscope_view::NOT_RECORDED.get() } else { "" };
        let lines = [
            (figures, 15.0, theme::DARK.text),
            (forces.as_str(), 13.0, weak),
            (half, 13.0, weak),
            (zoom.as_str(), 13.0, weak),
            (unrecorded, 13.0, weak),
        ];
        let inner = view.shrink(MARGIN);
        let corners = [
            (inner.left_bottom(), Align2::LEFT_BOTTOM),
            (inner.right_bottom(), Align2::RIGHT_BOTTOM),
            (inner.left_top(), Align2::LEFT_TOP),
        ];
        plate(painter, &corners, tips, &lines);
    }
}
