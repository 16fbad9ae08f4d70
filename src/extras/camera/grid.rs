//! Arranges the saddle points of a board into rows and columns. Two saddle points are neighbours if one side of the
//! line between them is light and the other dark: this holds only between neighbours, however the lens distorts the
//! board. Since the light side alternates from square to square, it distinguishes rows from columns.

use std::collections::{BTreeMap, VecDeque};

use nalgebra::Vector2;

use crate::{Grey, saddle::Saddle};

/// Number of nearest saddles that are considered as neighbours. A corner has four neighbours and four diagonal ones;
/// the rest allows for false saddles between them.
const NEAREST: usize = 12;
/// Positions along the edge between two saddle points at which both sides are compared, as fractions of its length.
/// Away from both ends, where the squares of the other row begin.
const ALONG: [f64; 5] = [0.25, 0.37, 0.5, 0.63, 0.75];
/// Distance of the compared points from the edge, in lengths, and minimum in px.
const BESIDE: f64 = 0.15;
const BESIDE_PX: f64 = 1.5;
/// Minimum difference between the two sides, relative to the contrast at the ends. An edge of the board separates light
/// and dark; a line between two unrelated saddles does not.
const DIFFERENCE: f64 = 0.3;

/// Maximum cosine of the angle between the edges to both neighbours in a row; and range of the ratio between successive
/// edges. Perspective and distortion bend a row only a little from one corner to the next.
const OPPOSITE: f64 = -0.7;
const ALIKE: std::ops::RangeInclusive<f64> = 0.5..=2.0;

/// An edge between two squares.
#[derive(Clone, Copy, Debug)]
struct Edge {
    to: usize,
    /// Whether the right-hand side is light.
    light_right: bool,
}

/// Saddles by column and row, each from zero.
pub(crate) type Cells = BTreeMap<[usize; 2], usize>;
/// The same grid while it grows in all directions.
type GrowingGrid = BTreeMap<[i32; 2], usize>;

/// Returns whether the right-hand side of the line between two points is the light one (px; y is down); `None` if this
/// is not uniform along the line.
pub(crate) fn light_side(image: &Grey, [from, to]: [&Vector2<f64>; 2], contrast: f64) -> Option<bool> {
    let way = to - from;
    let length = way.norm();
    let right = Vector2::new(-way.y, way.x) * ((BESIDE * length).max(BESIDE_PX) / length.max(1e-9));
    let mut light = None;
    for along in ALONG {
        let at = from + way * along;
        let difference = image.at(&(at + right)) - image.at(&(at - right));
        let is_light = difference > 0.0;
        if difference.abs() < DIFFERENCE * contrast || light.is_some_and(|before| before != is_light) {
            return None;
        }
        light = Some(is_light);
    }
    light
}

fn edges(image: &Grey, saddles: &[Saddle]) -> Vec<Vec<Edge>> {
    let mut all = Vec::with_capacity(saddles.len());
    for (index, saddle) in saddles.iter().enumerate() {
        let away = |other: &Saddle| (other.place_px - saddle.place_px).norm_squared();
        let mut others: Vec<(f64, usize)> = saddles.iter().map(away).zip(0..).filter(|(_, at)| *at != index).collect();
        let near = NEAREST.min(others.len());
        if near < others.len() {
            others.select_nth_unstable_by(near, |a, b| a.0.total_cmp(&b.0));
        }
        let joined = others[..near].iter().filter_map(|(_, to)| {
            let other = &saddles[*to];
            let contrast = saddle.contrast.min(other.contrast);
            let light_right = light_side(image, [&saddle.place_px, &other.place_px], contrast)?;
            Some(Edge { to: *to, light_right })
        });
        all.push(joined.collect());
    }
    all
}

/// Returns every grid of saddles in an image, the largest first, with its first column and row at zero.
pub(crate) fn grids(image: &Grey, saddles: &[Saddle]) -> Vec<Cells> {
    let edges = edges(image, saddles);
    let mut used = vec![false; saddles.len()];
    let mut all = Vec::new();
    for seed in 0..saddles.len() {
        if used[seed] || edges[seed].len() != 4 {
            continue;
        }
        let Some(cells) = grown(saddles, &edges, seed) else { continue };
        for index in cells.values() {
            used[*index] = true;
        }
        let cells = from_zero(&pruned(trimmed(pruned(cells))));
        if cells.len() > 3 {
            all.push(cells);
        }
    }
    all.sort_by_key(|cells| std::cmp::Reverse(cells.len()));
    all
}

/// A saddle at the edge of the growing grid, and the steps to the next column and row, px.
struct Front {
    index: usize,
    cell: [i32; 2],
    ways: [Vector2<f64>; 2],
}

/// Grows a grid from a saddle with four neighbours.
fn grown(saddles: &[Saddle], edges: &[Vec<Edge>], seed: usize) -> Option<GrowingGrid> {
    let way = |from: usize, to: usize| saddles[to].place_px - saddles[from].place_px;
    // Edges along a column have the light square on their right at the seed; the row direction is to the right of the
    // column.
    let along =
        |light: bool| edges[seed].iter().filter(move |edge| edge.light_right == light).map(|edge| way(seed, edge.to));
    let [columns, rows] = [true, false].map(|light| along(light).collect::<Vec<_>>());
    // At the border of the board a more distant saddle point may be mistaken for a neighbour, which could swap rows and
    // columns.
    let are_opposite = |ways: &[Vector2<f64>]| match ways {
        [a, b] => a.dot(b) < OPPOSITE * a.norm() * b.norm(),
        _ => false,
    };
    if !are_opposite(&columns) || !are_opposite(&rows) {
        return None;
    }
    let column = columns[0];
    let row = rows.into_iter().find(|row| column.perp(row) > 0.0)?;
    let mut cells = GrowingGrid::from([([0, 0], seed)]);
    let mut placed = BTreeMap::from([(seed, [0, 0])]);
    let mut fronts = VecDeque::from([Front { index: seed, cell: [0, 0], ways: [column, row] }]);
    while let Some(Front { index, cell, ways }) = fronts.pop_front() {
        let is_even = (cell[0] + cell[1]).rem_euclid(2) == 0;
        for edge in &edges[index] {
            let step = way(index, edge.to);
            let axis = usize::from(edge.light_right != is_even);
            if !ALIKE.contains(&(step.norm() / ways[axis].norm())) {
                continue;
            }
            let forward = step.dot(&ways[axis]) > 0.0;
            let mut next = cell;
            next[axis] += if forward { 1 } else { -1 };
            if cells.contains_key(&next) || placed.contains_key(&edge.to) {
                continue;
            }
            let mut ways = ways;
            ways[axis] = if forward { step } else { -step };
            cells.insert(next, edge.to);
            placed.insert(edge.to, next);
            fronts.push_back(Front { index: edge.to, cell: next, ways });
        }
    }
    Some(cells)
}

/// Removes saddles with only one neighbour: a corner of a board has two.
fn pruned(mut cells: GrowingGrid) -> GrowingGrid {
    loop {
        let beside = [[1, 0], [-1, 0], [0, 1], [0, -1]];
        let neighbours = |cell: &[i32; 2]| {
            beside.iter().filter(|by| cells.contains_key(&[cell[0] + by[0], cell[1] + by[1]])).count()
        };
        let loose: Vec<[i32; 2]> = cells.keys().filter(|cell| neighbours(cell) < 2).copied().collect();
        if loose.is_empty() {
            return cells;
        }
        for cell in loose {
            cells.remove(&cell);
        }
    }
}

/// Removes rows and columns at the border of which less than half exist: those of a board are complete, those of noise
/// next to it are not.
fn trimmed(mut cells: GrowingGrid) -> GrowingGrid {
    loop {
        let before = cells.len();
        for axis in 0..2 {
            let ends = |cells: &GrowingGrid| {
                let along = || cells.keys().map(|cell| cell[axis]);
                along().min().zip(along().max())
            };
            let across = cells.keys().map(|cell| cell[1 - axis]);
            let length = across.clone().max().zip(across.min()).map_or(0, |(max, min)| max.abs_diff(min) as usize + 1);
            let Some((first, last)) = ends(&cells) else { return cells };
            for end in [first, last] {
                if 2 * cells.keys().filter(|cell| cell[axis] == end).count() < length {
                    cells.retain(|cell, _| cell[axis] != end);
                }
            }
        }
        if cells.len() == before {
            return cells;
        }
    }
}

fn from_zero(cells: &GrowingGrid) -> Cells {
    let min = |axis: usize| cells.keys().map(|cell| cell[axis]).min().unwrap_or_default();
    let [column, row] = [min(0), min(1)];
    cells
        .iter()
        .map(|(cell, index)| ([cell[0].abs_diff(column) as usize, cell[1].abs_diff(row) as usize], *index))
        .collect()
}

/// Returns the columns and rows of a grid.
pub(crate) fn size(cells: &Cells) -> [usize; 2] {
    let max = |axis: usize| cells.keys().map(|cell| cell[axis] + 1).max().unwrap_or_default();
    [max(0), max(1)]
}
