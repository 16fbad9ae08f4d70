//! The file of a trained model: one safetensors file with the weights as tensors and everything else as metadata.
//!
//! The file contains names of inputs and outputs (which include units), normalisation, weights, limits of uncertainty,
//! baselines and origin. Loading checks everything that inference relies on; a missing or inconsistent part gives one
//! clear error. f32.

use std::path::Path;

use nima_core::tip_force::{
    Baselines, Doubt, Expansion, ForceModel, Member, ModelOrigin, Normalisation, TipForceLayer, TipForceNetwork,
};
use nima_files::{PASSAGE, shortened, write_atomically};
use safetensors::{Dtype, SafeTensors, tensor::TensorView};
use serde::{Deserialize, Serialize};

pub use stored_model::{keep_model, kept_model};

use super::TipForceError;

mod stored_model;

/// Format names in the file: the current one, and the one before checksums.
const FORMAT: &str = "nima tip force 3";
const FORMAT_UNCHECKED: &str = "nima tip force 2";
const KEY: &str = "nima";
/// CRC-32 of everything else, in hexadecimal digits.
const CHECKSUM: &str = "nima checksum";

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ModelHeader {
    format: String,
    inputs: Vec<String>,
    outputs: Vec<String>,
    members: usize,
    layers: usize,
    limits: [f32; 3],
    baselines: Baselines,
    origin: ModelOrigin,
}

/// Writes the file; on an error the old file, if any, is unchanged.
///
/// # Errors
/// [`TipForceError`] if the file cannot be written.
pub fn save_model(model: &ForceModel, path: &Path) -> Result<(), TipForceError> {
    let wrong = |reason: String| TipForceError::Write { path: path.to_owned(), reason };
    let file = model_to_bytes(model).map_err(wrong)?;
    write_atomically(path, |to| to.write_all(&file)).map_err(|error| wrong(error.to_string()))
}

/// Returns the bytes of such a file.
///
/// # Errors
/// A message with the reason.
pub fn model_to_bytes(model: &ForceModel) -> Result<Vec<u8>, String> {
    let tensors: Vec<(String, Vec<usize>, Vec<u8>)> =
        tensors_of(model).into_iter().map(|(name, shape, values)| (name, shape, bytes(&values))).collect();
    let views = tensors
        .iter()
        .map(|(name, shape, data)| TensorView::new(Dtype::F32, shape.clone(), data).map(|view| (name, view)))
        .collect::<Result<Vec<_>, _>>()
        .map_err(|error| error.to_string())?;
    let header = ModelHeader {
        format: FORMAT.to_owned(),
        inputs: model.inputs.clone(),
        outputs: model.outputs.clone(),
        members: model.network.members().len(),
        layers: model.network.members()[0].layers().len(),
        limits: [model.doubt.distance_limit, model.doubt.range_limit, model.doubt.spread_limit],
        baselines: model.baselines.clone(),
        origin: model.origin.clone(),
    };
    let text = serde_json::to_string(&header).map_err(|error| error.to_string())?;
    let parts = tensors.iter().map(|(name, shape, data)| (name.as_str(), shape.as_slice(), data.as_slice()));
    let checksum = checksum(&text, parts.collect());
    let metadata = [(KEY.to_owned(), text), (CHECKSUM.to_owned(), checksum)].into_iter().collect();
    safetensors::serialize(views, Some(metadata)).map_err(|error| error.to_string())
}

/// Computes the checksum of the header and of the tensors, in the order of their names.
fn checksum(header: &str, mut tensors: Vec<(&str, &[usize], &[u8])>) -> String {
    tensors.sort_unstable();
    let mut hash = crc32fast::Hasher::new();
    hash.update(header.as_bytes());
    for (name, shape, data) in tensors {
        hash.update(name.as_bytes());
        for size in shape {
            hash.update(&(*size as u64).to_le_bytes());
        }
        hash.update(data);
    }
    format!("{:08x}", hash.finalize())
}

fn tensors_of(model: &ForceModel) -> Vec<(String, Vec<usize>, Vec<f32>)> {
    let flat = |name: &str, values: Vec<f32>| (name.to_owned(), vec![values.len()], values);
    let mut all = vec![
        flat("soft", model.expansion.soft(model.inputs.len())),
        flat("features.mean", model.features.mean.clone()),
        flat("features.inverse_sd", model.features.inverse_sd.clone()),
        flat("outputs.mean", model.scale.mean.clone()),
        flat("outputs.inverse_sd", model.scale.inverse_sd.clone()),
        flat("doubt.whitening", model.doubt.whitening.clone()),
        flat("doubt.centres", model.doubt.centres.clone()),
        flat("doubt.range", model.doubt.range.iter().flatten().copied().collect()),
    ];
    for (m, member) in model.network.members().iter().enumerate() {
        for (k, layer) in member.layers().iter().chain([member.skip()]).enumerate() {
            let (inputs, outputs) = layer.shape();
            all.push((format!("{m}.{k}.weights"), vec![inputs, outputs], layer.weights()));
            all.push(flat(&format!("{m}.{k}.bias"), layer.bias().to_vec()));
        }
    }
    all
}

/// Reads and checks a file.
///
/// # Errors
/// [`TipForceError`] if the file cannot be read, is not a model, or its parts are inconsistent.
///
/// ```
/// use nima_recording::tip_force::load_model;
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("net.safetensors");
/// std::fs::write(&path, [0; 64])?;
/// assert!(load_model(&path).is_err());
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn load_model(path: &Path) -> Result<ForceModel, TipForceError> {
    let open = |error: std::io::Error| TipForceError::Open { path: path.to_owned(), reason: error.to_string() };
    let file = nima_files::read(path, nima_files::MODEL_MAX).map_err(open)?;
    let unusable = |reason: String| TipForceError::Model { path: path.to_owned(), reason: shortened(&reason, PASSAGE) };
    model_from_bytes(&file).map_err(unusable)
}

/// Parses and checks the bytes of such a file.
///
/// # Errors
/// A message with the fault.
pub fn model_from_bytes(file: &[u8]) -> Result<ForceModel, String> {
    let (_, metadata) =
        SafeTensors::read_metadata(file).map_err(|error| format!("it is not a safetensors file ({error})"))?;
    let tensors = SafeTensors::deserialize(file).map_err(|error| format!("it is not a safetensors file ({error})"))?;
    let text =
        metadata.metadata().as_ref().and_then(|texts| texts.get(KEY)).ok_or("it has no metadata of this program")?;
    let header: ModelHeader =
        serde_json::from_str(text).map_err(|error| format!("its metadata are invalid ({error})"))?;
    if header.format != FORMAT && header.format != FORMAT_UNCHECKED {
        return Err(format!("its format is \"{}\", but this version reads \"{FORMAT}\"", header.format));
    }
    let read = |name: &str| values(&tensors, name);
    let soft = read("soft")?;
    let expansion = Expansion::new(&header.inputs, &soft).ok_or("its speeds have no scale")?;
    let features = normalisation(&tensors, "features", expansion.width())?;
    let scale = normalisation(&tensors, "outputs", header.outputs.len())?;
    let members =
        (0..header.members).map(|m| member(&tensors, m, header.layers)).collect::<Result<Vec<_>, String>>()?;
    let network = TipForceNetwork::new(members).ok_or("its members do not match one another")?;
    if network.shape() != (expansion.width(), header.outputs.len()) {
        return Err("its weights do not match its columns".into());
    }
    if !header.baselines.fits(header.inputs.len(), header.outputs.len()) {
        return Err("its baselines do not match its columns".into());
    }
    let doubt = doubt(&tensors, expansion.measured(), header.limits)?;
    // Last, because the other checks give a more specific reason.
    let all = tensors.tensors();
    let parts = all.iter().map(|(name, view)| (name.as_str(), view.shape(), view.data()));
    match metadata.metadata().as_ref().and_then(|texts| texts.get(CHECKSUM)) {
        None if header.format == FORMAT_UNCHECKED => {}
        Some(stated) if *stated == checksum(text, parts.collect()) => {}
        _ => return Err("its content does not match its checksum: the file was changed or damaged".into()),
    }
    let ModelHeader { inputs, outputs, baselines, origin, .. } = header;
    Ok(ForceModel { inputs, outputs, expansion, features, scale, network, doubt, baselines, origin })
}

fn member(tensors: &SafeTensors<'_>, m: usize, layers: usize) -> Result<Member, String> {
    let layer = |k: usize| {
        let name = format!("{m}.{k}.weights");
        let weights = values(tensors, &name)?;
        let shape = tensors.tensor(&name).map_err(|error| error.to_string())?.shape().to_vec();
        let bias = values(tensors, &format!("{m}.{k}.bias"))?;
        let [inputs, outputs] = shape[..] else { return Err(format!("tensor {name} is not a matrix")) };
        TipForceLayer::new(inputs, outputs, &weights, &bias)
            .ok_or_else(|| format!("tensor {name} does not match its bias"))
    };
    let all = (0..layers).map(layer).collect::<Result<Vec<_>, _>>()?;
    Member::new(all, layer(layers)?).ok_or_else(|| format!("the layers of member {m} do not match one another"))
}

fn doubt(tensors: &SafeTensors<'_>, width: usize, limits: [f32; 3]) -> Result<Doubt, String> {
    let whitening = values(tensors, "doubt.whitening")?;
    let centres = values(tensors, "doubt.centres")?;
    let range: Vec<[f32; 2]> = values(tensors, "doubt.range")?.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
    let fits = whitening.len() == width * width && range.len() == width && centres.len() % width.max(1) == 0;
    if !fits || centres.is_empty() || !limits.iter().all(|limit| limit.is_finite() && *limit > 0.0) {
        return Err("its uncertainty limits do not match its columns".into());
    }
    let [distance_limit, range_limit, spread_limit] = limits;
    Ok(Doubt { width, whitening, centres, range, distance_limit, range_limit, spread_limit })
}

fn normalisation(tensors: &SafeTensors<'_>, name: &str, width: usize) -> Result<Normalisation, String> {
    let (mean, inverse_sd) =
        (values(tensors, &format!("{name}.mean"))?, values(tensors, &format!("{name}.inverse_sd"))?);
    let fits = mean.len() == width && inverse_sd.len() == width && inverse_sd.iter().all(|inverse| *inverse >= 0.0);
    fits.then_some(Normalisation { mean, inverse_sd })
        .ok_or_else(|| format!("its normalisation of {name} does not match its columns"))
}

fn values(tensors: &SafeTensors<'_>, name: &str) -> Result<Vec<f32>, String> {
    let tensor = tensors.tensor(name).map_err(|_| format!("tensor {name} is missing"))?;
    if tensor.dtype() != Dtype::F32 {
        return Err(format!("tensor {name} is not f32"));
    }
    let values: Vec<f32> =
        tensor.data().chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
    if values.iter().all(|value| value.is_finite()) {
        Ok(values)
    } else {
        Err(format!("tensor {name} contains a non-finite number"))
    }
}

fn bytes(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}
