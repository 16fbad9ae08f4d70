//! A trained network with everything that is needed to use it.

use super::{Baselines, Doubt, Expansion, Network, Normalisation, Origin};

/// A trained network with everything that is needed to use it.
#[derive(Clone, Debug)]
pub struct Model {
    pub inputs: Vec<String>,
    pub outputs: Vec<String>,
    /// How inputs become features.
    pub expansion: Expansion,
    pub features: Normalisation,
    /// Normalisation of the outputs.
    pub scale: Normalisation,
    pub network: Network,
    /// Detects inputs outside the training data.
    pub doubt: Doubt,
    /// Simpler methods fitted on the same data, for comparison.
    pub baselines: Baselines,
    pub origin: Origin,
}
