//! The parts of a journal other than its ticks: the origin of the loop, calibrations, and the end.

use nima_core::{
    calibration::gravity::GravityModel,
    tip_force::{Fallback, LiveTipForce},
};
use nima_machine::{
    config::RigConfig,
    rig::SIDES,
    teleop::{Calibrations, LoopOrigin},
};
use nima_recording::tip_force::{model_from_bytes, model_to_bytes};

use super::JournalError;
use crate::codec::{CodecError, bytes, number, take_number};

/// Bytes that are being written.
#[derive(Debug, Default)]
pub(super) struct ByteWriter(pub(super) Vec<u8>);

impl ByteWriter {
    pub(super) fn number(&mut self, value: u64) {
        number(&mut self.0, value);
    }

    fn part(&mut self, part: &[u8]) {
        self.number(part.len() as u64);
        self.0.extend_from_slice(part);
    }
}

#[derive(Clone, Debug)]
pub struct JournalStart {
    /// Version of the program that recorded it.
    pub program: String,
    /// Origin of the loop.
    pub origin: LoopOrigin,
}

impl JournalStart {
    pub(super) fn put(&self, to: &mut ByteWriter) -> Result<(), JournalError> {
        let Self { program, origin } = self;
        let LoopOrigin { rig, calibrations, suspended } = origin;
        to.part(program.as_bytes());
        to.part(rig_text(rig)?.as_bytes());
        to.number(u64::from(*suspended));
        for of_side in calibrations {
            to.number(u64::from(of_side.is_some()));
            if let Some(of_side) = of_side {
                put_calibrations(of_side, to)?;
            }
        }
        Ok(())
    }

    pub(super) fn take(from: &mut &[u8]) -> Result<Self, JournalError> {
        let program = text(from)?;
        let rig = read_rig(&text(from)?)?;
        let suspended = flag(from)?;
        let mut calibrations: [Option<Calibrations>; SIDES] = Default::default();
        for of_side in &mut calibrations {
            *of_side = if flag(from)? { Some(take_calibrations(from)?) } else { None };
        }
        Ok(Self { program, origin: LoopOrigin { rig, calibrations, suspended } })
    }
}

/// Returns a text of a rig's settings that reads back as the same rig.
fn rig_text(rig: &RigConfig) -> Result<String, JournalError> {
    let part = |why: String| JournalError::Part { what: "rig", why };
    // Nothing in the loop depends on a password.
    let rig = without_checked(rig).without_secrets();
    let text = toml::to_string(&rig).map_err(|error| part(error.to_string()))?;
    if read_rig(&text)? == rig { Ok(text) } else { Err(part("it changes when it is written and read back".to_owned())) }
}

/// The devices of the last ready check are not part of a rig's text, and nothing in the loop depends on them.
fn without_checked(rig: &RigConfig) -> RigConfig {
    let mut rig = rig.clone();
    rig.remember(None);
    rig
}

fn read_rig(text: &str) -> Result<RigConfig, JournalError> {
    // With the limits of a rig file, because they bound the sizes of buffers and windows.
    let read = RigConfig::parse("in the journal".as_ref(), text);
    read.map_err(|error| JournalError::Part { what: "rig", why: error.to_string() })
}

/// Replaces the name of a person.
const WITHHELD: &str = "(withheld)";

pub(super) fn put_calibrations(calibrations: &Calibrations, to: &mut ByteWriter) -> Result<(), JournalError> {
    // The reported quality of a calibration does not affect the loop.
    let Calibrations { gravity, tip_force, gravity_check: _ } = calibrations;
    let part = |what: &'static str| move |why: String| JournalError::Part { what, why };
    let gravity = gravity.as_ref().map(toml::to_string).transpose();
    let gravity = gravity.map_err(|error| part("gravity calibration")(error.to_string()))?;
    to.part(gravity.unwrap_or_default().as_bytes());
    let Some(tip_force) = tip_force else {
        to.part(&[]);
        return Ok(());
    };
    let mut model = tip_force.model().clone();
    // The name of the person who accepted an unproven network does not affect the loop and must not be shared with a
    // session.
    if let Some(check) = &mut model.origin.check {
        for text in [&mut check.judgement.override_by, &mut check.judgement.override_reason].into_iter().flatten() {
            WITHHELD.clone_into(text);
        }
    }
    let model = model_to_bytes(&model).map_err(part("network"))?;
    to.part(&model);
    to.number(match tip_force.fallback() {
        Fallback::WristForce => 0,
        Fallback::HoldAndFade => 1,
    });
    Ok(())
}

pub(super) fn take_calibrations(from: &mut &[u8]) -> Result<Calibrations, JournalError> {
    let part = |what: &'static str| move |why: String| JournalError::Part { what, why };
    let gravity = text(from)?;
    let gravity: Option<GravityModel> = if gravity.is_empty() {
        None
    } else {
        Some(
            nima_files::from_toml(&gravity)
                .map_err(|misfit| part("gravity calibration")(misfit.message().to_owned()))?,
        )
    };
    let model = take_part(from)?;
    let tip_force = if model.is_empty() {
        None
    } else {
        let model = model_from_bytes(model).map_err(part("network"))?;
        let fallback = match take_number(from)? {
            0 => Fallback::WristForce,
            1 => Fallback::HoldAndFade,
            _ => return Err(CodecError::NoSuchValue.into()),
        };
        Some(LiveTipForce::new(model, fallback).map_err(|error| part("network")(error.to_string()))?)
    };
    Ok(Calibrations { gravity, tip_force, gravity_check: None })
}

/// The end of a journal that was closed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JournalEnd {
    /// Number of ticks in the journal.
    pub ticks: u64,
    /// Number of dropped entries.
    pub lost: u64,
}

impl JournalEnd {
    pub(super) fn put(&self, to: &mut ByteWriter) {
        let Self { ticks, lost } = *self;
        to.number(ticks);
        to.number(lost);
    }

    pub(super) fn take(from: &mut &[u8]) -> Result<Self, JournalError> {
        Ok(Self { ticks: take_number(from)?, lost: take_number(from)? })
    }
}

fn take_part<'a>(from: &mut &'a [u8]) -> Result<&'a [u8], CodecError> {
    let length = usize::try_from(take_number(from)?).map_err(|_| CodecError::NoSuchValue)?;
    bytes(from, length)
}

fn text(from: &mut &[u8]) -> Result<String, CodecError> {
    take_part(from).and_then(|part| String::from_utf8(part.to_vec()).map_err(|_| CodecError::NoSuchValue))
}

fn flag(from: &mut &[u8]) -> Result<bool, CodecError> {
    match take_number(from)? {
        0 => Ok(false),
        1 => Ok(true),
        _ => Err(CodecError::NoSuchValue),
    }
}
