use super::{Baselines, Doubt, Expansion, ModelOrigin, Normalisation, TipForceNetwork};

/// A trained network with all data required to use it.
#[derive(Clone, Debug)]
pub struct ForceModel {
    pub inputs: Vec<String>,
    pub outputs: Vec<String>,
    pub expansion: Expansion,
    pub features: Normalisation,
    pub scale: Normalisation,
    pub network: TipForceNetwork,
    pub doubt: Doubt,
    /// Simpler methods fitted on the same data, for comparison.
    pub baselines: Baselines,
    pub origin: ModelOrigin,
}
