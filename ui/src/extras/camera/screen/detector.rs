//! Searches for the board on a separate thread, one image at a time, so that the window never waits for it.

use std::{
    sync::{
        Arc,
        mpsc::{Receiver, Sender, channel},
    },
    thread,
};

use egui::Context;
use nima_camera::{Grey, Sight, Unseen, find};
use nima_endoscope::{Board, Picture};

/// An image and the board in it.
#[derive(Debug)]
pub(super) struct Found {
    pub(super) picture: Arc<Picture>,
    pub(super) board: Board,
    pub(super) sight: Result<Sight, Unseen>,
}

/// The thread, which ends when this is dropped.
#[derive(Debug)]
pub(super) struct Detector {
    asked: Sender<(Arc<Picture>, Board)>,
    found: Receiver<Found>,
    busy: bool,
    last: u64,
}

impl Detector {
    /// `None` if no thread can be created.
    pub(super) fn new(ctx: &Context) -> Option<Self> {
        let (asked, pictures) = channel::<(Arc<Picture>, Board)>();
        let (finds, found) = channel();
        let ctx = ctx.clone();
        let work = move || {
            while let Ok((picture, board)) = pictures.recv() {
                let sight = Grey::of(&picture).map_or(Err(Unseen::Nothing), |grey| find(&grey, &board));
                if finds.send(Found { picture, board, sight }).is_err() {
                    return;
                }
                ctx.request_repaint();
            }
        };
        thread::Builder::new().name("board".to_owned()).spawn(work).ok()?;
        Some(Self { asked, found, busy: false, last: 0 })
    }

    /// Passes the newest image; images that arrive during a search are skipped.
    pub(super) fn show(&mut self, (number, picture): (u64, Arc<Picture>), board: Board) {
        if !self.busy && number != self.last {
            self.busy = self.asked.send((picture, board)).is_ok();
            self.last = number;
        }
    }

    /// Results since the last call.
    pub(super) fn take(&mut self) -> Option<Found> {
        let found = self.found.try_recv().ok();
        self.busy &= found.is_none();
        found
    }
}
