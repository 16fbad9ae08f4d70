//! Which part of each pixel an outline covers.
//!
//! An edge that goes down through a pixel covers all that lies to its right: in its own pixel the part beside it, in every pixel further right
//! the part of a row that it goes through. Noted is the change from each pixel to the next; added up along a row that is how often the outline
//! goes around a pixel.

use kurbo::{PathEl, Point};

/// An edge stays so close to its curve, pixels.
const TOLERANCE: f64 = 0.02;

#[derive(Debug)]
pub(crate) struct Coverage {
    width: usize,
    height: usize,
    /// Changes along the rows, two more than there are pixels in each: edges at the right border note theirs behind it.
    changes: Vec<f64>,
}

impl Coverage {
    pub(crate) fn new(width: usize, height: usize) -> Self {
        Self { width, height, changes: vec![0.0; (width + 2) * height] }
    }

    /// Adds an outline. Its parts are closed, as letters are.
    pub(crate) fn fill(&mut self, path: impl IntoIterator<Item = PathEl>) {
        let (mut first, mut last) = (Point::ZERO, Point::ZERO);
        kurbo::flatten(path, TOLERANCE, |element| match element {
            PathEl::LineTo(to) => {
                self.edge(last, to);
                last = to;
            }
            PathEl::ClosePath => {
                self.edge(last, first);
                last = first;
            }
            PathEl::MoveTo(to) => {
                self.edge(last, first);
                (first, last) = (to, to);
            }
            // Curves come as lines.
            PathEl::QuadTo(..) | PathEl::CurveTo(..) => {}
        });
        self.edge(last, first);
    }

    /// Parts from 0 to 1, from the top left along the rows.
    pub(crate) fn parts(&self) -> impl Iterator<Item = f64> {
        self.changes.chunks(self.width + 2).flat_map(|row| {
            let around = row[..self.width].iter().scan(0.0, |around, change| {
                *around += change;
                Some(*around)
            });
            around.map(|around: f64| around.abs().min(1.0))
        })
    }

    /// One row after the other.
    fn edge(&mut self, from: Point, to: Point) {
        let (top, bottom, sign) = if from.y < to.y { (from, to, 1.0) } else { (to, from, -1.0) };
        if !(top.y < bottom.y && top.is_finite() && bottom.is_finite()) {
            return;
        }
        let x_at = |y: f64| top.x + (y - top.y) / (bottom.y - top.y) * (bottom.x - top.x);
        let last = self.height as f64;
        for row in top.y.clamp(0.0, last) as usize..bottom.y.clamp(0.0, last).ceil() as usize {
            let (begin, end) = (top.y.max(row as f64), bottom.y.min((row + 1) as f64));
            self.edge_in_row(row, [x_at(begin), x_at(end)], sign * (end - begin));
        }
    }

    /// An edge that goes down by `height` within a row, one pixel after the other. What is left or right of the picture counts as at its border.
    fn edge_in_row(&mut self, row: usize, [from, to]: [f64; 2], height: f64) {
        let (left, right) = (from.min(to), from.max(to));
        let at = row * (self.width + 2);
        let mut x = left;
        loop {
            let inside = x.clamp(0.0, self.width as f64);
            let pixel = inside as usize;
            // A pixel ends at its right side; what is outside is one piece.
            let end = if x < 0.0 {
                right.min(0.0)
            } else if pixel < self.width {
                right.min((pixel + 1) as f64)
            } else {
                right
            };
            let part = if right > left { height * (end - x) / (right - left) } else { height };
            let beside = f64::midpoint(inside, end.clamp(0.0, self.width as f64)) - pixel as f64;
            self.changes[at + pixel] += part * (1.0 - beside);
            self.changes[at + pixel + 1] += part * beside;
            if end >= right {
                return;
            }
            x = end;
        }
    }
}

#[cfg(test)]
mod tests {
    use kurbo::{BezPath, Circle, Rect, Shape as _};

    use super::*;

    fn parts_of(width: usize, height: usize, paths: &[BezPath]) -> Vec<f64> {
        let mut coverage = Coverage::new(width, height);
        for path in paths {
            coverage.fill(path);
        }
        coverage.parts().collect()
    }

    #[track_caller]
    fn assert_near(parts: &[f64], expected: &[f64]) {
        assert_eq!(parts.len(), expected.len());
        let near = parts.iter().zip(expected).all(|(part, expected)| (part - expected).abs() < 1e-9);
        assert!(near, "{parts:?}, expected {expected:?}");
    }

    fn polygon(points: &[(f64, f64)]) -> BezPath {
        let mut path = BezPath::new();
        path.move_to(points[0]);
        for point in &points[1..] {
            path.line_to(*point);
        }
        path.close_path();
        path
    }

    #[test]
    fn a_pixel_gets_the_part_of_its_area_whichever_way_the_outline_goes() {
        let rectangle = [(0.5, 0.25), (2.75, 0.25), (2.75, 1.5), (0.5, 1.5)];
        let expected = [0.375, 0.75, 0.5625, 0.25, 0.5, 0.375];
        assert_near(&parts_of(3, 2, &[polygon(&rectangle)]), &expected);
        let mut back = rectangle;
        back.reverse();
        assert_near(&parts_of(3, 2, &[polygon(&back)]), &expected);
    }

    #[test]
    fn a_slanted_edge_cuts_its_pixels() {
        // From the top left to the bottom right, two pixels for each row.
        let triangle = polygon(&[(0.0, 0.0), (4.0, 2.0), (0.0, 2.0)]);
        assert_near(&parts_of(4, 2, &[triangle]), &[0.75, 0.25, 0.0, 0.0, 1.0, 1.0, 0.75, 0.25]);
    }

    #[test]
    fn a_circle_has_its_area_and_a_hole_is_empty() {
        let outer = Circle::new((8.0, 8.0), 7.0).to_path(1e-3);
        let area = |paths: &[BezPath]| parts_of(16, 16, paths).iter().sum::<f64>();
        assert!((area(std::slice::from_ref(&outer)) / (std::f64::consts::PI * 49.0) - 1.0).abs() < 0.005);
        let hole = polygon(&[(6.0, 6.0), (6.0, 10.0), (10.0, 10.0), (10.0, 6.0)]);
        let hole = if outer.area() * hole.area() < 0.0 { hole } else { hole.reverse_subpaths() };
        let ring = parts_of(16, 16, &[outer, hole]);
        assert!(ring[8 * 16 + 8].abs() < 1e-9 && (ring[8 * 16 + 4] - 1.0).abs() < 1e-9);
    }

    #[test]
    fn parts_of_a_letter_that_overlap_are_no_fuller_than_full() {
        let (one, other) = (Rect::new(0.0, 0.0, 2.0, 1.0).to_path(0.1), Rect::new(1.0, 0.0, 3.0, 1.0).to_path(0.1));
        assert_near(&parts_of(3, 1, &[one, other]), &[1.0; 3]);
    }

    #[test]
    fn what_is_outside_the_picture_or_no_number_does_no_harm() {
        let large = polygon(&[(-5.0, -5.0), (9.0, -5.0), (9.0, 9.0), (-5.0, 9.0)]);
        assert_near(&parts_of(2, 2, &[large]), &[1.0; 4]);
        let beside = polygon(&[(5.0, 0.0), (6.5, 0.0), (6.5, 2.0), (5.0, 2.0)]);
        assert_near(&parts_of(2, 2, &[beside]), &[0.0; 4]);
        let slanted = polygon(&[(-4.0, 0.0), (4.0, 0.0), (-4.0, 2.0)]);
        assert_near(&parts_of(1, 1, &[slanted]), &[0.875]);
        assert_near(&parts_of(2, 2, &[polygon(&[(f64::NAN, 0.0), (1.0, f64::INFINITY), (0.0, 1.0)])]), &[0.0; 4]);
        assert_near(&parts_of(0, 0, &[polygon(&[(0.0, 0.0), (1.0, 1.0), (0.0, 1.0)])]), &[]);
    }

    #[test]
    fn an_outline_that_is_left_open_is_closed() {
        let mut path = BezPath::new();
        path.move_to((0.0, 0.0));
        path.line_to((1.0, 0.0));
        path.line_to((1.0, 1.0));
        path.line_to((0.0, 1.0));
        path.move_to((1.0, 0.0));
        path.line_to((2.0, 0.0));
        path.line_to((2.0, 1.0));
        path.line_to((1.0, 1.0));
        assert_near(&parts_of(2, 1, &[path]), &[1.0, 1.0]);
    }
}
