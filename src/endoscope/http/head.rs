//! The head of a response, and of one of its parts.

use super::answer::Wrong;

/// Fields of a head; their names are case-insensitive.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Head {
    pub(super) content_type: Option<String>,
    pub(super) length: Option<usize>,
    pub(super) is_chunked: bool,
    pub(super) stamp_s: Option<f64>,
}

impl Head {
    /// Parses the lines of a head, without the first line.
    pub(super) fn parse(text: &[u8]) -> Result<Self, Wrong> {
        let mut head = Self::default();
        for line in text.split(|byte| *byte == b'\n') {
            let line = String::from_utf8_lossy(line);
            let Some((name, value)) = line.split_once(':') else { continue };
            let value = value.trim();
            match name.trim().to_ascii_lowercase().as_str() {
                "content-type" => head.content_type = Some(value.to_owned()),
                "content-length" => {
                    let length = value.parse().map_err(|_| Wrong::Unreadable("a length that is not a number"))?;
                    head.length = Some(length);
                }
                "transfer-encoding" => match value.to_ascii_lowercase().as_str() {
                    "chunked" => head.is_chunked = true,
                    "identity" => {}
                    _ => return Err(Wrong::Unreadable("a compression that was not asked for")),
                },
                // Seconds, as sent by mjpg-streamer and others.
                "x-timestamp" => head.stamp_s = value.parse().ok().filter(|stamp_s: &f64| stamp_s.is_finite()),
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

/// Returns the status in the first line of a response.
pub(super) fn status(line: &[u8]) -> Result<u16, Wrong> {
    let text = String::from_utf8_lossy(line);
    let mut words = text.split_whitespace();
    let is_http = words.next().is_some_and(|version| version.starts_with("HTTP/1."));
    let status = words.next().and_then(|status| status.parse().ok());
    status.filter(|_| is_http).ok_or(Wrong::Unreadable("an answer that is not HTTP"))
}

/// Returns the end of a head and the begin of the data after it; cameras end lines with and without a carriage return.
pub(super) fn end(bytes: &[u8]) -> Option<[usize; 2]> {
    let with = bytes.windows(4).position(|four| four == b"\r\n\r\n").map(|at| [at, at + 4]);
    let without = bytes.windows(2).position(|two| two == b"\n\n").map(|at| [at, at + 2]);
    [with, without].into_iter().flatten().min()
}
