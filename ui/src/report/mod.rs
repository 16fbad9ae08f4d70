//! The report of sessions: one self-contained page.

mod arms;
pub(crate) mod html;
mod overall;
pub(crate) mod plots;

use std::{
    fmt::Write as _,
    path::{Path, PathBuf},
};

use anyhow::Context as _;
use nima_session::report::Figures;

use crate::command::output;
use html::{escape, table};

pub(crate) const PAGE: &str = "report.html";
pub(crate) const STYLE: &str = include_str!("style.css");

/// Reads the sessions and writes their page into this folder, which is created if missing.
pub(crate) fn write(sessions: &[PathBuf], folder: &Path) -> anyhow::Result<PathBuf> {
    write_figures(&read(sessions)?, sessions, folder)
}

pub(crate) fn read(sessions: &[PathBuf]) -> anyhow::Result<Vec<Figures>> {
    sessions.iter().map(|path| Ok(Figures::read(path)?)).collect()
}

pub(crate) fn write_figures(figures: &[Figures], sessions: &[PathBuf], folder: &Path) -> anyhow::Result<PathBuf> {
    let inputs: Vec<&Path> = sessions.iter().map(PathBuf::as_path).collect();
    output::folder(folder, &[PAGE], &inputs)?;
    output::write(folder, PAGE, &page(figures)).context("the report")?;
    Ok(folder.join(PAGE))
}

fn page(sessions: &[Figures]) -> String {
    let title = match sessions {
        [one] => format!("Session {}", name(one)),
        _ => format!("{} sessions", sessions.len()),
    };
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
         content=\"width=device-width\">\n<title>{0}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<h1>{0}</h1>\n<p \
         class=\"note\">NIMA Console, research use only. Forces act from the tissue on the instrument's tip. \
         Times are seconds since the start of the session.</p>\n",
        escape(&title)
    );
    if sessions.len() > 1 {
        page.push_str("<section>\n<h2>Comparison</h2>\n");
        page.push_str(&overall::comparison(sessions));
        page.push_str("</section>\n");
    }
    for session in sessions {
        if sessions.len() > 1 {
            writeln!(page, "<h1>Session {}</h1>", escape(&name(session))).ok();
        }
        page.push_str(&overall::summary(session));
        for arm in &session.arms {
            page.push_str(&arms::arm(session, arm));
        }
        page.push_str(&overall::happenings(session));
        page.push_str(&overall::timing(session));
        page.push_str(&overall::marks(session));
        page.push_str(&overall::calibrations(session));
    }
    page.push_str(&definitions());
    page.push_str("</body>\n</html>\n");
    page
}

fn name(session: &Figures) -> String {
    Path::new(&session.file)
        .file_name()
        .map_or_else(|| session.file.clone(), |name| name.to_string_lossy().into_owned())
}

fn definitions() -> String {
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
    let rows: Vec<Vec<String>> = rows.iter().map(|row| row.iter().map(|cell| escape(cell)).collect()).collect();
    format!("<section>\n<h2>Definitions</h2>\n{}</section>\n", table(&["word", "meaning"], &rows))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use nima_session::report::{Mark, MarkLevel};

    use super::*;

    fn session(rig: &str) -> Figures {
        Figures {
            file: format!("/tmp/{rig}.mcap"),
            about: BTreeMap::from([("rig".to_owned(), rig.to_owned()), ("<k>".to_owned(), rig.to_owned())]),
            calibrations: BTreeMap::from([(
                rig.to_owned(),
                BTreeMap::from([("network_tool".to_owned(), rig.to_owned())]),
            )]),
            notes: vec![rig.to_owned()],
            marks: vec![Mark { t_s: 1.0, level: MarkLevel::Error, words: rig.to_owned() }],
            ..Figures::default()
        }
    }

    #[test]
    fn a_mark_is_told_with_its_time_and_is_no_fault() {
        let mark = |t_s, level, words: &str| Mark { t_s, level, words: words.to_owned() };
        let marks = vec![
            mark(1.5, MarkLevel::Mark, "mark 1"),
            mark(2.0, MarkLevel::Warning, "alarm: late"),
            mark(3.25, MarkLevel::Mark, "mark 2"),
        ];
        let page = page(&[Figures { marks, ..session("rig") }]);
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
