//! Runs `nima department`.

use std::{
    net::{Ipv6Addr, SocketAddr},
    path::PathBuf,
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context as _, bail};
use nima_console::{
    console::monitor::{self, MonitorMessage, MonitorOptions, MonitorSender},
    shutdown::Leave,
};
use nima_machine::config::RigConfig;
use nima_panels::settings::SettingsStore;
use nima_recording::store::{Store, utc_of};
use nima_report::output;
use nima_screen::stderr::print_line;
use nima_simulation::scene::Scene;
use serde::Serialize;

use crate::{
    Authority, FoundRig, MachineIdentity, MachineRole, RecordStep, RemoteRig, RigRecording,
    arguments::{DepartmentCommand, MonitorArguments, RecordArguments, RigSelection, RigsArguments},
    find, find_at,
};

/// Default port of a shared rig.
const PORT: u16 = 7447;
/// Time for rigs on the local network to respond.
const ANSWER: Duration = Duration::from_millis(1500);
/// Time after which a silent or missing rig is searched for again.
const AGAIN: Duration = Duration::from_secs(2);

pub(super) fn run(command: &DepartmentCommand) -> anyhow::Result<()> {
    match command {
        DepartmentCommand::Create { name } => {
            let authority = Authority::create(&folder()?, name)?;
            output::line(&format!(
                "department {} created; issue a certificate to every machine with `nima department issue NAME \
                 --out FILE`",
                authority.department
            ))
        }
        DepartmentCommand::Issue { name, watcher, out } => {
            let role = if *watcher { MachineRole::Watcher } else { MachineRole::Rig };
            let identity = Authority::load(&folder()?)?.issue(name, role, out)?;
            output::line(&format!(
                "certificate of {} {} written to {}: copy it to that machine, run `nima department join` there, \
                 and delete the file",
                role.word(),
                identity.name,
                out.display()
            ))
        }
        DepartmentCommand::Join { file } => {
            let identity = MachineIdentity::join(&folder()?, file)?;
            let MachineIdentity { department, name, role, .. } = &identity;
            output::line(&format!(
                "this machine is now {} {name} of department {department}; delete {}",
                role.word(),
                file.display()
            ))
        }
        DepartmentCommand::Rigs(arguments) => rigs(arguments),
        DepartmentCommand::Monitor(arguments) => watch(arguments),
        DepartmentCommand::Record(arguments) => record(arguments),
    }
}

fn folder() -> anyhow::Result<PathBuf> {
    let store = Store::of_user()?;
    let folder = store.folder().parent().context("no data folder was found; set NIMA_DATA_DIR")?;
    Ok(folder.join("department"))
}

/// Returns the identity of this machine.
pub(super) fn own_identity() -> anyhow::Result<MachineIdentity> {
    Ok(MachineIdentity::load(&folder()?)?)
}

#[derive(Serialize)]
struct ListedRig {
    name: String,
    address: String,
    /// `None`: no loop is running there.
    rig: Option<String>,
    scene: Option<String>,
    running_since: Option<String>,
    watchers: usize,
    program: String,
}

impl ListedRig {
    fn of(found: &FoundRig) -> Self {
        let about = &found.about;
        let runs = about.session != 0;
        let name = |text: &str| toml::from_str::<toml::Table>(text).ok()?.get("name")?.as_str().map(str::to_owned);
        Self {
            name: about.name.clone(),
            address: found.address.clone(),
            rig: name(&about.rig).filter(|_| runs),
            scene: name(&about.scene).filter(|_| runs),
            running_since: runs.then(|| utc_of(std::time::UNIX_EPOCH + Duration::from_nanos(about.started_ns))),
            watchers: found.watchers,
            program: about.program.clone(),
        }
    }

    fn as_text(&self) -> String {
        let Self { name, address, rig, scene, running_since, watchers, .. } = self;
        let runs = match (rig, scene, running_since) {
            (Some(rig), Some(scene), Some(since)) => format!("rig {rig}, scene {scene}, since {since}"),
            _ => "no loop is running".to_owned(),
        };
        format!("{name} at {address}: {runs}; viewers: {watchers}")
    }
}

fn rigs(arguments: &RigsArguments) -> anyhow::Result<()> {
    let own = own_identity()?;
    let found = if arguments.at.is_empty() {
        find(&own, ANSWER)?
    } else {
        let at = |address: &String| find_at(&own, &with_port(address));
        arguments.at.iter().map(at).collect::<Result<_, _>>()?
    };
    let listed: Vec<ListedRig> = found.iter().map(ListedRig::of).collect();
    if arguments.json {
        return output::json(&listed);
    }
    if listed.is_empty() {
        return output::line(
            "no rig of this department is shared on the local network; use --at HOST for a rig elsewhere",
        );
    }
    listed.iter().try_for_each(|rig| output::line(&rig.as_text()))
}

impl RigSelection {
    fn address(&self, own: &MachineIdentity) -> anyhow::Result<String> {
        if let Some(address) = &self.at {
            return Ok(with_port(address));
        }
        let mut found = find(own, ANSWER)?;
        if let Some(name) = &self.rig {
            found.retain(|found| found.about.name == *name);
        }
        match found.as_slice() {
            [found] => Ok(found.address.clone()),
            [] => bail!(
                "no such rig of this department is shared on the local network; `nima department rigs` lists the \
                 shared rigs, --at HOST finds a rig elsewhere"
            ),
            several => {
                let names: Vec<&str> = several.iter().map(|found| found.about.name.as_str()).collect();
                bail!("several rigs are shared ({}): select one by name", names.join(", "))
            }
        }
    }
}

fn watch(arguments: &MonitorArguments) -> anyhow::Result<()> {
    let own = own_identity()?;
    let address = arguments.which.address(&own)?;
    let rig = RemoteRig::open(&own, &address)?;
    let options = MonitorOptions {
        role: arguments.role,
        language: arguments.language.unwrap_or_else(|| SettingsStore::of_user().now.language),
        exit_after: arguments.exit_after.map(Duration::from_secs_f64),
        screenshot: arguments.screenshot.clone(),
    };
    let name = rig.name().to_owned();
    monitor::open(&name, options, move |publisher| {
        let thread = thread::Builder::new().name("monitor".to_owned());
        let listen = move || listen(rig, &own, &address, &publisher);
        if let Err(error) = thread.spawn(listen) {
            print_line(format_args!("nima: cannot start a thread: {error}; close other programs, then try again"));
        }
    })
}

/// Passes a rig's data to a window until the window is closed. A missing rig is searched for again.
fn listen(rig: RemoteRig, own: &MachineIdentity, address: &str, publisher: &MonitorSender) {
    let mut rig = Some(rig);
    loop {
        let received = match rig.take() {
            Some(rig) => listen_to(&rig, publisher),
            None => {
                RemoteRig::open(own, address).map_err(anyhow::Error::from).and_then(|rig| listen_to(&rig, publisher))
            }
        };
        match received {
            Ok(()) => return,
            Err(why) => {
                tracing::warn!("{why:#}");
                if !publisher.notify(MonitorMessage::Trouble(format!("{why:#}"))) {
                    return;
                }
            }
        }
        thread::sleep(AGAIN);
    }
}

/// Returns when the window is closed.
fn listen_to(rig: &RemoteRig, publisher: &MonitorSender) -> anyhow::Result<()> {
    let (to, came) = crossbeam_channel::unbounded();
    let presence = rig.presence()?;
    let _watching = rig.watch(move |session, moments| drop(to.send((session, moments))))?;
    let mut shown = None;
    loop {
        // The current rig and scene, at the start and whenever the session changes or no data arrive.
        let about = rig.about()?;
        if shown != Some(about.session) {
            shown = Some(about.session);
            let received = if about.session == 0 {
                MonitorMessage::Rests
            } else {
                let rig: RigConfig =
                    nima_files::from_toml(&about.rig).context("cannot read the rig file sent by the rig")?;
                let scene: Scene =
                    nima_files::from_toml(&about.scene).context("cannot read the scene sent by the rig")?;
                MonitorMessage::Runs(Box::new(rig), Box::new(scene))
            };
            if !publisher.notify(received) {
                return Ok(());
            }
        }
        while let Ok((session, moments)) = came.recv_timeout(AGAIN) {
            if shown != Some(session) {
                break;
            }
            if !publisher.notify(MonitorMessage::Shows(moments?)) {
                return Ok(());
            }
        }
        if !presence.is_there() {
            bail!("rig {} was closed or cannot be reached", rig.name());
        }
    }
}

fn record(arguments: &RecordArguments) -> anyhow::Result<()> {
    let own = own_identity()?;
    let leave = Leave::on_signals()?;
    let address = arguments.which.address(&own)?;
    let rig = RemoteRig::open(&own, &address)?;
    let mut recording = RigRecording::start(&rig, &arguments.into)?;
    print_line(format_args!("nima: recording {} into {}", rig.name(), arguments.into.display()));
    let ends = arguments.seconds.map(|seconds| Instant::now() + Duration::from_secs_f64(seconds));
    let mut written = None;
    while !leave.is_asked() && ends.is_none_or(|ends| Instant::now() < ends) {
        match recording.step(Duration::from_millis(250))? {
            RecordStep::Writes { file, .. } if written.as_ref() != Some(&file) => {
                print_line(format_args!("nima: a session: {}", file.display()));
                written = Some(file);
            }
            RecordStep::Ended { file, messages } => ended(&file, messages)?,
            RecordStep::Writes { .. } | RecordStep::Waits => {}
        }
    }
    if let RecordStep::Ended { file, messages } = recording.finish()? {
        ended(&file, messages)?;
    }
    Ok(())
}

fn ended(file: &std::path::Path, messages: u64) -> anyhow::Result<()> {
    output::line(&format!("recorded {} messages into {}", messages, file.display()))
}

/// Adds the default port to an address without one.
fn with_port(address: &str) -> String {
    let has_port = address.parse::<SocketAddr>().is_ok()
        || address.rsplit_once(':').is_some_and(|(host, port)| !host.contains(':') && port.parse::<u16>().is_ok());
    match address.parse::<Ipv6Addr>() {
        Ok(ip) => format!("[{ip}]:{PORT}"),
        Err(_) if has_port => address.to_owned(),
        Err(_) => format!("{address}:{PORT}"),
    }
}

#[cfg(test)]
mod tests {
    use std::net::Ipv4Addr;

    use super::*;

    #[test]
    fn an_address_without_a_port_gets_the_usual_one() {
        let localhost = Ipv4Addr::LOCALHOST;
        for (given, expected) in [
            ("theatre-1", "theatre-1:7447".to_owned()),
            ("theatre-1:80", "theatre-1:80".to_owned()),
            ("127.0.0.1", format!("{localhost}:7447")),
            ("[::1]:9", "[::1]:9".to_owned()),
            ("::1", "[::1]:7447".to_owned()),
        ] {
            assert_eq!(with_port(given), expected);
        }
    }
}
