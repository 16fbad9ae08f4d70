//! The checkerboard for camera calibration: its geometry, its printout, and its rendered image (for emulators and
//! tests).
//!
//! A board is named by its inner corners, where four squares meet. One of the two numbers is odd and the other even, so
//! that the board looks different upside down. Its frame: the origin at the first inner corner, next to the black
//! square in the corner of the board; x along the first number, y along the second, z away from the viewer, m.

use std::{fmt::Write as _, str::FromStr};

use nalgebra::{Isometry3, Vector2, Vector3};

use crate::Lens;

/// Inner corners along a side.
const CORNERS: std::ops::RangeInclusive<usize> = 3..=40;
/// Side of a square, m.
pub const SQUARE_M: std::ops::RangeInclusive<f64> = 0.000_5..=0.2;
/// White margin around the squares, in squares.
const MARGIN: f64 = 1.0;
/// Samples along each side of a pixel that contains an edge.
const SAMPLES: usize = 6;
/// Grey values of the printed squares, the paper, and the background.
const BLACK: f64 = 28.0;
const WHITE: f64 = 222.0;
const BEHIND: f64 = 92.0;

/// A checkerboard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Checkerboard {
    /// Inner corners along x and y.
    corners: [usize; 2],
    square_m: f64,
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BoardError {
    /// Not written as two numbers.
    #[error("\"{0}\" is not a board size; enter the number of inner corners, such as 9x6")]
    Text(String),
    /// A side has too few or too many corners.
    #[error("a board cannot have {0} inner corners along a side; use {min} to {max}", min = CORNERS.start(), max = CORNERS.end())]
    Corners(usize),
    #[error("a board of {0}x{1} inner corners looks the same upside down; use an odd and an even number, such as 9x6")]
    Ambiguous(usize, usize),
    #[error("squares cannot have a side of {0} mm; use {min} to {max} mm", min = SQUARE_M.start() * 1e3, max = SQUARE_M.end() * 1e3)]
    Square(f64),
}

/// Inner corners along both sides, written as `9x6`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoardCorners(pub [usize; 2]);

impl FromStr for BoardCorners {
    type Err = BoardError;

    fn from_str(text: &str) -> Result<Self, BoardError> {
        let sides =
            text.split_once(['x', 'X']).and_then(|(a, b)| Some([a.trim().parse().ok()?, b.trim().parse().ok()?]));
        sides.map(Self).ok_or_else(|| BoardError::Text(text.to_owned()))
    }
}

impl Checkerboard {
    /// Creates a board with these inner corners and this side of a square.
    ///
    /// # Errors
    /// [`BoardError`] for a size out of range, or a board that looks the same upside down.
    pub fn new(corners @ [across, down]: [usize; 2], square_m: f64) -> Result<Self, BoardError> {
        if let Some(side) = corners.into_iter().find(|side| !CORNERS.contains(side)) {
            return Err(BoardError::Corners(side));
        }
        if (across + down) % 2 == 0 {
            return Err(BoardError::Ambiguous(across, down));
        }
        if !SQUARE_M.contains(&square_m) {
            return Err(BoardError::Square(square_m * 1e3));
        }
        Ok(Self { corners, square_m })
    }

    /// Returns the numbers of inner corners along x and y.
    pub const fn corners(&self) -> [usize; 2] {
        self.corners
    }

    /// Returns the side of a square, m.
    pub const fn square_m(&self) -> f64 {
        self.square_m
    }

    /// Returns the number of inner corners.
    pub const fn count(&self) -> usize {
        self.corners[0] * self.corners[1]
    }

    /// Returns the number of a corner in the order of [`Self::places_m`].
    pub const fn index(&self, [across, down]: [usize; 2]) -> usize {
        down * self.corners[0] + across
    }

    /// Returns all inner corners in the board's frame, row by row, m.
    pub fn places_m(&self) -> Vec<Vector3<f64>> {
        let [across, down] = self.corners;
        let place = |i: usize, j: usize| Vector3::new(i as f64, j as f64, 0.0) * self.square_m;
        (0..down).flat_map(|j| (0..across).map(move |i| place(i, j))).collect()
    }

    /// Returns the middle of the board, m.
    pub fn middle_m(&self) -> Vector3<f64> {
        let [across, down] = self.corners.map(|side| 0.5 * (side - 1) as f64);
        Vector3::new(across, down, 0.0) * self.square_m
    }

    /// Returns the brightness at a position in units of squares; `None` outside the paper.
    fn grey(&self, place: &Vector2<f64>) -> Option<f64> {
        let size = Vector2::from(self.corners.map(|side| (side + 1) as f64));
        // Measured from the outer corner of the squares.
        let from = place.add_scalar(1.0);
        let on_paper = from.iter().zip(&size).all(|(at, size)| (-MARGIN..=size + MARGIN).contains(at));
        let on_squares = from.iter().zip(&size).all(|(at, size)| (0.0..*size).contains(at));
        on_paper.then(|| {
            let is_black = on_squares && (from.x.floor() + from.y.floor()).rem_euclid(2.0) == 0.0;
            if is_black { BLACK } else { WHITE }
        })
    }

    /// Returns the board as a drawing in its true size, for printing.
    ///
    /// ```
    /// let board = nima_endoscope::Checkerboard::new([9, 6], 0.010)?;
    /// let svg = board.svg();
    /// assert!(svg.contains("width=\"120mm\" height=\"90mm\""));
    /// assert_eq!(svg.matches("M").count(), 35, "half of the 10 x 7 squares");
    /// # Ok::<(), nima_endoscope::BoardError>(())
    /// ```
    pub fn svg(&self) -> String {
        let square = self.square_m * 1e3;
        let [across, down] = self.corners.map(|side| side + 1);
        let [width, height] = [across, down].map(|side| square * (side as f64 + 2.0 * MARGIN));
        let mut squares = String::new();
        for (row, column) in (0..down).flat_map(|row| (0..across).map(move |column| (row, column))) {
            if (row + column) % 2 == 0 {
                let [x, y] = [column, row].map(|at| square * (at as f64 + MARGIN));
                // Writing into a String cannot fail.
                write!(squares, "M{x} {y}h{square}v{square}h-{square}z").ok();
            }
        }
        let words = format!(
            "nima board {}x{}, squares of {square} mm: measure one, print at 100 %",
            self.corners[0], self.corners[1]
        );
        let at = height - 0.3 * square;
        let size = 0.3 * square;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" viewBox=\"0 0 {width} {height}\">\
             <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/><path d=\"{squares}\"/>\
             <text x=\"{square}\" y=\"{at}\" font-size=\"{size}\" font-family=\"sans-serif\" fill=\"#999\">{words}</text></svg>\n"
        )
    }
}

/// Renders boards as seen through a lens; pixels on an edge are blended by area.
#[derive(Debug)]
pub struct Portrait {
    size_px: [usize; 2],
    /// Direction of each pixel's centre; `None` outside the lens's view.
    sights: Vec<Option<Vector2<f64>>>,
}

impl Portrait {
    /// Takes some tenths of a second.
    pub fn new(lens: &Lens) -> Self {
        let [width, height] = lens.size_px;
        let places = (0..height).flat_map(|y| (0..width).map(move |x| Vector2::new(x as f64 + 0.5, y as f64 + 0.5)));
        let sights = places.map(|place_px| lens.direction(&place_px).map(|sight| sight.xy())).collect();
        Self { size_px: lens.size_px, sights }
    }

    /// Returns the grey values, 0 to 255, row by row, of a board at this pose in the camera's frame.
    pub fn draw(&self, board: &Checkerboard, camera_from_board: &Isometry3<f64>) -> Vec<f32> {
        let [width, height] = self.size_px;
        let from = camera_from_board.inverse();
        let way = camera_from_board.rotation.inverse();
        let eye = from.translation.vector / board.square_m;
        // Intersection of a line of sight with the board, in squares.
        let meets = |sight: &Vector2<f64>| {
            let direction = way * sight.push(1.0);
            let steps = -eye.z / direction.z;
            (steps > 0.0 && steps.is_finite()).then(|| (eye + direction * steps).xy())
        };
        let met: Vec<Option<Vector2<f64>>> = self.sights.iter().map(|sight| sight.as_ref().and_then(meets)).collect();
        let mut greys = vec![BEHIND as f32; width * height];
        for (at, grey) in greys.iter_mut().enumerate() {
            let Some(middle) = met[at] else {
                if self.sights[at].is_none() {
                    *grey = 4.0;
                }
                continue;
            };
            let [x, y] = [at % width, at / width];
            // Distance to the next pixel, measured on the board.
            let next = |there: bool, step: usize| if there { met[at + step].map(|next| next - middle) } else { None };
            let before = |there: bool, step: usize| if there { met[at - step].map(|last| middle - last) } else { None };
            let across = next(x + 1 < width, 1).or_else(|| before(x > 0, 1)).unwrap_or_default();
            let down = next(y + 1 < height, width).or_else(|| before(y > 0, width)).unwrap_or_default();
            *grey = shade(board, &middle, &across, &down) as f32;
        }
        greys
    }
}

/// Returns the brightness of a pixel whose sides are these vectors on the board.
fn shade(board: &Checkerboard, middle: &Vector2<f64>, across: &Vector2<f64>, down: &Vector2<f64>) -> f64 {
    let reach = (across.abs() + down.abs()) * 0.5;
    let is_even = middle.iter().zip(&reach).all(|(at, reach)| (at - at.round()).abs() > *reach);
    if is_even {
        return board.grey(middle).unwrap_or(BEHIND);
    }
    let fraction = |k: usize| (k as f64 + 0.5) / SAMPLES as f64 - 0.5;
    let samples = (0..SAMPLES).flat_map(|row| (0..SAMPLES).map(move |column| [fraction(column), fraction(row)]));
    let sum: f64 = samples.map(|[u, v]| board.grey(&(middle + across * u + down * v)).unwrap_or(BEHIND)).sum();
    sum / (SAMPLES * SAMPLES) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_board_that_cannot_be_told_from_itself_is_refused() {
        for (text, square_m, word) in [
            ("9", 0.01, "enter the number of inner corners"),
            ("axb", 0.01, "enter the number of inner corners"),
            ("2x5", 0.01, "3 to 40"),
            ("9x7", 0.01, "upside down"),
            ("8x8", 0.01, "upside down"),
            ("9x6", 0.0, "0.5 to 200 mm"),
            ("9x6", f64::NAN, "0.5 to 200 mm"),
        ] {
            let made =
                text.parse::<BoardCorners>().and_then(|BoardCorners(corners)| Checkerboard::new(corners, square_m));
            let report = made.unwrap_err().to_string();
            assert!(report.contains(word), "{text}: {report}");
        }
        assert_eq!("9x6".parse::<BoardCorners>().map(|BoardCorners(corners)| corners), Ok([9, 6]));
    }

    #[test]
    fn its_picture_has_the_first_corner_where_the_lens_says_and_black_above_it() {
        let board = Checkerboard::new([5, 4], 0.01).unwrap();
        let lens = Lens::simple([320, 240], 300.0, -0.2);
        let camera_from_board = Isometry3::translation(-0.02, -0.015, 0.15);
        let greys = Portrait::new(&lens).draw(&board, &camera_from_board);
        let first_px = lens.project(&camera_from_board.translation.vector).unwrap();
        let at = |x: f64, y: f64| greys[(first_px.y + y) as usize * 320 + (first_px.x + x) as usize];
        assert!(at(-6.0, -6.0) < 40.0 && at(6.0, 6.0) < 40.0, "black above and left of it, and across");
        assert!(at(6.0, -6.0) > 200.0 && at(-6.0, 6.0) > 200.0);
        assert!((greys[0] - BEHIND as f32).abs() < 1.0, "nothing of it is in the corner of the picture");
    }
}
