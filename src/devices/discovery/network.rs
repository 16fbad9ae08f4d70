//! Tests whether a server listens at a network address.

use std::{
    net::ToSocketAddrs as _,
    time::{Duration, Instant},
};

use super::{FoundDevice, Probe};
use crate::{
    ConnectionState, DeviceError, DeviceIdentity,
    transport::{Tcp, check_no_example},
};

/// A probe of a TCP address; connects and disconnects.
#[derive(Debug)]
pub struct TcpProbe {
    address: String,
}

impl TcpProbe {
    /// Creates a probe of an address `host:port`.
    ///
    /// # Errors
    /// [`DeviceError::Setting`] if the text is not an address with a port.
    pub fn new(address: &str) -> Result<Self, DeviceError> {
        let has_port =
            address.rsplit_once(':').is_some_and(|(host, port)| !host.is_empty() && port.parse::<u16>().is_ok());
        if has_port { Ok(Self { address: address.to_owned() }) } else { Err(setting(address, "HOST:PORT")) }
    }
}

fn setting(address: &str, allowed: &str) -> DeviceError {
    DeviceError::Setting { key: "address".to_owned(), value: address.to_owned(), allowed: allowed.to_owned() }
}

impl Probe for TcpProbe {
    fn name(&self) -> &str {
        &self.address
    }

    fn probe(&mut self, timeout: Duration) -> Result<FoundDevice, DeviceError> {
        check_no_example(&self.address)?;
        let unknown = |_| setting(&self.address, "a host name that exists in this network");
        let resolved = self.address.to_socket_addrs().map_err(unknown)?.next();
        let resolved = resolved.ok_or_else(|| DeviceError::Unreachable { place: self.address.clone() })?;
        let begin = Instant::now();
        // Report the address as given, not as resolved.
        let of = |trouble| match trouble {
            DeviceError::Unreachable { .. } => DeviceError::Unreachable { place: self.address.clone() },
            DeviceError::NobodyListens { .. } => DeviceError::NobodyListens { place: self.address.clone() },
            other => other,
        };
        drop(Tcp::open(&resolved.to_string(), timeout).map_err(of)?);
        let identity = DeviceIdentity { product: "somebody listens".to_owned(), ..DeviceIdentity::default() };
        let latency_s = Some(begin.elapsed().as_secs_f64());
        Ok(FoundDevice { identity, standing: ConnectionState::Connected, latency_s, ..FoundDevice::default() })
    }
}
