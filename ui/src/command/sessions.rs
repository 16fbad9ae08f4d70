//! `nima sessions`: lists, keeps and deletes sessions in the user's folder.

use std::{fmt::Write as _, path::PathBuf};

use anyhow::{Context as _, bail};
use clap::Args;
use nima_files::quoted;
use nima_recording::{session::ReadError, store::Store};
use nima_report::output;
use nima_session::{
    file::{self, RecordedFile},
    plot_channels,
    session_store::{MAX_BYTES, SessionStore, StoredSession, keep},
};
use serde::Serialize;

#[derive(Debug, Args)]
pub(super) struct SessionsArguments {
    /// Delete this session
    #[arg(long, value_name = "NAME", group = "one")]
    delete: Option<String>,
    /// Keep this session: it is never deleted to make room for new ones
    #[arg(long, value_name = "NAME", group = "one")]
    keep: Option<String>,
    /// Stop keeping this session
    #[arg(long, value_name = "NAME", group = "one")]
    unkeep: Option<String>,
    /// Print the list as one JSON object
    #[arg(long, conflicts_with = "one")]
    json: bool,
}

pub(super) fn run(arguments: &SessionsArguments) -> anyhow::Result<()> {
    let store = Store::of_user()?;
    let folder = store.folder().parent().context("no data folder was found; set NIMA_DATA_DIR")?;
    let shelf = SessionStore::new(folder.join("sessions"), MAX_BYTES);
    let SessionsArguments { delete, keep: kept, unkeep, json } = arguments;
    if let Some(name) = delete {
        return delete_one(&shelf, name);
    }
    if let Some((name, kept)) = kept.as_ref().map(|name| (name, true)).or(unkeep.as_ref().map(|name| (name, false))) {
        let session = find(&shelf, name)?;
        keep(&session.path, kept).with_context(|| format!("cannot mark session {}", session.path.display()))?;
        let words = if kept { "is kept" } else { "is no longer kept: it can be deleted to make room for new sessions" };
        return output::line(&format!("{} {words}", session.path.display()));
    }
    let listed = ListedSession::of(&shelf)?;
    if *json { output::json(&listed) } else { output::line(&listed.as_text()) }
}

/// Finds a session by its file name, with or without the extension.
fn find(shelf: &SessionStore, name: &str) -> anyhow::Result<StoredSession> {
    let is_it = |session: &StoredSession| {
        let path = &session.path;
        [path.file_name(), path.file_stem()].into_iter().flatten().any(|known| known == name)
    };
    let found = sessions(shelf)?.into_iter().find(is_it);
    found.with_context(|| {
        format!(
            "session \"{}\" not found in {}; `nima sessions` lists all sessions",
            quoted(name),
            shelf.folder().display()
        )
    })
}

fn sessions(shelf: &SessionStore) -> anyhow::Result<Vec<StoredSession>> {
    shelf.sessions().with_context(|| format!("cannot read the folder {}", shelf.folder().display()))
}

fn delete_one(shelf: &SessionStore, name: &str) -> anyhow::Result<()> {
    let StoredSession { path, kept, writing, .. } = find(shelf, name)?;
    if writing {
        bail!("session {} is being recorded: end the program that records it first", path.display());
    }
    if kept {
        bail!("session {} is kept: use --unkeep first", path.display());
    }
    std::fs::remove_file(&path).with_context(|| format!("cannot delete session {}", path.display()))?;
    output::line(&format!("{} is deleted", path.display()))
}

#[derive(Serialize)]
struct ListedSession {
    folder: PathBuf,
    sessions: Vec<SessionReport>,
    bytes: u64,
    /// Size of all sessions that are not kept.
    loose_bytes: u64,
    #[serde(rename = "most_loose_bytes")]
    max_loose_bytes: u64,
}

#[derive(Serialize)]
struct SessionReport {
    name: String,
    bytes: u64,
    kept: bool,
    /// `recording`, `closed`, `stretch`, `not closed` or `damaged`.
    state: &'static str,
    #[serde(flatten)]
    about: Option<SessionListing>,
    #[serde(skip_serializing_if = "Option::is_none")]
    trouble: Option<String>,
}

#[derive(Serialize)]
struct SessionListing {
    started: Option<String>,
    rig: Option<String>,
    seconds: f64,
    /// Start of an excerpt in its session.
    #[serde(skip_serializing_if = "Option::is_none")]
    stretch_from_s: Option<f64>,
    last_fault: Option<LastFault>,
    closed: bool,
}

#[derive(Serialize)]
struct LastFault {
    t_s: f64,
    words: String,
}

impl ListedSession {
    fn of(shelf: &SessionStore) -> anyhow::Result<Self> {
        let all = sessions(shelf)?;
        let sum = |sessions: &mut dyn Iterator<Item = &StoredSession>| sessions.map(|session| session.bytes).sum();
        Ok(Self {
            folder: shelf.folder().to_owned(),
            bytes: sum(&mut all.iter()),
            loose_bytes: sum(&mut all.iter().filter(|session| !session.kept)),
            max_loose_bytes: MAX_BYTES,
            sessions: all.iter().map(SessionReport::of).collect(),
        })
    }

    fn as_text(&self) -> String {
        let Self { folder, sessions, bytes, loose_bytes, max_loose_bytes } = self;
        let mut text = String::new();
        for session in sessions {
            text += &session.as_text();
        }
        let megabytes = |bytes: u64| bytes as f64 * 1e-6;
        write!(
            text,
            "{} session{} in {}, {:.1} MB; sessions that are not kept use {:.1} of {:.0} MB",
            sessions.len(),
            if sessions.len() == 1 { "" } else { "s" },
            folder.display(),
            megabytes(*bytes),
            megabytes(*loose_bytes),
            megabytes(*max_loose_bytes),
        )
        .ok();
        text
    }
}

impl SessionReport {
    fn of(session: &StoredSession) -> Self {
        let StoredSession { path, bytes, kept, writing, .. } = session;
        let read = SessionListing::of(session);
        let state = match &read {
            _ if *writing => "recording",
            Ok(about) if about.closed => "closed",
            Ok(about) if about.stretch_from_s.is_some() => "stretch",
            Ok(_) => "not closed",
            Err(_) => "damaged",
        };
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let trouble = read.as_ref().err().map(ToString::to_string);
        Self { name, bytes: *bytes, kept: *kept, state, about: read.ok(), trouble }
    }

    fn as_text(&self) -> String {
        let Self { name, bytes, kept, state, about, trouble } = self;
        let mut text = format!("{name}: {state}, {:.1} MB", *bytes as f64 * 1e-6);
        if *kept {
            text += ", kept";
        }
        if let Some(SessionListing { started, rig, seconds, last_fault, .. }) = about {
            let [started, rig] =
                [started, rig].map(|report| report.as_deref().map_or_else(|| "unknown".to_owned(), quoted));
            write!(text, ", {seconds:.1} s, started {started}, rig \"{rig}\"").ok();
            if let Some(LastFault { t_s, words }) = last_fault {
                write!(text, ", last fault at {t_s:.1} s: {}", quoted(words)).ok();
            }
        }
        if let Some(trouble) = trouble {
            write!(text, ": {trouble}").ok();
        }
        text + "\n"
    }
}

impl SessionListing {
    fn of(session: &StoredSession) -> Result<Self, ReadError> {
        let file = RecordedFile::open(&session.path)?;
        let reader = file.reader();
        let begin_ns = plot_channels::beginning_ns(reader)?;
        let since = |time_ns: u64| time_ns.saturating_sub(begin_ns) as f64 / 1e9;
        let about = file.about()?;
        let seconds = about.length_s();
        let file::SessionInfo { started, rig, stretch_from_s, .. } = about;
        let fault = file.last_fault()?.map(|(time_ns, words)| LastFault { t_s: since(time_ns), words });
        Ok(Self { started, rig, seconds, stretch_from_s, last_fault: fault, closed: file.is_closed()? })
    }
}
