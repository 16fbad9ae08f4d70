//! Parses a response as its bytes arrive, without I/O: head, chunks if there are any, parts.

use std::collections::VecDeque;

use super::{chunked::Chunked, head::Head};

/// Maximum size of an image, bytes.
pub(super) const PICTURE_MOST: usize = 8 << 20;
/// Number of images that are kept for a slow reader; older ones are dropped.
const PARTS_MOST: usize = 8;

/// One image with its headers, still encoded.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Part {
    pub(super) body: Vec<u8>,
    pub(super) stamp_s: Option<f64>,
}

/// Why there will be no more images.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Wrong {
    Status(u16),
    /// A password is needed: what the camera asks for.
    Locked(Vec<String>),
    Format(String),
    Unreadable(&'static str),
    Ended,
}

/// The response received so far.
#[derive(Debug, Default)]
pub(super) struct Answer {
    state: State,
    chunked: Option<Chunked>,
    boundary: Vec<u8>,
    held: Vec<u8>,
    /// Bytes of `held` that have been searched for the next boundary.
    searched: usize,
}

/// Result of a step.
enum Step {
    /// More bytes are needed.
    Wait,
    /// The next step is possible.
    On,
    Give(Part),
}

#[derive(Debug, Default)]
enum State {
    #[default]
    Head,
    /// Before a boundary.
    Between,
    PartHead,
    Body(Head),
}

impl Answer {
    /// Adds received bytes to the response; appends the images that they complete to `parts`.
    pub(super) fn take(&mut self, bytes: &[u8], parts: &mut VecDeque<Part>) -> Result<(), Wrong> {
        match &mut self.chunked {
            Some(chunked) => chunked.take(bytes, &mut self.held)?,
            None => self.held.extend_from_slice(bytes),
        }
        loop {
            match self.step()? {
                Step::Wait => return Ok(()),
                Step::On => {}
                Step::Give(part) => {
                    parts.push_back(part);
                    if parts.len() > PARTS_MOST {
                        parts.pop_front();
                    }
                }
            }
        }
    }

    /// Bytes in memory, for a test.
    #[cfg(test)]
    pub(super) fn held(&self) -> usize {
        self.held.capacity()
    }

    /// Performs one step.
    fn step(&mut self) -> Result<Step, Wrong> {
        match std::mem::take(&mut self.state) {
            State::Head => self.head(),
            State::Between => self.between(),
            State::PartHead => self.part_head(),
            State::Body(head) => match head.length {
                Some(length) => Ok(self.counted(head, length)),
                None => self.searched_for(head),
            },
        }
    }

    fn head(&mut self) -> Result<Step, Wrong> {
        let Some((head, begins)) = Head::read(&self.held)? else { return Ok(Step::Wait) };
        match head.status {
            200 => {}
            401 => return Err(Wrong::Locked(head.challenges)),
            status => return Err(Wrong::Status(status)),
        }
        let kind = head.kind();
        self.boundary = match (kind.as_str(), head.boundary()) {
            (kind, Some(boundary)) if kind.starts_with("multipart/") => boundary,
            ("", _) => return Err(Wrong::Format("something without a type".to_owned())),
            (kind, _) if kind.starts_with("multipart/") => return Err(Wrong::Unreadable("parts without a boundary")),
            ("image/jpeg", _) => return Err(Wrong::Format("a single picture".to_owned())),
            (kind, _) => return Err(Wrong::Format(short(kind))),
        };
        let rest = self.held.split_off(begins);
        self.held.clear();
        if head.is_chunked {
            self.chunked.insert(Chunked::default()).take(&rest, &mut self.held)?;
        } else {
            self.held = rest;
        }
        Ok(self.to(State::Between, 0))
    }

    fn between(&mut self) -> Result<Step, Wrong> {
        self.state = State::Between;
        let Some(at) = self.find_boundary() else {
            let gone = self.searched;
            self.skip(gone);
            return Ok(Step::Wait);
        };
        let behind = at + 2 + self.boundary.len();
        let Some(next) = self.held.get(behind..behind + 2) else { return Ok(Step::Wait) };
        if next == b"--" {
            return Err(Wrong::Ended);
        }
        Ok(self.to(State::PartHead, behind))
    }

    fn part_head(&mut self) -> Result<Step, Wrong> {
        let Some((head, begins)) = Head::read_part(&self.held)? else {
            self.state = State::PartHead;
            return Ok(Step::Wait);
        };
        if head.length.is_some_and(|length| length > PICTURE_MOST) {
            return Err(Wrong::Unreadable("a picture that is too long"));
        }
        match head.kind().as_str() {
            "" | "image/jpeg" | "image/jpg" => Ok(self.to(State::Body(head), begins)),
            kind => Err(Wrong::Format(short(kind))),
        }
    }

    /// Reads an image whose length is known.
    fn counted(&mut self, head: Head, length: usize) -> Step {
        if self.held.len() < length {
            self.state = State::Body(head);
            return Step::Wait;
        }
        let rest = self.held.split_off(length);
        let body = std::mem::replace(&mut self.held, rest);
        self.state = State::Between;
        self.searched = 0;
        Step::Give(Part { body, stamp_s: head.stamp_s })
    }

    /// Reads an image that ends at the next boundary.
    fn searched_for(&mut self, head: Head) -> Result<Step, Wrong> {
        let Some(at) = self.find_boundary() else {
            self.state = State::Body(head);
            let too_long = self.held.len() > PICTURE_MOST;
            return if too_long { Err(Wrong::Unreadable("a picture that is too long")) } else { Ok(Step::Wait) };
        };
        let rest = self.held.split_off(at);
        let mut body = std::mem::replace(&mut self.held, rest);
        // Remove the line break of the boundary: a JPEG never ends with one.
        while body.last().is_some_and(|byte| matches!(byte, b'\r' | b'\n' | b'-')) {
            body.pop();
        }
        self.state = State::Between;
        self.searched = 0;
        Ok(Step::Give(Part { body, stamp_s: head.stamp_s }))
    }

    /// Returns the begin of the next boundary, with its two dashes. Searches each byte only once.
    fn find_boundary(&mut self) -> Option<usize> {
        let length = 2 + self.boundary.len();
        let is_boundary = |window: &[u8]| window.starts_with(b"--") && window[2..] == self.boundary;
        let found = self.held[self.searched..].windows(length).position(is_boundary);
        if found.is_none() {
            self.searched = (self.held.len() + 1).saturating_sub(length);
        }
        found.map(|at| self.searched + at)
    }

    fn skip(&mut self, count: usize) {
        self.held.drain(..count);
        self.searched = 0;
    }

    fn to(&mut self, state: State, gone: usize) -> Step {
        self.skip(gone);
        self.state = state;
        Step::On
    }
}

/// A content type from the other end, shortened for a message.
fn short(kind: &str) -> String {
    kind.chars().filter(char::is_ascii_graphic).take(60).collect()
}
