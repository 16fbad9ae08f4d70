//! The parts of the image in which corners of a board have been seen.

use nalgebra::Vector2;

use crate::Grey;

/// Columns and rows of cells into which the image is divided.
pub const CELLS: [usize; 2] = [6, 4];
const COUNT: usize = CELLS[0] * CELLS[1];
/// A pixel counts as lit from this brightness (of 255), and a cell if half of its pixels are: an endoscope leaves the
/// corners of the image black.
const LIT: f32 = 20.0;
/// One pixel of this many is checked. A prime, so that the samples do not follow the columns of a regular pattern.
const STEP: usize = 7;

/// Cells of the image, row by row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CameraCoverage {
    /// Number of corners in each cell.
    pub corners: [u32; COUNT],
    /// Whether the cell is lit.
    pub lit: [bool; COUNT],
}

/// A ninth of the image: column and row, 0 to 2 each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region(pub [usize; 2]);

fn cell(place_px: &Vector2<f64>, size_px: [usize; 2]) -> Option<usize> {
    let fraction = [place_px.x / size_px[0] as f64, place_px.y / size_px[1] as f64];
    let inside = fraction.iter().all(|fraction| (0.0..1.0).contains(fraction));
    let [column, row] = [0, 1].map(|axis| (fraction[axis] * CELLS[axis] as f64) as usize);
    inside.then_some(row * CELLS[0] + column)
}

impl CameraCoverage {
    /// Returns the coverage of one image.
    pub fn of(image: &Grey, corners_px: &[Vector2<f64>]) -> Self {
        let size_px @ [_, height] = image.size_px();
        let mut lit = [0_u32; COUNT];
        let mut seen = [0_u32; COUNT];
        for y in (0..height).step_by(STEP) {
            for (x, value) in image.row(y).iter().enumerate().step_by(STEP) {
                if let Some(at) = cell(&Vector2::new(x as f64, y as f64), size_px) {
                    seen[at] += 1;
                    lit[at] += u32::from(*value >= LIT);
                }
            }
        }
        let mut corners = [0; COUNT];
        for at in corners_px.iter().filter_map(|place_px| cell(place_px, size_px)) {
            corners[at] += 1;
        }
        Self { corners, lit: std::array::from_fn(|at| 2 * lit[at] > seen[at]) }
    }

    /// Adds the coverage of another image.
    pub fn add(&mut self, other: &Self) {
        for at in 0..COUNT {
            self.corners[at] += other.corners[at];
            self.lit[at] |= other.lit[at];
        }
    }

    /// Returns the fraction of the lit cells that have contained corners.
    pub fn fraction(&self) -> f64 {
        let lit = (0..COUNT).filter(|at| self.is_wanted(*at)).count();
        let seen = self.corners.iter().filter(|count| **count > 0).count();
        if lit == 0 { 0.0 } else { seen as f64 / lit as f64 }
    }

    /// Returns whether it is lit, or a corner was seen there.
    const fn is_wanted(&self, at: usize) -> bool {
        self.lit[at] || self.corners[at] > 0
    }

    /// Returns the ninth of the image with the most cells without a corner; `None` if each cell has one.
    pub fn emptiest(&self) -> Option<Region> {
        let empty = |Region([column, row]): Region| {
            let inside = |at: &usize| {
                let here = [at % CELLS[0] * 3 / CELLS[0], at / CELLS[0] * 3 / CELLS[1]];
                here == [column, row]
            };
            (0..COUNT).filter(inside).filter(|at| self.is_wanted(*at) && self.corners[*at] == 0).count()
        };
        let regions = (0..3).flat_map(|row| (0..3).map(move |column| Region([column, row])));
        regions.filter(|region| empty(*region) > 0).max_by_key(|region| empty(*region))
    }
}
