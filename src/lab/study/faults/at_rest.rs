//! Corrupted calibrations and networks: in files, which must be rejected when loaded, and in memory, where the loop
//! must detect them.

use std::{fs, path::Path, sync::atomic::AtomicBool, time::SystemTime};

use nalgebra::Vector3;
use nima_core::{
    calibration::gravity::{GravityModel, GravityParameters, GravityRecord},
    impedance::Mode,
    tip_force::{FeatureSettings, TrainingSettings},
};
use nima_machine::{
    config::RigConfig,
    messages::{Command, LoopState},
    rig::{Rig as _, Side},
    runtime::VirtualClock,
    teleop::{Calibrations, Loop, Timing},
};
use nima_recording::{
    store::{Store, utc_now},
    tip_force::{load_model, save_model},
};
use nima_simulation::{Worlds, scene::Scene};
use nima_training::train_model;

use super::{FaultVerdict, FaultsError, LiveFaultError, MODES, SensorAt, Special};
use crate::{
    release::{self, ReleaseSituation, ReleaseStyle},
    validation::{
        ValidationError,
        experiment::{self, SimulatedExperiment},
        isolation,
    },
};

/// Returns every fault of a file or of loaded data.
pub(super) fn all() -> Result<Vec<Special>, FaultsError> {
    let folder = tempfile::tempdir().map_err(LiveFaultError::Scratch)?;
    let gravity = experiment::gravity(1)?;
    let mut specials = vec![
        in_memory("gravity calibration with NaN in memory", &poisoned(&gravity, f64::NAN))?,
        in_memory("gravity calibration of 1e9 kg in memory", &poisoned(&gravity, 1e9))?,
        let_go()?,
    ];
    specials.extend(networks(folder.path())?);
    specials.extend(gravity_files(folder.path())?);
    Ok(specials)
}

/// Returns the same model with its mass or gain scaled by `by`.
fn poisoned(model: &GravityModel, by: f64) -> GravityModel {
    let mut poisoned = *model;
    match &mut poisoned.parameters {
        GravityParameters::Physical { mass_kg, .. } => *mass_kg = by,
        GravityParameters::Gain { gain_kg, .. } => gain_kg[2][2] = by,
        GravityParameters::Paper { force_n, .. } => force_n[2][4] = by,
    }
    poisoned
}

/// Returns a loop whose calibration is corrupted after loading: engaging must be refused.
fn in_memory(what: &str, gravity: &GravityModel) -> Result<Special, FaultsError> {
    let mut config = RigConfig::load("simulated")?;
    config.mode = Mode::Dfr;
    let known = Calibrations { gravity: Some(*gravity), ..Calibrations::default() };
    let mut control = Loop::new(&config, &[Some(known), None])?;
    let mut worlds = Worlds::new(&Scene::load(SensorAt::Wrist.scene())?, config.rate_hz);
    let mut force = false;
    for tick in 0..500_u32 {
        let now_s = f64::from(tick) * 1e-3;
        let inputs = worlds.read(now_s);
        control.clear_events();
        if tick % 100 == 50 {
            control.obey(Command::Engage, now_s);
        }
        let (outputs, _) = control.step(inputs, &Timing { now_s, ..Timing::default() });
        worlds.write(now_s, &outputs);
        force |= outputs[0].hand_force_n != Vector3::zeros() || outputs[0].drives;
    }
    let idle = control.pair(Side::Right).map(nima_machine::teleop::Pair::state) == Some(LoopState::Idle);
    Ok(Special {
        what: what.to_owned(),
        verdict: if idle && !force { FaultVerdict::Detected } else { FaultVerdict::Silent },
        report: "the force is unknown; engaging is refused".to_owned(),
        detection_ms: Some(1.0),
        zero_ms: None,
    })
}

/// Returns the hand opens on a rig without presence detection: measures the force that the gates still allow.
fn let_go() -> Result<Special, FaultsError> {
    let tissue = Scene::load("peg_transfer")?.tissue;
    let wrong = |reason: String| FaultsError::Calibration(ValidationError::Calibration(reason));
    let tissue = tissue.ok_or_else(|| wrong("peg_transfer has no tissue".to_owned()))?;
    let situation = ReleaseSituation::Held;
    let governor = true;
    let mode = MODES[0];
    let way = ReleaseStyle { clock: VirtualClock::PERFECT, situation, governor, mode, delay_ms: 50.0, contact_n: 5.0 };
    let row = release::let_go(&way, tissue).map_err(|error| wrong(error.to_string()))?;
    Ok(Special {
        what: "the hand opens, no presence detection".to_owned(),
        verdict: FaultVerdict::Bounded,
        report: format!(
            "governor: {:.1} mJ, {:.1} mm (no presence switch; docs/safety.md)",
            row.energy_mj, row.travel_mm
        ),
        detection_ms: None,
        zero_ms: None,
    })
}

/// Returns a network's file with one number made NaN, a truncated one, and one of another format.
fn networks(folder: &Path) -> Result<Vec<Special>, FaultsError> {
    let known = isolation::PriorCalibrations::calibrate(1)?;
    let scene = SimulatedExperiment::scene("isolation", 1)?;
    let data = isolation::record(&scene, &known, FeatureSettings::default(), 2000, 7.0)?.data(None)?;
    let settings = TrainingSettings { members: 1, epochs: Some(1), ..TrainingSettings::default() };
    let model = train_model(&data, &settings, [None, None], &AtomicBool::new(false), &|_| {})?;
    let path = folder.join("network.safetensors");
    save_model(&model, &path)?;
    let sound = fs::read(&path).map_err(LiveFaultError::Scratch)?;
    let mut specials = Vec::new();
    // The weights are the last tensors of the file, f32 in little-endian order.
    let mut nan = sound.clone();
    let end = nan.len();
    nan[end - 4..].copy_from_slice(&f32::NAN.to_le_bytes());
    let mut header = sound.clone();
    header[9] ^= 0xff;
    let cases = [
        ("network file with a NaN among its weights", nan),
        ("network file cut short", sound[..sound.len() / 2].to_vec()),
        ("network file with a damaged header", header),
    ];
    for (what, bytes) in cases {
        fs::write(&path, &bytes).map_err(LiveFaultError::Scratch)?;
        specials.push(refused(what, load_model(&path).err().map(|error| error.to_string()), &path));
    }
    Ok(specials)
}

fn refused(what: &str, report: Option<String>, path: &Path) -> Special {
    let verdict = if report.is_some() { FaultVerdict::Detected } else { FaultVerdict::Silent };
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let report = report
        .map_or_else(String::new, |report| format!("refused: {}", report.replace(&*path.to_string_lossy(), &name)));
    Special { what: what.to_owned(), verdict, report, detection_ms: None, zero_ms: None }
}

/// Returns a calibration file with one number made NaN, a truncated one, and a valid one of another sensor and tool.
fn gravity_files(folder: &Path) -> Result<Vec<Special>, FaultsError> {
    let wrong = |reason: String| FaultsError::Calibration(ValidationError::Calibration(reason));
    let record = experiment::gravity_report(1)?.record("S1", "grasper", &utc_now());
    let record = record.ok_or_else(|| wrong("the simulated calibration gives no record".to_owned()))?;
    let store = Store::open(folder);
    let path = store.save(&record).map_err(|error| wrong(error.to_string()))?;
    let sound = fs::read_to_string(&path).map_err(LiveFaultError::Scratch)?;
    let load = |sensor: &str, tool: &str| {
        let loaded = store.load::<GravityRecord>(sensor, tool, SystemTime::now());
        loaded.err().map(|error| error.to_string())
    };
    let mut specials = vec![refused("gravity file of another tool", load("S1", "scissors"), &path)];
    let other = store.path::<GravityRecord>("S2").map_err(|error| wrong(error.to_string()))?;
    fs::copy(&path, &other).map_err(LiveFaultError::Scratch)?;
    specials.push(refused("gravity file of another sensor", load("S2", "grasper"), &other));
    for (what, text) in [
        ("gravity file with NaN", numbers_replaced(&sound, "nan")),
        ("gravity file with infinite numbers", numbers_replaced(&sound, "inf")),
        ("gravity file cut short", sound[..sound.len() / 2].to_owned()),
    ] {
        fs::write(&path, text).map_err(LiveFaultError::Scratch)?;
        specials.push(refused(what, load("S1", "grasper"), &path));
    }
    Ok(specials)
}

/// Replaces the first bias in the text of a calibration.
fn numbers_replaced(text: &str, by: &str) -> String {
    let Some((before, after)) = text.split_once("bias_n = [") else { return String::new() };
    let rest = after.split_once(',').map_or(after, |(_, rest)| rest);
    format!("{before}bias_n = [{by},{rest}")
}
