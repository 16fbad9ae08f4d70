//! Configuration of zenoh at each end.

use base64::{Engine as _, engine::general_purpose::STANDARD};
use serde_json::{Value, json};
use zenoh::Config;

use crate::{DepartmentError, MachineIdentity, keys};

/// Maximum number of connected watchers.
const WATCHERS_MAX: usize = 64;
/// A watcher that is silent for this long is disconnected, ms. Longer than a short outage of a wireless network, after
/// which a watcher need not connect again.
const LEASE_MS: u64 = 5000;

/// Returns the configuration of a rig. It accepts connections and only sends. Data of a watcher other than its
/// requests are dropped on arrival.
pub(crate) fn rig(own: &MachineIdentity, address: &str, scouting: ScoutingMode) -> Result<Config, DepartmentError> {
    let [authority, certificate, key] = [&own.authority, &own.certificate, &own.key].map(|pem| STANDARD.encode(pem));
    let tls = json!({
        "root_ca_certificate_base64": authority,
        "listen_certificate_base64": certificate,
        "listen_private_key_base64": key,
        "enable_mtls": true,
        "close_link_on_expiration": true,
    });
    let asks = ["declare_subscriber", "query", "liveliness_query", "declare_liveliness_subscriber"];
    let gives = ["put", "reply", "liveliness_token", "declare_queryable"];
    let rules = json!([
        { "id": "asks", "messages": asks, "flows": ["ingress"], "permission": "allow", "key_exprs": [keys::ALL] },
        { "id": "gives", "messages": gives, "flows": ["egress"], "permission": "allow", "key_exprs": [keys::ALL] },
        {
            "id": "announces that it watches", "messages": ["liveliness_token"], "flows": ["ingress"],
            "permission": "allow", "key_exprs": ["nima/watcher/**"],
        },
    ]);
    config(&json!({
        "mode": "router",
        "listen": { "endpoints": [format!("tls/{address}")], "exit_on_failure": true },
        "scouting": scouting.rig(),
        "transport": {
            "unicast": { "max_sessions": WATCHERS_MAX, "accept_pending": 16, "accept_timeout": 5000 },
            "link": { "protocols": ["tls"], "tls": tls, "tx": { "lease": LEASE_MS } },
        },
        "adminspace": { "enabled": false },
        "access_control": {
            "enabled": true,
            "default_permission": "deny",
            "rules": rules,
            "subjects": [{ "id": "everybody" }],
            "policies": [{ "rules": ["asks", "gives", "announces that it watches"], "subjects": ["everybody"] }],
        },
    }))
}

/// A watcher connects to one rig and does not listen.
pub(crate) fn watcher(own: &MachineIdentity, address: &str) -> Result<Config, DepartmentError> {
    let [authority, certificate, key] = [&own.authority, &own.certificate, &own.key].map(|pem| STANDARD.encode(pem));
    config(&json!({
        "mode": "client",
        "connect": { "endpoints": [format!("tls/{address}")], "timeout_ms": 4000, "exit_on_failure": true },
        "listen": { "endpoints": [] },
        "scouting": { "multicast": { "enabled": false }, "gossip": { "enabled": false } },
        "transport": {
            "unicast": { "open_timeout": 4000 },
            "link": {
                "protocols": ["tls"],
                "tls": {
                    "root_ca_certificate_base64": authority,
                    "connect_certificate_base64": certificate,
                    "connect_private_key_base64": key,
                    "enable_mtls": true,
                    // The certificate of any rig in the department is accepted, whatever its address.
                    "verify_name_on_connect": false,
                },
                "tx": { "lease": LEASE_MS },
            },
        },
        "adminspace": { "enabled": false },
    }))
}

/// Whether rigs can be found without their address, by a multicast within the local network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ScoutingMode {
    /// They answer.
    Answers,
    /// The address is found, but nothing responds at it.
    Silent,
}

impl ScoutingMode {
    fn rig(self) -> Value {
        json!({
            "multicast": { "enabled": self == Self::Answers, "listen": true, "autoconnect": { "router": [] } },
            "gossip": { "enabled": false, "autoconnect": { "router": [] } },
        })
    }
}

/// Returns the configuration for finding rigs.
pub(crate) fn scout() -> Result<Config, DepartmentError> {
    config(
        &json!({ "mode": "client", "scouting": { "multicast": { "enabled": true }, "gossip": { "enabled": false } } }),
    )
}

fn config(value: &Value) -> Result<Config, DepartmentError> {
    Config::from_json5(&value.to_string()).map_err(|error| DepartmentError::Certificate(error.to_string()))
}
