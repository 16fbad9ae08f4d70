//! The report of sessions: one self-contained page.
// These macros panic if stderr or stdout is closed.
#![cfg_attr(not(test), deny(clippy::print_stderr, clippy::print_stdout))]

mod arms;
pub mod html;
pub mod output;
mod overall;
pub mod plots;

use std::path::{Path, PathBuf};

use anyhow::Context as _;
use maud::{Markup, html};
use nima_session::report::SessionFigures;

use html::{section, table};

pub const PAGE: &str = "report.html";

/// Reads the sessions and writes their page into this folder, which is created if missing.
pub fn write(sessions: &[PathBuf], folder: &Path) -> anyhow::Result<PathBuf> {
    write_figures(&read(sessions)?, sessions, folder)
}

pub fn read(sessions: &[PathBuf]) -> anyhow::Result<Vec<SessionFigures>> {
    sessions.iter().map(|path| Ok(SessionFigures::read(path)?)).collect()
}

pub fn write_figures(figures: &[SessionFigures], sessions: &[PathBuf], folder: &Path) -> anyhow::Result<PathBuf> {
    let inputs: Vec<&Path> = sessions.iter().map(PathBuf::as_path).collect();
    output::folder(folder, &[PAGE], &inputs)?;
    output::write(folder, PAGE, &page(figures)).context("the report")?;
    Ok(folder.join(PAGE))
}

fn page(sessions: &[SessionFigures]) -> String {
    let title = match sessions {
        [one] => format!("Session {}", name(one)),
        _ => format!("{} sessions", sessions.len()),
    };
    let is_comparison = sessions.len() > 1;
    let body = html! {
        p.note {
            "NIMA Console, research use only. Forces act from the tissue on the instrument's tip. Times are seconds \
             since the start of the session."
        }
        @if is_comparison { (section("Comparison", &overall::comparison(sessions))) }
        @for session in sessions {
            @if is_comparison { h1 { "Session " (name(session)) } }
            (overall::summary(session))
            @for arm in &session.arms { (arms::arm(session, arm)) }
            (overall::happenings(session))
            (overall::timing(session))
            (overall::marks(session))
            (overall::calibrations(session))
        }
        (definitions())
    };
    html::page(&title, &body)
}

fn name(session: &SessionFigures) -> String {
    Path::new(&session.file)
        .file_name()
        .map_or_else(|| session.file.clone(), |name| name.to_string_lossy().into_owned())
}

fn definitions() -> Markup {
    let rows = [
        ["peak, mean", "maximum and mean magnitude of the force"],
        ["integral", "magnitude of the force, integrated over time"],
        [
            "force volume",
            "volume of the ellipsoid whose half axes are the standard deviations of the force along its three principal axes \
             (after Horeman et al. 2012, doi 10.1109/TOH.2011.60); zero if the force stays on a line or in a plane",
        ],
        [
            "rate",
            "change of the force vector from one sample to the next, over the time between them; sensor noise adds to it",
        ],
        [
            "prediction error",
            "error of each mode's prediction of the force one link delay ahead; the delayed force is \"Direct \
             (DFR)\"",
        ],
        ["gates", "the checks between a mode's force and the hand; each can reduce the force"],
    ];
    section("Definitions", &table(&["word", "meaning"], &rows.map(Vec::from)))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use nima_session::report::{EventMark, MarkLevel};

    use super::*;

    fn session(rig: &str) -> SessionFigures {
        SessionFigures {
            file: format!("/tmp/{rig}.mcap"),
            about: BTreeMap::from([("rig".to_owned(), rig.to_owned()), ("<k>".to_owned(), rig.to_owned())]),
            calibrations: BTreeMap::from([(
                rig.to_owned(),
                BTreeMap::from([("network_tool".to_owned(), rig.to_owned())]),
            )]),
            notes: vec![rig.to_owned()],
            marks: vec![EventMark { t_s: 1.0, level: MarkLevel::Error, words: rig.to_owned() }],
            ..SessionFigures::default()
        }
    }

    #[test]
    fn a_mark_is_told_with_its_time_and_is_no_fault() {
        let mark = |t_s, level, words: &str| EventMark { t_s, level, words: words.to_owned() };
        let marks = vec![
            mark(1.5, MarkLevel::Mark, "mark 1"),
            mark(2.0, MarkLevel::Warning, "alarm: late"),
            mark(3.25, MarkLevel::Mark, "mark 2"),
        ];
        let page = page(&[SessionFigures { marks, ..session("rig") }]);
        assert!(page.contains("<td>operator marks</td><td>1.500 s, 3.250 s</td>"), "{page}");
        assert!(page.contains("<td>faults</td><td>0</td>") && page.contains("alarm: late"), "{page}");
    }

    #[test]
    fn no_text_of_a_file_becomes_markup() {
        let page = page(&[session("<script>alert('x')</script>"), session("a & \"b\"")]);
        assert!(!page.contains("<script") && !page.contains("<k>"), "{page}");
        assert!(page.contains("&lt;script&gt;") && page.contains("a &amp; &quot;b&quot;"), "{page}");
        assert!(!page.contains("http://") && !page.contains("https://"), "nothing is loaded from elsewhere");
    }
}
