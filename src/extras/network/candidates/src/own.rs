//! The link of `nima-network`, with two copies of each payload, delivered on arrival.

use std::{fs, path::Path};

use nima_network::{
    endpoint::{Config, Endpoint, LinkState, Role},
    keys::{Keys, Peers},
};

use crate::{Engine, Outcome, PORT, THERE, now_ns};

pub(crate) fn prepare(folder: &Path) -> Outcome<()> {
    let folders = ["console", "follower"].map(|name| folder.join(name));
    for folder in &folders {
        fs::create_dir_all(folder)?;
    }
    let mut consoles = Peers::default();
    consoles.add("console", Keys::open(&folders[0])?.public())?;
    consoles.save(&folders[1])?;
    let mut follower = Peers::default();
    follower.add("follower", Keys::open(&folders[1])?.public())?;
    Ok(follower.save(&folders[0])?)
}

pub(crate) struct Link(Endpoint);

impl Link {
    pub(crate) fn open(sends: bool, folder: &Path) -> Outcome<Self> {
        let folder = folder.join(if sends { "console" } else { "follower" });
        let keys = Keys::open(&folder)?;
        let peers = Peers::open(&folder)?;
        let at = format!("{THERE}:{PORT}").parse()?;
        let role = if sends {
            Role::Console { follower: at, key: peers.list().first().ok_or("no key")?.key }
        } else {
            Role::Follower { at: Some(at), consoles: peers }
        };
        let mut config = Config::new(role, keys);
        config.stream.rate_max_bit_s = 4e6;
        config.stream.playout.waits = false;
        Ok(Self(Endpoint::open(config)?))
    }
}

fn now_s() -> f64 {
    now_ns() as f64 * 1e-9
}

impl Engine for Link {
    fn is_ready(&mut self) -> bool {
        self.0.state() == LinkState::Open
    }

    fn send(&mut self, payload: &[u8]) {
        self.0.send(now_s(), payload);
    }

    fn poll(&mut self, got: &mut dyn FnMut(&[u8], u64)) {
        let mut received = self.0.poll(now_s());
        while let Some(payload) = received.next_due() {
            got(payload.bytes, now_ns());
        }
    }
}
