//! Searches for the board on a separate thread, one image at a time, so that the window never waits for it.

use std::{
    sync::{
        Arc,
        mpsc::{Receiver, Sender, channel},
    },
    thread,
};

use egui::Context;
use nima_camera::{BoardSight, DetectionFailure, Grey, find};
use nima_endoscope::{Checkerboard, DecodedImage};

/// An image and the board in it.
#[derive(Debug)]
pub(super) struct BoardImage {
    pub(super) image: Arc<DecodedImage>,
    pub(super) board: Checkerboard,
    pub(super) sight: Result<BoardSight, DetectionFailure>,
}

/// The thread, which ends when this is dropped.
#[derive(Debug)]
pub(super) struct Detector {
    asked: Sender<(Arc<DecodedImage>, Checkerboard)>,
    found: Receiver<BoardImage>,
    busy: bool,
    last: u64,
}

impl Detector {
    /// `None` if no thread can be created.
    pub(super) fn new(ctx: &Context) -> Option<Self> {
        let (asked, images) = channel::<(Arc<DecodedImage>, Checkerboard)>();
        let (finds, found) = channel();
        let ctx = ctx.clone();
        let work = move || {
            while let Ok((image, board)) = images.recv() {
                let sight = Grey::of(&image).map_or(Err(DetectionFailure::Nothing), |grey| find(&grey, &board));
                if finds.send(BoardImage { image, board, sight }).is_err() {
                    return;
                }
                ctx.request_repaint();
            }
        };
        thread::Builder::new().name("board".to_owned()).spawn(work).ok()?;
        Some(Self { asked, found, busy: false, last: 0 })
    }

    /// Passes the newest image; images that arrive during a search are skipped.
    pub(super) fn show(&mut self, (number, image): (u64, Arc<DecodedImage>), board: Checkerboard) {
        if !self.busy && number != self.last {
            self.busy = self.asked.send((image, board)).is_ok();
            self.last = number;
        }
    }

    /// Returns the results since the last call.
    pub(super) fn take(&mut self) -> Option<BoardImage> {
        let found = self.found.try_recv().ok();
        self.busy &= found.is_none();
        found
    }
}
