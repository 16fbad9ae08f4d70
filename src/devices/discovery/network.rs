//! Tests whether a server listens at a network address.

use std::{
    net::ToSocketAddrs as _,
    time::{Duration, Instant},
};

use super::{Found, Probe};
use crate::{Identity, Standing, Trouble, transport::Tcp};

/// A probe of a TCP address; connects and disconnects.
#[derive(Debug)]
pub struct TcpProbe {
    address: String,
}

impl TcpProbe {
    /// Creates a probe of an address `host:port`.
    ///
    /// # Errors
    /// [`Trouble::Setting`] if the text is not an address with a port.
    pub fn new(address: &str) -> Result<Self, Trouble> {
        let has_port =
            address.rsplit_once(':').is_some_and(|(host, port)| !host.is_empty() && port.parse::<u16>().is_ok());
        if has_port { Ok(Self { address: address.to_owned() }) } else { Err(setting(address, "HOST:PORT")) }
    }
}

fn setting(address: &str, allowed: &str) -> Trouble {
    Trouble::Setting { key: "address".to_owned(), value: address.to_owned(), allowed: allowed.to_owned() }
}

impl Probe for TcpProbe {
    fn name(&self) -> &str {
        &self.address
    }

    fn probe(&mut self, timeout: Duration) -> Result<Found, Trouble> {
        let unknown = |_| setting(&self.address, "a host name that exists in this network");
        let resolved = self.address.to_socket_addrs().map_err(unknown)?.next();
        let resolved = resolved.ok_or_else(|| Trouble::Unreachable { place: self.address.clone() })?;
        let begin = Instant::now();
        // Report the address as given, not as resolved.
        let of = |trouble| match trouble {
            Trouble::Unreachable { .. } => Trouble::Unreachable { place: self.address.clone() },
            Trouble::NobodyListens { .. } => Trouble::NobodyListens { place: self.address.clone() },
            other => other,
        };
        drop(Tcp::open(&resolved.to_string(), timeout).map_err(of)?);
        let identity = Identity { product: "somebody listens".to_owned(), ..Identity::default() };
        let latency_s = Some(begin.elapsed().as_secs_f64());
        Ok(Found { identity, standing: Standing::Connected, latency_s, ..Found::default() })
    }
}
