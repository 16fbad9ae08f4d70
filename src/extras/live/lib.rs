//! Live viewing of a session: a server that sends the channels and messages of its file to Foxglove and `PlotJuggler`.
//!
//! The protocol is Foxglove's over WebSocket (subprotocols `foxglove.sdk.v1` and `v1.1`), from Foxglove's library. It
//! runs on its own threads. Viewers cannot act: the server only offers channels. A viewer that is too slow loses the
//! oldest messages; neither the loop nor the recording waits for it.
#![cfg(feature = "engine")]

use std::{
    fmt,
    net::{IpAddr, SocketAddr},
    sync::Arc,
};

use foxglove::{ChannelBuilder, Context, FoxgloveError, PartialMetadata, RawChannel, Schema, WebSocketServerHandle};
use nima_recording::session::Encoding;
use nima_session::{recorder::JOURNAL_TOPIC, sinks::Audience};

/// Maximum number of messages waiting for a viewer: more than two seconds of two arms, which send 6 100 per second.
const BACKLOG: usize = 16_384;

/// Why the server cannot start.
#[derive(Debug, thiserror::Error)]
pub enum LiveError {
    /// The address cannot be used.
    #[error(
        "live viewing: cannot listen on {address}: {reason}; end the program that uses this port, or choose another port"
    )]
    Listen { address: SocketAddr, reason: String },
}

/// A server that runs until it is dropped, for successive sessions.
pub struct LiveServer {
    context: Arc<Context>,
    handle: Option<WebSocketServerHandle>,
    address: SocketAddr,
}

impl LiveServer {
    /// Listens at this address; port 0 selects a free one. `program` is the name that viewers show.
    ///
    /// # Errors
    /// [`LiveError`] if the address is not this computer's or the port is in use.
    ///
    /// ```
    /// let server = nima_live::LiveServer::start("127.0.0.1:0".parse()?, "an example")?;
    /// assert_ne!(server.address().port(), 0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn start(address: SocketAddr, program: &str) -> Result<Self, LiveError> {
        let context = Context::new();
        let server = context.websocket_server().name(program).message_backlog_size(BACKLOG);
        let handle = server.bind(host(address.ip()), address.port()).start_blocking();
        let handle = handle.map_err(|error| LiveError::Listen { address, reason: reason(&error) })?;
        let address = SocketAddr::new(address.ip(), handle.port());
        Ok(Self { context, handle: Some(handle), address })
    }

    pub const fn address(&self) -> SocketAddr {
        self.address
    }

    /// Returns the number of connected viewers.
    pub fn viewers(&self) -> usize {
        self.handle.as_ref().map_or(0, WebSocketServerHandle::client_count)
    }

    /// Returns the audience for the recorder of the next session. When it is dropped, the viewers lose its channels.
    pub fn audience(&self) -> Box<dyn Audience> {
        Box::new(Viewers { context: Arc::clone(&self.context), channels: Vec::new() })
    }
}

/// Returns the library's form of an address.
fn host(ip: IpAddr) -> String {
    match ip {
        IpAddr::V4(ip) => ip.to_string(),
        IpAddr::V6(ip) => format!("[{ip}]"),
    }
}

fn reason(error: &FoxgloveError) -> String {
    match error {
        FoxgloveError::Bind(source) | FoxgloveError::IoError(source) => source.to_string(),
        other => other.to_string(),
    }
}

impl Drop for LiveServer {
    fn drop(&mut self) {
        if let Some(handle) = self.handle.take() {
            handle.stop().wait_blocking();
        }
    }
}

impl fmt::Debug for LiveServer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Server").field("address", &self.address).finish_non_exhaustive()
    }
}

/// The channels of one session.
struct Viewers {
    context: Arc<Context>,
    /// By number; `None` if the library refuses a channel, and for the journal, which viewers cannot read.
    channels: Vec<Option<Arc<RawChannel>>>,
}

impl Audience for Viewers {
    fn channel(&mut self, topic: &str, encoding: &Encoding) {
        if topic == JOURNAL_TOPIC {
            return self.channels.push(None);
        }
        let Encoding { schema, schema_encoding, schema_data, message_encoding } = encoding;
        let schema = Schema::new(schema.clone(), schema_encoding.clone(), schema_data.clone());
        let channel = ChannelBuilder::new(topic).schema(schema).message_encoding(message_encoding.clone());
        self.channels.push(channel.context(&self.context).build_raw().ok());
    }

    fn message(&mut self, channel: usize, log_time_ns: u64, data: &[u8]) {
        if let Some(Some(channel)) = self.channels.get(channel) {
            channel.log_with_meta(data, PartialMetadata::with_log_time(log_time_ns));
        }
    }
}

impl Drop for Viewers {
    fn drop(&mut self) {
        for channel in self.channels.iter().flatten() {
            channel.close();
        }
    }
}

impl fmt::Debug for Viewers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Viewers").field("channels", &self.channels.len()).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests;
