//! Work on another thread, whose result the window shows when it arrives.

use std::{
    sync::mpsc::{Receiver, TryRecvError, channel},
    thread,
};

use egui::Context;
use nima_words::language;

/// Work on a separate thread, and its last result.
#[derive(Debug)]
pub struct BackgroundQuery<T> {
    running: Option<Receiver<T>>,
    found: Option<T>,
}

impl<T> Default for BackgroundQuery<T> {
    fn default() -> Self {
        Self { running: None, found: None }
    }
}

impl<T: Send + 'static> BackgroundQuery<T> {
    /// Starts the work; the window is woken when there is a result. Does nothing while work is in progress.
    pub fn begin(&mut self, ctx: &Context, work: impl FnOnce() -> T + Send + 'static) {
        if self.running.is_some() {
            return;
        }
        let (give, take) = channel();
        let ctx = ctx.clone();
        let looks = move || {
            give.send(work()).ok();
            ctx.request_repaint();
        };
        self.running =
            thread::Builder::new().name("devices".to_owned()).spawn(language::carried(looks)).ok().map(|_| take);
    }

    pub fn found(&mut self) -> Option<&T> {
        match self.running.as_ref().map(Receiver::try_recv) {
            Some(Ok(found)) => (self.running, self.found) = (None, Some(found)),
            Some(Err(TryRecvError::Disconnected)) => self.running = None,
            Some(Err(TryRecvError::Empty)) | None => {}
        }
        self.found.as_ref()
    }

    pub const fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// Discards the result, and a result of work in progress.
    pub fn forget(&mut self) {
        *self = Self::default();
    }
}
