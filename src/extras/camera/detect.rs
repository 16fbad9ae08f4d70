//! Finds a board in an image.

use nalgebra::Vector2;
use nima_endoscope::Checkerboard;

use crate::{
    CameraCoverage, Grey,
    grid::{Cells, grids, light_side, size},
    refine::{blur_px, corner},
    saddle::{Saddle, saddles},
};

/// The image is also searched at half and a quarter of its size, at which a blurred board is sharp.
const SCALES: usize = 3;
/// Smoothing before the search for saddles, and before locating corners, px.
const SADDLES_PX: f32 = 1.5;
const CORNERS_PX: f32 = 0.8;
/// Maximum distance between a corner and its first detection, relative to the distance to the next corner.
const NEAR: f64 = 0.3;

/// A completely visible board.
#[derive(Clone, Debug, PartialEq)]
pub struct BoardSight {
    /// Inner corners in the order of the board, px.
    pub corners_px: Vec<Vector2<f64>>,
    /// Standard deviation of the blur at its edges, px; includes motion blur.
    pub blur_px: f64,
    /// The image's cells that contain corners, and its lit cells.
    pub coverage: CameraCoverage,
}

impl BoardSight {
    /// Returns the mean distance of the corners from those of another detection, px.
    pub fn mean_move_px(&self, other: &Self) -> f64 {
        let moves = self.corners_px.iter().zip(&other.corners_px).map(|(a, b)| (a - b).norm());
        moves.sum::<f64>() / self.corners_px.len().max(1) as f64
    }
}

/// Why no board was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DetectionFailure {
    /// The image contains nothing like a board.
    Nothing,
    /// Only a part of the board is visible.
    Part {
        /// Visible inner corners.
        seen: usize,
        /// Inner corners of the board.
        of: usize,
    },
    /// There is a board with other numbers of inner corners.
    Other([usize; 2]),
}

/// Finds a completely visible board in an image.
///
/// # Errors
/// [`DetectionFailure`] if no such board is found.
pub fn find(image: &Grey, board: &Checkerboard) -> Result<BoardSight, DetectionFailure> {
    let mut unseen = DetectionFailure::Nothing;
    let mut level = Some(image.clone());
    for halvings in 0..SCALES {
        let Some(grey) = level else { break };
        let scale = f64::from(1_u32 << halvings);
        match coarse(&grey, board) {
            Ok(rough) => {
                let rough: Vec<_> = rough.into_iter().map(|place| place * scale).collect();
                if let Some(sight) = fine(image, board, &rough) {
                    return Ok(sight);
                }
                unseen = DetectionFailure::Part { seen: 0, of: board.count() };
            }
            Err(other) if weight(&other) > weight(&unseen) => unseen = other,
            Err(_) => {}
        }
        level = grey.halved();
    }
    Err(unseen)
}

fn weight(unseen: &DetectionFailure) -> usize {
    match unseen {
        DetectionFailure::Nothing => 0,
        DetectionFailure::Part { seen, .. } => *seen,
        DetectionFailure::Other([across, down]) => across * down,
    }
}

/// Locates the corners of the board to within a pixel or two.
fn coarse(grey: &Grey, board: &Checkerboard) -> Result<Vec<Vector2<f64>>, DetectionFailure> {
    let smooth = grey.smooth(SADDLES_PX);
    let saddles = saddles(&smooth);
    let grids = grids(&smooth, &saddles);
    if let Some(places) = grids.iter().find_map(|cells| in_order(&smooth, &saddles, cells, board)) {
        return Ok(places);
    }
    let Some(largest) = grids.first() else { return Err(DetectionFailure::Nothing) };
    let [columns, rows] = size(largest);
    let is_whole = largest.len() == columns * rows && columns > 2 && rows > 2;
    let is_larger = columns.min(rows) > board.corners().into_iter().min().unwrap_or_default()
        || columns.max(rows) > board.corners().into_iter().max().unwrap_or_default();
    if is_whole && is_larger {
        return Err(DetectionFailure::Other([columns.max(rows), columns.min(rows)]));
    }
    Err(DetectionFailure::Part { seen: largest.len().min(board.count()), of: board.count() })
}

/// Position of a corner of the board in a grid with this many columns and rows.
type GridTurn = fn([usize; 2], [usize; 2]) -> [usize; 2];

/// Returns the saddle points of a grid as the board's corners; `None` if it is not this board.
fn in_order(smooth: &Grey, saddles: &[Saddle], cells: &Cells, board: &Checkerboard) -> Option<Vec<Vector2<f64>>> {
    let [columns, rows] = size(cells);
    if cells.len() != board.count() {
        return None;
    }
    let [across, down] = board.corners();
    // Quarter turns, each right-handed like the board.
    let turns: [GridTurn; 4] = [
        |[i, j], _| [i, j],
        |[i, j], [columns, _]| [(columns - 1).wrapping_sub(j), i],
        |[i, j], [columns, rows]| [(columns - 1).wrapping_sub(i), (rows - 1).wrapping_sub(j)],
        |[i, j], [_, rows]| [j, (rows - 1).wrapping_sub(i)],
    ];
    turns.into_iter().find_map(|turn| {
        let saddle = |i: usize, j: usize| cells.get(&turn([i, j], [columns, rows])).map(|index| &saddles[*index]);
        let all: Option<Vec<&Saddle>> =
            (0..down).flat_map(|j| (0..across).map(move |i| [i, j])).map(|[i, j]| saddle(i, j)).collect();
        let all = all?;
        // The square below an edge to the right of a corner is black if column and row are both even or both odd; most
        // edges must agree.
        let says = |at: usize| {
            let [from, to] = [all[at], all[at + 1]];
            let contrast = from.contrast.min(to.contrast);
            let is_light = light_side(smooth, [&from.place_px, &to.place_px], contrast)?;
            Some(is_light == ((at % across + at / across) % 2 == 1))
        };
        let said: Vec<bool> = (0..all.len()).filter(|at| at % across + 1 < across).filter_map(says).collect();
        let agree = said.iter().filter(|says| **says).count();
        (2 * agree > said.len()).then(|| all.iter().map(|saddle| saddle.place_px).collect())
    })
}

/// Locates the corners exactly, and measures the sharpness of the image.
fn fine(image: &Grey, board: &Checkerboard, rough: &[Vector2<f64>]) -> Option<BoardSight> {
    let smooth = image.smooth(CORNERS_PX);
    let [across, down] = board.corners();
    let neighbours = |at: usize| {
        let i = at % across;
        let j = at / across;
        let beside = [
            (i > 0, at.wrapping_sub(1)),
            (i + 1 < across, at + 1),
            (j > 0, at.wrapping_sub(across)),
            (j + 1 < down, at + across),
        ];
        beside.into_iter().filter(|(there, _)| *there).map(|(_, other)| other)
    };
    let spacing =
        |at: usize| neighbours(at).map(|other| (rough[other] - rough[at]).norm()).fold(f64::INFINITY, f64::min);
    let exact = (0..rough.len()).map(|at| {
        let spacing_px = spacing(at);
        let place_px = corner(&smooth, rough[at], spacing_px)?;
        ((place_px - rough[at]).norm() < NEAR * spacing_px).then_some(place_px)
    });
    let corners_px = exact.collect::<Option<Vec<_>>>()?;
    let pair = |at: usize, step: usize| blur_px(image, [&corners_px[at], &corners_px[at + step]]);
    let in_rows = (0..rough.len()).filter(|at| at % across + 1 < across).filter_map(|at| pair(at, 1));
    let in_columns = (0..rough.len()).filter(|at| at / across + 1 < down).filter_map(|at| pair(at, across));
    let blur_px = f64::max(median(in_rows.collect())?, median(in_columns.collect())?);
    let coverage = CameraCoverage::of(image, &corners_px);
    Some(BoardSight { corners_px, blur_px, coverage })
}

pub(crate) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
