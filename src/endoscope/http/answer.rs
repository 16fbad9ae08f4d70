//! Parses a response as its bytes arrive, without I/O: head, chunks if there are any, parts.

use std::collections::VecDeque;

use super::{chunked::ChunkedBody, head::HttpHead};

/// Maximum size of an image, bytes. Far larger than an image of any camera; a wrong length must not fill the memory.
pub(super) const IMAGE_MAX: usize = 8 << 20;
/// Number of images kept for a slow reader; older images are dropped.
const PARTS_MAX: usize = 8;

/// One image with its headers, still encoded.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ImagePart {
    pub(super) body: Vec<u8>,
    pub(super) stamp_s: Option<f64>,
}

/// Why there will be no more images.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum HttpFault {
    Status(u16),
    /// A password is required: the camera's challenges.
    Locked(Vec<String>),
    /// The images are at another address.
    Moved(String),
    Format(String),
    Unreadable(&'static str),
    Ended,
}

/// The response received so far.
#[derive(Debug, Default)]
pub(super) struct HttpAnswer {
    state: AnswerState,
    chunked: Option<ChunkedBody>,
    boundary: Vec<u8>,
    held: Vec<u8>,
    /// Bytes of `held` that have been searched for the next boundary.
    searched: usize,
}

/// Result of a step.
enum AnswerStep {
    /// More bytes are needed.
    Wait,
    /// The next step is possible.
    On,
    Give(ImagePart),
}

#[derive(Debug, Default)]
enum AnswerState {
    #[default]
    Head,
    /// Before a boundary.
    Between,
    PartHead,
    Body(HttpHead),
}

impl HttpAnswer {
    /// Adds received bytes to the response; appends the images that they complete to `parts`.
    pub(super) fn take(&mut self, bytes: &[u8], parts: &mut VecDeque<ImagePart>) -> Result<(), HttpFault> {
        match &mut self.chunked {
            Some(chunked) => chunked.take(bytes, &mut self.held)?,
            None => self.held.extend_from_slice(bytes),
        }
        loop {
            match self.step()? {
                AnswerStep::Wait => return Ok(()),
                AnswerStep::On => {}
                AnswerStep::Give(part) => {
                    parts.push_back(part);
                    if parts.len() > PARTS_MAX {
                        parts.pop_front();
                    }
                }
            }
        }
    }

    /// Returns the bytes in memory, for a test.
    #[cfg(test)]
    pub(super) fn held(&self) -> usize {
        self.held.capacity()
    }

    /// Performs one step.
    fn step(&mut self) -> Result<AnswerStep, HttpFault> {
        match std::mem::take(&mut self.state) {
            AnswerState::Head => self.head(),
            AnswerState::Between => self.between(),
            AnswerState::PartHead => self.part_head(),
            AnswerState::Body(head) => match head.length {
                Some(length) => Ok(self.counted(head, length)),
                None => self.searched_for(head),
            },
        }
    }

    fn head(&mut self) -> Result<AnswerStep, HttpFault> {
        let Some((head, begins)) = HttpHead::read(&self.held)? else { return Ok(AnswerStep::Wait) };
        match head.status {
            200 => {}
            401 => return Err(HttpFault::Locked(head.challenges)),
            status @ (301 | 302 | 303 | 307 | 308) => {
                return Err(head.location.map_or(HttpFault::Status(status), HttpFault::Moved));
            }
            status => return Err(HttpFault::Status(status)),
        }
        let kind = head.kind();
        self.boundary = match (kind.as_str(), head.boundary()) {
            (kind, Some(boundary)) if kind.starts_with("multipart/") => boundary,
            ("", _) => return Err(HttpFault::Format("a response without a content type".to_owned())),
            (kind, _) if kind.starts_with("multipart/") => {
                return Err(HttpFault::Unreadable("a multipart response without a boundary"));
            }
            // A snapshot address instead of the stream: it would show one image and freeze.
            ("image/jpeg", _) => return Err(HttpFault::Format("a single image".to_owned())),
            (kind, _) => return Err(HttpFault::Format(short(kind))),
        };
        let rest = self.held.split_off(begins);
        self.held.clear();
        if head.is_chunked {
            self.chunked.insert(ChunkedBody::default()).take(&rest, &mut self.held)?;
        } else {
            self.held = rest;
        }
        Ok(self.to(AnswerState::Between, 0))
    }

    fn between(&mut self) -> Result<AnswerStep, HttpFault> {
        self.state = AnswerState::Between;
        let Some(at) = self.find_boundary() else {
            let gone = self.searched;
            self.skip(gone);
            return Ok(AnswerStep::Wait);
        };
        let behind = at + 2 + self.boundary.len();
        let Some(next) = self.held.get(behind..behind + 2) else { return Ok(AnswerStep::Wait) };
        if next == b"--" {
            return Err(HttpFault::Ended);
        }
        Ok(self.to(AnswerState::PartHead, behind))
    }

    fn part_head(&mut self) -> Result<AnswerStep, HttpFault> {
        let Some((head, begins)) = HttpHead::read_part(&self.held)? else {
            self.state = AnswerState::PartHead;
            return Ok(AnswerStep::Wait);
        };
        if head.length.is_some_and(|length| length > IMAGE_MAX) {
            return Err(HttpFault::Unreadable("an image that is too large"));
        }
        match head.kind().as_str() {
            // Some cameras omit the type of a part, and some misspell it.
            "" | "image/jpeg" | "image/jpg" => Ok(self.to(AnswerState::Body(head), begins)),
            kind => Err(HttpFault::Format(short(kind))),
        }
    }

    /// Reads an image whose length is known.
    fn counted(&mut self, head: HttpHead, length: usize) -> AnswerStep {
        if self.held.len() < length {
            self.state = AnswerState::Body(head);
            return AnswerStep::Wait;
        }
        let rest = self.held.split_off(length);
        let body = std::mem::replace(&mut self.held, rest);
        self.state = AnswerState::Between;
        self.searched = 0;
        AnswerStep::Give(ImagePart { body, stamp_s: head.stamp_s })
    }

    /// Reads an image that ends at the next boundary.
    fn searched_for(&mut self, head: HttpHead) -> Result<AnswerStep, HttpFault> {
        let Some(at) = self.find_boundary() else {
            self.state = AnswerState::Body(head);
            let too_long = self.held.len() > IMAGE_MAX;
            return if too_long {
                Err(HttpFault::Unreadable("an image that is too large"))
            } else {
                Ok(AnswerStep::Wait)
            };
        };
        let rest = self.held.split_off(at);
        let mut body = std::mem::replace(&mut self.held, rest);
        // Remove the line break of the boundary: a JPEG never ends with one.
        while body.last().is_some_and(|byte| matches!(byte, b'\r' | b'\n' | b'-')) {
            body.pop();
        }
        self.state = AnswerState::Between;
        self.searched = 0;
        Ok(AnswerStep::Give(ImagePart { body, stamp_s: head.stamp_s }))
    }

    /// Returns the start of the next boundary, with its two dashes. Searches each byte only once.
    fn find_boundary(&mut self) -> Option<usize> {
        let length = 2 + self.boundary.len();
        let is_boundary = |window: &[u8]| window.starts_with(b"--") && window[2..] == self.boundary;
        let found = self.held[self.searched..].windows(length).position(is_boundary);
        if found.is_none() {
            // A boundary may be split between two reads, so the last bytes are searched again.
            self.searched = (self.held.len() + 1).saturating_sub(length);
        }
        found.map(|at| self.searched + at)
    }

    fn skip(&mut self, count: usize) {
        self.held.drain(..count);
        self.searched = 0;
    }

    fn to(&mut self, state: AnswerState, gone: usize) -> AnswerStep {
        self.skip(gone);
        self.state = state;
        AnswerStep::On
    }
}

/// Returns a content type from the other end, shortened for a message.
fn short(kind: &str) -> String {
    kind.chars().filter(char::is_ascii_graphic).take(60).collect()
}
