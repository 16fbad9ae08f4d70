//! Addresses in a rig file that are on this computer.

use std::net::{IpAddr, Ipv4Addr};

use super::EmulatedRigError;

fn wrong(device: &str, place: &str, wanted: &'static str) -> EmulatedRigError {
    EmulatedRigError::Place { device: device.to_owned(), place: place.to_owned(), wanted }
}

/// Checks that this host is this computer.
pub(super) fn local(device: &str, host: &str) -> Result<(), EmulatedRigError> {
    if host == "localhost" || host.parse() == Ok(IpAddr::V4(Ipv4Addr::LOCALHOST)) {
        return Ok(());
    }
    Err(wrong(device, host, "it must be 127.0.0.1 for an emulator on this computer"))
}

/// Returns the port of `127.0.0.1:PORT`, or `usual` if there is none.
pub(super) fn port(device: &str, address: &str, usual: u16) -> Result<u16, EmulatedRigError> {
    let (host, port) = address.rsplit_once(':').map_or((address, None), |(host, port)| (host, Some(port)));
    local(device, host)?;
    port.map_or(Ok(usual), |port| port.parse().map_err(|_| wrong(device, address, "it must be 127.0.0.1:PORT")))
}

/// Returns the path of a pedal's `emulated:PATH`.
#[cfg(any(target_os = "linux", test))]
pub(super) fn pedal<'a>(device: &str, source: &'a str) -> Result<&'a str, EmulatedRigError> {
    let path = source.strip_prefix("emulated:").filter(|path| !path.is_empty());
    path.ok_or_else(|| wrong(device, source, "it must be emulated:PATH"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_this_computer_can_be_emulated() {
        assert_eq!(port("arm", "127.0.0.1:47140", 23).unwrap(), 47140);
        assert_eq!(port("arm", "localhost", 23).unwrap(), 23);
        for bad in ["192.168.1.1", "192.168.1.1:23", "127.0.0.1:many", "127.0.0.1:99999", ""] {
            let report = port("right arm", bad, 23).unwrap_err().to_string();
            assert!(report.contains("right arm") && report.contains("127.0.0.1"), "{report}");
        }
        assert_eq!(pedal("pedal", "emulated:/tmp/x").unwrap(), "/tmp/x");
        assert!(pedal("pedal", "any").is_err() && pedal("pedal", "emulated:").is_err());
    }
}
