//! Exports of a plot as CSV and PNG, in the folder `plots` of the user's data.

use std::{
    path::{Path, PathBuf},
    sync::{Arc, Mutex},
    time::{Duration, Instant, SystemTime},
};

use egui::{Context, Id, Pos2, Rect, Ui};
use nima_files::write_atomically;
use nima_recording::store::utc_of;
use nima_words::text;

use crate::{screenshot, widgets::small};

/// Time for which the outcome is displayed.
const SHOWN: Duration = Duration::from_secs(8);

/// The folder of the exports, and the outcome of the last one. Every panel of the window uses the same, so it belongs to
/// the window's context.
#[derive(Clone, Default)]
struct Exports {
    folder: Option<PathBuf>,
    report: Arc<Mutex<Option<(Instant, String)>>>,
}

fn exports(ctx: &Context) -> Exports {
    ctx.data_mut(|data| data.get_temp_mut_or_default::<Exports>(Id::unique("exports")).clone())
}

/// Uses the folder `plots` in this folder from now on.
pub fn set_folder(ctx: &Context, folder: Option<&Path>) {
    let folder = folder.map(|folder| folder.join("plots"));
    ctx.data_mut(|data| data.insert_temp(Id::unique("exports"), Exports { folder, ..Exports::default() }));
}

impl Exports {
    /// Returns a new file for this plot, named after the time.
    fn place(&self, plot: &str, ending: &str) -> Result<PathBuf, String> {
        let folder = self.folder.as_ref().ok_or_else(|| text::start::NO_FOLDER.get().to_owned())?;
        std::fs::create_dir_all(folder).map_err(|error| text::traces::not_saved(&folder.display(), &error))?;
        let time = utc_of(SystemTime::now()).replace(['-', ':'], "");
        let first = folder.join(format!("{plot}-{time}.{ending}"));
        let others = (1_u32..).map(|copy| folder.join(format!("{plot}-{time}-{copy}.{ending}")));
        Ok(std::iter::once(first.clone()).chain(others).find(|path| !path.exists()).unwrap_or(first))
    }

    fn notify(&self, outcome: Result<PathBuf, String>) {
        let words = outcome.map_or_else(|why| why, |path| text::traces::saved(&path.display()));
        if let Ok(mut report) = self.report.lock() {
            *report = Some((Instant::now(), words));
        }
    }
}

/// Writes a table of this plot.
pub fn save_csv(ctx: &Context, plot: &str, table: &str) {
    let exports = exports(ctx);
    let written = exports.place(plot, "csv").and_then(|path| {
        let written = write_atomically(&path, |file| file.write_all(table.as_bytes()));
        written.map_err(|error| text::traces::not_saved(&path.display(), &error)).map(|()| path)
    });
    exports.notify(written);
}

/// Writes this part of the next frame.
pub fn save_png(ctx: &Context, plot: &str, part: Rect) {
    let exports = exports(ctx);
    let points = ctx.pixels_per_point();
    let plot = plot.to_owned();
    ctx.request_screenshot(move |image| {
        let window = Rect::from_min_size(Pos2::ZERO, image.size.map(|side| side as f32 / points).into());
        let part = part.intersect(window);
        let written = exports.place(&plot, "png").and_then(|path| {
            let image = image.region(&part, Some(points));
            screenshot::save(&path, &image).map_err(|error| format!("{error:#}")).map(|()| path)
        });
        exports.notify(written);
    });
}

/// Shows the outcome of the last export for a short time.
pub fn report_ui(ui: &mut Ui) {
    let report = exports(ui.ctx()).report;
    let Ok(report) = report.lock() else { return };
    if let Some((_, words)) = report.as_ref().filter(|(at, _)| at.elapsed() < SHOWN) {
        ui.add(egui::Label::new(small(words)).truncate()).on_hover_text(words);
    }
}

/// Writes a row of numbers; an unknown one is empty.
pub fn row(table: &mut String, numbers: impl IntoIterator<Item = Option<f64>>) {
    for (place, number) in numbers.into_iter().enumerate() {
        if place > 0 {
            table.push(',');
        }
        table.push_str(&number.map(|number| number.to_string()).unwrap_or_default());
    }
    table.push('\n');
}
