//! The emulated endoscope as a network camera: responses of RTSP (RFC 2326), and H.264 in packets of RTP (RFC 6184)
//! over the same connection, with sender reports. Without I/O.

use std::time::Duration;

use nima_endoscope::h264;

/// Maximum request, bytes.
const REQUEST_MAX: usize = 8 << 10;
/// Maximum payload of a packet, bytes: fits into an Ethernet frame, as sent by cameras. Larger ones would be split by
/// the network, and one lost piece loses the packet.
const PAYLOAD_MAX: usize = 1400;
/// RFC 6184 prescribes 90 kHz for H.264.
const CLOCK_HZ: f64 = 90_000.0;
/// The first of the dynamic types (RFC 3551).
const PAYLOAD_TYPE: u8 = 96;
/// The letters "NIMA"; a receiver accepts any number (RFC 3550, SSRC).
const SOURCE: u32 = 0x4e49_4d41;
/// Time from 1900, the epoch of the reports, to 1970, s. Seventy years with seventeen leap days (RFC 868).
const SINCE_1900_S: u64 = 2_208_988_800;
const REPORT_EVERY: Duration = Duration::from_secs(1);
/// Type of a NAL unit that is sent in pieces. FU-A in RFC 6184.
const FRAGMENTS: u8 = 28;

/// A connection that speaks RTSP.
#[derive(Debug, Default)]
pub(super) struct RtspSession {
    held: Vec<u8>,
    /// Channel of the packets while playing; the reports use the next one.
    channel: u8,
    pub(super) plays: bool,
    sequence: u16,
    packets: u32,
    octets: u32,
    reported: Option<Duration>,
}

/// Result of a request.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct RtspReply {
    pub(super) text: String,
    /// Whether the client starts to play.
    pub(super) begins: bool,
    pub(super) ends: bool,
}

/// Returns whether bytes are the beginning of an RTSP request.
pub(super) fn is_rtsp(request: &[u8]) -> bool {
    request.split(|byte| *byte == b'\n').next().is_some_and(|line| line.trim_ascii_end().ends_with(b"RTSP/1.0"))
}

impl RtspSession {
    /// Processes bytes of a client; returns a response to each complete request. `announces` is the camera's
    /// description of its stream.
    pub(super) fn receive(&mut self, bytes: &[u8], announces: &str) -> Vec<RtspReply> {
        self.held.extend_from_slice(bytes);
        let mut replies = Vec::new();
        loop {
            // Receiver reports arrive on the same connection.
            if let [b'$', _, high, low, ..] = self.held[..] {
                let length = 4 + usize::from(u16::from_be_bytes([high, low]));
                if self.held.len() < length {
                    break;
                }
                self.held.drain(..length);
                continue;
            }
            let Some(end) = self.held.windows(4).position(|four| four == b"\r\n\r\n") else { break };
            let head = String::from_utf8_lossy(&self.held[..end]).into_owned();
            let body = header(&head, "content-length").and_then(|length| length.parse().ok()).unwrap_or(0_usize);
            if body > REQUEST_MAX || self.held.len() < end + 4 + body {
                break;
            }
            self.held.drain(..end + 4 + body);
            replies.push(self.reply(&head, announces));
        }
        if self.held.len() > REQUEST_MAX {
            replies.push(RtspReply { text: answer("400 Bad Request", "0", "", ""), begins: false, ends: true });
        }
        replies
    }

    fn reply(&mut self, head: &str, announces: &str) -> RtspReply {
        let mut words = head.split_whitespace();
        let method = words.next().unwrap_or_default();
        let url = words.next().unwrap_or_default();
        let number: String =
            header(head, "cseq").unwrap_or("0").chars().filter(char::is_ascii_digit).take(10).collect();
        let session = "Session: 4e494d41;timeout=60\r\n";
        let report = |status: &str, more: &str, body: &str| answer(status, &number, more, body);
        let mut reply = RtspReply { text: String::new(), begins: false, ends: false };
        reply.text = match method {
            _ if !is_known(url) => report("404 Not Found", "", ""),
            "OPTIONS" => report("200 OK", "Public: OPTIONS, DESCRIBE, SETUP, PLAY, TEARDOWN, GET_PARAMETER\r\n", ""),
            "DESCRIBE" if announces.is_empty() => report("501 Not Implemented", "", ""),
            "DESCRIBE" => {
                let base = url.trim_end_matches('/');
                report("200 OK", &format!("Content-Base: {base}/\r\nContent-Type: application/sdp\r\n"), announces)
            }
            "SETUP" => match channels(header(head, "transport").unwrap_or_default()) {
                Some(channel) => {
                    self.channel = channel;
                    let next = u16::from(channel) + 1;
                    let transport = format!("Transport: RTP/AVP/TCP;unicast;interleaved={channel}-{next}\r\n{session}");
                    report("200 OK", &transport, "")
                }
                // Players request datagrams first.
                None => report("461 Unsupported Transport", "", ""),
            },
            "PLAY" => {
                self.plays = true;
                reply.begins = true;
                report("200 OK", &format!("{session}Range: npt=0.000-\r\n"), "")
            }
            "GET_PARAMETER" | "SET_PARAMETER" => report("200 OK", session, ""),
            "TEARDOWN" => {
                self.plays = false;
                reply.ends = true;
                report("200 OK", session, "")
            }
            _ => report("405 Method Not Allowed", "", ""),
        };
        reply
    }

    /// Returns the packets of an image taken at this time (since 1970), each on its channel, preceded by a report from
    /// time to time.
    pub(super) fn packets(&mut self, unit: &[u8], since: Duration) -> Vec<u8> {
        let stamp = (since.as_secs_f64() * CLOCK_HZ) as u64 as u32;
        let mut out = Vec::with_capacity(unit.len() + unit.len() / 50 + 100);
        if self.reported.is_none_or(|reported| since.saturating_sub(reported) >= REPORT_EVERY) {
            self.reported = Some(since);
            framed(&mut out, self.channel + 1, &[&self.report(stamp, since)]);
        }
        let mut nals = h264::nal_units(unit).peekable();
        while let Some(nal) = nals.next() {
            let is_last = nals.peek().is_none();
            if nal.len() <= PAYLOAD_MAX {
                self.packet(&mut out, stamp, is_last, &[nal]);
                continue;
            }
            let head = nal[0];
            let body = &nal[1..];
            let pieces = body.len().div_ceil(PAYLOAD_MAX - 2);
            for (number, piece) in body.chunks(PAYLOAD_MAX - 2).enumerate() {
                let begins = if number == 0 { 0x80 } else { 0 };
                let ends = if number + 1 == pieces { 0x40 } else { 0 };
                let heads = [head & 0x60 | FRAGMENTS, begins | ends | head & 0x1f];
                self.packet(&mut out, stamp, is_last && ends != 0, &[&heads, piece]);
            }
        }
        out
    }

    fn packet(&mut self, out: &mut Vec<u8>, stamp: u32, is_last: bool, payload: &[&[u8]]) {
        let mut head = [0; 12];
        head[0] = 0x80;
        head[1] = PAYLOAD_TYPE | if is_last { 0x80 } else { 0 };
        head[2..4].copy_from_slice(&self.sequence.to_be_bytes());
        head[4..8].copy_from_slice(&stamp.to_be_bytes());
        head[8..].copy_from_slice(&SOURCE.to_be_bytes());
        self.sequence = self.sequence.wrapping_add(1);
        self.packets = self.packets.wrapping_add(1);
        self.octets = self.octets.wrapping_add(payload.iter().map(|part| part.len() as u32).sum());
        framed(out, self.channel, &[&[&head[..]], payload].concat());
    }

    /// Returns a sender report (RFC 3550, 6.4.1), with the sender's name, which a complete report needs.
    fn report(&self, stamp: u32, since: Duration) -> Vec<u8> {
        let mut report = vec![0x80, 200, 0, 6];
        let fraction = (u64::from(since.subsec_nanos()) << 32) / 1_000_000_000;
        let seconds = (since.as_secs() + SINCE_1900_S) as u32;
        for word in [SOURCE, seconds, fraction as u32, stamp, self.packets, self.octets] {
            report.extend_from_slice(&word.to_be_bytes());
        }
        report.extend_from_slice(&[0x81, 202, 0, 3]);
        report.extend_from_slice(&SOURCE.to_be_bytes());
        report.extend_from_slice(&[1, 4, b'n', b'i', b'm', b'a', 0, 0]);
        report
    }
}

/// Returns the same paths as for a browser.
fn is_known(url: &str) -> bool {
    if url == "*" {
        return true;
    }
    let path = url.split_once("://").and_then(|(_, rest)| rest.find('/').map(|at| &rest[at..])).unwrap_or("/");
    matches!(path.trim_end_matches('/'), "" | "/stream" | "/stream/picture" | "/picture")
}

/// Returns the value of a header, whose name is case-insensitive.
fn header<'a>(head: &'a str, name: &str) -> Option<&'a str> {
    let lines = head.lines().filter_map(|line| line.split_once(':'));
    lines.into_iter().find(|(key, _)| key.trim().eq_ignore_ascii_case(name)).map(|(_, value)| value.trim())
}

/// Returns the first of the two requested channels; `None` if the client requests datagrams.
fn channels(transport: &str) -> Option<u8> {
    let wanted = transport.split(',').find(|wanted| wanted.contains("RTP/AVP/TCP"))?;
    let pair = wanted.split(';').find_map(|part| part.trim().strip_prefix("interleaved="));
    let channel = pair.map_or(Some(0), |pair| pair.split('-').next().and_then(|first| first.trim().parse().ok()));
    channel.filter(|channel| *channel < 255)
}

fn answer(status: &str, number: &str, more: &str, body: &str) -> String {
    let length = if body.is_empty() { String::new() } else { format!("Content-Length: {}\r\n", body.len()) };
    format!("RTSP/1.0 {status}\r\nCSeq: {number}\r\n{more}{length}\r\n{body}")
}

/// Returns the camera's description of its stream (RFC 4566).
pub(super) fn announcement(encoding: &str) -> String {
    format!(
        "v=0\r\no=- 0 0 IN IP4 127.0.0.1\r\ns=nima endoscope\r\nc=IN IP4 0.0.0.0\r\nt=0 0\r\na=control:*\r\nm=video 0 RTP/AVP {PAYLOAD_TYPE}\r\n\
        a=rtpmap:{PAYLOAD_TYPE} {encoding}/90000\r\na=fmtp:{PAYLOAD_TYPE} packetization-mode=1\r\na=control:picture\r\n"
    )
}

/// Writes bytes on a channel of the connection.
fn framed(out: &mut Vec<u8>, channel: u8, parts: &[&[u8]]) {
    let length: usize = parts.iter().map(|part| part.len()).sum();
    out.extend_from_slice(&[b'$', channel]);
    out.extend_from_slice(&(length as u16).to_be_bytes());
    for part in parts {
        out.extend_from_slice(part);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(session: &mut RtspSession, request: &str) -> RtspReply {
        let mut replies = session.receive(request.as_bytes(), &announcement("H264"));
        assert_eq!(replies.len(), 1, "{request}");
        replies.remove(0)
    }

    #[test]
    fn a_player_is_answered_from_the_first_question_to_the_last() {
        let mut session = RtspSession::default();
        let url = "rtsp://127.0.0.1:47150/stream";
        assert!(is_rtsp(format!("OPTIONS {url} RTSP/1.0\r\nCSeq").as_bytes()) && !is_rtsp(b"GET / HTTP/1.1\r\n"));
        let mut ask = |text: String| asked(&mut session, &text);
        assert!(ask(format!("OPTIONS {url} RTSP/1.0\r\nCSeq: 1\r\n\r\n")).text.contains("DESCRIBE"));
        let described = ask(format!("DESCRIBE {url} RTSP/1.0\r\ncseq: 2\r\n\r\n")).text;
        assert!(described.starts_with("RTSP/1.0 200 OK\r\nCSeq: 2\r\n") && described.contains("H264/90000"));
        assert!(described.contains(&format!("Content-Base: {url}/")), "{described}");
        let setup =
            |transport: &str| format!("SETUP {url}/picture RTSP/1.0\r\nCSeq: 3\r\nTransport: {transport}\r\n\r\n");
        assert!(ask(setup("RTP/AVP;unicast;client_port=5000-5001")).text.contains(" 461 "));
        assert!(ask(setup("RTP/AVP/TCP;unicast;interleaved=4-5")).text.contains("interleaved=4-5"));
        assert!(ask(format!("PLAY {url}/ RTSP/1.0\r\nCSeq: 4\r\nSession: 1\r\n\r\n")).begins);
        assert!(ask("GET_PARAMETER rtsp://h/other RTSP/1.0\r\nCSeq: 5\r\n\r\n".to_owned()).text.contains(" 404 "));
        assert!(ask(format!("TEARDOWN {url} RTSP/1.0\r\nCSeq: 6\r\n\r\n")).ends);
        assert!(!session.plays);
    }

    #[test]
    fn requests_in_pieces_reports_between_them_and_nonsense_are_borne() {
        let mut session = RtspSession::default();
        let bytes = b"$\x01\x00\x03abcOPTIONS * RTSP/1.0\r\nCSeq: 1\r\n\r\n$\x01\x00\x01xOPTIONS * RTSP/1.0\r\nCSeq: 2\r\nContent-Length: 3\r\n\r\nabc";
        let replies: Vec<RtspReply> = bytes.iter().flat_map(|byte| session.receive(&[*byte], "")).collect();
        assert_eq!(replies.len(), 2);
        assert!(RtspSession::default().receive(&vec![b'a'; 10_000], "").iter().all(|reply| reply.ends));
        let mut random = fastrand::Rng::with_seed(1);
        for _ in 0..2000 {
            let mut bytes =
                b"SETUP rtsp://h/stream RTSP/1.0\r\nCSeq: 1\r\nTransport: RTP/AVP/TCP;interleaved=0-1\r\n\r\n".to_vec();
            for _ in 0..random.usize(1..6) {
                let at = random.usize(..bytes.len());
                bytes[at] = random.u8(..);
            }
            RtspSession::default().receive(&bytes, "x");
        }
    }

    #[test]
    fn a_picture_goes_into_packets_and_can_be_put_together_again() {
        let nals = [
            vec![0x67, 1, 2, 3],
            vec![0x68, 4],
            (0..4000).map(|at| if at == 0 { 0x65 } else { (at % 251 + 1) as u8 }).collect(),
        ];
        let unit: Vec<u8> = nals.iter().flat_map(|nal| [&[0, 0, 0, 1][..], nal].concat()).collect();
        let mut session = RtspSession { channel: 2, ..RtspSession::default() };
        let since = Duration::new(1_700_000_000, 250_000_000);
        let bytes = session.packets(&unit, since);
        let mut at = 0;
        let mut found: Vec<Vec<u8>> = Vec::new();
        let mut marks = 0;
        let mut last = None;
        while at < bytes.len() {
            assert_eq!(bytes[at], b'$');
            let length = usize::from(u16::from_be_bytes([bytes[at + 2], bytes[at + 3]]));
            let packet = &bytes[at + 4..at + 4 + length];
            if bytes[at + 1] == 3 {
                let word = |at: usize| u32::from_be_bytes(packet[at..at + 4].try_into().unwrap());
                assert_eq!((packet[1], word(8), word(12)), (200, 3_908_988_800, 1 << 30));
            } else {
                let sequence = u16::from_be_bytes([packet[2], packet[3]]);
                assert!(last.is_none_or(|last| sequence == last + 1));
                last = Some(sequence);
                marks += usize::from(packet[1] >> 7);
                assert_eq!(marks, usize::from(at + 4 + length == bytes.len()), "only the last one is marked");
                let payload = &packet[12..];
                if payload[0] & 0x1f != FRAGMENTS {
                    found.push(payload.to_vec());
                } else if payload[1] & 0x80 != 0 {
                    found.push([&[payload[0] & 0xe0 | payload[1] & 0x1f], &payload[2..]].concat());
                } else {
                    found.last_mut().unwrap().extend_from_slice(&payload[2..]);
                }
            }
            at += 4 + length;
        }
        assert_eq!(found, nals);
        assert!(session.packets(&unit, since).len() < bytes.len(), "a report comes once a second");
    }
}
