//! The lens and the poses that fit the corners best: least squares by Levenberg and Marquardt's method. The poses are
//! eliminated one by one (Schur complement), so that the cost of a step is proportional to the number of corners.

use nalgebra::{Isometry3, Matrix2, Matrix2x3, SMatrix, SVector, Translation3, UnitQuaternion, Vector2, Vector3};
use nima_endoscope::{Bend, Lens};

/// Focal lengths, centre, k1, k2, p1, p2.
pub(crate) const PARAMETERS: usize = 8;
type FitInner = SMatrix<f64, PARAMETERS, PARAMETERS>;
type FitMixed = SMatrix<f64, PARAMETERS, 6>;
type Outer = SMatrix<f64, 6, 6>;
pub(crate) type FitParameters = SVector<f64, PARAMETERS>;
type FitMotion = SVector<f64, 6>;

/// The iteration ends when a step improves the fit by less than this fraction.
const GAIN: f64 = 1e-9;
const DAMPING: f64 = 1e-3;
/// At that damping a step is too small to change anything, so the fit has failed.
const DAMPING_MAX: f64 = 1e9;

/// The terms of a lens that are fitted; the others stay constant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Terms {
    /// Different focal lengths across and down, for pixels that are not square.
    pub aspect: bool,
    pub k2: bool,
    pub tangential: bool,
}

impl Terms {
    fn are_found(self) -> [bool; PARAMETERS] {
        [true, self.aspect, true, true, true, self.k2, self.tangential, self.tangential]
    }

    /// Returns the number of fitted parameters.
    pub fn count(self) -> usize {
        self.are_found().into_iter().filter(|found| *found).count()
    }
}

/// Corners of one view.
#[derive(Clone, Debug)]
pub(crate) struct FitCorners {
    pub(crate) places_m: Vec<Vector3<f64>>,
    pub(crate) seen_px: Vec<Vector2<f64>>,
}

impl FitCorners {
    /// Returns the squared distances between observed and predicted corners; `None` if the lens does not see them.
    pub(crate) fn squares(&self, lens: &Lens, pose: &Isometry3<f64>) -> Option<Vec<f64>> {
        let pairs = self.places_m.iter().zip(&self.seen_px);
        pairs
            .map(|(place_m, seen)| {
                Some((lens.project(&(pose * nalgebra::Point3::from(*place_m)).coords)? - seen).norm_squared())
            })
            .collect()
    }

    pub(crate) fn square(&self, lens: &Lens, pose: &Isometry3<f64>) -> Option<f64> {
        Some(self.squares(lens, pose)?.iter().sum())
    }
}

/// A lens, and the pose of the board in each view.
#[derive(Clone, Debug)]
pub(crate) struct CameraFit {
    pub(crate) lens: Lens,
    pub(crate) poses: Vec<Isometry3<f64>>,
}

/// The equations of one step: those of the lens, of each pose, and between them.
struct Equations {
    lens: (FitInner, FitParameters),
    poses: Vec<(FitMixed, Outer, FitMotion)>,
}

/// Returns the derivative of a corner's position by the lens, and by the pose (rotation, then translation, in the
/// camera's frame).
fn slopes(
    lens: &Lens,
    pose: &Isometry3<f64>,
    place_m: &Vector3<f64>,
) -> (SMatrix<f64, 2, PARAMETERS>, SMatrix<f64, 2, 6>) {
    let turned = pose.rotation * place_m;
    let at = turned + pose.translation.vector;
    let flat = at.xy() / at.z;
    let bent = lens.bend.at(&flat);
    let square = flat.norm_squared();
    let [x, y] = [flat.x, flat.y];
    let [fx, fy] = [lens.focal_px.x, lens.focal_px.y];
    let cross = 2.0 * x * y;
    let columns = [
        [bent.x, 0.0],
        [0.0, bent.y],
        [1.0, 0.0],
        [0.0, 1.0],
        [fx * x * square, fy * y * square],
        [fx * x * square * square, fy * y * square * square],
        [fx * cross, fy * (square + 2.0 * y * y)],
        [fx * (square + 2.0 * x * x), fy * cross],
    ];
    let of_lens = SMatrix::from_columns(&columns.map(Vector2::from));
    let of_flat = Matrix2::from_diagonal(&lens.focal_px) * lens.bend.slope(&flat);
    let of_point = of_flat * Matrix2x3::new(1.0, 0.0, -x, 0.0, 1.0, -y) / at.z;
    let mut of_pose = SMatrix::<f64, 2, 6>::zeros();
    of_pose.fixed_columns_mut::<3>(0).copy_from(&(of_point * -turned.cross_matrix()));
    of_pose.fixed_columns_mut::<3>(3).copy_from(&of_point);
    (of_lens, of_pose)
}

impl CameraFit {
    fn equations(&self, views: &[FitCorners], terms: Terms) -> Option<Equations> {
        let found = terms.are_found();
        let mut all =
            Equations { lens: (FitInner::zeros(), FitParameters::zeros()), poses: Vec::with_capacity(views.len()) };
        for (view, pose) in views.iter().zip(&self.poses) {
            let mut mixed = FitMixed::zeros();
            let mut outer = Outer::zeros();
            let mut motion = FitMotion::zeros();
            for (place_m, seen) in view.places_m.iter().zip(&view.seen_px) {
                let miss = seen - self.lens.project(&(pose * nalgebra::Point3::from(*place_m)).coords)?;
                let (mut of_lens, of_pose) = slopes(&self.lens, pose, place_m);
                if !terms.aspect {
                    let both = of_lens.column(0) + of_lens.column(1);
                    of_lens.set_column(0, &both);
                }
                for at in (0..PARAMETERS).filter(|at| !found[*at]) {
                    of_lens.set_column(at, &Vector2::zeros());
                }
                all.lens.0 += of_lens.transpose() * of_lens;
                all.lens.1 += of_lens.transpose() * miss;
                mixed += of_lens.transpose() * of_pose;
                outer += of_pose.transpose() * of_pose;
                motion += of_pose.transpose() * miss;
            }
            all.poses.push((mixed, outer, motion));
        }
        for at in (0..PARAMETERS).filter(|at| !found[*at]) {
            all.lens.0[(at, at)] = 1.0;
        }
        Some(all)
    }

    pub(crate) fn square(&self, views: &[FitCorners]) -> Option<f64> {
        views.iter().zip(&self.poses).map(|(view, pose)| view.square(&self.lens, pose)).sum()
    }

    /// Returns the root mean square of the distances of all corners, px.
    pub(crate) fn rms_px(&self, views: &[FitCorners]) -> Option<f64> {
        let count: usize = views.iter().map(|view| view.seen_px.len()).sum();
        Some((self.square(views)? / count.max(1) as f64).sqrt())
    }

    /// Refines the fit in at most this many steps.
    pub(crate) fn refined(mut self, views: &[FitCorners], terms: Terms, steps: usize) -> Option<Self> {
        let mut square = self.square(views)?;
        let mut damping = DAMPING;
        for _ in 0..steps {
            let equations = self.equations(views, terms)?;
            let before = square;
            while damping < DAMPING_MAX {
                let next = equations.step(damping).map(|step| self.moved(&step, terms));
                let reached = next.as_ref().and_then(|next| next.square(views));
                if let (Some(next), Some(reached)) = (next, reached.filter(|reached| *reached < square)) {
                    self = next;
                    square = reached;
                    damping = (damping * 0.2).max(1e-12);
                    break;
                }
                damping *= 6.0;
            }
            if before - square <= GAIN * before {
                break;
            }
        }
        Some(self)
    }

    fn moved(&self, (of_lens, of_poses): &(FitParameters, Vec<FitMotion>), terms: Terms) -> Self {
        let mut lens = self.lens;
        lens.focal_px.x += of_lens[0];
        lens.focal_px.y += if terms.aspect { of_lens[1] } else { of_lens[0] };
        lens.centre_px += Vector2::new(of_lens[2], of_lens[3]);
        let Bend { k1, k2, p1, p2 } = lens.bend;
        lens.bend = Bend { k1: k1 + of_lens[4], k2: k2 + of_lens[5], p1: p1 + of_lens[6], p2: p2 + of_lens[7] };
        let poses = self.poses.iter().zip(of_poses).map(|(pose, by)| {
            let turn = UnitQuaternion::from_scaled_axis(by.fixed_rows::<3>(0).into_owned());
            let shift = pose.translation.vector + by.fixed_rows::<3>(3);
            Isometry3::from_parts(Translation3::from(shift), turn * pose.rotation)
        });
        Self { lens, poses: poses.collect() }
    }

    /// Returns the standard deviations of the parameters; infinite if the views do not determine them.
    pub(crate) fn deviations(&self, views: &[FitCorners], terms: Terms) -> Option<FitParameters> {
        let count: usize = views.iter().map(|view| 2 * view.seen_px.len()).sum();
        let free = count.saturating_sub(terms.count() + 6 * views.len());
        let variance = self.square(views)? / free.max(1) as f64;
        let (inner, _) = self.equations(views, terms)?.reduced(0.0)?;
        // Scale first, because pixels and coefficients differ by a factor of a million.
        let scale = inner.diagonal().map(|part| part.max(0.0).sqrt().recip());
        let scaled: FitInner = SMatrix::from_fn(|row, column| inner[(row, column)] * scale[row] * scale[column]);
        let inverse: Option<FitInner> = scaled.try_inverse();
        let Some(inverse) = inverse else { return Some(FitParameters::repeat(f64::INFINITY)) };
        let found = terms.are_found();
        let mut deviations = FitParameters::zeros();
        for at in (0..PARAMETERS).filter(|at| found[*at]) {
            let own = inverse[(at, at)] * scale[at] * scale[at] * variance;
            deviations[at] = if own >= 0.0 { own.sqrt() } else { f64::INFINITY };
        }
        if !terms.aspect {
            deviations[1] = deviations[0];
        }
        Some(deviations)
    }
}

impl Equations {
    /// Returns the equations of the lens alone, with this damping.
    fn reduced(&self, damping: f64) -> Option<(FitInner, FitParameters)> {
        let (mut inner, mut right) = self.lens;
        damp(&mut inner, damping);
        for (mixed, outer, motion) in &self.poses {
            let mut outer = *outer;
            damp(&mut outer, damping);
            let inverse = outer.try_inverse()?;
            inner -= mixed * inverse * mixed.transpose();
            right -= mixed * (inverse * motion);
        }
        Some((inner, right))
    }

    fn step(&self, damping: f64) -> Option<(FitParameters, Vec<FitMotion>)> {
        let (inner, right) = self.reduced(damping)?;
        let of_lens = inner.cholesky()?.solve(&right);
        let of_poses = self.poses.iter().map(|(mixed, outer, motion)| {
            let mut outer = *outer;
            damp(&mut outer, damping);
            Some(outer.cholesky()?.solve(&(motion - mixed.transpose() * of_lens)))
        });
        Some((of_lens, of_poses.collect::<Option<_>>()?))
    }
}

fn damp<const N: usize>(matrix: &mut SMatrix<f64, N, N>, damping: f64) {
    for at in 0..N {
        matrix[(at, at)] *= 1.0 + damping;
    }
}

/// Returns the pose that fits a view best, starting from an initial one.
pub(crate) fn refined_pose(
    lens: &Lens,
    view: &FitCorners,
    first: Isometry3<f64>,
    steps: usize,
) -> Option<Isometry3<f64>> {
    let mut pose = first;
    let mut damping = DAMPING;
    let mut square = view.square(lens, &pose)?;
    for _ in 0..steps {
        let mut outer = Outer::zeros();
        let mut motion = FitMotion::zeros();
        for (place_m, seen) in view.places_m.iter().zip(&view.seen_px) {
            let miss = seen - lens.project(&(pose * nalgebra::Point3::from(*place_m)).coords)?;
            let (_, of_pose) = slopes(lens, &pose, place_m);
            outer += of_pose.transpose() * of_pose;
            motion += of_pose.transpose() * miss;
        }
        let before = square;
        while damping < DAMPING_MAX {
            let mut damped = outer;
            damp(&mut damped, damping);
            let by = damped.cholesky()?.solve(&motion);
            let turn = UnitQuaternion::from_scaled_axis(by.fixed_rows::<3>(0).into_owned());
            let shift = pose.translation.vector + by.fixed_rows::<3>(3);
            let next = Isometry3::from_parts(Translation3::from(shift), turn * pose.rotation);
            if let Some(reached) = view.square(lens, &next).filter(|reached| *reached < square) {
                pose = next;
                square = reached;
                damping *= 0.2;
                break;
            }
            damping *= 6.0;
        }
        if before - square <= GAIN * before {
            break;
        }
    }
    Some(pose)
}
