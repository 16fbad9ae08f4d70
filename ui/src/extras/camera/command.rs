//! `nima calibrate camera`: the lens of the endoscope's camera, from a folder of images or from the camera itself.

use std::{
    fmt::Write as _,
    path::{Path, PathBuf},
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context as _, bail};
use clap::Args;
use nima_camera::{BoardSight, CameraSession, Grey, LensReport, Terms, ViewOutcome, ViewRequest, calibrate, find};
use nima_core::calibration::Verdict;
use nima_endoscope::{Address, Checkerboard, EndoscopeFeed, FrameFault, FrameHealth, board::BoardCorners, jpeg};
use nima_machine::config::{RigFile, change_rig};
use nima_report::output;
use nima_screen::stderr::print_line;
use nima_words::report_text::ShortText as _;
use serde_json::json;

use super::{camera_calibration::changes, report_text as camera};
use crate::shutdown::Leave;

/// Maximum number of images in a folder.
const IMAGES: usize = 500;
/// Maximum size of an image, bytes.
const BYTES: u64 = 16 << 20;
/// A camera is observed until no new view has been captured for this time.
const PATIENCE: Duration = Duration::from_mins(2);
const NAP: Duration = Duration::from_millis(20);

#[derive(Debug, Args)]
pub(super) struct CalibrateCameraArguments {
    /// Folder with JPEGs of the board, or the camera itself (http://HOST:PORT/PATH), which is watched while you move the
    /// board
    #[arg(value_name = "FOLDER_OR_URL")]
    source: String,
    /// Number of inner corners along each side: one number odd, the other even
    #[arg(long, value_name = "AxB", default_value = "9x6")]
    board: BoardCorners,
    /// Side length of a square
    #[arg(long, value_name = "MM", default_value_t = 10.0)]
    square_mm: f64,
    /// Write the lens to this rig file and keep its comments; the camera position is removed, because it belongs to the
    /// previous lens
    #[arg(long, value_name = "RIG.toml")]
    out: Option<PathBuf>,
    /// Print the report as one JSON object
    #[arg(long)]
    json: bool,
}

/// Views, and their names.
struct NamedViews {
    size_px: [usize; 2],
    views: Vec<(String, BoardSight)>,
}

pub(super) fn run(arguments: &CalibrateCameraArguments) -> anyhow::Result<()> {
    let BoardCorners(corners) = arguments.board;
    let board = Checkerboard::new(corners, arguments.square_mm * 1e-3)?;
    if let Some(out) = &arguments.out {
        let rig = rig_file(out)?;
        if rig.value("endoscope.url").is_none() {
            bail!("{} has no endoscope: add [endoscope] with its url first", out.display());
        }
        output::check(out, &[])?;
    }
    let address: Address = arguments.source.parse()?;
    let taken = match &address {
        Address::File(folder) => of_folder(folder, &board)?,
        Address::Http(_) | Address::Rtsp(_) | Address::Camera { .. } => of_camera(address, board)?,
    };
    let views: Vec<BoardSight> = taken.views.iter().map(|(_, view)| view.clone()).collect();
    let report = calibrate(&board, taken.size_px, &views);
    let reason = report.cause.as_ref().map(camera::camera_cause);
    if arguments.json {
        output::json(&in_json(&report, &taken, reason.as_deref()))?;
    } else {
        output::line(&as_text(&report, &taken))?;
    }
    if let Some(reason) = reason {
        bail!("{}: {reason}", report.verdict().words());
    }
    let (Some(out), Some(found)) = (&arguments.out, &report.lens) else { return Ok(()) };
    let name = out.to_string_lossy();
    let changes = changes(&rig_file(out)?, &found.lens, None);
    let folder = out.parent().unwrap_or_else(|| Path::new("."));
    change_rig(&name, folder, &changes)?;
    print_line(format_args!(
        "{name}: lens written; now calibrate the camera position with `nima console --calibrate camera`"
    ));
    Ok(())
}

fn rig_file(out: &Path) -> anyhow::Result<RigFile> {
    if !out.is_file() {
        bail!("{} is not a rig file: set --out to the rig file to change", out.display());
    }
    Ok(RigFile::of(&out.to_string_lossy())?)
}

/// Returns the views in the JPEGs of a folder, sorted by name.
fn of_folder(folder: &Path, board: &Checkerboard) -> anyhow::Result<NamedViews> {
    let about = || format!("cannot read the images in {}", folder.display());
    let entries = std::fs::read_dir(folder).with_context(about)?;
    let mut paths: Vec<PathBuf> =
        entries.map(|entry| Ok(entry?.path())).collect::<std::io::Result<_>>().with_context(about)?;
    paths.retain(|path| {
        path.extension().is_some_and(|ending| ["jpg", "jpeg"].iter().any(|jpeg| ending.eq_ignore_ascii_case(jpeg)))
    });
    paths.sort();
    if paths.is_empty() || paths.len() > IMAGES {
        bail!("found {} JPEGs in {}: use a folder with 8 to {IMAGES}", paths.len(), folder.display());
    }
    let mut taken = NamedViews { size_px: [0, 0], views: Vec::new() };
    for path in paths {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let bytes = nima_files::read(&path, BYTES).with_context(|| path.display().to_string())?;
        let image = jpeg::decode(&bytes).with_context(|| path.display().to_string())?;
        let [width, height] = image.size_px;
        if taken.size_px != [0, 0] && taken.size_px != image.size_px {
            bail!("{} is {width} x {height} px, unlike the previous images: use images of one size", path.display());
        }
        taken.size_px = image.size_px;
        let found = Grey::of(&image).map(|grey| find(&grey, board));
        match found {
            Some(Ok(sight)) => taken.views.push((name, sight)),
            Some(Err(why)) => print_line(format_args!("{name}: {}", camera::unseen(why))),
            None => print_line(format_args!("{name}: the file is empty")),
        }
    }
    Ok(taken)
}

/// Watches the camera while the board is moved, and prints the next request.
fn of_camera(address: Address, board: Checkerboard) -> anyhow::Result<NamedViews> {
    let leave = Leave::on_signals()?;
    let shown = address.to_string();
    let feed = EndoscopeFeed::start(address, None, || {}).context("cannot start a thread to decode the image")?;
    let mut session: Option<CameraSession> = None;
    let mut last = 0;
    let mut since = Instant::now();
    let mut report = String::new();
    let mut say = |words: String| {
        if report != words {
            print_line(&words);
            report = words;
        }
    };
    loop {
        if leave.is_asked() {
            bail!("ended on request; nothing was written");
        }
        if since.elapsed() > PATIENCE {
            bail!("no new view for {} s: hold the board still in view of {shown}", PATIENCE.as_secs());
        }
        let look = feed.look(Instant::now());
        if let FrameHealth::Lost(trouble) = &look.standing {
            bail!("{trouble}: {}", trouble.cure());
        }
        if matches!(look.standing, FrameHealth::Wrong(FrameFault::Black)) {
            say("the image is black".to_owned());
        }
        let Some((number, image)) = look.image.filter(|(number, _)| *number != last) else {
            thread::sleep(NAP);
            continue;
        };
        last = number;
        if session.as_ref().is_some_and(|session| session.size_px() != image.size_px) {
            bail!("the image size has changed: set the camera to a fixed size");
        }
        let session = session.get_or_insert_with(|| CameraSession::new(board, image.size_px));
        let asked = session.asks();
        if asked == ViewRequest::Complete {
            break;
        }
        say(format!("{} views: {}", session.views().len(), camera::ask(asked)));
        match Grey::of(&image).map(|grey| find(&grey, &board)) {
            Some(Ok(sight)) => {
                if session.offer(sight) == ViewOutcome::Taken {
                    since = Instant::now();
                }
            }
            _ => session.miss(),
        }
    }
    let session = session.context("no image received")?;
    let views = session.views().iter().enumerate().map(|(at, view)| (format!("view {}", at + 1), view.clone()));
    Ok(NamedViews { size_px: session.size_px(), views: views.collect() })
}

const fn terms_text(terms: Terms) -> [(&'static str, bool); 3] {
    [("pixels are not square", terms.aspect), ("k2", terms.k2), ("p1, p2", terms.tangential)]
}

fn as_text(report: &LensReport, taken: &NamedViews) -> String {
    let mut text = format!("{}\n", report.verdict().words());
    // Writing to a String cannot fail.
    writeln!(
        text,
        "{} of {} views used; corners in {:.0} % of the image",
        report.used.len(),
        taken.views.len(),
        100.0 * report.coverage.fraction()
    )
    .ok();
    for (at, why) in &report.left_out {
        writeln!(text, "left out: {}, {}", taken.views[*at].0, camera::left_out(*why)).ok();
    }
    let Some(found) = &report.lens else { return text + "no lens" };
    let lens = &found.lens;
    let sd = &found.deviations;
    writeln!(
        text,
        "focal length {:.2} ± {:.2} px horizontal, {:.2} px vertical   centre {:.2} ± {:.2}, {:.2} ± {:.2} px",
        lens.focal_px.x,
        sd.focal_px.x,
        lens.focal_px.y,
        lens.centre_px.x,
        sd.centre_px.x,
        lens.centre_px.y,
        sd.centre_px.y
    )
    .ok();
    writeln!(
        text,
        "k1 {:.5} ± {:.5}   k2 {:.5}   p1 {:.5}   p2 {:.5}",
        lens.bend.k1, sd.bend.k1, lens.bend.k2, lens.bend.p1, lens.bend.p2
    )
    .ok();
    for (name, is_found) in terms_text(found.terms) {
        writeln!(
            text,
            "{name}: {}",
            if is_found { "improves held-out views" } else { "left out, does not improve held-out views" }
        )
        .ok();
    }
    write!(
        text,
        "error {:.3} px fitted, {:.3} px held out (largest {:.2} px)   tilt up to {:.0} deg",
        found.fitted_px, found.held_out_px, found.held_out_max_px, found.tilt_deg
    )
    .ok();
    text
}

fn in_json(report: &LensReport, taken: &NamedViews, reason: Option<&str>) -> serde_json::Value {
    let left_out =
        report.left_out.iter().map(|(at, why)| json!({ "view": taken.views[*at].0, "why": camera::left_out(*why) }));
    let lens = report.lens.as_ref().map(|found| {
        let lens = &found.lens;
        let sd = &found.deviations;
        json!({
            "focal_px": [lens.focal_px.x, lens.focal_px.y],
            "focal_sd_px": [sd.focal_px.x, sd.focal_px.y],
            "centre_px": [lens.centre_px.x, lens.centre_px.y],
            "centre_sd_px": [sd.centre_px.x, sd.centre_px.y],
            "k1": lens.bend.k1,
            "k1_sd": sd.bend.k1,
            "k2": lens.bend.k2,
            "p1": lens.bend.p1,
            "p2": lens.bend.p2,
            "fitted_px": found.fitted_px,
            "held_out_px": found.held_out_px,
            "held_out_max_px": found.held_out_max_px,
            "tilt_deg": found.tilt_deg,
        })
    });
    json!({
        "verdict": match report.verdict() {
            Verdict::Accepted => "accepted",
            Verdict::InsufficientMotion => "insufficient_motion",
            Verdict::PoorData => "poor_data",
        },
        "reason": reason,
        "size_px": taken.size_px,
        "views": taken.views.len(),
        "used": report.used.len(),
        "left_out": left_out.collect::<Vec<_>>(),
        "coverage": report.coverage.fraction(),
        "lens": lens,
    })
}
