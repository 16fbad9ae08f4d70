//! A hash for each shape: equal shapes have equal hashes; different ones differ except in one case in 2^64.
//!
//! Callbacks, which only the driver understands, are hashed by their address. That is safe as long as the compared
//! shapes are alive.

use std::{
    hash::{DefaultHasher, Hash as _, Hasher as _},
    sync::Arc,
};

use egui::{
    Galley, Mesh, Pos2, Rect, Shape, Stroke,
    epaint::{ClippedShape, ColorMode, PathStroke},
};

/// Returns the hash of a shape and its clip rectangle.
pub(super) fn of(shape: &ClippedShape) -> u64 {
    let mut hash = DefaultHasher::new();
    rect(&mut hash, &shape.clip_rect);
    let transform = shape.transform_after_tessellation;
    numbers(&mut hash, &[transform.scaling, transform.translation.x, transform.translation.y]);
    add(&mut hash, &shape.shape);
    hash.finish()
}

fn add(hash: &mut DefaultHasher, shape: &Shape) {
    std::mem::discriminant(shape).hash(hash);
    match shape {
        Shape::Noop => {}
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| add(hash, shape)),
        Shape::Circle(circle) => {
            points(hash, &[circle.center]);
            numbers(hash, &[circle.radius]);
            (circle.fill, circle.stroke).hash(hash);
        }
        Shape::Ellipse(ellipse) => {
            points(hash, &[ellipse.center, ellipse.radius.to_pos2()]);
            numbers(hash, &[ellipse.angle]);
            (ellipse.fill, ellipse.stroke).hash(hash);
        }
        Shape::LineSegment { points: ends, stroke } => {
            points(hash, ends);
            stroke.hash(hash);
        }
        Shape::Path(path) => {
            points(hash, &path.points);
            (path.closed, path.fill).hash(hash);
            path_stroke(hash, &path.stroke);
        }
        Shape::Band(band) => {
            for point in &band.points {
                numbers(hash, &[point.x, point.y.min, point.y.max]);
            }
            numbers(hash, &[band.angle]);
            (band.fill, band.stroke).hash(hash);
            std::mem::discriminant(&band.stroke_kind).hash(hash);
        }
        Shape::Rect(shape) => rectangle(hash, shape),
        Shape::Text(text) => {
            points(hash, &[text.pos]);
            numbers(hash, &[text.opacity_factor, text.angle]);
            galley(hash, &text.galley);
            (text.underline, text.fallback_color, text.override_text_color).hash(hash);
        }
        Shape::Mesh(shape) => mesh(hash, shape),
        Shape::QuadraticBezier(curve) => {
            points(hash, &curve.points);
            (curve.closed, curve.fill).hash(hash);
            path_stroke(hash, &curve.stroke);
        }
        Shape::CubicBezier(curve) => {
            points(hash, &curve.points);
            (curve.closed, curve.fill).hash(hash);
            path_stroke(hash, &curve.stroke);
        }
        Shape::Callback(callback) => {
            rect(hash, &callback.rect);
            Arc::as_ptr(&callback.callback).cast::<()>().hash(hash);
        }
    }
}

fn rectangle(hash: &mut DefaultHasher, shape: &egui::epaint::RectShape) {
    rect(hash, &shape.rect);
    numbers(hash, &[shape.blur_width, shape.angle]);
    let stroke: Stroke = shape.stroke;
    (shape.corner_radius, shape.fill, stroke, shape.round_to_pixels).hash(hash);
    std::mem::discriminant(&shape.stroke_kind).hash(hash);
    if let Some(brush) = &shape.brush {
        brush.fill_texture_id.hash(hash);
        rect(hash, &brush.uv);
    }
}

/// Text is hashed by its triangles: that of a disabled button is a new but equal object in every frame.
fn galley(hash: &mut DefaultHasher, galley: &Galley) {
    for row in &galley.rows {
        points(hash, &[row.pos]);
        mesh(hash, &row.row.visuals.mesh);
    }
}

fn mesh(hash: &mut DefaultHasher, mesh: &Mesh) {
    mesh.texture_id.hash(hash);
    mesh.indices.hash(hash);
    for vertex in &mesh.vertices {
        points(hash, &[vertex.pos, vertex.uv]);
        vertex.color.hash(hash);
    }
}

fn path_stroke(hash: &mut DefaultHasher, stroke: &PathStroke) {
    numbers(hash, &[stroke.width]);
    std::mem::discriminant(&stroke.kind).hash(hash);
    match &stroke.color {
        ColorMode::Solid(colour) => colour.hash(hash),
        ColorMode::UV(colours) => Arc::as_ptr(colours).cast::<()>().hash(hash),
    }
}

fn rect(hash: &mut DefaultHasher, rect: &Rect) {
    points(hash, &[rect.min, rect.max]);
}

fn points(hash: &mut DefaultHasher, points: &[Pos2]) {
    for point in points {
        numbers(hash, &[point.x, point.y]);
    }
}

fn numbers(hash: &mut DefaultHasher, numbers: &[f32]) {
    for number in numbers {
        hash.write_u32(number.to_bits());
    }
}
