//! Redraws only the changed parts, if a software renderer is used.
//!
//! egui describes the whole window in every frame, and its painter draws all of it. With a software renderer that is most of
//! a frame's cost: 1.6 million pixels are shaded and blended to change a few numbers. Here the shapes of a frame are compared
//! with those of the previous one; the differences give a few rectangles, and only the shapes that overlap these are drawn,
//! over the image that is already in the window (`surface`). The result is identical, pixel by pixel. With a GPU this module
//! is not used.

mod print;
mod surface;

use std::{collections::HashMap, sync::Arc};

use egui::{Color32, Context, FullOutput, Rect, Shape, Ui, ViewportId, epaint::ClippedShape, pos2};

pub use surface::{Surface, renderer_of};

/// A shape may extend beyond its bounds by the width of its antialiased edge, points.
const EDGE: f32 = 2.0;
/// Maximum number of rectangles; more would take more time than they save.
const RECTANGLES_MAX: usize = 24;

/// The whole window is drawn once in this many frames, so that the display never depends on comparisons alone.
const WHOLE_EVERY: u64 = 150;

/// Compares each frame with the previous one, for each window.
#[derive(Debug)]
pub struct Canvas {
    surface: Arc<Surface>,
    windows: HashMap<ViewportId, WindowCanvas>,
    /// The window whose frame ends, and its rectangle: the output names neither.
    ends: (ViewportId, Rect),
    background: fn() -> Color32,
}

#[derive(Debug)]
struct WindowCanvas {
    surface: Arc<Surface>,
    /// The shapes on the surface. Kept alive, so that no address that is part of a hash is reused.
    before: Vec<ClippedShape>,
    prints: Vec<u64>,
    ground: CanvasGround,
    /// Number of the frame that `before` belongs to.
    frame: u64,
}

/// Properties of the window as a whole.
#[derive(Clone, Copy, Debug, PartialEq)]
struct CanvasGround {
    rect: Rect,
    pixels_per_point: f32,
    background: Color32,
}

impl Canvas {
    /// Keeps the image of the main window on this surface, over this background.
    pub fn new(surface: Arc<Surface>, background: fn() -> Color32) -> Self {
        Self { surface, windows: HashMap::new(), ends: (ViewportId::ROOT, Rect::NOTHING), background }
    }

    /// Returns the image in the window whose frame ends.
    fn window(&mut self) -> &mut WindowCanvas {
        let (id, _) = self.ends;
        let main = &self.surface;
        let surface = || if id == ViewportId::ROOT { Arc::clone(main) } else { main.of_another_window() };
        self.windows.entry(id).or_insert_with(|| WindowCanvas::new(surface()))
    }
}

impl WindowCanvas {
    fn new(surface: Arc<Surface>) -> Self {
        let ground = CanvasGround { rect: Rect::NOTHING, pixels_per_point: 0.0, background: Color32::TRANSPARENT };
        Self { surface, before: Vec::new(), prints: Vec::new(), ground, frame: 0 }
    }

    /// Returns the parts of the window that these shapes change, in points.
    fn changed(&self, shapes: &[ClippedShape], prints: &[u64], ground: CanvasGround) -> Vec<Rect> {
        if ground != self.ground || self.frame.is_multiple_of(WHOLE_EVERY) || !self.surface.shows(self.frame) {
            return vec![ground.rect];
        }
        let Some(rects) = differences((&self.before, &self.prints), (shapes, prints)) else { return vec![ground.rect] };
        // Round to whole pixels, so that neighbouring pixels are not affected.
        let whole = |x: f32, up: bool| {
            let pixels = x * ground.pixels_per_point;
            (if up { pixels.ceil() } else { pixels.floor() }) / ground.pixels_per_point
        };
        let rects = rects.into_iter().map(|rect| {
            let rect = rect.expand(EDGE);
            Rect::from_min_max(
                pos2(whole(rect.min.x, false), whole(rect.min.y, false)),
                pos2(whole(rect.max.x, true), whole(rect.max.y, true)),
            )
            .intersect(ground.rect)
        });
        apart(rects.filter(Rect::is_positive).collect(), shapes)
    }
}

impl egui::Plugin for Canvas {
    fn debug_name(&self) -> &'static str {
        "canvas"
    }

    fn on_end_pass(&mut self, ui: &mut Ui) {
        self.ends = (ui.ctx().viewport_id(), ui.ctx().viewport_rect());
    }

    fn output_hook(&mut self, ctx: &Context, output: &mut FullOutput) {
        let (_, rect) = self.ends;
        let ground = CanvasGround { rect, pixels_per_point: output.pixels_per_point, background: (self.background)() };
        let shapes = std::mem::take(&mut output.shapes);
        output.shapes = self.window().frame(ctx, shapes, ground);
    }
}

impl WindowCanvas {
    /// Returns the shapes that change the image in the window to these.
    fn frame(&mut self, ctx: &Context, shapes: Vec<ClippedShape>, ground: CanvasGround) -> Vec<ClippedShape> {
        let callback = |work| {
            let shape = Shape::Callback(egui::PaintCallback { rect: ground.rect, callback: Arc::new(work) });
            ClippedShape::new(ground.rect, shape)
        };
        let size = ground.rect.size() * ground.pixels_per_point;
        if self.surface.is_refused() {
            // Another window may have left its own framebuffer bound, so the clearing of eframe may have missed this one.
            let begin = self.surface.begin(size, true, &[ground.rect], ground.background);
            return std::iter::once(callback(begin)).chain(shapes).collect();
        }
        let prints: Vec<u64> = shapes.iter().map(print::of).collect();
        let rects = self.changed(&shapes, &prints, ground);
        let area: f32 = rects.iter().map(Rect::area).sum();
        self.frame += 1;
        let fraction = f64::from(area / ground.rect.area().max(1.0));
        let begin = self.surface.begin(size, rects == [ground.rect], &rects, ground.background);
        let mut drawn = vec![callback(begin)];
        for rect in rects {
            let touching = shapes.iter().filter(|shape| bounds(shape).intersects(rect));
            drawn.extend(
                touching.map(|shape| ClippedShape { clip_rect: shape.clip_rect.intersect(rect), ..shape.clone() }),
            );
        }
        drawn.push(callback(self.surface.end(ctx, self.frame, fraction, ground.background)));
        self.before = shapes;
        self.prints = prints;
        self.ground = ground;
        drawn
    }
}

/// Returns the part of the window that a shape may touch.
fn bounds(shape: &ClippedShape) -> Rect {
    let own = shape.shape.visual_bounding_rect();
    (shape.transform_after_tessellation * own).expand(EDGE).intersect(shape.clip_rect)
}

/// Returns the bounds of the shapes that are in only one of two frames; `None` if the common shapes are not in the same
/// order.
fn differences(before: (&[ClippedShape], &[u64]), now: (&[ClippedShape], &[u64])) -> Option<Vec<Rect>> {
    let mut counts: HashMap<u64, [u32; 2]> = HashMap::with_capacity(now.1.len());
    for (which, prints) in [before.1, now.1].into_iter().enumerate() {
        for print in prints {
            counts.entry(*print).or_default()[which] += 1;
        }
    }
    let in_both = |print: &&u64| counts.get(*print).is_some_and(|[was, is]| was == is);
    if !before.1.iter().filter(in_both).eq(now.1.iter().filter(in_both)) {
        return None;
    }
    let mut rects = Vec::new();
    for (shapes, prints) in [before, now] {
        let differing = shapes.iter().zip(prints).filter(|(_, print)| !in_both(print)).map(|(shape, _)| bounds(shape));
        rects.extend(differing.filter(Rect::is_positive));
    }
    Some(rects)
}

/// Returns rectangles that do not overlap and cover all of these. A shape drawn by a callback is drawn completely or
/// not at all.
fn apart(mut rects: Vec<Rect>, shapes: &[ClippedShape]) -> Vec<Rect> {
    let callbacks: Vec<Rect> =
        shapes.iter().filter(|shape| matches!(shape.shape, Shape::Callback(_))).map(bounds).collect();
    loop {
        for callback in &callbacks {
            let touched = rects.iter().any(|rect| rect.intersects(*callback));
            if touched && !rects.iter().any(|rect| rect.contains_rect(*callback)) {
                rects.push(*callback);
            }
        }
        let count = rects.len();
        rects = joined(rects);
        if rects.len() == count {
            break;
        }
    }
    // If there are too many, merge neighbours in the list, which are usually close on the screen.
    while rects.len() > RECTANGLES_MAX {
        let pairs = rects.chunks(2).map(|pair| pair.iter().copied().reduce(Rect::union).unwrap_or(Rect::NOTHING));
        rects = apart(pairs.collect(), shapes);
    }
    rects
}

/// Merges each rectangle with those that it overlaps, in one pass.
fn joined(rects: Vec<Rect>) -> Vec<Rect> {
    let mut apart: Vec<Rect> = Vec::new();
    for mut rect in rects {
        while let Some(touching) = apart.iter().position(|other| other.intersects(rect)) {
            rect = rect.union(apart.swap_remove(touching));
        }
        apart.push(rect);
    }
    apart
}

#[cfg(test)]
mod tests {
    use egui::{Stroke, epaint::RectShape, vec2};

    use super::*;

    fn square(x: f32, y: f32, colour: Color32) -> ClippedShape {
        let rect = Rect::from_min_size(pos2(x, y), vec2(10.0, 10.0));
        let clip_rect = Rect::from_min_size(pos2(0.0, 0.0), vec2(1000.0, 1000.0));
        ClippedShape::new(clip_rect, RectShape::filled(rect, 0.0, colour))
    }

    fn found(before: &[ClippedShape], now: &[ClippedShape]) -> Option<Vec<Rect>> {
        let prints = |shapes: &[ClippedShape]| shapes.iter().map(print::of).collect::<Vec<_>>();
        differences((before, &prints(before)), (now, &prints(now)))
    }

    #[test]
    fn a_window_is_not_compared_with_another_one() {
        let rect = Rect::from_min_size(pos2(0.0, 0.0), vec2(1000.0, 1000.0));
        let ground = CanvasGround { rect, pixels_per_point: 1.0, background: Color32::BLACK };
        let mut canvas = Canvas::new(Arc::default(), || Color32::BLACK);
        let [main, other] = [ViewportId::ROOT, ViewportId::from_hash_of("other")];
        for (id, colour) in [(main, Color32::RED), (other, Color32::BLUE), (main, Color32::RED)] {
            canvas.ends = (id, rect);
            drop(canvas.window().frame(&Context::default(), vec![square(0.0, 0.0, colour)], ground));
        }
        let prints = |id| canvas.windows[&id].prints.clone();
        assert_eq!(prints(main), [print::of(&square(0.0, 0.0, Color32::RED))]);
        assert_eq!(prints(other), [print::of(&square(0.0, 0.0, Color32::BLUE))]);
        assert_eq!([main, other].map(|id| canvas.windows[&id].frame), [2, 1]);
        assert!(!Arc::ptr_eq(&canvas.windows[&main].surface, &canvas.windows[&other].surface));
    }

    #[test]
    fn only_what_differs_is_drawn_where_it_was_and_where_it_is() {
        let stays = [square(0.0, 0.0, Color32::RED), square(100.0, 0.0, Color32::RED)];
        let frame = |moving: ClippedShape| vec![stays[0].clone(), moving, stays[1].clone()];
        let before = frame(square(300.0, 300.0, Color32::BLUE));
        let now = frame(square(500.0, 300.0, Color32::BLUE));
        assert_eq!(found(&before, &before), Some(vec![]));
        let rects = apart(found(&before, &now).unwrap(), &now);
        assert_eq!(rects.len(), 2);
        assert!(rects.iter().any(|rect| rect.contains(pos2(305.0, 305.0))));
        assert!(rects.iter().any(|rect| rect.contains(pos2(505.0, 305.0))));
        assert!(!rects.iter().any(|rect| rect.contains(pos2(5.0, 5.0))));
    }

    #[test]
    fn what_changes_its_place_in_the_pile_draws_everything() {
        let one = square(0.0, 0.0, Color32::RED);
        let other = square(5.0, 5.0, Color32::BLUE);
        assert_eq!(found(&[one.clone(), other.clone()], &[other, one]), None);
    }

    #[test]
    fn a_shape_that_goes_or_comes_is_a_difference() {
        let one = square(0.0, 0.0, Color32::RED);
        let other = square(200.0, 5.0, Color32::BLUE);
        let both = [one.clone(), other.clone()];
        let alone = std::slice::from_ref(&one);
        for rects in [found(&both, alone).unwrap(), found(alone, &both).unwrap()] {
            assert_eq!(rects.len(), 1);
            assert!(rects[0].contains(pos2(205.0, 10.0)));
        }
        let twice = [one.clone(), one.clone()];
        assert!(!found(&twice, &[one]).unwrap().is_empty(), "twice over one another is darker than once");
    }

    #[test]
    fn rectangles_that_touch_become_one_and_a_callback_is_never_cut() {
        let rect = |x: f32| Rect::from_min_size(pos2(x, 0.0), vec2(10.0, 10.0));
        let far = Rect::from_min_size(pos2(800.0, 800.0), vec2(5.0, 5.0));
        let rects = apart(vec![rect(0.0), far, rect(9.0), rect(18.0)], &[]);
        assert_eq!(rects.len(), 2);
        assert!(rects.contains(&Rect::from_min_max(pos2(0.0, 0.0), pos2(28.0, 10.0))));
        let view = Rect::from_min_size(pos2(20.0, 0.0), vec2(300.0, 200.0));
        let shape = Shape::Callback(egui::PaintCallback { rect: view, callback: Arc::new(()) });
        let drawn = ClippedShape::new(Rect::EVERYTHING, shape);
        let rects = apart(vec![rect(0.0), rect(25.0)], &[drawn]);
        assert!(rects.iter().any(|rect| rect.contains_rect(view)));
        assert!(!rects.iter().any(|one| rects.iter().any(|two| one != two && one.intersects(*two))));
    }

    #[test]
    fn very_many_places_become_few_and_none_is_lost() {
        let places: Vec<Rect> = (0..400)
            .map(|i| Rect::from_min_size(pos2((i % 20) as f32 * 40.0, (i / 20) as f32 * 40.0), vec2(8.0, 8.0)))
            .collect();
        let rects = apart(places.clone(), &[]);
        assert!(rects.len() <= RECTANGLES_MAX, "{}", rects.len());
        assert!(places.iter().all(|place| rects.iter().any(|rect| rect.contains_rect(*place))));
    }

    #[test]
    fn every_kind_of_change_changes_the_print() {
        let base = square(0.0, 0.0, Color32::RED);
        let mut clipped = base.clone();
        clipped.clip_rect.max.x = 5.0;
        let line = |x: f32, width: f32| {
            ClippedShape::new(
                base.clip_rect,
                Shape::line_segment([pos2(0.0, 0.0), pos2(x, 1.0)], Stroke::new(width, Color32::RED)),
            )
        };
        let path = |x: f32, colour| {
            ClippedShape::new(
                base.clip_rect,
                Shape::line(vec![pos2(0.0, 0.0), pos2(x, 1.0), pos2(9.0, 9.0)], Stroke::new(1.0, colour)),
            )
        };
        let all = [
            base.clone(),
            clipped,
            square(0.0, 1.0, Color32::RED),
            square(0.0, 0.0, Color32::BLUE),
            line(1.0, 1.0),
            line(2.0, 1.0),
            line(1.0, 2.0),
            path(1.0, Color32::RED),
            path(2.0, Color32::RED),
            path(1.0, Color32::BLUE),
        ];
        for (i, one) in all.iter().enumerate() {
            for (k, other) in all.iter().enumerate() {
                assert_eq!(print::of(one) == print::of(&other.clone()), i == k, "{i} and {k}");
            }
        }
    }
}
