//! Longer work on a session, in a separate thread: a report, an excerpt.

use std::{
    ops::Range,
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, TryRecvError, channel},
    },
    thread::{self, JoinHandle},
};

use egui::Context;
use nima_recording::session::SessionReader;
use nima_screen::opener;
use nima_session::{plot_channels, session_store::keep, trim};
use nima_words::{
    language::{self, Language},
    report_text::{chain, quoted},
    text,
};

/// Folder of the reports, next to the sessions.
const REPORTS: &str = "reports";

/// Running work, and the receiver of its messages.
#[derive(Debug)]
pub(super) struct SessionJob {
    doing: &'static str,
    message: Receiver<String>,
    /// Set when the result is no longer needed.
    left: Arc<AtomicBool>,
    /// Deletes the half-written file then, which takes a moment: the program must not end before.
    tidies: Option<JoinHandle<()>>,
}

impl Drop for SessionJob {
    fn drop(&mut self) {
        self.left.store(true, Ordering::Relaxed);
        if let Some(tidies) = self.tidies.take() {
            tidies.join().ok();
        }
    }
}

impl SessionJob {
    /// Updates the work; returns true when it is over.
    pub(super) fn message(&self) -> (String, bool) {
        match self.message.try_recv() {
            Ok(words) => (words, true),
            Err(TryRecvError::Empty) => (self.doing.to_owned(), false),
            Err(TryRecvError::Disconnected) => (text::playback::NO_THREAD.get().to_owned(), true),
        }
    }

    fn start(ctx: &Context, doing: &'static str, work: impl FnOnce(&AtomicBool) -> String + Send + 'static) -> Self {
        let (sender, message) = channel();
        let ctx = ctx.clone();
        let left = Arc::new(AtomicBool::new(false));
        let seen = Arc::clone(&left);
        let work = move || {
            sender.send(work(&seen)).ok();
            ctx.request_repaint();
        };
        // If no thread can be created, `sender` is dropped, which is reported.
        let tidies = thread::Builder::new().name("session".to_owned()).spawn(language::carried(work)).ok();
        Self { doing, message, left, tidies }
    }

    /// Writes the page of a session and opens it, if this computer has a program for it.
    pub(super) fn report(ctx: &Context, session: &Path) -> Self {
        let session = session.to_path_buf();
        let mut job = Self::start(ctx, text::playback::REPORTING.get(), move |_| {
            let folder = beside(&session).join(REPORTS).join(session.file_stem().unwrap_or_default());
            // Files are in English.
            match language::with(Language::English, || nima_report::write(&[session], &folder)) {
                Ok(page) => {
                    // If no browser opens, the message on the screen still shows the file's path.
                    opener::open(&page);
                    text::playback::reported(&page)
                }
                Err(error) => text::playback::not_reported(&format!("{error:#}")),
            }
        });
        // No files need to be removed: the report is written completely or not at all, and the browser may stay open
        // for a long time.
        job.tidies = None;
        job
    }

    /// Saves the excerpt between these times (s) next to the session, and keeps it.
    pub(super) fn cut(ctx: &Context, session: &Path, times_s: Range<f64>) -> Self {
        let session = session.to_path_buf();
        Self::start(ctx, text::playback::CUTTING.get(), move |left| match save(&session, &times_s, left) {
            Ok(path) => text::playback::saved(&path),
            Err(why) => text::playback::not_saved(&why),
        })
    }
}

fn beside(session: &Path) -> &Path {
    session.parent().unwrap_or_else(|| Path::new(""))
}

fn save(session: &Path, times_s: &Range<f64>, left: &AtomicBool) -> Result<PathBuf, String> {
    let stem = session.file_stem().unwrap_or_default().to_string_lossy();
    let to = session.with_file_name(format!("{stem}-{:.1}-{:.1}.mcap", times_s.start, times_s.end));
    if to.symlink_metadata().is_ok() {
        return Err(text::playback::taken(&to));
    }
    let part = to.with_extension("part");
    let written = cut_out(session, times_s, &part, left)
        .and_then(|()| std::fs::rename(&part, &to).and_then(|()| keep(&to, true)).map_err(|error| quoted(&error)));
    if written.is_err() {
        std::fs::remove_file(&part).ok();
    }
    written.map(|()| to)
}

fn cut_out(session: &Path, times_s: &Range<f64>, part: &Path, left: &AtomicBool) -> Result<(), String> {
    let reader = SessionReader::open(session).map_err(|error| quoted(&chain(&error)))?;
    let begin_ns = plot_channels::beginning_ns(&reader).map_err(|error| quoted(&chain(&error)))?;
    let time_ns = |seconds: f64| begin_ns + (seconds * 1e9).round() as u64;
    let name = session.file_name().unwrap_or_default().to_string_lossy();
    let times_ns = time_ns(times_s.start)..time_ns(times_s.end);
    trim::write(&reader, &name, &times_ns, part, left).map_err(|error| quoted(&chain(&error)))?;
    Ok(())
}
