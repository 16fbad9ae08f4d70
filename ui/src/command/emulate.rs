//! `nima emulate`: emulators on the real wire, for drivers, third-party clients and demos without hardware.
//!
//! Prints one JSON line per endpoint (`{"device": ..., "endpoint": ...}`), then serves until Ctrl-C or the end of its standard
//! input. Lines on standard input set faults: `fault NAME` (see `--help`), `fault none` takes it back; with several devices
//! `fault DEVICE NAME`.

mod bota;
mod dynamixel;
mod force_dimension;
#[cfg(target_os = "linux")]
mod hid;
mod kinova;
#[cfg(unix)]
mod ndi;

use std::{
    io::BufRead as _,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

use anyhow::{Context as _, bail};
use clap::Args;
use nima::device::emulation::{EmulatedFault, Serving};
use serde::Serialize;

use super::output;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Which devices
    #[arg(required = true, value_name = "DEVICE")]
    devices: Vec<String>,
    /// A setting of the emulated devices, as far as they have it
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
}

/// Settings by name, as given with `--set`.
#[derive(Debug, Default)]
pub(super) struct Settings(Vec<(String, String)>);

impl Settings {
    /// The value of `key`, if it was given; a value that does not read is an error.
    pub(super) fn get<T: std::str::FromStr>(&self, key: &str) -> anyhow::Result<Option<T>> {
        let Some((_, value)) = self.0.iter().find(|(known, _)| known == key) else { return Ok(None) };
        value.parse().map(Some).map_err(|_| anyhow::anyhow!("--set {key}={value} is not a usable value"))
    }
}

/// One device that serves.
pub(super) struct Emulated {
    device: String,
    serving: Serving,
}

impl Emulated {
    /// Under this name.
    pub(super) fn new(device: impl Into<String>, serving: Serving) -> Self {
        Self { device: device.into(), serving }
    }
}

/// A name on the command line and what starts it; one name may start several devices.
type Known = (&'static str, fn(&Settings) -> anyhow::Result<Vec<Emulated>>);

/// All that can be emulated.
const KNOWN: &[Known] = &[
    #[cfg(unix)]
    ("bota-gen0", bota::gen0),
    #[cfg(unix)]
    ("bota-gen-a", bota::gen_a),
    ("bota-socket", bota::socket),
    ("dynamixel", dynamixel::start),
    (force_dimension::NAME, force_dimension::start),
    ("kinova", kinova::start),
    #[cfg(unix)]
    ("ndi", ndi::network),
    #[cfg(unix)]
    ("ndi-serial", ndi::line),
    #[cfg(target_os = "linux")]
    ("pedal", hid::pedal),
    #[cfg(target_os = "linux")]
    ("spacemouse", hid::cap),
    #[cfg(target_os = "linux")]
    ("spacenavd", hid::spacenavd),
];

#[derive(Serialize)]
struct Endpoint<'a> {
    device: &'a str,
    endpoint: &'a str,
}

pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let pair = |text: &String| {
        let (key, value) = text.split_once('=').with_context(|| format!("--set {text} is not KEY=VALUE"))?;
        Ok((key.to_owned(), value.to_owned()))
    };
    let settings = Settings(arguments.set.iter().map(pair).collect::<anyhow::Result<_>>()?);
    let mut emulated = Vec::new();
    for name in &arguments.devices {
        let Some((_, start)) = KNOWN.iter().find(|(known, _)| known == name) else {
            let known: Vec<_> = KNOWN.iter().map(|(known, _)| *known).collect();
            bail!("there is no emulator \"{name}\"; there are {}", known.join(", "));
        };
        emulated.extend(start(&settings).with_context(|| format!("cannot emulate {name}"))?);
    }
    serve(&emulated)
}

/// Tells the endpoints and serves until somebody ends it.
fn serve(emulated: &[Emulated]) -> anyhow::Result<()> {
    for Emulated { device, serving } in emulated {
        output::line(&serde_json::to_string(&Endpoint { device, endpoint: &serving.endpoint })?)?;
    }
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed)).context("Ctrl-C cannot be caught")?;
    let (lines, told) = std::sync::mpsc::sync_channel(16);
    std::thread::spawn(move || {
        for line in std::io::stdin().lock().lines().map_while(Result::ok) {
            if lines.send(line).is_err() {
                return;
            }
        }
    });
    while !stop.load(Ordering::Relaxed) && emulated.iter().all(|one| one.serving.is_serving()) {
        match told.recv_timeout(Duration::from_millis(50)) {
            Ok(line) => obey(&line, emulated),
            Err(std::sync::mpsc::RecvTimeoutError::Timeout) => {}
            // Whoever started it is gone.
            Err(std::sync::mpsc::RecvTimeoutError::Disconnected) => return Ok(()),
        }
    }
    Ok(())
}

fn obey(line: &str, emulated: &[Emulated]) {
    let words: Vec<&str> = line.split_whitespace().collect();
    let (device, name) = match words[..] {
        [] => return,
        ["fault", name] => (None, name),
        ["fault", device, name] => (Some(device), name),
        _ => {
            eprintln!("\"{line}\" is not understood: fault [DEVICE] NAME");
            return;
        }
    };
    let Some(fault) = EmulatedFault::named(name) else {
        let known: Vec<_> = EmulatedFault::ALL.iter().map(|fault| fault.name()).collect();
        eprintln!("there is no fault \"{name}\": none, {}", known.join(", "));
        return;
    };
    for one in emulated.iter().filter(|one| device.is_none_or(|device| device == one.device)) {
        one.serving.faults.set(fault);
    }
}
