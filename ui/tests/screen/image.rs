//! Pictures of the window, compared with those in `stored/`. They are drawn without a GPU: egui's triangles are filled here,
//! in grey, and reduced to a quarter. Content drawn only by OpenGL stays empty, and images within the window are plain
//! rectangles.
//!
//! Numbers vary with the clock of the computer, so each text with a digit is drawn as a bar of its size. Timing and ports of
//! this computer are covered, and names of temporary folders are missing.

use std::{env, fs, path::Path, time::Duration};

use egui::{
    Color32, ColorImage, Pos2, Rect, Shape, TextureId, Vec2,
    epaint::{ClippedShape, Primitive, Vertex},
};
use egui_kittest::{Harness, kittest::Queryable as _};
use image::GrayImage;
use nima_screen::theme;

use crate::bench::comes;

/// Points of the window per pixel of a picture, in each direction.
const SHRUNK: usize = 4;
/// Greys are stored in steps of this size, which makes the files small.
const GREY_STEP: f32 = 16.0;
/// Side of the squares that are compared, pixels: 16 points, the height of a line of text.
const SQUARE: u32 = 4;
/// Mean difference of grey in a square, of 255, above which the images differ. The steps of grey are 4 on average,
/// another antialiasing of the same letters 3; a word that is missing or has moved by half a letter is 25.
const TOLERANCE: f32 = 12.0;
/// Colour of the bars instead of texts with a digit.
const BAR: Color32 = Color32::GRAY;

/// Smallest width of a bar: that of "100 s".
const BAR_WIDTH_MIN: f32 = 36.0;

/// Longest time in which a busy computer finishes drawing.
const SETTLING_TIME: Duration = Duration::from_secs(10);

/// Returns the difference of the window from its stored image; `None` if there is none. `UPDATE_SNAPSHOTS=1` stores
/// the new one.
fn differs_now<A>(window: &Harness<'_, A>, name: &str) -> Option<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/screen/stored").join(name).with_extension("png");
    let now = drawn(window);
    let stored = image::open(&path).map(image::DynamicImage::into_luma8);
    let why = match &stored {
        Ok(stored) => difference(stored, &now)?,
        Err(error) => error.to_string(),
    };
    let is_meant = env::var_os("UPDATE_SNAPSHOTS").is_some();
    let new = if is_meant {
        path.clone()
    } else {
        Path::new(env!("CARGO_TARGET_TMPDIR")).join("pictures").join(name).with_extension("png")
    };
    fs::create_dir_all(new.parent().unwrap()).unwrap();
    now.save(&new).unwrap();
    let report = format!(
        "{name} looks different: {why}\n  stored: {}\n  now:    {}\n  if this is meant, store it: UPDATE_SNAPSHOTS=1 cargo test -p nima-console --test screen",
        path.display(),
        new.display()
    );
    (!is_meant).then_some(report)
}

/// Returns the difference that remains after a while: the window may still be drawing, or the loop catching up.
pub(crate) fn differs<A>(window: &mut Harness<'_, A>, name: &str) -> Option<String> {
    let stores = env::var_os("UPDATE_SNAPSHOTS").is_some();
    comes(window, SETTLING_TIME, |window| !stores && differs_now(window, name).is_none());
    differs_now(window, name)
}

/// Checks that the window comes to look like its stored image.
pub(crate) fn same<A>(window: &mut Harness<'_, A>, name: &str) {
    if let Some(difference) = differs(window, name) {
        panic!("{difference}");
    }
}

/// Returns the place and size of the largest difference.
fn difference(stored: &GrayImage, now: &GrayImage) -> Option<String> {
    if stored.dimensions() != now.dimensions() {
        return Some(format!("{:?} pixels were {:?}", now.dimensions(), stored.dimensions()));
    }
    let (width, height) = now.dimensions();
    let in_square = |left: u32, top: u32| {
        let places =
            (top..height.min(top + SQUARE)).flat_map(|y| (left..width.min(left + SQUARE)).map(move |x| (x, y)));
        let differences = places.map(|(x, y)| f32::from(stored.get_pixel(x, y)[0].abs_diff(now.get_pixel(x, y)[0])));
        let differences: Vec<f32> = differences.collect();
        differences.iter().sum::<f32>() / differences.len() as f32
    };
    let squares = (0..height)
        .step_by(SQUARE as usize)
        .flat_map(|top| (0..width).step_by(SQUARE as usize).map(move |left| (left, top)));
    let differing: Vec<_> =
        squares.map(|(left, top)| (in_square(left, top), left, top)).filter(|(by, ..)| *by > TOLERANCE).collect();
    let (by, left, top) = differing.iter().copied().max_by(|one, other| one.0.total_cmp(&other.0))?;
    let at = [left, top].map(|pixels| pixels * SHRUNK as u32);
    Some(format!("{} squares of 16 points, most at {at:?} points, by {by:.0} of 255", differing.len()))
}

/// Returns an image of the window.
fn drawn<A>(window: &Harness<'_, A>) -> GrayImage {
    let Vec2 { x, y } = window.ctx.content_rect().size();
    assert!((window.ctx.pixels_per_point() - 1.0).abs() < 1e-6, "a pixel is a point");
    let mut sheet = GreyImage { width: x as usize, greys: vec![0.0; x as usize * y as usize] };
    #[expect(clippy::redundant_closure_for_method_calls, reason = "the method itself is for one lifetime only")]
    let letters = window.ctx.fonts(|fonts| fonts.image());
    let barred = |clipped: &ClippedShape| ClippedShape { shape: without_numbers(&clipped.shape), ..clipped.clone() };
    let covers =
        of_this_computer(window).into_iter().map(|place| ClippedShape::new(place, Shape::rect_filled(place, 0.0, BAR)));
    let shapes = window.output().shapes.iter().map(barred).chain(covers).collect();
    for clipped in window.ctx.tessellate(shapes, 1.0) {
        let Primitive::Mesh(mesh) = clipped.primitive else { continue };
        let letters = (mesh.texture_id == TextureId::default()).then_some(&letters);
        for corners in mesh.triangles() {
            sheet.fill(corners.map(|corner| &mesh.vertices[corner as usize]), clipped.clip_rect, letters);
        }
    }
    sheet.shrunk()
}

/// Areas that depend on the computer: the figures of timing, and the devices on the start page.
fn of_this_computer<A>(window: &Harness<'_, A>) -> Vec<Rect> {
    let timing = window.query_all_by_label_contains("histogram").chain(window.query_all_by_label("\u{b5}s"));
    let ports = window.query_all_by_label("Plugged into this computer").map(|node| node.rect());
    let below = ports.map(|title| Rect::from_min_max(title.left_bottom(), window.ctx.content_rect().max).expand(16.0));
    // The scroll bar next to these areas changes with their length.
    let with_bar = |area: Rect| area.with_max_x(area.max.x + 16.0);
    timing.map(|node| node.rect()).reduce(Rect::union).map(with_bar).into_iter().chain(below).collect()
}

fn without_numbers(shape: &Shape) -> Shape {
    match shape {
        Shape::Vec(shapes) => Shape::Vec(shapes.iter().map(without_numbers).collect()),
        Shape::Text(text) if text.galley.text().starts_with(&*env::temp_dir().to_string_lossy()) => Shape::Noop,
        Shape::Text(text) if text.galley.text().contains(|letter: char| letter.is_ascii_digit()) => {
            // The room of the digits, not their ink: each has another margin. A count that loses a digit keeps its room.
            let mut room = text.galley.rect.translate(text.pos.to_vec2());
            room.set_width(room.width().max(BAR_WIDTH_MIN));
            Shape::rect_filled(room, 0.0, BAR)
        }
        _ => shape.clone(),
    }
}

/// The window in greys, 0 to 255.
struct GreyImage {
    width: usize,
    greys: Vec<f32>,
}

/// A number over a triangle: its value at the origin, and its gradients in x and y.
type Plane = [f32; 3];

impl GreyImage {
    /// Fills the part of a triangle within `clip`. Pixels belong to the triangle that contains their centre, so that
    /// neighbours never share one.
    fn fill(&mut self, corners: [&Vertex; 3], clip: Rect, letters: Option<&ColorImage>) {
        let [a, b, c] = corners.map(|corner| corner.pos);
        let doubled_area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        if doubled_area.abs() < 1e-6 {
            return;
        }
        // The weight of a corner is 1 there, and 0 along the opposite edge.
        let weight = |from: Pos2, to: Pos2| -> Plane {
            let [per_x, per_y] = [(from.y - to.y) / doubled_area, (to.x - from.x) / doubled_area];
            [-per_x * from.x - per_y * from.y, per_x, per_y]
        };
        let weights = [weight(b, c), weight(c, a), weight(a, b)];
        let plane = |values: [f32; 3]| -> Plane {
            [0, 1, 2].map(|i| weights.iter().zip(values).map(|(weight, value)| weight[i] * value).sum())
        };
        let [grey, alpha] = [
            plane(corners.map(|corner| grey(corner.color))),
            plane(corners.map(|corner| f32::from(corner.color.a()) / 255.0)),
        ];
        let uv = [plane(corners.map(|corner| corner.uv.x)), plane(corners.map(|corner| corner.uv.y))];
        let is_plain = corners.iter().all(|corner| corner.uv == corners[0].uv && corner.color == corners[0].color);
        let bounds = Rect::from_points(&[a, b, c]).intersect(clip);
        let height = self.greys.len() / self.width;
        for row in from_centre(bounds.top())..from_centre(bounds.bottom()).min(height) {
            let y = row as f32 + 0.5;
            let mut left = bounds.left();
            let mut right = bounds.right();
            for [at, per_x, per_y] in weights {
                let rest = at + per_y * y;
                if per_x > 0.0 {
                    left = left.max(-rest / per_x);
                } else if per_x < 0.0 {
                    right = right.min(-rest / per_x);
                }
            }
            let columns = from_centre(left)..from_centre(right).min(self.width);
            let Some(greys) = self.greys[row * self.width..].get_mut(columns.clone()) else { continue };
            let at = |plane: Plane, column: usize| plane[0] + plane[1] * (column as f32 + 0.5) + plane[2] * y;
            let covers =
                |column: usize| letters.map_or(1.0, |letters| covered(letters, uv.map(|plane| at(plane, column))));
            if is_plain {
                let covered = covers(columns.start);
                let [add, keep] = [at(grey, columns.start) * covered, 1.0 - at(alpha, columns.start) * covered];
                for value in greys {
                    *value = add + keep * *value;
                }
                continue;
            }
            for (value, column) in greys.iter_mut().zip(columns) {
                let covered = covers(column);
                *value = at(grey, column) * covered + (1.0 - at(alpha, column) * covered) * *value;
            }
        }
    }

    /// Returns the means of squares, in steps.
    fn shrunk(&self) -> GrayImage {
        let height = self.greys.len() / self.width;
        let mean = |x: u32, y: u32| {
            let [left, top] = [x, y].map(|pixels| pixels as usize * SHRUNK);
            let rows = (top..top + SHRUNK).map(|row| &self.greys[row * self.width + left..][..SHRUNK]);
            rows.flatten().sum::<f32>() / (SHRUNK * SHRUNK) as f32
        };
        let pixel = |x, y| image::Luma([((mean(x, y) / GREY_STEP).round() * GREY_STEP).clamp(0.0, 255.0) as u8]);
        GrayImage::from_fn((self.width / SHRUNK) as u32, (height / SHRUNK) as u32, pixel)
    }
}

/// Returns the first pixel whose centre is not before this position.
fn from_centre(place: f32) -> usize {
    (place - 0.5).ceil().max(0.0) as usize
}

/// Not the brightness: red, green and blue of the same brightness must differ.
fn grey(colour: Color32) -> f32 {
    0.5 * f32::from(colour.r()) + 0.35 * f32::from(colour.g()) + 0.15 * f32::from(colour.b())
}

/// Coverage of this position by a letter.
fn covered(letters: &ColorImage, uv: [f32; 2]) -> f32 {
    let [x, y] = [0, 1].map(|i| ((uv[i] * letters.size[i] as f32) as usize).min(letters.size[i] - 1));
    f32::from(letters.pixels[y * letters.size[0] + x].a()) / 255.0
}

#[test]
fn a_word_that_is_gone_or_has_moved_makes_a_difference_and_a_number_none() {
    let image = |text: &'static str, left: f32| {
        drawn(&Harness::builder().with_size([240.0, 80.0]).with_context_setup(theme::apply).build_ui(move |ui| {
            ui.add_space(20.0);
            ui.horizontal(|ui| {
                ui.add_space(left);
                ui.label(text);
            });
        }))
    };
    let before = image("Engage the arm", 40.0);
    assert_eq!(difference(&before, &image("Engage the arm", 40.0)), None);
    for (text, left) in [("Engage the", 40.0), ("Engage an arm", 40.0), ("Engage the arm", 44.0), (" ", 40.0)] {
        assert!(difference(&before, &image(text, left)).is_some(), "{text} at {left}");
    }
    assert_eq!(difference(&image("12.3 N", 40.0), &image("45.6 N", 40.0)), None);
    assert!(difference(&image("12.3 N", 40.0), &image(" ", 40.0)).is_some());
}
