//! H.264 (or motion JPEG) over RTSP, as sent by network cameras: one connection, which also carries the images. The
//! client is `retina`, which uses tokio; its runtime is confined to this thread.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    pin::Pin,
    time::{Duration, Instant},
};

use futures_util::StreamExt as _;
use retina::{
    client::{
        Credentials, Demuxed, InitialTimestampPolicy, PlayOptions, Session, SessionOptions, SetupOptions,
        TcpTransportOptions, TeardownPolicy, Transport,
    },
    codec::{CodecItem, FrameFormat, VideoFrame},
    rtcp::ReceivedCompoundPacket,
};
use tokio::{runtime::Runtime, time::timeout};
use url::Url;

use crate::{CompressedFrame, EndoscopeError, Endpoint, Format, ImageSource, Login, http};

/// Time in which the camera must have answered all requests and started to send.
const OPENING: Duration = Duration::from_secs(3);
/// After this time without data the connection is closed and opened again.
const SILENT: Duration = Duration::from_secs(2);
const PATIENCE: Duration = Duration::from_millis(100);
/// Time from 1900, the epoch of RTP senders, to 1970, s.
const SINCE_1900_S: f64 = 2_208_988_800.0;

/// A camera that is playing.
struct Rtsp {
    place: String,
    runtime: Runtime,
    /// Must be dropped within the runtime.
    session: Option<Pin<Box<Demuxed>>>,
    is_jpeg: bool,
    received: Instant,
    /// From the sender's first report: its time, s since 1970, and the corresponding time stamp, s.
    reported_s: Option<[f64; 2]>,
}

enum RtspFailure {
    Client(retina::Error),
    Format(String),
}

impl From<retina::Error> for RtspFailure {
    fn from(error: retina::Error) -> Self {
        Self::Client(error)
    }
}

/// Opens a camera and starts it.
pub(crate) fn open(endpoint: &Endpoint) -> Result<Box<dyn ImageSource>, EndoscopeError> {
    guarded(&endpoint.place(), || begin(endpoint))
}

/// Converts a panic into an error of the request, so that the thread survives. The client panics on some malformed
/// responses, mostly in its parser of descriptions and in code that relies on it.
fn guarded<T>(place: &str, work: impl FnOnce() -> Result<T, EndoscopeError>) -> Result<T, EndoscopeError> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|_| {
        let reason = "a response that cannot be parsed".to_owned();
        Err(EndoscopeError::Unreadable { place: place.to_owned(), reason })
    })
}

fn begin(endpoint: &Endpoint) -> Result<Box<dyn ImageSource>, EndoscopeError> {
    let place = endpoint.place();
    let other = |reason: String| EndoscopeError::Other { place: place.clone(), reason };
    let url = Url::parse(&endpoint.url("rtsp")).map_err(|error| other(error.to_string()))?;
    let login = endpoint.login.clone().map(|Login { user, password }| Credentials { username: user, password });
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(|error| other(error.to_string()))?;
    match runtime.block_on(async { timeout(OPENING, play(url, login)).await }) {
        Err(_) => Err(EndoscopeError::Silent { place }),
        Ok(Ok((session, is_jpeg))) => {
            let session = Some(Box::pin(session));
            let received = Instant::now();
            Ok(Box::new(Rtsp { place, runtime, session, is_jpeg, received, reported_s: None }))
        }
        Ok(Err(RtspFailure::Format(found))) => Err(EndoscopeError::OtherFormat { place, found, wanted: "H.264" }),
        Ok(Err(RtspFailure::Client(error))) => Err(report(&place, &error, Some(endpoint))),
    }
}

async fn play(url: Url, login: Option<Credentials>) -> Result<(Demuxed, bool), RtspFailure> {
    let options = SessionOptions::default().user_agent("nima".to_owned()).teardown(TeardownPolicy::Never);
    let options = options.creds(login);
    let mut session = Session::describe(url, options).await?;
    let images = || session.streams().iter().enumerate().filter(|(_, stream)| stream.media() == "video");
    let known = images().find(|(_, stream)| matches!(stream.encoding_name(), "h264" | "jpeg"));
    let Some((number, is_jpeg)) = known.map(|(number, stream)| (number, stream.encoding_name() == "jpeg")) else {
        let found: Vec<&str> = images().map(|(_, stream)| stream.encoding_name()).take(3).collect();
        let found = if found.is_empty() { "no picture".to_owned() } else { found.join(", ") };
        return Err(RtspFailure::Format(found.chars().filter(char::is_ascii_graphic).take(60).collect()));
    };
    let transport = Transport::Tcp(TcpTransportOptions::default());
    let options = SetupOptions::default().transport(transport).frame_format(FrameFormat::SIMPLE);
    session.setup(number, options).await?;
    let options = PlayOptions::default().initial_timestamp(InitialTimestampPolicy::Permissive);
    Ok((session.play(options).await?.demuxed()?, is_jpeg))
}

/// Converts an error of the client, which is only a text.
fn report(place: &str, error: &retina::Error, reach: Option<&Endpoint>) -> EndoscopeError {
    let place = place.to_owned();
    let text = error.to_string();
    if let Some(status) = error.status_code().filter(|status| *status != 200) {
        return EndoscopeError::Refused { place, status };
    }
    let begins = |words: &str| text.starts_with(words);
    if begins("Unable to connect") {
        // The error does not include its cause, so connect once more to find it.
        let why = reach.and_then(|endpoint| http::connect(endpoint).err());
        return why.unwrap_or(EndoscopeError::Closed { place });
    }
    if begins("Error reading") || begins("Error writing") || begins("Timeout") {
        return EndoscopeError::Closed { place };
    }
    // Some of them quote an address, which may contain a password.
    let first = text.lines().next().and_then(|line| line.split("rtsp://").next()).unwrap_or_default();
    EndoscopeError::Unreadable { place, reason: first.chars().filter(|c| !c.is_control()).take(120).collect() }
}

impl Rtsp {
    fn image(&mut self, frame: VideoFrame) -> CompressedFrame {
        let stamp = frame.timestamp();
        let own_s = stamp.timestamp() as f64 / f64::from(stamp.clock_rate().get());
        let format = if self.is_jpeg { Format::Jpeg } else { Format::H264 { is_key: frame.is_random_access_point() } };
        let arrived = frame.end_ctx().received();
        let stamp_s = self.reported_s.map_or(own_s, |[time_s, of_s]| time_s + own_s - of_s);
        CompressedFrame { format, bytes: frame.into_data(), arrived, stamp_s: Some(stamp_s), taken: None }
    }

    /// Stores the first report of a connection; later reports might jump.
    fn report(&mut self, packet: &ReceivedCompoundPacket) {
        let Some(stamp) = packet.rtp_timestamp().filter(|_| self.reported_s.is_none()) else { return };
        let mut reports = packet.pkts().filter_map(|packet| packet.as_sender_report().ok().flatten());
        let Some(report) = reports.next() else { return };
        let time_s = report.ntp_timestamp().0 as f64 / 2.0_f64.powi(32) - SINCE_1900_S;
        self.reported_s = Some([time_s, stamp.timestamp() as f64 / f64::from(stamp.clock_rate().get())]);
    }
}

impl ImageSource for Rtsp {
    fn next(&mut self) -> Result<Option<CompressedFrame>, EndoscopeError> {
        let place = self.place.clone();
        guarded(&place, || self.wait())
    }
}

impl Rtsp {
    /// Returns the next image, if it arrives in time.
    fn wait(&mut self) -> Result<Option<CompressedFrame>, EndoscopeError> {
        let begin = Instant::now();
        while begin.elapsed() < PATIENCE {
            let closed = || EndoscopeError::Closed { place: self.place.clone() };
            let Some(session) = &mut self.session else { return Err(closed()) };
            let left = PATIENCE.saturating_sub(begin.elapsed());
            match self.runtime.block_on(async { timeout(left, session.next()).await }) {
                Err(_) if self.received.elapsed() > SILENT => {
                    return Err(EndoscopeError::Silent { place: self.place.clone() });
                }
                Err(_) => return Ok(None),
                Ok(None) => return Err(closed()),
                Ok(Some(Err(error))) => return Err(report(&self.place, &error, None)),
                Ok(Some(Ok(CodecItem::VideoFrame(frame)))) => {
                    self.received = Instant::now();
                    return Ok(Some(self.image(frame)));
                }
                Ok(Some(Ok(CodecItem::Rtcp(packet)))) => self.report(&packet),
                Ok(Some(Ok(_))) => {}
            }
        }
        Ok(None)
    }
}

impl Drop for Rtsp {
    fn drop(&mut self) {
        let _within = self.runtime.enter();
        self.session = None;
    }
}

#[cfg(test)]
mod tests;
