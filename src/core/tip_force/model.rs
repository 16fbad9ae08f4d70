//! A trained network with all that belongs to it.

use super::{Baselines, Doubt, Expansion, Network, Normalisation, Origin};

/// A trained model with all that belongs to it.
#[derive(Clone, Debug)]
#[expect(missing_docs, reason = "the names say it")]
pub struct Model {
    pub inputs: Vec<String>,
    pub outputs: Vec<String>,
    /// How inputs become features.
    pub expansion: Expansion,
    pub features: Normalisation,
    /// Normalisation of the outputs.
    pub scale: Normalisation,
    pub network: Network,
    /// When it must not be believed.
    pub doubt: Doubt,
    /// What simpler methods fitted on the same data say.
    pub baselines: Baselines,
    pub origin: Origin,
}
