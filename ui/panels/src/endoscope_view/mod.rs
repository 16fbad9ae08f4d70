//! The endoscope image in the Surgeon view: taken from a feed with its own threads, uploaded once, and labelled with a text
//! if it is not current. Nothing here touches the loop.

mod aim;
mod banner;
mod corner;
mod mount;
mod occlusion;
mod overlay;
mod place;
mod poses;
mod projector;
mod stereo;
#[cfg(test)]
mod tests;

use std::{
    path::Path,
    sync::Arc,
    time::{Duration, Instant},
};

use egui::{Color32, Context, Key, Mesh, Painter, Rect, Sense, Ui};
use nalgebra::{Isometry3, Vector3};
use nima_endoscope::{
    Address, Camera, DecodedImage, EndoscopeFeed, FROZEN, FeedSnapshot, FrameFault, FrameHealth, FrameQueue,
};
use nima_machine::{
    config::{EndoscopeConfig, StereoView},
    messages::Tick,
    rig::{SIDES, Side},
};
use nima_screen::{double_buffer::DoubleBuffer, live::LiveState, scene3d::tip_bars, theme};
use nima_words::text;

#[cfg(test)]
use self::place::ImagePlacement;
use self::{
    aim::ImageZoom,
    banner::wrong_ui,
    corner::Corner,
    mount::Mount,
    overlay::OverlayInstrument,
    poses::{Poses, TipPose},
    projector::Projector,
    stereo::{ImageChoice, LensHalf},
};
use crate::settings::ImageSettings;

/// Forces of a camera with a larger error in its check are drawn with this opacity; in image widths: 10 px of 1280.
const OFF: f64 = 10.0 / 1280.0;
const DOUBTFUL: f32 = 0.35;
/// Frame interval while a text shows a clock and no image wakes the window.
const CLOCK: Duration = Duration::from_millis(100);
/// From this rate on, images wake the window often enough for other motion.
const WAKES_HZ: f64 = 24.0;
/// Tint of an image that is not current.
const PAST: Color32 = Color32::from_gray(110);

type NewestFrame = FeedSnapshot<Arc<DecodedImage>>;

/// State of the image in a frame.
struct ImageState {
    look: Option<NewestFrame>,
    /// Reason for a missing image, and remedy, unless its state gives them.
    nothing: Option<[String; 2]>,
    /// Tip poses at the time of a recorded image.
    poses: Option<[Option<TipPose>; SIDES]>,
    /// Pose of the endoscope's marker at the time of the image, if known.
    world_from_n: Option<Isometry3<f64>>,
}

/// Image found for a moment of a recorded session.
#[derive(Debug)]
pub struct RecordedMoment(pub Option<Arc<DecodedImage>>);

/// The endoscope image, or nothing for a rig without endoscope.
#[derive(Default)]
pub struct EndoscopeView {
    /// The endoscope of the rig file.
    wanted: Option<EndoscopeConfig>,
    feed: Option<EndoscopeFeed>,
    /// For a recorded session.
    projector: Option<Projector>,
    /// Reason why its address cannot be used.
    refused: Option<String>,
    mount: Option<Mount>,
    screen: DoubleBuffer,
    number: u64,
    shown: Option<(Instant, String)>,
    rate_hz: f64,
    hides_forces: bool,
    /// Displayed part of a stereo image.
    view: Option<StereoView>,
    poses: Poses,
    aim: ImageZoom,
    settings: ImageSettings,
}

impl std::fmt::Debug for EndoscopeView {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Eyes").field("wanted", &self.wanted).field("number", &self.number).finish_non_exhaustive()
    }
}

impl EndoscopeView {
    /// Uses the endoscope of the rig file, and also puts its images into this queue; called in every frame.
    pub fn serve(&mut self, wanted: Option<&EndoscopeConfig>, reel: &FrameQueue, ctx: &Context) {
        if self.wanted.as_ref() == wanted {
            return;
        }
        let Self { hides_forces, settings, .. } = *self;
        *self = Self { wanted: wanted.cloned(), hides_forces, settings, ..Self::default() };
        let Some(endoscope @ EndoscopeConfig { url, camera, view, .. }) = wanted else { return };
        self.mount = camera.as_ref().and_then(Mount::of);
        self.view = *view;
        let address = match url.parse::<Address>() {
            Ok(address) => address,
            Err(error) => {
                self.refused = Some(text::endoscope_view::refused(&nima_words::report_text::quoted(&error)));
                return;
            }
        };
        let ctx = ctx.clone();
        let size_px = camera.as_ref().map(|camera| stereo::whole_px(camera.size_px, endoscope));
        match EndoscopeFeed::start(address, size_px, move || ctx.request_repaint()) {
            Ok(feed) => {
                feed.record_to(reel.clone());
                feed.set_tone(self.settings.tone());
                self.feed = Some(feed);
            }
            Err(error) => self.refused = Some(text::endoscope_view::refused(&nima_words::report_text::quoted(&error))),
        }
    }

    /// Shows the images of a recorded session on this rig.
    pub fn project(&mut self, session: &Path, endoscope: EndoscopeConfig, ctx: &Context) {
        let ctx = ctx.clone();
        let settings = self.settings;
        *self = Self {
            settings,
            mount: endoscope.camera.as_ref().and_then(Mount::of),
            view: endoscope.view,
            projector: Some(Projector::start(session, move || ctx.request_repaint())),
            wanted: Some(endoscope),
            ..Self::default()
        };
    }

    /// Sets the display settings; called in every frame.
    pub fn show_as(&mut self, settings: ImageSettings) {
        if self.settings == settings {
            return;
        }
        self.settings = settings;
        if let Some(feed) = &self.feed {
            feed.set_tone(settings.tone());
        }
    }

    pub const fn is_on(&self) -> bool {
        self.wanted.is_some()
    }

    pub const fn has_two_lenses(&self) -> bool {
        self.view.is_some()
    }

    /// Returns whether images wake the window often enough for everything else that moves.
    pub fn wakes(&self) -> bool {
        self.rate_hz >= WAKES_HZ
    }

    /// Returns the newest image and its number, for other uses.
    pub fn newest(&self) -> Option<(u64, Arc<DecodedImage>)> {
        self.feed.as_ref()?.look(Instant::now()).image
    }

    /// Records the tip position of a tick.
    pub fn note(&mut self, tick: &Tick) {
        if self.mount.is_some() {
            self.poses.note(tick, Instant::now());
        }
    }

    /// Returns the state of the image and remedy, for the list of devices; `None` without endoscope.
    pub fn report(&self) -> Option<[String; 2]> {
        self.wanted.as_ref()?;
        Some(self.health_text(&self.feed.as_ref().map_or(FrameHealth::Opening, |feed| feed.standing(Instant::now()))))
    }

    /// Returns problem and remedy; the state and an empty text if there is no problem.
    fn health_text(&self, standing: &FrameHealth) -> [String; 2] {
        if let Some(refused) = &self.refused {
            return [refused.clone(), text::endoscope_view::REFUSED_CURE.get().to_owned()];
        }
        match standing {
            FrameHealth::Opening => [text::endoscope_view::WAITING.get().to_owned(), String::new()],
            FrameHealth::Live => [text::endoscope_view::LIVE.get().to_owned(), String::new()],
            FrameHealth::Still => [text::endoscope_view::STILL.get().to_owned(), String::new()],
            FrameHealth::Wrong(wrong) => fault_text(wrong),
            FrameHealth::Lost(trouble) => {
                [text::endoscope_view::lost(&nima_words::report_text::quoted(trouble)), trouble.cure().to_owned()]
            }
        }
    }

    /// Draws the image over the available space.
    pub fn ui(&mut self, ui: &mut Ui, live: &LiveState) {
        let now = Instant::now();
        let ImageState { look, nothing, poses: then, world_from_n } = self.look(live, now);
        let camera = self.mount.as_ref().and_then(|mount| mount.camera(world_from_n.as_ref()));
        self.rate_hz = look.as_ref().map_or(0.0, |look| look.rate_hz);
        let pressed = |key| ui.input(|input| input.modifiers.is_none() && input.key_pressed(key));
        let free = !ui.ctx().text_edit_focused();
        self.hides_forces ^= free && pressed(Key::O);
        if free && pressed(Key::V) {
            self.view = self.view.map(stereo::next);
        }
        let (view, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        let standing = look.as_ref().map_or(FrameHealth::Opening, |look| look.standing.clone());
        let [report, cure] = nothing.unwrap_or_else(|| self.health_text(&standing));
        let words = text::endoscope_view::image(&report);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &words));
        let painter = ui.painter_at(view);
        painter.rect_filled(view, 0.0, Color32::BLACK);
        let is_good = self.refused.is_none() && matches!(standing, FrameHealth::Live | FrameHealth::Still);
        let shows_past = matches!(standing, FrameHealth::Lost(_) | FrameHealth::Wrong(FrameFault::Frozen(_)));
        let halves = look
            .as_ref()
            .and_then(|look| self.image_ui(&painter, view, look, camera.as_ref(), shows_past))
            .unwrap_or_default();
        let fits = is_good || matches!(standing, FrameHealth::Wrong(FrameFault::Late(_) | FrameFault::Damaged(_)));
        let mut tips = Vec::new();
        for LensHalf { place, camera, within } in halves.iter().filter(|_| fits) {
            let Some(camera) = camera else { continue };
            let age = look.as_ref().and_then(|look| look.age).unwrap_or_default();
            let mut painter = painter.with_clip_rect(*within);
            if self.off_px().is_some() {
                painter.multiply_opacity(DOUBTFUL);
            }
            let age = if self.settings.forces_of_now { Duration::ZERO } else { age };
            let seen =
                overlay::OverlayImage { painter: &painter, place, camera, ceiling_n: live.gate_settings().ceiling_n };
            let pose = |side: Side| match &then {
                Some(poses) => poses[side.index()],
                None => self.poses.at(side, now, age),
            };
            let instrument = |side| Some(OverlayInstrument { side, pose: pose(side)?, trocar_m: trocar(live, side) });
            let drawn = seen.draw(live.sides().filter_map(instrument), self.hides_forces);
            if !self.hides_forces {
                for (side, tip) in &drawn {
                    tip_bars(&painter, live, *side, *tip);
                }
            }
            tips.extend(drawn.into_iter().map(|(_, tip)| tip));
        }
        // If there are two halves, use the one under the pointer.
        let pointed = response.hover_pos().and_then(|at| halves.iter().find(|half| half.within.contains(at)));
        if let Some(half) = pointed.or(halves.first()) {
            self.aim.obey(&response, half.within, &half.place);
        }
        if !is_good {
            let colour = if standing == FrameHealth::Opening && self.refused.is_none() {
                theme::DARK.text
            } else {
                theme::DARK.alarm_high
            };
            let over = halves.iter().map(|half| half.place.rect).reduce(Rect::union).unwrap_or(view);
            if shows_past {
                painter.rect_stroke(over, 0.0, egui::Stroke::new(3.0, colour), egui::StrokeKind::Inside);
            }
            wrong_ui(&painter, over, &tips, [&report, &cure], colour);
        }
        self.corner_ui(&painter, view, Corner { tips: &tips, fits, camera: camera.as_ref() }, look.as_ref(), now);
        if self.projector.is_none() {
            ui.ctx().request_repaint_after(until_report(look.as_ref(), is_good));
        }
    }

    /// Returns the recorded image of this moment (s), once it was searched for.
    /// Returns the image that is shown at this time of a session; `None` while it is being read.
    pub fn projected(&self, t_s: f64) -> Option<RecordedMoment> {
        let found = self.projector.as_ref()?.found().filter(|found| found.asked_s.to_bits() == t_s.to_bits())?;
        Some(RecordedMoment(found.look().ok().and_then(|look| look.image).map(|(_, image)| image)))
    }

    /// Returns the newest image, or that of the moment on the screen.
    fn look(&mut self, live: &LiveState, now: Instant) -> ImageState {
        let Some(projector) = &mut self.projector else {
            let look = self.feed.as_ref().map(|feed| feed.look(now));
            let age = look.as_ref().and_then(|look| look.age).unwrap_or_default();
            return ImageState { look, nothing: None, poses: None, world_from_n: self.poses.marker(now, age) };
        };
        let tone = self.settings.tone();
        projector.show(tone, live.ticks.iter().flatten().map(|tick| tick.t_s).fold(0.0, f64::max));
        let nothing = |words: String| ImageState {
            look: None,
            nothing: Some([words, String::new()]),
            poses: None,
            world_from_n: None,
        };
        let Some(found) = projector.found() else { return nothing(text::endoscope_view::SEARCHING.get().to_owned()) };
        match found.look() {
            Ok(look) => {
                let poses = Some(found.poses);
                let world_from_n = found.world_from_n;
                ImageState { look: Some(look), nothing: None, poses, world_from_n }
            }
            Err(why) => nothing(text::endoscope_view::none_then(why)),
        }
    }

    /// Returns the distance between drawn forces and tips, px, if the error in the camera check was too large.
    fn off_px(&self) -> Option<f64> {
        let camera = self.wanted.as_ref()?.camera?;
        camera.checked_px.filter(|off_px| *off_px > OFF * camera.size_px[0] as f64)
    }

    /// Uploads a new image and draws it as large as possible; returns the displayed parts.
    fn image_ui(
        &mut self,
        painter: &Painter,
        view: Rect,
        look: &NewestFrame,
        camera: Option<&Camera>,
        shows_past: bool,
    ) -> Option<Vec<LensHalf>> {
        let (number, image) = look.image.as_ref()?;
        if self.number != *number {
            self.screen.upload(painter.ctx(), "endoscope", image);
            self.number = *number;
        }
        let endoscope = self.wanted.as_ref()?;
        let shown = ImageChoice { view: self.view, crop: self.settings.crop(), aim: self.aim };
        let halves = stereo::halves(view, image.size_px, endoscope, shown, camera);
        for half in &halves {
            let mut mesh = Mesh::with_texture(self.screen.id()?);
            for (corner, at) in half.place.corners() {
                let colour = if shows_past { PAST } else { Color32::WHITE };
                mesh.vertices.push(egui::epaint::Vertex { pos: at, uv: corner, color: colour });
            }
            mesh.add_triangle(0, 1, 2);
            mesh.add_triangle(2, 1, 3);
            painter.with_clip_rect(half.within).add(mesh);
        }
        Some(halves)
    }
}

/// Returns the position of a side's trocar, m.
fn trocar(live: &LiveState, side: Side) -> Option<Vector3<f64>> {
    let of_rig = live.rig.devices.as_ref().and_then(|devices| devices.arm(side)).map(|set| set.rcm.trocar_m);
    of_rig.or_else(|| live.scene.of_side(side).map(|scene| scene.trocar_m))
}

pub fn fault_text(wrong: &FrameFault) -> [String; 2] {
    let (words, cure) = match wrong {
        FrameFault::Frozen(stood) => (text::endoscope_view::frozen(*stood), text::endoscope_view::FROZEN_CURE.get()),
        FrameFault::Black => (text::endoscope_view::BLACK.get().to_owned(), text::endoscope_view::BLACK_CURE.get()),
        FrameFault::Late(late) => (text::endoscope_view::late(*late), text::endoscope_view::LATE_CURE.get()),
        FrameFault::Damaged(damage) => (
            text::endoscope_view::damaged(&nima_words::report_text::quoted(damage)),
            text::endoscope_view::DAMAGED_CURE.get(),
        ),
        FrameFault::Size(has, wanted) => {
            (text::endoscope_view::size(*has, *wanted), text::endoscope_view::SIZE_CURE.get())
        }
    };
    [words, cure.to_owned()]
}

/// Returns the time until the text of the window changes without a new image.
fn until_report(look: Option<&NewestFrame>, is_good: bool) -> Duration {
    let age = look.and_then(|look| look.age).unwrap_or_default();
    let frozen = FROZEN.saturating_sub(age) + Duration::from_millis(2);
    if is_good { frozen.max(Duration::from_millis(10)) } else { CLOCK }
}
