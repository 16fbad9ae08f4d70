//! The Camera wizard: check, views of a board, the lens, the corners touched with the tip, save. It writes to the rig file.

mod detector;
mod image;
mod steps_ui;
#[cfg(test)]
mod tests;
mod tip;
mod touch;

use std::sync::Arc;

use egui::Ui;
use nima_camera::{
    BoardSight, CameraPlacement, CameraSession, DetectionFailure, LensReport, PlaceError, TouchedCorner, ViewOutcome,
    calibrate,
};
use nima_core::calibration::frames::RigChange;
use nima_endoscope::{BoardError, Checkerboard, DecodedImage, Lens, board::BoardCorners};
use nima_machine::{
    config::{EndoscopeConfig, RigConfig, RigFile},
    messages::Tick,
    rig::Prompt,
};
use nima_screen::widgets::card;
use nima_simulation::camera::lens_of;
use nima_wizards::{
    Binding, SaveRequest, Wizard,
    frame::{WizardFrame, WizardRequest, WizardStep},
};
use nima_words::text;

use self::{
    detector::{BoardImage, Detector},
    image::DisplayedImage,
    steps_ui::is_good,
    tip::{CameraTip, EndoscopeMarker},
};
use super::{
    camera_calibration::{changes, undone},
    report_text, text as texts,
};

const STEPS: [WizardStep; 5] = [
    WizardStep { name: text::wizards::STEP_CHECK, meaning: texts::STEP_CHECK_HOVER },
    WizardStep { name: texts::STEP_VIEWS, meaning: texts::STEP_VIEWS_HOVER },
    WizardStep { name: texts::STEP_LENS, meaning: texts::STEP_LENS_HOVER },
    WizardStep { name: texts::STEP_TOUCH, meaning: texts::STEP_TOUCH_HOVER },
    WizardStep { name: text::wizards::STEP_SAVE, meaning: text::wizards::STEP_SAVE_IN_RIG_HOVER },
];
const CHECK: usize = 0;
const VIEWS: usize = 1;
const LENS: usize = 2;
const TOUCH: usize = 3;
const SAVE: usize = 4;

pub(super) struct CameraWizard {
    frame: WizardFrame,
    corners: String,
    square_mm: f64,
    keeps_lens: bool,
    /// The endoscope in the rig file.
    endoscope: Option<EndoscopeConfig>,
    rig: Option<String>,
    detector: Option<Detector>,
    /// The newest searched image, until it is uploaded.
    fresh: Option<Arc<DecodedImage>>,
    shown: DisplayedImage,
    sight: Option<BoardSight>,
    last: Option<Result<ViewOutcome, DetectionFailure>>,
    session: Option<CameraSession>,
    report: Option<LensReport>,
    tip: CameraTip,
    /// The endoscope's marker while the board is at rest, if its pose is known.
    marker: EndoscopeMarker,
    /// The board at rest while it is touched, and the previous detection, which must be the same.
    base: Option<BoardSight>,
    lying: Option<BoardSight>,
    moved: bool,
    touches: Vec<TouchedCorner>,
    placed: Option<Result<CameraPlacement, PlaceError>>,
    /// Changes to be saved, and saved changes.
    pending: Option<Vec<RigChange>>,
    undoable: Vec<RigChange>,
}

impl std::fmt::Debug for CameraWizard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("CameraWizard").field("frame", &self.frame).field("views", &self.views()).finish_non_exhaustive()
    }
}

impl Default for CameraWizard {
    fn default() -> Self {
        Self {
            frame: WizardFrame::default(),
            corners: "9x6".to_owned(),
            square_mm: 10.0,
            keeps_lens: false,
            endoscope: None,
            rig: None,
            detector: None,
            fresh: None,
            shown: DisplayedImage::default(),
            sight: None,
            last: None,
            session: None,
            report: None,
            tip: CameraTip::default(),
            marker: EndoscopeMarker::default(),
            base: None,
            lying: None,
            moved: false,
            touches: Vec::new(),
            placed: None,
            pending: None,
            undoable: Vec::new(),
        }
    }
}

impl CameraWizard {
    fn take(&mut self, BoardImage { image, board, sight }: BoardImage) {
        let size_px = image.size_px;
        self.fresh = Some(image);
        self.sight = sight.as_ref().ok().cloned();
        if self.session.as_ref().is_none_or(|session| session.size_px() != size_px || *session.board() != board) {
            self.session = Some(CameraSession::new(board, size_px));
        }
        self.last = Some(match sight {
            Ok(sight) if self.frame.step == VIEWS && !self.keeps_lens => Ok(self.offer(sight)),
            Ok(sight) => {
                if self.frame.step == TOUCH {
                    self.lie(&sight);
                }
                Ok(ViewOutcome::TakenHere)
            }
            Err(unseen) => {
                self.session.iter_mut().for_each(CameraSession::miss);
                Err(unseen)
            }
        });
    }

    fn offer(&mut self, sight: BoardSight) -> ViewOutcome {
        let Some(session) = &mut self.session else { return ViewOutcome::Moving };
        let offer = session.offer(sight);
        if offer == ViewOutcome::Taken {
            self.report = None;
            self.frame.saved = None;
        }
        offer
    }

    fn board(&self) -> Result<Checkerboard, BoardError> {
        board_of(&self.corners, self.square_mm)
    }

    fn views(&self) -> usize {
        self.session.as_ref().map_or(0, |session| session.views().len())
    }

    fn rig_lens(&self) -> Option<Lens> {
        self.endoscope.as_ref()?.camera.as_ref().map(lens_of)
    }

    /// Returns the lens used from here on.
    fn lens(&self) -> Option<Lens> {
        if self.keeps_lens {
            return self.rig_lens();
        }
        let report = self.report.as_ref().filter(|report| is_good(report))?;
        report.lens.as_ref().map(|found| found.lens)
    }

    /// Returns the state of the board in the newest image.
    fn report(&self) -> String {
        match &self.last {
            None => texts::LOOKING.get().to_owned(),
            Some(Ok(_)) if self.frame.step != VIEWS => texts::SEEN.get().to_owned(),
            Some(Ok(offer)) => report_text::offer(*offer).to_owned(),
            Some(Err(unseen)) => report_text::unseen(*unseen),
        }
    }
}

fn board_of(corners: &str, square_mm: f64) -> Result<Checkerboard, BoardError> {
    let BoardCorners(corners) = corners.trim().parse()?;
    Checkerboard::new(corners, square_mm * 1e-3)
}

impl Wizard for CameraWizard {
    fn steps(&self) -> &'static [WizardStep] {
        &STEPS
    }

    fn frame_mut(&mut self) -> &mut WizardFrame {
        &mut self.frame
    }

    fn is_of_a_sensor(&self) -> bool {
        false
    }

    fn refresh(&mut self, binding: &Binding) {
        let changed = self.frame.take_changed();
        if changed || self.rig.as_ref() != Some(&binding.rig) {
            self.rig = Some(binding.rig.clone());
            self.endoscope = RigConfig::load(&binding.rig).ok().and_then(|rig| rig.endoscope);
            self.keeps_lens &= self.rig_lens().is_some();
            if matches!(self.frame.saved, Some(Ok(_))) && self.frame.step == SAVE {
                // A saved change can be undone, and an undone change can be saved again.
                let saved = self.pending.take().unwrap_or_default();
                self.undoable = if self.undoable.is_empty() { saved } else { Vec::new() };
            }
        }
        if self.frame.step == SAVE && self.pending.is_none() && self.undoable.is_empty() {
            let file = RigFile::of(&binding.rig).ok();
            self.pending = file.zip(self.lens()).map(|(file, lens)| changes(&file, &lens, self.found_place()));
        }
    }

    fn tick(&mut self, tick: &Tick, _: f64) {
        self.tip.note(tick.t_s, tick.positions.tip_m);
        if self.frame.step == TOUCH && self.base.is_some() {
            self.marker.note(tick.t_s, tick.calibration.view.world_from_n());
        }
    }

    fn see(&mut self, image: Option<(u64, Arc<DecodedImage>)>, ctx: &egui::Context) {
        if self.detector.is_none() {
            self.detector = Detector::new(ctx);
        }
        let (Some(detector), Ok(board)) = (&mut self.detector, board_of(&self.corners, self.square_mm)) else { return };
        let found = detector.take();
        if let Some(image) = image {
            detector.show(image, board);
        }
        if let Some(found) = found.filter(|found| found.board == board) {
            self.take(found);
        }
    }

    fn prompt(&self) -> Prompt {
        Prompt::Rest
    }

    fn may_go_on(&self, _: &Binding) -> Result<(), &'static str> {
        match self.frame.step {
            CHECK if self.endoscope.is_none() || !self.shown.has_come() => Err(text::wizards::NEEDS_CHECKS.get()),
            CHECK => self.board().map(|_| ()).map_err(|_| texts::NEEDS_BOARD.get()),
            VIEWS | LENS if self.keeps_lens => Ok(()),
            VIEWS if self.views() >= 4 => Ok(()),
            VIEWS => Err(texts::NEEDS_VIEWS.get()),
            LENS => self.lens().map(|_| ()).ok_or(texts::NEEDS_LENS.get()),
            TOUCH if self.good_place().is_some() || self.touches.is_empty() && !self.keeps_lens => Ok(()),
            TOUCH => Err(texts::NEEDS_PLACE.get()),
            _ => Err(text::wizards::LAST_STEP.get()),
        }
    }

    fn is_done(&self) -> bool {
        match self.frame.step {
            VIEWS => self.keeps_lens || self.session.as_ref().is_some_and(|session| session.fraction() >= 1.0),
            TOUCH => self.good_place().is_some() && self.next_corner().is_none(),
            _ => true,
        }
    }

    fn step_ui(&mut self, ui: &mut Ui, _: &Binding) -> Option<WizardRequest> {
        if let Some(image) = self.fresh.take() {
            self.shown.upload(ui, &image);
        }
        match self.frame.step {
            CHECK => self.check_ui(ui),
            VIEWS => self.views_ui(ui),
            LENS => self.lens_ui(ui),
            _ => self.touch_ui(ui),
        }
        None
    }

    fn proof(&self) -> Option<String> {
        self.lens()?;
        let held_out_px = self.report.as_ref().and_then(|report| Some(report.lens?.held_out_px));
        let place = self.found_place().map(|place| (place.checked_px, place.on_marker));
        Some(texts::proof(held_out_px.filter(|_| !self.keeps_lens), place))
    }

    fn made(&self, _: &Binding) -> Option<SaveRequest> {
        self.pending.clone().map(SaveRequest::Camera)
    }

    fn before_saving(&self, ui: &mut Ui) -> bool {
        if self.lens().is_none() {
            ui.label(texts::NEEDS_LENS);
        }
        self.lens().is_some()
    }

    fn after_saving(&mut self, ui: &mut Ui) -> Option<SaveRequest> {
        if self.undoable.is_empty() {
            return None;
        }
        let wanted = card(ui, text::frames::UNDO_TITLE, text::frames::UNDO_CARD_HOVER, |ui| {
            ui.button(text::frames::UNDO).clicked()
        });
        wanted.then(|| SaveRequest::Undo(undone(&self.undoable)))
    }

    fn go_to(&mut self, step: usize) {
        self.frame.step = step;
        if step == SAVE {
            self.pending = None;
            self.frame.saved = None;
            self.undoable.clear();
        }
        if step == LENS && self.report.is_none() && !self.keeps_lens {
            let session = self.session.as_ref();
            self.report = session.map(|session| calibrate(session.board(), session.size_px(), session.views()));
            self.find_place();
        }
    }

    fn start_over(&mut self) {
        let corners = std::mem::take(&mut self.corners);
        let square_mm = self.square_mm;
        let detector = self.detector.take();
        *self = Self { corners, square_mm, detector, ..Self::default() };
    }
}
