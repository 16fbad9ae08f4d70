//! The server against a client over a real socket.

use std::{net::TcpStream, time::Duration};

use serde_json::{Value, json};
use tungstenite::{ClientRequestBuilder, Message, WebSocket, connect, stream::MaybeTlsStream};

use super::*;

/// Maximum number of messages read before the expected one.
const READ_MAX: usize = 100;

struct Viewer(WebSocket<MaybeTlsStream<TcpStream>>);

impl Viewer {
    fn of(server: &LiveServer) -> Self {
        let uri = format!("ws://{}", server.address()).parse().unwrap();
        let (socket, _) = connect(ClientRequestBuilder::new(uri).with_sub_protocol("foxglove.sdk.v1")).unwrap();
        if let MaybeTlsStream::Plain(stream) = socket.get_ref() {
            stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
        }
        Self(socket)
    }

    /// Returns the next message of this kind.
    fn report(&mut self, op: &str) -> Value {
        for _ in 0..READ_MAX {
            if let Message::Text(text) = self.0.read().unwrap() {
                let value: Value = serde_json::from_str(&text).unwrap();
                if value["op"] == op {
                    return value;
                }
            }
        }
        panic!("no {op}");
    }

    /// Returns channels until all of these topics are present.
    fn channels(&mut self, topics: &[&str]) -> Vec<Value> {
        let mut channels = Vec::new();
        while !topics.iter().all(|topic| channels.iter().any(|channel: &Value| channel["topic"] == *topic)) {
            channels.extend(self.report("advertise")["channels"].as_array().unwrap().clone());
        }
        channels
    }

    fn subscribe(&mut self, id: u32, channel: &Value) {
        let wish = json!({"op": "subscribe", "subscriptions": [{"id": id, "channelId": channel["id"]}]});
        self.0.send(Message::text(wish.to_string())).unwrap();
    }

    /// Returns subscription, time (ns) and bytes of the next message.
    fn message(&mut self) -> (u32, u64, Vec<u8>) {
        for _ in 0..READ_MAX {
            if let Message::Binary(bytes) = self.0.read().unwrap() {
                assert_eq!(bytes[0], 1, "data of a message");
                let id = bytes[1..5].try_into().unwrap();
                let time_ns = bytes[5..13].try_into().unwrap();
                return (u32::from_le_bytes(id), u64::from_le_bytes(time_ns), bytes[13..].to_vec());
            }
        }
        panic!("no message");
    }
}

fn json_channel() -> Encoding {
    Encoding {
        schema: "Force".into(),
        schema_encoding: "jsonschema".into(),
        schema_data: br#"{"type": "object"}"#.to_vec(),
        message_encoding: "json".into(),
    }
}

fn at_any_port() -> LiveServer {
    LiveServer::start("127.0.0.1:0".parse().unwrap(), "nima test").unwrap()
}

/// Sends the message repeatedly until the viewer receives it, because a subscription takes a moment.
fn seen(audience: &mut dyn Audience, channel: usize, viewer: &mut Viewer, time_ns: u64, data: &[u8]) -> u32 {
    for _ in 0..20 {
        audience.message(channel, time_ns, data);
        std::thread::sleep(Duration::from_millis(5));
    }
    let (id, at_ns, bytes) = viewer.message();
    assert_eq!((at_ns, bytes.as_slice()), (time_ns, data));
    id
}

#[test]
fn a_viewer_gets_what_it_asks_for_with_the_time_of_the_sample() {
    let server = at_any_port();
    let mut audience = server.audience();
    audience.channel("right/forces", &json_channel());
    let mut viewer = Viewer::of(&server);
    assert_eq!(viewer.report("serverInfo")["name"], "nima test");
    audience.channel("log", &json_channel());
    let channels = viewer.channels(&["right/forces", "log"]);
    let log = channels.iter().find(|channel| channel["topic"] == "log").unwrap();
    assert_eq!((&log["encoding"], &log["schemaName"]), (&json!("json"), &json!("Force")));
    assert_eq!((&log["schemaEncoding"], &log["schema"]), (&json!("jsonschema"), &json!("{\"type\": \"object\"}")));
    viewer.subscribe(7, log);
    // The other channel was not requested.
    audience.message(0, 1, b"{}");
    assert_eq!(seen(&mut *audience, 1, &mut viewer, 1_700_000_000_123_456_789, b"{\"message\": \"here\"}"), 7);
    assert_eq!(server.viewers(), 1);
}

#[test]
fn the_next_session_has_channels_of_its_own() {
    let server = at_any_port();
    let mut viewer = Viewer::of(&server);
    let mut first = server.audience();
    first.channel("log", &json_channel());
    let before = viewer.channels(&["log"])[0]["id"].clone();
    drop(first);
    assert_eq!(viewer.report("unadvertise")["channelIds"], json!([before]));
    let mut second = server.audience();
    second.channel("log", &json_channel());
    let log = viewer.channels(&["log"]).pop().unwrap();
    assert_ne!(log["id"], before);
    viewer.subscribe(1, &log);
    assert_eq!(seen(&mut *second, 0, &mut viewer, 5, b"{}"), 1);
}

#[test]
fn a_viewer_that_reads_nothing_holds_up_nobody() {
    let server = at_any_port();
    let mut audience = server.audience();
    audience.channel("log", &json_channel());
    let mut viewer = Viewer::of(&server);
    let log = viewer.channels(&["log"]).pop().unwrap();
    viewer.subscribe(1, &log);
    seen(&mut *audience, 0, &mut viewer, 1, b"first");
    // Far more than the system's buffers and the backlog can hold.
    let much = vec![0; 4096];
    for time_ns in 0..3 * BACKLOG as u64 {
        audience.message(0, time_ns, &much);
    }
    assert_eq!(server.viewers(), 1);
}

#[test]
fn an_address_in_use_is_told_in_one_line() {
    let server = at_any_port();
    let error = LiveServer::start(server.address(), "second").unwrap_err().to_string();
    assert!(error.contains(&server.address().to_string()) && error.contains("in use"), "{error}");
    assert_eq!(error.lines().count(), 1);
    drop(server);
}

#[test]
fn nobody_listens_any_more_when_the_server_has_ended() {
    let server = at_any_port();
    let mut audience = server.audience();
    audience.channel("log", &json_channel());
    let address = server.address();
    drop(server);
    audience.message(0, 1, b"to nobody");
    // The library closes its socket on its own thread.
    let closed = |_| {
        std::thread::sleep(Duration::from_millis(5));
        TcpStream::connect(address).is_err()
    };
    assert!((0..1000).any(closed));
}
