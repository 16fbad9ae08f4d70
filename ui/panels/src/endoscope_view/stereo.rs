//! Images of two lenses side by side: the displayed half, its position, and its lens.

use egui::{Rect, pos2};
use nima_endoscope::Camera;
use nima_machine::config::{EndoscopeConfig, StereoView};
use nima_words::text;

use super::{aim::ImageZoom, place::ImagePlacement};

/// Image of one lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LensHalf {
    pub(super) place: ImagePlacement,
    /// Camera, if known.
    pub(super) camera: Option<Camera>,
    /// Drawings for this half are clipped to this area.
    pub(super) within: Rect,
}

/// The operator's choice of the displayed part.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ImageChoice {
    /// `None` for an image of one lens.
    pub(super) view: Option<StereoView>,
    /// Cut off at the left, top, right and bottom, as fractions; for two lenses, of each half.
    pub(super) crop: [f32; 4],
    pub(super) aim: ImageZoom,
}

pub(super) const fn next(view: StereoView) -> StereoView {
    match view {
        StereoView::Left => StereoView::Right,
        StereoView::Right => StereoView::Both,
        StereoView::Both => StereoView::Left,
    }
}

/// Returns the size of the whole image of which a lens covers a part, px.
pub(super) fn whole_px([width, height]: [usize; 2], endoscope: &EndoscopeConfig) -> [usize; 2] {
    if endoscope.view.is_some() { [2 * width, height] } else { [width, height] }
}

/// Returns the displayed parts of an image, and their positions.
pub(super) fn halves(
    area: Rect,
    size_px: [usize; 2],
    endoscope: &EndoscopeConfig,
    ImageChoice { view, crop, aim }: ImageChoice,
    camera: Option<&Camera>,
) -> Vec<LensHalf> {
    let Some(view) = view else {
        let place = ImagePlacement::new(area, size_px, endoscope, crop, aim);
        return vec![LensHalf { place, camera: camera.copied(), within: area }];
    };
    let half_px = [size_px[0] / 2, size_px[1]];
    let middle = area.center().x;
    let [left, right] = [
        Rect::from_min_max(area.min, pos2(middle, area.bottom())),
        Rect::from_min_max(pos2(middle, area.top()), area.max),
    ];
    let of_right = || camera.zip(endoscope.baseline_m).map(|(camera, baseline_m)| camera.beside(baseline_m));
    let of_left = |within| {
        let place = ImagePlacement::new(within, half_px, endoscope, crop, aim).of_fraction([0.0, 0.5]);
        LensHalf { place, camera: camera.copied(), within }
    };
    let of_right = |within| {
        let place = ImagePlacement::new(within, half_px, endoscope, crop, aim).of_fraction([0.5, 1.0]);
        LensHalf { place, camera: of_right(), within }
    };
    match view {
        StereoView::Left => vec![of_left(area)],
        StereoView::Right => vec![of_right(area)],
        StereoView::Both => vec![of_left(left), of_right(right)],
    }
}

/// Returns the text about the displayed half and the key; empty for an image of one lens.
pub(super) fn report(view: Option<StereoView>, endoscope: &EndoscopeConfig) -> &'static str {
    match view {
        None => "",
        Some(StereoView::Right) if endoscope.camera.is_some() && endoscope.baseline_m.is_none() => {
            text::endoscope_view::RIGHT_WITHOUT_FORCES.get()
        }
        Some(StereoView::Left) => text::endoscope_view::LEFT_HALF.get(),
        Some(StereoView::Right) => text::endoscope_view::RIGHT_HALF.get(),
        Some(StereoView::Both) => text::endoscope_view::BOTH_HALVES.get(),
    }
}

#[cfg(test)]
mod tests {
    use egui::{Pos2, vec2};
    use nalgebra::{Vector2, Vector3};
    use nima_simulation::{
        camera::{camera_of, usual},
        scene::Scene,
    };

    use super::*;

    fn of(view: Option<StereoView>) -> ImageChoice {
        ImageChoice { view, ..ImageChoice::default() }
    }

    #[test]
    fn each_half_is_a_picture_of_its_own_with_the_camera_of_its_lens() {
        let settings = usual(&Scene::load("bimanual").unwrap());
        let camera = camera_of(&settings);
        let mut endoscope =
            EndoscopeConfig { camera: Some(settings), view: Some(StereoView::Both), ..EndoscopeConfig::default() };
        endoscope.baseline_m = Some(0.004);
        assert_eq!(whole_px(camera.lens.size_px, &endoscope), [2560, 720]);
        let area = Rect::from_min_size(Pos2::ZERO, vec2(1280.0, 360.0));
        let [left, right] = halves(area, [2560, 720], &endoscope, of(Some(StereoView::Both)), Some(&camera))[..] else {
            panic!("two halves")
        };
        assert_eq!(left.place.rect, Rect::from_min_size(Pos2::ZERO, vec2(640.0, 360.0)));
        assert_eq!(right.place.rect, Rect::from_min_size(pos2(640.0, 0.0), vec2(640.0, 360.0)));
        let fractions = |half: &LensHalf| half.place.corners().map(|(fraction, _)| fraction.x);
        assert_eq!((fractions(&left), fractions(&right)), ([0.0, 0.5, 0.0, 0.5], [0.5, 1.0, 0.5, 1.0]));
        assert_eq!(right.place.at(&Vector2::new(0.0, 0.0)), right.place.rect.min);
        // The right lens sees near objects farther to the left.
        let point_m = Vector3::new(0.01, 0.0, 0.01);
        let [seen_left, seen_right] = [left, right].map(|half| half.camera.unwrap().project(&point_m).unwrap());
        assert!(seen_left.x - seen_right.x > 10.0 && (seen_left.y - seen_right.y).abs() < 5.0);
        endoscope.baseline_m = None;
        let alone = halves(area, [2560, 720], &endoscope, of(Some(StereoView::Right)), Some(&camera));
        assert!(alone.len() == 1 && alone[0].camera.is_none());
        assert_eq!(report(Some(StereoView::Right), &endoscope), text::endoscope_view::RIGHT_WITHOUT_FORCES.get());
        let mono = halves(area, [1280, 720], &endoscope, of(None), Some(&camera));
        assert!(mono.len() == 1 && mono[0].camera == Some(camera));
    }

    #[test]
    fn the_key_goes_round() {
        let mut view = StereoView::Left;
        let round = [(); 3].map(|()| {
            view = next(view);
            view
        });
        assert_eq!(round, [StereoView::Right, StereoView::Both, StereoView::Left]);
    }
}
