//! `nima devices`: lists connected devices, tests the requested ones, and prints cause and remedy of each problem.

use std::fmt::Write as _;

use anyhow::{Context as _, bail};
use clap::Args;
use nima_devices::{
    ConnectionState,
    discovery::{
        DiscoveryDiagnosis, FoundDevice, KINDS, PluggedDevices, TIMEOUT, TestOutcome, diagnose, probe_named, rules,
    },
};
use nima_machine::config::RigConfig;
use nima_report::output;
use serde::Serialize;

#[derive(Debug, Args)]
pub(super) struct DevicesArguments {
    /// Test this device; may be repeated: `spacemouse`, `pedal`, `force-dimension`, `haply`, `kinova`, `ndi`, `dynamixel`,
    /// `bota-gen0`, `bota-gen-a`, `bota-socket`, `ati`, `external-handle`, `external-arm`, `external-sensor`, each with `=PLACE`;
    /// `serial=PORT@BAUD[,HEADER][,quiet]`, `tcp=HOST:PORT`
    #[arg(long, value_name = "KIND[=PLACE]")]
    probe: Vec<String>,
    /// Test every device of a rig (name or file); close any console that uses them first
    #[arg(long, value_name = "RIG")]
    rig: Option<String>,
    /// Print the results as one JSON object
    #[arg(long)]
    json: bool,
    /// Print the command that grants access to the devices without root
    #[arg(long, conflicts_with_all = ["json", "probe", "rig"])]
    udev: bool,
    /// Print the udev rules
    #[arg(long, conflicts_with_all = ["json", "probe", "rig", "udev"])]
    udev_rules: bool,
}

#[derive(Serialize)]
struct DevicesReport {
    plugged: PluggedDevices,
    cameras: Vec<CameraReport>,
    devices: Vec<DiscoveryDiagnosis>,
}

#[derive(Serialize)]
struct CameraReport {
    path: std::path::PathBuf,
    name: String,
}

fn cameras() -> Vec<CameraReport> {
    nima_endoscope::plugged_cameras()
        .into_iter()
        .map(|camera| CameraReport { path: camera.path, name: camera.name })
        .collect()
}

pub(super) fn run(arguments: &DevicesArguments) -> anyhow::Result<()> {
    if arguments.udev_rules {
        return output::line(rules::RULES.trim_end());
    }
    if arguments.udev {
        let program = std::env::current_exe().context("cannot find the path of this program")?;
        return output::line(&rules::install_command(&program.to_string_lossy()));
    }
    let mut probes = Vec::new();
    let mut emulated = None;
    for text in &arguments.probe {
        probes.push(probe_named(text).map_err(|trouble| anyhow::anyhow!("{trouble}"))?);
    }
    if let Some(name) = &arguments.rig {
        let rig = RigConfig::load(name)?;
        if rig.devices.is_none() && !rig.has_real_hand() {
            anyhow::ensure!(
                rig.desk.is_none(),
                "rig \"{}\" is simulated; test the devices on its desk with --probe spacemouse and --probe pedal",
                rig.name
            );
            bail!("rig \"{}\" is simulated: it has no devices", rig.name);
        }
        probes.extend(rig.probes());
        emulated = rig.devices.is_some_and(|devices| devices.emulated).then_some(name);
    }
    let report =
        DevicesReport { plugged: PluggedDevices::list(), cameras: cameras(), devices: diagnose(probes, TIMEOUT) };
    if arguments.json {
        output::json(&report)?;
        return end(&report);
    }
    let mut text = as_text(&report);
    if let Some(rig) = emulated.filter(|_| report.devices.iter().all(is_trouble)) {
        // The remedies are for real devices, not emulated ones.
        writeln!(
            text,
            "\nThis rig is emulated: start its devices with `nima emulate rig --rig {rig}` in another terminal"
        )
        .ok();
    }
    output::line(text.trim_end())?;
    end(&report)
}

/// Returns an error if a device has a problem, so that scripts detect it.
fn end(report: &DevicesReport) -> anyhow::Result<()> {
    let troubled = report.devices.iter().filter(|device| is_trouble(device)).count();
    let all = report.devices.len();
    if troubled > 0 {
        bail!("{troubled} of {all} devices cannot be used; cause and remedy are given for each");
    }
    Ok(())
}

const fn is_trouble(device: &DiscoveryDiagnosis) -> bool {
    matches!(device.outcome, TestOutcome::Trouble { .. })
}

/// Formats rows in columns as wide as their widest entry.
fn table(text: &mut String, rows: &[[String; 3]]) {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let first = width(0);
    let second = width(1);
    for [a, b, c] in rows {
        writeln!(text, "{}", format!("  {a:first$}  {b:second$}  {c}").trim_end()).ok();
    }
}

fn as_text(report: &DevicesReport) -> String {
    let DevicesReport { plugged, cameras, devices } = report;
    let mut text = String::from("Plugged in\n");
    let mut rows = plugged.lines();
    rows.extend(
        cameras.iter().map(|camera| [camera.path.display().to_string(), "camera".to_owned(), camera.name.clone()]),
    );
    if rows.is_empty() {
        text.push_str("  no usable device found\n");
    }
    table(&mut text, &rows);
    text.push_str("\nTested\n");
    if devices.is_empty() {
        let kinds: Vec<_> = KINDS.iter().map(|kind| kind.name).collect();
        writeln!(
            text,
            "  nothing requested; --rig RIG tests all devices of a rig, --probe KIND[=PLACE] one of: {}",
            kinds.join(", ")
        )
        .ok();
    }
    let width = devices.iter().map(|device| device.name.chars().count()).max().unwrap_or(0);
    for DiscoveryDiagnosis { name, outcome, .. } in devices {
        match outcome {
            TestOutcome::Connected(found) => writeln!(text, "  {name:width$}  {}", device_text(found)).ok(),
            TestOutcome::Trouble { cause, cure, .. } => {
                writeln!(text, "  {name:width$}  problem: {cause}\n  {:width$}  {cure}", "").ok()
            }
        };
    }
    text
}

fn device_text(found: &FoundDevice) -> String {
    let standing = match found.standing {
        ConnectionState::Lost(loss) => format!("lost: {}", loss.cause()),
        _ => "connected".to_owned(),
    };
    let mut words = vec![standing];
    let identity = &found.identity;
    words.extend(
        [&identity.product, &identity.serial, &identity.firmware].into_iter().filter(|word| !word.is_empty()).cloned(),
    );
    words.extend(found.rate_hz.map(|rate_hz| format!("{rate_hz:.0} Hz")));
    if found.readings > 0 || found.lost + found.damaged > 0 {
        words.push(format!("{} readings, {} lost, {} damaged", found.readings, found.lost, found.damaged));
    }
    words.extend(found.note.map(str::to_owned));
    words.extend(found.latency_s.map(|latency_s| format!("answers in {:.1} ms", latency_s * 1e3)));
    words.join(", ")
}
