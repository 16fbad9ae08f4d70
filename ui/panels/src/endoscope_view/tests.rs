use std::{
    sync::Mutex,
    thread,
    time::{SystemTime, UNIX_EPOCH},
};

use egui::{Pos2, pos2, vec2};
use nalgebra::{Vector2, Vector3};
use nima_emulation::emulators::endoscope::{EmulatedEndoscope, EndoscopeInstrument, SQUARE_PX};
use nima_endoscope::time_code;
use nima_simulation::{
    camera::{camera_of, usual},
    scene::Scene,
};

use super::{overlay::OverlayImage, *};

/// Bright green, which nothing else in the image has.
fn is_mark(pixel: &[u8]) -> bool {
    pixel[1] > 150 && pixel[0] < 90 && pixel[2] < 150
}

fn mark_px(image: &DecodedImage) -> Vector2<f64> {
    let [width, _] = image.size_px;
    let marked = image.rgba.chunks_exact(4).enumerate().filter(|(_, pixel)| is_mark(pixel));
    let places: Vec<_> =
        marked.map(|(at, _)| Vector2::new((at % width) as f64 + 0.5, (at / width) as f64 + 0.5)).collect();
    assert!(places.len() > 20, "{} pixels of the mark", places.len());
    places.iter().sum::<Vector2<f64>>() / places.len() as f64
}

fn now_us() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_micros() as u64
}

/// Returns an image that was taken after this time.
fn image_after(feed: &EndoscopeFeed, begin_us: u64) -> Arc<DecodedImage> {
    let begin = Instant::now();
    loop {
        let image = feed.look(Instant::now()).image.map(|(_, image)| image);
        let made = |image: &DecodedImage| {
            time_code::read(SQUARE_PX, |x, y| image.rgba[4 * (image.size_px[0] * y + x) + 1]).unwrap_or_default()
        };
        if let Some(image) = image.filter(|image| made(image) > begin_us) {
            return image;
        }
        assert!(begin.elapsed() < Duration::from_mins(1), "no picture");
        thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn forces_are_drawn_where_the_tip_is_seen_through_the_distortion_of_the_lens() {
    let scene = Scene::load("bimanual").unwrap();
    for k1 in [-0.3, 0.3] {
        let tip_m = Arc::new(Mutex::new(Vector3::zeros()));
        let shown = Arc::clone(&tip_m);
        let mut settings = usual(&scene);
        settings.k1 = k1;
        let endoscope = EndoscopeConfig { camera: Some(settings), ..EndoscopeConfig::default() };
        let camera = camera_of(&settings);
        let body = move |_: f64| vec![EndoscopeInstrument { tip_m: *shown.lock().unwrap(), trocar_m: scene_trocar() }];
        let serving = EmulatedEndoscope { camera, ..EmulatedEndoscope::of(&scene, 0) }
            .with(&scene, Box::new(body))
            .serve()
            .unwrap();
        let feed = EndoscopeFeed::start(serving.endpoint.parse().unwrap(), Some([1280, 720]), || {}).unwrap();
        let ctx = Context::default();
        let view = Rect::from_min_size(Pos2::ZERO, vec2(1280.0, 720.0));
        let place = ImagePlacement::new(view, [1280, 720], &endoscope, [0.0; 4], ImageZoom::default());
        let painter = Painter::new(ctx, egui::LayerId::background(), view);
        let seen = OverlayImage { painter: &painter, place: &place, camera: &camera, ceiling_n: 4.0 };
        let mut squares = 0.0;
        let tips = [[0.0, 0.0], [0.03, 0.02], [-0.03, 0.02], [0.025, -0.025], [-0.04, -0.01], [0.0, 0.035]];
        for [x_m, y_m] in tips {
            *tip_m.lock().unwrap() = Vector3::new(x_m, y_m, 0.004);
            let image = image_after(&feed, now_us());
            let is = place.at(&mark_px(&image));
            let drawn = seen.at(&Vector3::new(x_m, y_m, 0.004)).unwrap();
            squares += (is - drawn).length_sq();
        }
        let rms = (squares / tips.len() as f32).sqrt();
        assert!(rms <= 5.0, "k1 {k1}: {rms} points, one of which is a pixel here");
    }
}

fn scene_trocar() -> Vector3<f64> {
    Vector3::new(0.05, -0.06, 0.14)
}

/// Returns the filled rectangles that a text plate leaves.
fn plates(tips: &[Pos2]) -> Vec<Rect> {
    let view = Rect::from_min_size(pos2(0.0, 0.0), vec2(900.0, 470.0));
    let mut plates = Vec::new();
    let ctx = Context::default();
    theme::apply(&ctx);
    let mut output = ctx.run_ui(egui::RawInput::default(), |ui| {
        let painter = ui.ctx().layer_painter(egui::LayerId::background()).with_clip_rect(view);
        let cure = text::endoscope_view::FROZEN_CURE.get();
        wrong_ui(&painter, view, tips, [&text::endoscope_view::frozen(Duration::from_secs(2)), cure], Color32::RED);
    });
    output.textures_delta.clear();
    for clipped in output.shapes {
        if let egui::Shape::Rect(rect) = clipped.shape {
            plates.push(rect.rect);
        }
    }
    plates
}

#[test]
fn words_over_the_picture_never_cover_a_tip() {
    let free = plates(&[]);
    assert_eq!(free.len(), 1, "{free:?}");
    let covered = free[0].center();
    let other = plates(&[covered]);
    assert!(other.len() == 1 && !other[0].contains(covered), "{other:?}");
    let both = plates(&[covered, other[0].center()]);
    assert!(both.len() == 1 && !both[0].contains(covered) && !both[0].contains(other[0].center()), "{both:?}");
}
