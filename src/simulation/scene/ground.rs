//! Everything that the tip can touch: tissue, objects in and on it, and walls.

use nima_machine::config::{ConfigError, Ranges};
use serde::{Deserialize, Serialize};

use super::Scene;

/// Soft tissue with a flat surface at rest (Hunt and Crossley 1975: `f = k d^n (1 + c d')`), with Coulomb friction
/// tangentially.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TissueModel {
    /// Height of the surface at rest, m.
    pub surface_z_m: f64,
    /// Extent of the pad in x and y, m, centred on the origin.
    pub size_m: [f64; 2],
    /// `k`, N/m^n.
    pub stiffness: f64,
    /// `n`, 1 to 3.
    pub exponent: f64,
    /// `c`, s/m.
    pub damping_s_m: f64,
    /// Coulomb friction coefficient; zero for none.
    pub friction: f64,
    /// Tangential stiffness before the tip slides, N/m.
    pub shear_stiffness_n_m: f64,
}

/// A layer on the tissue with the law `f = k d^n`; all layers and the tissue are compressed together like springs in
/// series.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroundLayer {
    /// `k`, N/m^n.
    pub stiffness: f64,
    /// `n`, 1 to 3.
    pub exponent: f64,
}

/// Lumps in the tissue, which is an elastic foundation of this thickness on a rigid ground.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lumps {
    /// Thickness of the tissue, m.
    pub thickness_m: f64,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub list: Vec<Lump>,
    /// Additional lumps at positions determined by the scene's seed.
    pub drawn: Option<RandomLumps>,
}

/// A lump: a sphere in the tissue.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lump {
    /// Position of its middle, x and y, m.
    #[serde(rename = "at_m")]
    pub position_m: [f64; 2],
    /// Radius, m; its diameter is less than the tissue's thickness.
    pub radius_m: f64,
    /// Stiffness as a multiple of the tissue's.
    pub times_stiffer: f64,
}

/// Lumps at random positions, so that they cannot be learnt: another seed of the scene gives other positions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RandomLumps {
    pub count: u32,
    /// Minimum and maximum radius, m.
    pub radius_m: [f64; 2],
    /// Stiffness as a multiple of the tissue's.
    pub times_stiffer: f64,
    /// Minimum distance between their middles, m.
    pub apart_m: f64,
    /// Minimum distance of their middles from the tissue's edges, m.
    pub margin_m: f64,
}

/// A force that is held fades: `f(t) = f(0) (1 - fraction (1 - exp(-t / time)))`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Relaxation {
    /// Fraction of the force that fades, below 1.
    #[serde(rename = "share")]
    pub fraction: f64,
    /// Time constant, s.
    pub time_s: f64,
}

/// A membrane over the tissue with the law `f = a d + b d^2` until it tears.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroundMembrane {
    /// Height at rest, m.
    pub height_m: f64,
    /// `a`, N/m.
    pub stiffness_n_m: f64,
    /// `b`, N/m^2.
    pub stiffening_n_m2: f64,
    /// Force at which it tears, N.
    pub tears_at_n: f64,
    /// Radius of the hole, m.
    pub hole_radius_m: f64,
}

/// A flat wall: a spring and a damper along its normal.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wall {
    /// A point on it, m.
    #[serde(rename = "at_m")]
    pub position_m: [f64; 3],
    /// Direction in which the wall pushes; of any length.
    pub normal: [f64; 3],
    pub stiffness_n_m: f64,
    pub damping_n_s_m: f64,
}

/// Maximum number of random lumps.
const DRAWN_MAX: u32 = 32;

impl Scene {
    pub(super) fn validate_ground(&self, ranges: &Ranges<'_>) -> Result<(), ConfigError> {
        self.tissue.as_ref().map_or(Ok(()), |tissue| tissue.validate(ranges))?;
        for layer in &self.layers {
            ranges.positive("layers.stiffness", layer.stiffness)?;
            ranges.check("layers.exponent", layer.exponent, (1.0..=3.0).contains(&layer.exponent), "1 to 3")?;
        }
        if let Some(lumps) = &self.lumps {
            lumps.validate(ranges)?;
            if let (Some(drawn), Some(tissue)) = (&lumps.drawn, &self.tissue) {
                drawn.validate(ranges, lumps.thickness_m, tissue.size_m)?;
                let placed = lumps.placed(self.seed, tissue.size_m).list.len() - lumps.list.len();
                let allowed = "a number for which there is space: use fewer lumps, or place them closer together";
                ranges.check("lumps.drawn.count", f64::from(drawn.count), placed == drawn.count as usize, allowed)?;
            }
        }
        if let Some(Relaxation { fraction, time_s }) = self.relaxation {
            ranges.check("relaxation.share", fraction, (0.0..1.0).contains(&fraction), "0 to below 1")?;
            ranges.positive("relaxation.time_s", time_s)?;
        }
        if let Some(membrane) = &self.membrane {
            membrane.validate(ranges)?;
        }
        for wall in &self.walls {
            for entry in wall.position_m {
                ranges.check("walls.at_m", entry, entry.abs() <= 1.0, "within 1 m of the origin")?;
            }
            let length = wall.normal.iter().map(|x| x * x).sum::<f64>().sqrt();
            ranges.check("walls.normal (length)", length, (1e-6..1e6).contains(&length), "a direction")?;
            ranges.positive("walls.stiffness_n_m", wall.stiffness_n_m)?;
            ranges.not_negative("walls.damping_n_s_m", wall.damping_n_s_m)?;
        }
        let on_tissue =
            !self.layers.is_empty() || self.lumps.is_some() || self.relaxation.is_some() || self.membrane.is_some();
        let tissues = if self.tissue.is_some() { 1.0 } else { 0.0 };
        let needs = "1 with layers, lumps, relaxation or a membrane";
        ranges.check("number of [tissue] parts", tissues, self.tissue.is_some() || !on_tissue, needs)
    }
}

impl TissueModel {
    fn validate(&self, ranges: &Ranges<'_>) -> Result<(), ConfigError> {
        ranges.check("tissue.surface_z_m", self.surface_z_m, self.surface_z_m.abs() <= 1.0, "within 1 m")?;
        ranges.positive("tissue.size_m", self.size_m[0])?;
        ranges.positive("tissue.size_m", self.size_m[1])?;
        ranges.not_negative("tissue.stiffness", self.stiffness)?;
        ranges.check("tissue.exponent", self.exponent, (1.0..=3.0).contains(&self.exponent), "1 to 3")?;
        ranges.not_negative("tissue.damping_s_m", self.damping_s_m)?;
        ranges.not_negative("tissue.friction", self.friction)?;
        ranges.not_negative("tissue.shear_stiffness_n_m", self.shear_stiffness_n_m)
    }
}

impl Lumps {
    fn validate(&self, ranges: &Ranges<'_>) -> Result<(), ConfigError> {
        ranges.positive("lumps.thickness_m", self.thickness_m)?;
        for Lump { position_m, radius_m, times_stiffer } in &self.list {
            for entry in position_m {
                ranges.check("lumps.list.at_m", *entry, entry.abs() <= 1.0, "within 1 m of the origin")?;
            }
            let fits = *radius_m > 0.0 && 2.0 * radius_m < self.thickness_m;
            ranges.check("lumps.list.radius_m", *radius_m, fits, "above 0, and less than half the thickness")?;
            ranges.check(
                "lumps.list.times_stiffer",
                *times_stiffer,
                (1.0..=1e3).contains(times_stiffer),
                "1 to 1000",
            )?;
        }
        Ok(())
    }
}

impl RandomLumps {
    fn validate(&self, ranges: &Ranges<'_>, thickness_m: f64, size_m: [f64; 2]) -> Result<(), ConfigError> {
        let Self { count, radius_m: [min_m, max_m], times_stiffer, apart_m, margin_m } = *self;
        ranges.check("lumps.drawn.count", f64::from(count), (1..=DRAWN_MAX).contains(&count), "1 to 32")?;
        ranges.positive("lumps.drawn.radius_m", min_m)?;
        let fits = max_m >= min_m && 2.0 * max_m < thickness_m;
        ranges.check(
            "lumps.drawn.radius_m (greatest)",
            max_m,
            fits,
            "at least the least one, and less than half the thickness",
        )?;
        let fits = (1.0..=1e3).contains(&times_stiffer);
        ranges.check("lumps.drawn.times_stiffer", times_stiffer, fits, "1 to 1000")?;
        ranges.not_negative("lumps.drawn.apart_m", apart_m)?;
        let fits = margin_m >= 0.0 && size_m.iter().all(|size_m| 2.0 * margin_m < *size_m);
        ranges.check("lumps.drawn.margin_m", margin_m, fits, "from 0 to less than half the tissue's size")
    }
}

impl GroundMembrane {
    fn validate(&self, ranges: &Ranges<'_>) -> Result<(), ConfigError> {
        ranges.check("membrane.height_m", self.height_m, self.height_m.abs() <= 1.0, "within 1 m")?;
        ranges.positive("membrane.stiffness_n_m", self.stiffness_n_m)?;
        ranges.not_negative("membrane.stiffening_n_m2", self.stiffening_n_m2)?;
        ranges.positive("membrane.tears_at_n", self.tears_at_n)?;
        ranges.positive("membrane.hole_radius_m", self.hole_radius_m)
    }
}
