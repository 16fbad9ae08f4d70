//! `nima emulate`: emulators on the real interfaces, for drivers, third-party clients and demos without hardware.
//!
//! Prints one JSON line per endpoint (`{"device": ..., "endpoint": ...}`), then serves until Ctrl-C, or until its standard
//! input ends if that is a pipe or a terminal, so that it does not outlive the process that started it. Lines on standard
//! input set faults: `fault NAME` (see `--help`), `fault none` removes it; with several devices `fault DEVICE NAME`, where a
//! name with blanks is written in quotes or with dashes. `nima emulate rig` emulates a whole rig with one simulated world;
//! `pedal BITS` presses its pedal's switches, `screen ...` gives its technician an instruction.

mod link;
#[cfg(unix)]
mod rig;

#[cfg(unix)]
use std::io::IsTerminal as _;
use std::{io::BufRead as _, sync::mpsc::RecvTimeoutError, time::Duration};

use anyhow::{Context as _, bail};
use clap::Args;
use nima_emulation::emulators::{ALONE, EmulatedFault, EmulatorSettings, EmulatorThread};
use nima_report::output;
use nima_screen::stderr::print_line;
use serde::Serialize;

#[cfg(unix)]
use crate::command::rig_args::default_scene;
use crate::shutdown::Leave;

#[derive(Debug, Args)]
pub(super) struct EmulateArguments {
    /// Devices to emulate (an unknown name lists them); `rig` for all devices of a rig, `link` for a bad network between two machines
    #[arg(required = true, value_name = "DEVICE")]
    devices: Vec<String>,
    /// Setting of the emulated devices; an unknown key lists those of the devices
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// With `rig`: the rig, built-in name or TOML file
    #[arg(long, default_value = "emulated")]
    rig: String,
    /// With `rig`: the scene, built-in name or TOML file (default: `bimanual` for a rig with two arms, else `peg_transfer`)
    #[arg(long)]
    scene: Option<String>,
    /// Fault to activate at the start, as with `fault NAME` on standard input; an unknown name lists all faults
    #[arg(long, value_name = "NAME")]
    fault: Option<String>,
    /// End silently when standard input closes, for a parent process that holds its other end
    #[arg(long, hide = true)]
    until_input_ends: bool,
}

#[derive(Serialize)]
struct EmulatorEndpoint<'a> {
    device: &'a str,
    endpoint: &'a str,
}

pub(super) fn run(arguments: &EmulateArguments) -> anyhow::Result<()> {
    if arguments.fault.is_some() && arguments.devices.iter().any(|name| name == "rig" || name == "link") {
        bail!(
            "--fault applies only to single devices: for a rig or a link write `fault DEVICE NAME` to standard input"
        );
    }
    if !arguments.set.is_empty() && arguments.devices.iter().any(|name| name == "rig") {
        bail!(
            "--set applies only to single devices and links: write the settings of an emulated rig into its rig file"
        );
    }
    #[cfg(unix)]
    if arguments.devices == ["rig"] {
        return rig::run(
            &arguments.rig,
            arguments.scene.as_deref().unwrap_or_else(|| default_scene(&arguments.rig)),
            arguments.until_input_ends,
        );
    }
    if arguments.devices == ["link"] {
        return link::run(&arguments.set);
    }
    let settings = EmulatorSettings::new(&arguments.set)?;
    let fault = arguments.fault.as_deref().map(fault_named).transpose().map_err(anyhow::Error::msg)?;
    let mut emulated = Vec::new();
    let mut made = Vec::new();
    for name in &arguments.devices {
        let Some((known, maker)) = ALONE.iter().find(|(known, _)| known == name) else {
            let known: Vec<_> = ALONE.iter().map(|(known, _)| *known).collect();
            bail!("unknown emulator \"{name}\"; known: {}", known.join(", "));
        };
        made.push((*known, maker(&settings).with_context(|| format!("cannot emulate {name}"))?));
    }
    settings.check()?;
    for (name, emulator) in made {
        emulated.push((name, emulator.serve().with_context(|| format!("cannot emulate {name}"))?));
    }
    for (_, serving) in &emulated {
        serving.faults.set(fault.unwrap_or_default());
    }
    let served: Vec<_> = emulated.iter().map(|(device, serving)| (*device, serving)).collect();
    serve(&served, arguments.until_input_ends, |_| false)
}

/// Prints the endpoints and serves until the end is requested. Other lines on standard input are passed to `other`, which
/// returns whether it accepts them.
fn serve(
    emulated: &[(&str, &EmulatorThread)],
    until_input_ends: bool,
    other: impl Fn(&str) -> bool,
) -> anyhow::Result<()> {
    for (device, serving) in emulated {
        output::line(&serde_json::to_string(&EmulatorEndpoint { device, endpoint: &serving.endpoint })?)?;
    }
    let leave = Leave::on_signals()?;
    let (lines, report) = std::sync::mpsc::sync_channel(16);
    std::thread::spawn(move || {
        for line in std::io::stdin().lock().lines().map_while(Result::ok) {
            if lines.send(line).is_err() {
                return;
            }
        }
    });
    let held = until_input_ends || input_is_held();
    while !leave.is_asked() && emulated.iter().all(|(_, serving)| serving.is_serving()) {
        match report.recv_timeout(Duration::from_millis(50)) {
            Ok(line) if other(&line) => {}
            Ok(line) => obey(&line, emulated),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) if held => {
                if !until_input_ends {
                    print_line("nima: standard input has ended: the emulators end too");
                }
                return Ok(());
            }
            // Standard input is missing, or was a file that has been read to its end.
            Err(RecvTimeoutError::Disconnected) => std::thread::sleep(Duration::from_millis(50)),
        }
    }
    Ok(())
}

/// Returns whether another process or a person at a terminal holds the other end of standard input.
#[cfg(unix)]
fn input_is_held() -> bool {
    use std::os::{fd::AsFd as _, unix::fs::FileTypeExt as _};
    let stdin = std::io::stdin();
    let kind = stdin.as_fd().try_clone_to_owned().and_then(|input| std::fs::File::from(input).metadata());
    stdin.is_terminal() || kind.is_ok_and(|kind| kind.file_type().is_fifo() || kind.file_type().is_socket())
}

/// Returns whether another process or a person at a terminal holds the other end of standard input.
#[cfg(not(unix))]
fn input_is_held() -> bool {
    true
}

/// Returns a device name in normal form, for blanks written in any way.
fn plain(name: &str) -> String {
    name.trim_matches(['"', '\'']).replace('-', " ")
}

fn fault_named(name: &str) -> Result<EmulatedFault, String> {
    EmulatedFault::named(name).ok_or_else(|| {
        let known: Vec<_> = EmulatedFault::every().map(EmulatedFault::name).collect();
        format!("unknown fault \"{name}\"; known: none, {}", known.join(", "))
    })
}

fn obey(line: &str, emulated: &[(&str, &EmulatorThread)]) {
    let words: Vec<&str> = line.split_whitespace().collect();
    let (device, name) = match words[..] {
        [] => return,
        ["fault", name] => (None, name),
        ["fault", ref device @ .., name] => (Some(plain(&device.join(" "))), name),
        _ => {
            print_line(format_args!("unknown command \"{line}\"; expected: fault [DEVICE] NAME"));
            return;
        }
    };
    let fault = match fault_named(name) {
        Ok(fault) => fault,
        Err(unknown) => {
            print_line(unknown);
            return;
        }
    };
    let meant = |known: &str| device.as_ref().is_none_or(|device| *device == plain(known));
    if !emulated.iter().any(|(known, _)| meant(known)) {
        let known: Vec<_> = emulated.iter().map(|(known, _)| *known).collect();
        print_line(format_args!(
            "unknown device \"{}\"; known: {}",
            device.as_deref().unwrap_or_default(),
            known.join(", ")
        ));
    }
    for (_, serving) in emulated.iter().filter(|(known, _)| meant(known)) {
        serving.faults.set(fault);
    }
}
