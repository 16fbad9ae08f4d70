//! The head of a response, and of one of its parts.

use httparse::{EMPTY_HEADER, Error, Header, ParserConfig, Response, Status};

use super::answer::HttpFault;

/// Longest head, in bytes and in lines.
const HEAD_MAX: usize = 16 << 10;
const LINES_MOST: usize = 64;
/// A part has no status line. It starts with the end of the boundary line, which this text completes.
const PART: &[u8] = b"HTTP/1.1 200 OK";

/// Fields of a head; their names are case-insensitive.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct HttpHead {
    pub(super) status: u16,
    pub(super) content_type: Option<String>,
    pub(super) length: Option<usize>,
    pub(super) is_chunked: bool,
    pub(super) stamp_s: Option<f64>,
    /// Authentication methods requested by the camera, as sent.
    pub(super) challenges: Vec<String>,
    /// Address to which the camera redirects.
    pub(super) location: Option<String>,
}

impl HttpHead {
    /// Returns the head of an answer and its length in bytes; `None` until it is complete.
    pub(super) fn read(bytes: &[u8]) -> Result<Option<(Self, usize)>, HttpFault> {
        let mut lines = [EMPTY_HEADER; LINES_MOST];
        let mut response = Response::new(&mut lines);
        // As lenient as browsers, because cameras are tested with browsers.
        let mut parser = ParserConfig::default();
        parser.allow_spaces_after_header_name_in_responses(true);
        parser.allow_multiple_spaces_in_response_status_delimiters(true);
        parser.ignore_invalid_headers_in_responses(true);
        match parser.parse_response(&mut response, bytes) {
            Ok(Status::Complete(length)) => {
                let status = response.code.unwrap_or_default();
                Ok(Some((Self::of(status, response.headers)?, length)))
            }
            Ok(Status::Partial) if bytes.len() <= HEAD_MAX => Ok(None),
            Ok(Status::Partial) | Err(Error::TooManyHeaders) => {
                Err(HttpFault::Unreadable("a header that does not end"))
            }
            Err(_) => Err(HttpFault::Unreadable("a response that is not HTTP")),
        }
    }

    /// Returns the head of a part, from behind its boundary.
    pub(super) fn read_part(bytes: &[u8]) -> Result<Option<(Self, usize)>, HttpFault> {
        let end = bytes.len().min(HEAD_MAX + 1);
        let found = Self::read(&[PART, &bytes[..end]].concat())?;
        Ok(found.map(|(head, length)| (head, length - PART.len())))
    }

    fn of(status: u16, lines: &[Header]) -> Result<Self, HttpFault> {
        let mut head = Self { status, ..Self::default() };
        for line in lines {
            let value = String::from_utf8_lossy(line.value);
            let value = value.trim();
            match line.name.to_ascii_lowercase().as_str() {
                "content-type" => head.content_type = Some(value.to_owned()),
                "content-length" => {
                    let length = value.parse().map_err(|_| HttpFault::Unreadable("a length that is not a number"))?;
                    head.length = Some(length);
                }
                "transfer-encoding" => match value.to_ascii_lowercase().as_str() {
                    "chunked" => head.is_chunked = true,
                    "identity" => {}
                    _ => return Err(HttpFault::Unreadable("an unexpected compression")),
                },
                // Seconds, as sent by mjpg-streamer and others.
                "x-timestamp" => head.stamp_s = value.parse().ok().filter(|stamp_s: &f64| stamp_s.is_finite()),
                "location" => head.location = Some(value.to_owned()),
                "www-authenticate" => head.challenges.push(value.to_owned()),
                _ => {}
            }
        }
        Ok(head)
    }

    /// Returns type and subtype, in lower case and without parameters.
    pub(super) fn kind(&self) -> String {
        let whole = self.content_type.as_deref().unwrap_or_default();
        whole.split(';').next().unwrap_or_default().trim().to_ascii_lowercase()
    }

    /// Returns the boundary between the parts of a response; cameras write it with and without dashes and quotes.
    pub(super) fn boundary(&self) -> Option<Vec<u8>> {
        let parameters = self.content_type.as_deref()?.split(';').skip(1);
        let mut boundaries = parameters.filter_map(|parameter| {
            let (name, value) = parameter.split_once('=')?;
            name.trim().eq_ignore_ascii_case("boundary").then(|| value.trim().trim_matches('"').trim_start_matches('-'))
        });
        boundaries
            .next()
            .filter(|boundary| !boundary.is_empty() && boundary.len() <= 200)
            .map(|text| text.as_bytes().to_vec())
    }
}
