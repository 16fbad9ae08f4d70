//! Two conditions, one difference per participant.

use super::{Power, PowerSimulation, normal};
use crate::error::Result;
use crate::signed_rank::{self, SignedRankOptions};
use crate::{check, t_test};

/// The distribution of future participants' differences, without the effect.
#[derive(Clone, Debug, PartialEq)]
pub enum Population {
    /// Deviations to be drawn with replacement. [`Population::from_pilot`] computes them.
    Deviations(Vec<f64>),
    /// A normal distribution with this standard deviation.
    Normal {
        /// Standard deviation in the unit of the differences.
        sd: f64,
    },
}

/// The test that the study will use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PairedTest {
    /// [`signed_rank::of_differences`] with its defaults.
    #[default]
    Wilcoxon,
    /// [`t_test::of_differences`].
    T,
}

impl Population {
    /// Computes the deviations from at least two differences of a pilot study: without their Hodges-Lehmann estimate,
    /// which the effect replaces, and wider by sqrt(n / (n - 1)), because resamples of n values vary less than the
    /// population. A small pilot says little about the tails, and its standard deviation may be far off; test a range
    /// of them.
    pub fn from_pilot(differences: &[f64]) -> Result<Self> {
        check::values("differences of the pilot", differences, 2)?;
        let centre = signed_rank::location(differences, 0.95)?.estimate;
        let n = differences.len() as f64;
        let wider = (n / (n - 1.0)).sqrt();
        Ok(Self::Deviations(differences.iter().map(|difference| (difference - centre) * wider).collect()))
    }

    fn check(&self) -> Result<()> {
        match self {
            Self::Deviations(deviations) => check::values("deviations to draw from", deviations, 2),
            Self::Normal { sd } => check::positive("the standard deviation", *sd),
        }
    }

    fn draw(&self, rng: &mut fastrand::Rng) -> f64 {
        match self {
            Self::Deviations(deviations) => deviations[rng.usize(..deviations.len())],
            Self::Normal { sd } => sd * normal(rng),
        }
    }
}

impl PowerSimulation {
    /// Returns the power of a study with `n` participants (2 to 10 000) if the differences have the distribution
    /// `population` about `effect`.
    pub fn paired(&self, population: &Population, effect: f64, n: usize, test: PairedTest) -> Result<Power> {
        population.check()?;
        check::finite("the effect", &[effect])?;
        check::enough("participants", n, 2)?;
        check::not_too_many("participants", n, 10_000)?;
        let mut differences = vec![0.0; n];
        self.run(|rng| {
            differences.fill_with(|| effect + population.draw(rng));
            p_value(&differences, test)
        })
    }
}

fn p_value(differences: &[f64], test: PairedTest) -> Option<f64> {
    match test {
        PairedTest::Wilcoxon => {
            signed_rank::of_differences(differences, &SignedRankOptions::default()).ok().map(|test| test.p)
        }
        PairedTest::T => t_test::of_differences(differences, 0.95).ok().map(|test| test.p),
    }
}
