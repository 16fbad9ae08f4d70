//! Opens the link between two machines, at either end.

use std::net::{Ipv4Addr, SocketAddr, ToSocketAddrs as _};

use anyhow::{Context as _, bail};
use nima_machine::{
    config::RigConfig,
    remote::at_follower,
    rig::{RigEnds, Side},
};
use nima_network::{
    endpoint::{Endpoint, EndpointConfig, EndpointRole, PORT},
    keys::{NetworkKeys, Peers, PublicKey},
    stream::StreamSettings,
};
use nima_screen::link::{ArmLink, RemoteLine};
use nima_simulation::scene::Scene;

use super::line::NetworkLine;

/// The connection to a machine where `nima follower` runs.
pub(super) struct FollowerNetwork;

impl ArmLink for FollowerNetwork {
    fn is_loopback(&self, host: &str) -> bool {
        address(host).is_ok_and(|follower| follower.ip().is_loopback())
    }

    fn open(&self, host: &str, rig: &mut RigConfig, scene: &Scene) -> anyhow::Result<Box<dyn RemoteLine>> {
        without_objects(scene)?;
        let follower = address(host)?;
        let (keys, peers) = own_keys()?;
        let paired = peers.list().iter().find(|peer| peer.name == name_of(host)).map(|peer| peer.key);
        // A follower of the same user on the same machine has the same key.
        let key = paired.or_else(|| follower.ip().is_loopback().then(|| keys.public()));
        let Some(key) = key else {
            bail!("this machine is not paired with {host}: run `nima pair {host}` here and `nima pair --offer` there");
        };
        here(rig, RigEnds::Leader);
        open(arms(rig, scene), EndpointRole::Console { follower, key }, keys, RigEnds::Leader)
    }
}

/// Opens the follower's end at this address; reduces the rig to the parts at this machine.
pub(super) fn listen(rig: &mut RigConfig, scene: &Scene, at: SocketAddr) -> anyhow::Result<Box<dyn RemoteLine>> {
    without_objects(scene)?;
    let (keys, mut consoles) = own_keys()?;
    // The key of the same user's console on this machine.
    let own: PublicKey = keys.public();
    if consoles.with_key(&own).is_none() {
        consoles.add("this machine", own)?;
    }
    *rig = at_follower(rig);
    here(rig, RigEnds::Follower);
    open(arms(rig, scene), EndpointRole::Follower { at: Some(at), consoles }, keys, RigEnds::Follower)
}

/// Removes the objects: a follower's tools belong to its own simulated hand, which would perform the task by itself.
fn without_objects(scene: &Scene) -> anyhow::Result<()> {
    anyhow::ensure!(
        !scene.is_played(),
        "scene \"{}\" has a training task, which works only on one machine: choose another scene",
        scene.name
    );
    Ok(())
}

fn here(rig: &mut RigConfig, ends: RigEnds) {
    if let Some(devices) = &mut rig.devices {
        devices.ends = ends;
    }
}

fn arms(rig: &RigConfig, scene: &Scene) -> usize {
    Side::ALL.into_iter().filter(|side| scene.has(rig, *side)).count()
}

fn open(arms: usize, role: EndpointRole, keys: NetworkKeys, ends: RigEnds) -> anyhow::Result<Box<dyn RemoteLine>> {
    let endpoint =
        Endpoint::open(EndpointConfig { stream: StreamSettings::of_arms(arms), ..EndpointConfig::new(role, keys) })?;
    Ok(Box::new(NetworkLine::new(endpoint, ends)))
}

/// Returns the folder of this machine's key and of the paired machines.
pub(super) fn folder() -> anyhow::Result<std::path::PathBuf> {
    let store = nima_recording::store::Store::of_user()?;
    let folder = store.folder().parent().context("no data folder was found; set NIMA_DATA_DIR")?;
    let folder = folder.join("network");
    std::fs::create_dir_all(&folder).with_context(|| format!("cannot create the folder {}", folder.display()))?;
    Ok(folder)
}

/// This machine's key, and the paired machines.
pub(super) fn own_keys() -> anyhow::Result<(NetworkKeys, Peers)> {
    let folder = folder()?;
    Ok((NetworkKeys::open(&folder)?, Peers::open(&folder)?))
}

/// Returns the name under which a paired machine is stored: its address without the port.
pub(super) fn name_of(host: &str) -> &str {
    if host.parse::<std::net::Ipv6Addr>().is_ok() {
        return host;
    }
    host.rsplit_once(':').map_or(host, |(name, _)| name)
}

/// Returns the address of a host, with the default port if it has none.
pub(crate) fn address(host: &str) -> anyhow::Result<SocketAddr> {
    let with_port = host.to_socket_addrs();
    let mut found = with_port.or_else(|_| (host, PORT).to_socket_addrs()).with_context(|| {
        format!(
            "cannot find the machine \"{host}\": enter its name or address, and the port after a colon if it is \
             not {PORT}"
        )
    })?;
    found.next().with_context(|| format!("the machine \"{host}\" has no address"))
}

/// Returns the listening address of a follower, with the default port if it has none; loopback without an address.
pub(super) fn listening(at: Option<&str>) -> anyhow::Result<SocketAddr> {
    at.map_or_else(|| Ok((Ipv4Addr::LOCALHOST, PORT).into()), address)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_host_may_name_its_port() {
        assert_eq!(address("127.0.0.1").unwrap(), SocketAddr::from(([127, 0, 0, 1], PORT)));
        assert_eq!(address("127.0.0.1:99").unwrap(), SocketAddr::from(([127, 0, 0, 1], 99)));
        assert_eq!((name_of("theatre-2:99"), name_of("theatre-2"), name_of("::1")), ("theatre-2", "theatre-2", "::1"));
        assert!(address("no such host").unwrap_err().to_string().contains("no such host"));
        assert_eq!(listening(None).unwrap(), SocketAddr::from(([127, 0, 0, 1], PORT)));
    }
}
