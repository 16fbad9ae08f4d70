//! A trained model and its file: one safetensors file with weights as tensors and all else as metadata.
//!
//! The file holds names of inputs and outputs (units by their names), normalisation, weights, doubt, baselines and where it
//! came from. Loading checks everything that inference relies on: an absent or unfitting piece is one clear error. f32.

use std::{collections::HashMap, path::Path, sync::atomic::AtomicBool};

use safetensors::{Dtype, SafeTensors, tensor::TensorView};
use serde::{Deserialize, Serialize};

use super::{
    Check, DataSet, Expansion, Layer, Member, MemberFigures, Network, Normalisation, Progress, Settings, TipForceError,
    baseline::Baselines, doubt::Doubt, train, training::features_of,
};
use crate::{calibration::store::utc_now, files::write_atomically};

/// What the file calls itself.
const FORMAT: &str = "nima tip force 1";
const KEY: &str = "nima";

/// Where a model came from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Origin {
    /// Serial number of the sensor, as the caller gave it.
    pub sensor: Option<String>,
    /// The tool, as the caller gave it.
    pub tool: Option<String>,
    /// When it was trained, UTC, ISO 8601.
    pub date: String,
    /// Version of this software.
    pub software: String,
    /// Hash of the training files (see [`DataSet::hash`]).
    pub data_hash: String,
    /// Rows trained on.
    pub rows: usize,
    /// How it was trained.
    pub settings: Settings,
    /// What the members reached.
    pub figures: Vec<MemberFigures>,
    /// Features that never changed in the training data; any other value of them is in doubt.
    pub constant: Vec<String>,
    /// What it showed on data recorded after the training.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub check: Option<Check>,
}

/// A trained model with all that belongs to it.
#[derive(Clone, Debug)]
pub struct Model {
    /// Names of the inputs.
    pub inputs: Vec<String>,
    /// Names of the outputs.
    pub outputs: Vec<String>,
    pub(super) expansion: Expansion,
    pub(super) features: Normalisation,
    pub(super) scale: Normalisation,
    pub(super) network: Network,
    pub(super) doubt: Doubt,
    /// What simpler methods fitted on the same data say.
    pub baselines: Baselines,
    /// Where it came from.
    pub origin: Origin,
}

/// The part of the file that is text.
#[derive(Serialize, Deserialize)]
struct Header {
    format: String,
    inputs: Vec<String>,
    outputs: Vec<String>,
    members: usize,
    layers: usize,
    limits: [f32; 3],
    baselines: Baselines,
    origin: Origin,
}

impl Model {
    /// Trains a model (see [`train`]), fits its baselines and calibrates its doubt on the same data.
    pub fn train(
        data: &DataSet,
        settings: &Settings,
        [sensor, tool]: [Option<String>; 2],
        cancel: &AtomicBool,
        progress: &(dyn Fn(&Progress) + Sync),
    ) -> Result<Self, TipForceError> {
        let trained = train(data, settings, cancel, progress)?;
        let absent = || TipForceError::Tensor { reason: "members do not fit together".into() };
        let mut network = Network::new(trained.members).ok_or_else(absent)?;
        let width = trained.expansion.width();
        let mut x = features_of(data, &trained.expansion);
        x.chunks_mut(width).for_each(|row| trained.features.apply(row));
        let mut spreads = Vec::new();
        for (_, judge) in trained.folds.iter().take(settings.members) {
            for row in judge {
                let spread = network.answer(&x[row * width..(row + 1) * width], 1.0).spread;
                spreads.push(spread.iter().copied().fold(0.0, f32::max));
            }
        }
        let measured = trained.expansion.measured();
        // Every trajectory a file of its own: what is left out is another session.
        let whole_sessions = data.files.len() > 1 && data.trajectories.len() == data.files.len();
        let doubt = Doubt::fit(&x, width, measured, &trained.folds, spreads, whole_sessions, settings.seed);
        let origin = Origin {
            sensor,
            tool,
            date: utc_now(),
            software: env!("CARGO_PKG_VERSION").to_owned(),
            data_hash: data.hash.clone(),
            rows: data.rows(),
            settings: settings.clone(),
            figures: trained.figures,
            constant: trained.constant,
            check: None,
        };
        Ok(Self {
            inputs: data.inputs.clone(),
            outputs: data.outputs.clone(),
            baselines: Baselines::fit(data),
            expansion: trained.expansion,
            features: trained.features,
            scale: trained.outputs,
            network,
            doubt,
            origin,
        })
    }

    /// Writes the file; on any error the old one (or none) stays.
    pub fn save(&self, path: &Path) -> Result<(), TipForceError> {
        let wrong = |reason: String| TipForceError::Write { path: path.to_owned(), reason };
        let tensors: Vec<(String, Vec<usize>, Vec<u8>)> =
            self.tensors().into_iter().map(|(name, shape, values)| (name, shape, bytes(&values))).collect();
        let views = tensors
            .iter()
            .map(|(name, shape, data)| TensorView::new(Dtype::F32, shape.clone(), data).map(|view| (name, view)))
            .collect::<Result<Vec<_>, _>>()
            .map_err(|error| wrong(error.to_string()))?;
        let header = Header {
            format: FORMAT.to_owned(),
            inputs: self.inputs.clone(),
            outputs: self.outputs.clone(),
            members: self.network.members().len(),
            layers: self.network.members()[0].layers().len(),
            limits: [self.doubt.distance_limit, self.doubt.range_limit, self.doubt.spread_limit],
            baselines: self.baselines.clone(),
            origin: self.origin.clone(),
        };
        let text = serde_json::to_string(&header).map_err(|error| wrong(error.to_string()))?;
        let metadata = HashMap::from([(KEY.to_owned(), text)]);
        let file = safetensors::serialize(views, Some(metadata)).map_err(|error| wrong(error.to_string()))?;
        write_atomically(path, |to| to.write_all(&file)).map_err(|error| wrong(error.to_string()))
    }

    fn tensors(&self) -> Vec<(String, Vec<usize>, Vec<f32>)> {
        let flat = |name: &str, values: Vec<f32>| (name.to_owned(), vec![values.len()], values);
        let mut all = vec![
            flat("soft", self.expansion.soft(self.inputs.len())),
            flat("features.mean", self.features.mean.clone()),
            flat("features.inverse_sd", self.features.inverse_sd.clone()),
            flat("outputs.mean", self.scale.mean.clone()),
            flat("outputs.inverse_sd", self.scale.inverse_sd.clone()),
            flat("doubt.whitening", self.doubt.whitening.clone()),
            flat("doubt.centres", self.doubt.centres.clone()),
            flat("doubt.range", self.doubt.range.iter().flatten().copied().collect()),
        ];
        for (m, member) in self.network.members().iter().enumerate() {
            for (k, layer) in member.layers().iter().chain([member.skip()]).enumerate() {
                let (inputs, outputs) = layer.shape();
                all.push((format!("{m}.{k}.weights"), vec![inputs, outputs], layer.weights()));
                all.push(flat(&format!("{m}.{k}.bias"), layer.bias().to_vec()));
            }
        }
        all
    }

    /// Reads and checks a file.
    pub fn load(path: &Path) -> Result<Self, TipForceError> {
        let open = |error: std::io::Error| TipForceError::Open { path: path.to_owned(), reason: error.to_string() };
        let file = std::fs::read(path).map_err(open)?;
        Self::from_bytes(&file).map_err(|reason| TipForceError::Model { path: path.to_owned(), reason })
    }

    fn from_bytes(file: &[u8]) -> Result<Self, String> {
        let (_, metadata) =
            SafeTensors::read_metadata(file).map_err(|error| format!("no safetensors file ({error})"))?;
        let tensors = SafeTensors::deserialize(file).map_err(|error| format!("no safetensors file ({error})"))?;
        let text = metadata.metadata().as_ref().and_then(|texts| texts.get(KEY)).ok_or("it has no metadata of ours")?;
        let header: Header = serde_json::from_str(text).map_err(|error| format!("its metadata are wrong ({error})"))?;
        if header.format != FORMAT {
            return Err(format!("it is \"{}\", this version reads \"{FORMAT}\"", header.format));
        }
        let read = |name: &str| values(&tensors, name);
        let soft = read("soft")?;
        let expansion = Expansion::new(&header.inputs, &soft).ok_or("its speeds have no scale")?;
        let features = normalisation(&tensors, "features", expansion.width())?;
        let scale = normalisation(&tensors, "outputs", header.outputs.len())?;
        let members =
            (0..header.members).map(|m| member(&tensors, m, header.layers)).collect::<Result<Vec<_>, String>>()?;
        let network = Network::new(members).ok_or("its members do not fit together")?;
        if network.shape() != (expansion.width(), header.outputs.len()) {
            return Err("its weights do not fit its columns".into());
        }
        if !header.baselines.fits(header.inputs.len(), header.outputs.len()) {
            return Err("its baselines do not fit its columns".into());
        }
        let doubt = doubt(&tensors, expansion.measured(), header.limits)?;
        let Header { inputs, outputs, baselines, origin, .. } = header;
        Ok(Self { inputs, outputs, expansion, features, scale, network, doubt, baselines, origin })
    }
}

fn member(tensors: &SafeTensors<'_>, m: usize, layers: usize) -> Result<Member, String> {
    let layer = |k: usize| {
        let name = format!("{m}.{k}.weights");
        let weights = values(tensors, &name)?;
        let shape = tensors.tensor(&name).map_err(|error| error.to_string())?.shape().to_vec();
        let bias = values(tensors, &format!("{m}.{k}.bias"))?;
        let [inputs, outputs] = shape[..] else { return Err(format!("tensor {name} is no matrix")) };
        Layer::new(inputs, outputs, &weights, &bias).ok_or_else(|| format!("tensor {name} does not fit its bias"))
    };
    let all = (0..layers).map(layer).collect::<Result<Vec<_>, _>>()?;
    Member::new(all, layer(layers)?).ok_or_else(|| format!("the layers of member {m} do not follow one another"))
}

fn doubt(tensors: &SafeTensors<'_>, width: usize, limits: [f32; 3]) -> Result<Doubt, String> {
    let (whitening, centres) = (values(tensors, "doubt.whitening")?, values(tensors, "doubt.centres")?);
    let range: Vec<[f32; 2]> = values(tensors, "doubt.range")?.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
    let fits = whitening.len() == width * width && range.len() == width && centres.len() % width.max(1) == 0;
    if !fits || centres.is_empty() || !limits.iter().all(|limit| limit.is_finite() && *limit > 0.0) {
        return Err("its doubt does not fit its columns".into());
    }
    let [distance_limit, range_limit, spread_limit] = limits;
    Ok(Doubt { width, whitening, centres, range, distance_limit, range_limit, spread_limit })
}

fn normalisation(tensors: &SafeTensors<'_>, name: &str, width: usize) -> Result<Normalisation, String> {
    let (mean, inverse_sd) =
        (values(tensors, &format!("{name}.mean"))?, values(tensors, &format!("{name}.inverse_sd"))?);
    let fits = mean.len() == width && inverse_sd.len() == width && inverse_sd.iter().all(|inverse| *inverse >= 0.0);
    fits.then_some(Normalisation { mean, inverse_sd })
        .ok_or_else(|| format!("its normalisation of {name} does not fit"))
}

fn values(tensors: &SafeTensors<'_>, name: &str) -> Result<Vec<f32>, String> {
    let tensor = tensors.tensor(name).map_err(|_| format!("tensor {name} is absent"))?;
    if tensor.dtype() != Dtype::F32 {
        return Err(format!("tensor {name} is not f32"));
    }
    let values: Vec<f32> =
        tensor.data().chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
    if values.iter().all(|value| value.is_finite()) { Ok(values) } else { Err(format!("tensor {name} is not finite")) }
}

fn bytes(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}
