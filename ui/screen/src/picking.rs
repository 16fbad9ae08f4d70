//! Lets the user choose a file anywhere, in the system's own dialog, while the window keeps running.

use std::{
    path::{Path, PathBuf},
    sync::mpsc::{Receiver, TryRecvError, channel},
    thread,
};

use egui::Context;

/// Description and endings of the files to choose from.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    pub name: &'static str,
    pub endings: &'static [&'static str],
}

/// A dialog that is open.
#[derive(Debug)]
pub struct Picking(Receiver<PathBuf>);

impl Picking {
    /// Opens the dialog in this folder on its own thread, because it waits for the user.
    pub fn open(ctx: &Context, title: &str, kind: Kind, folder: Option<&Path>) -> Self {
        let mut dialog = rfd::FileDialog::new().set_title(title).add_filter(kind.name, kind.endings);
        if let Some(folder) = folder {
            dialog = dialog.set_directory(folder);
        }
        Self::with(ctx, move || dialog.pick_file())
    }

    pub fn with(ctx: &Context, pick: impl FnOnce() -> Option<PathBuf> + Send + 'static) -> Self {
        let (give, picked) = channel();
        let ctx = ctx.clone();
        let work = move || {
            if let Some(path) = pick() {
                give.send(path).ok();
            }
            drop(give);
            ctx.request_repaint();
        };
        // If no thread can be created, the dialog counts as cancelled.
        thread::Builder::new().name("dialog".to_owned()).spawn(work).ok();
        Self(picked)
    }

    /// Returns the chosen file, once. Closes `picking` when the user has chosen or cancelled.
    pub fn take(picking: &mut Option<Self>) -> Option<PathBuf> {
        let report = picking.as_ref()?.0.try_recv();
        if report != Err(TryRecvError::Empty) {
            *picking = None;
        }
        report.ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the result of a dialog in which this file is chosen.
    fn picked(path: Option<PathBuf>) -> Option<PathBuf> {
        let mut picking = Some(Picking::with(&Context::default(), || path));
        while picking.is_some() {
            if let Some(path) = Picking::take(&mut picking) {
                assert!(picking.is_none());
                return Some(path);
            }
            thread::yield_now();
        }
        None
    }

    #[test]
    fn a_file_comes_once_and_a_cancelled_dialog_is_closed() {
        let path = PathBuf::from("/data/a.mcap");
        assert_eq!(picked(Some(path.clone())), Some(path));
        assert_eq!(picked(None), None);
    }

    #[test]
    fn nobody_waits_for_a_dialog() {
        let (close, closed) = channel::<()>();
        let mut picking = Some(Picking::with(&Context::default(), move || {
            closed.recv().ok();
            None
        }));
        assert_eq!(Picking::take(&mut picking), None);
        assert!(picking.is_some());
        close.send(()).unwrap();
    }
}
