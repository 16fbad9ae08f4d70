//! zenoh over UDP: express, real-time priority, dropped rather than delayed. Its own thread receives the data at once.

use std::{
    sync::mpsc::{Receiver, channel},
    time::{Duration, Instant},
};

use zenoh::{
    Config, Session, Wait as _,
    pubsub::{Publisher, Subscriber},
    qos::{CongestionControl, Priority},
};

use crate::{Engine, Outcome, PORT, THERE, now_ns};

const KEY: &str = "nima/stream";

pub(crate) struct Zenoh {
    _session: Session,
    publisher: Option<Publisher<'static>>,
    _subscriber: Option<Subscriber<()>>,
    got: Receiver<(Vec<u8>, u64)>,
    opened: Instant,
}

impl Zenoh {
    pub(crate) fn open(sends: bool) -> Outcome<Self> {
        let mut config = Config::default();
        let place = format!("[\"udp/{THERE}:{PORT}\"]");
        let settings = [
            ("mode", "\"peer\""),
            ("scouting/multicast/enabled", "false"),
            (if sends { "connect/endpoints" } else { "listen/endpoints" }, place.as_str()),
        ];
        for (key, value) in settings {
            config.insert_json5(key, value).map_err(|error| error.to_string())?;
        }
        if sends {
            config.insert_json5("listen/endpoints", "[]").map_err(|error| error.to_string())?;
        }
        let session = zenoh::open(config).wait().map_err(|error| error.to_string())?;
        let (sender, got) = channel();
        let mut publisher = None;
        let mut subscriber = None;
        if sends {
            let made = session
                .declare_publisher(KEY)
                .express(true)
                .priority(Priority::RealTime)
                .congestion_control(CongestionControl::Drop)
                .wait();
            publisher = Some(made.map_err(|error| error.to_string())?);
        } else {
            let seen = move |sample: zenoh::sample::Sample| {
                let seen_ns = now_ns();
                sender.send((sample.payload().to_bytes().into_owned(), seen_ns)).ok();
            };
            let made = session.declare_subscriber(KEY).callback(seen).wait();
            subscriber = Some(made.map_err(|error| error.to_string())?);
        }
        Ok(Self { _session: session, publisher, _subscriber: subscriber, got, opened: Instant::now() })
    }
}

impl Engine for Zenoh {
    fn is_ready(&mut self) -> bool {
        self.opened.elapsed() > Duration::from_secs(1)
    }

    fn send(&mut self, payload: &[u8]) {
        if let Some(publisher) = &self.publisher {
            publisher.put(payload).wait().ok();
        }
    }

    fn poll(&mut self, got: &mut dyn FnMut(&[u8], u64)) {
        while let Ok((payload, seen_ns)) = self.got.try_recv() {
            got(&payload, seen_ns);
        }
    }
}
