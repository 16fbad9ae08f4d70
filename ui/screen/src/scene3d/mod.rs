//! The 3-D view of the operating field: triangles built by [`stage`], drawn by the GPU ([`gl`]) inside egui's frame, with
//! labels by egui's painter over them. Without a GPU (in tests) everything except the triangles is drawn.

mod aim;
mod arrows;
pub mod camera;
pub mod extras;
pub mod gl;
mod labels;
pub mod mesh;
mod mouse_drive;
mod objects;
mod pick;
mod reach;
pub mod release_trail;
mod shadows;
pub mod stage;
mod training;
mod vignette;

use std::sync::Arc;

use eframe::{egui_glow, glow};
use egui::{Rect, Sense, Ui};
use nalgebra::Vector3;
use nima_machine::rig::{SIDES, Side};
use nima_simulation::{Worlds, scene::Scene};
use nima_words::text;

pub use self::camera::SceneCamera;
pub use nima_words::report_text::side_name;

pub use self::labels::tip_bars;

use self::{
    aim::SceneAim,
    extras::Extras,
    gl::GlRenderer,
    labels::{axes, hint, labels, readings, readings_width, release},
    mouse_drive::MouseDrive,
    objects::DisplayedObjects,
    release_trail::ReleaseTrail,
    stage::{StageArm, StagePose},
    training::TrialClock,
};
use crate::{live::LiveState, outbox::Outbox, theme};

/// Height of a view from which its axes are drawn: in a lower one they would cover the gauges.
const AXES_FROM: f32 = 200.0;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CameraLook {
    #[default]
    Free,
    Endoscope,
}

/// Camera and GPU objects of the view.
#[derive(Debug)]
#[expect(clippy::struct_excessive_bools, reason = "each is a separate switch")]
pub struct SceneView {
    pub smooth: bool,
    pub look: CameraLook,
    /// Show the forces as numbers and gauges.
    pub figures: bool,
    /// Draw the forces as arrows.
    pub arrows: bool,
    pub extras: Extras,
    /// The trail of a released handle, in the demonstration.
    pub release: Option<ReleaseTrail>,
    /// Drawn in this frame.
    pub is_seen: bool,
    camera: SceneCamera,
    /// Name of the scene for which the cameras were set.
    set_for: Option<String>,
    /// Tip positions before the first tick.
    starts_m: [Option<Vector3<f64>>; SIDES],
    lead: MouseDrive,
    trial: TrialClock,
    renderer: Option<Arc<GlRenderer>>,
    /// The last drawn scene; if nothing has changed, no new triangles are built, and a software renderer does not draw.
    drawn: Option<(SceneInputs, egui::PaintCallback)>,
    problem: Option<String>,
}

/// Everything that the triangles depend on.
#[derive(Clone, Debug, PartialEq)]
struct SceneInputs {
    rect: Rect,
    scene: String,
    camera: SceneCamera,
    smooth: bool,
    extras: Extras,
    arms: Vec<StageArm>,
    shown: Option<DisplayedObjects>,
}

impl Default for SceneView {
    fn default() -> Self {
        Self {
            smooth: true,
            look: CameraLook::Free,
            figures: true,
            arrows: true,
            extras: Extras::default(),
            release: None,
            is_seen: false,
            camera: SceneCamera::default(),
            set_for: None,
            starts_m: [None; SIDES],
            lead: MouseDrive::default(),
            trial: TrialClock::default(),
            renderer: None,
            drawn: None,
            problem: None,
        }
    }
}

impl SceneView {
    /// Creates a view that draws with this context; without one it shows labels only.
    pub fn new(gl: Option<&glow::Context>) -> Self {
        match gl.map(GlRenderer::new) {
            None => Self::default(),
            Some(Ok(renderer)) => Self { renderer: Some(Arc::new(renderer)), ..Self::default() },
            Some(Err(problem)) => Self { problem: Some(problem), ..Self::default() },
        }
    }

    /// Creates a second view that uses the same GPU objects, with its own camera; this view releases them.
    #[must_use]
    pub fn twin(&self) -> Self {
        Self { renderer: self.renderer.clone(), problem: self.problem.clone(), ..Self::default() }
    }

    /// Ends mouse control.
    pub fn let_go(&mut self, outbox: &mut Outbox) {
        self.lead.let_go(outbox);
    }

    /// View of a study's participant: without arrows, because a force would reveal the condition. `leads`: the instrument is
    /// always driven.
    pub const fn be_of_participant(&mut self, is_of: bool, leads: bool) {
        self.arrows = !is_of;
        self.lead.is_held = leads;
    }

    /// Returns whether mouse control is on.
    pub fn is_led(&self) -> bool {
        self.lead.is_on()
    }

    fn camera(&self, scene: &Scene) -> SceneCamera {
        match self.look {
            CameraLook::Free => self.camera,
            CameraLook::Endoscope => SceneCamera::endoscope(scene),
        }
    }

    /// Releases all objects on the GPU.
    pub fn destroy(&mut self, gl: &glow::Context) {
        if let Some(renderer) = self.renderer.take() {
            renderer.destroy(gl);
        }
    }
}

/// Draws the view over the available space.
pub fn scene_ui(ui: &mut Ui, live: &LiveState, view: &mut SceneView, outbox: &mut Outbox) {
    view.is_seen = true;
    if view.set_for.as_ref() != Some(&live.scene.name) {
        view.set_for = Some(live.scene.name.clone());
        view.camera = SceneCamera::of(&live.scene);
        view.starts_m = Worlds::new(&live.scene, live.rig.rate_hz).tips_m();
    }
    let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Canvas, true, text::field::OPERATING_FIELD.get()));
    // Reserve a place below the view's buttons, because the triangles are known only later.
    let ground = ui.painter_at(rect).add(egui::Shape::Noop);
    let rim = vignette::reserve(&ui.painter_at(rect));
    let camera = view.camera(&live.scene);
    // Only a simulated hand follows the mouse. A real hand at the handle would stay where it is.
    let offered = live.rig.has_simulated_hand();
    if view.figures {
        view.extras.ui(ui, rect);
    }
    view.lead.restart_by_key(ui, live, outbox);
    let leading = offered && view.lead.ui(ui, rect, &response, live, &camera, outbox);
    if view.look == CameraLook::Free {
        turn(ui, live, view, &response, leading);
    }
    let camera = view.camera(&live.scene);
    let arms: Vec<StageArm> = live.sides().filter_map(|side| arm(live, side, view)).collect();
    let painter = ui.painter_at(rect);
    let led = view.lead.side();
    let shown = DisplayedObjects::of(live, led);
    let reach = shown.as_ref().and_then(|shown| shown.reach);
    if let Some(marked) = view.lead.marked() {
        for StageArm { side, pose: StagePose { tip_m, .. }, .. } in &arms {
            if *side == marked {
                let ring_m = shown.as_ref().and_then(DisplayedObjects::held_m);
                SceneAim { scene: &live.scene, tip_m: *tip_m, ring_m }.paint(&painter, rect, &camera);
            } else {
                aim::paint_other(&painter, rect, &camera, tip_m);
            }
        }
    }
    if let Some(callback) = triangles(rect, live, view, &arms, shown) {
        painter.set(ground, callback);
    }
    if view.look == CameraLook::Endoscope && view.extras.round {
        vignette::paint(&painter, rect, rim);
    }
    if view.figures {
        view.extras.paint(&painter, rect, &camera, &live.scene, &arms, live.gate_settings().ceiling_n);
    }
    for arm in &arms {
        labels(&painter, rect, live, &camera, arm, view);
    }
    if let Some(trail) = &view.release {
        release(&painter, rect, &camera, trail);
    }
    if view.figures {
        readings(&painter, rect, live);
    }
    if view.look == CameraLook::Free && rect.height() > AXES_FROM {
        axes(&painter, rect, &camera);
    }
    hint(&painter, rect, live, view);
    // The keys of a study trial are shown next to it, except those for the jaws.
    let reported_led = led.filter(|_| !view.lead.is_held || live.scene.objects.is_some());
    let begins = view.lead.takes_begin();
    let mut words = training::report(live, reported_led, reach);
    // A recording does not say when its trial began, and a participant of a study reads the time next to the view.
    if let (Some(words), Some(tick), false, false) =
        (&mut words, live.first_tick(), live.is_shown_only(), view.lead.is_held)
    {
        let ended = live.training.as_ref().is_some_and(|training| training.ended);
        *words = text::training::timed(view.trial.seconds(tick.t_s, begins, ended), words);
    }
    training::line_ui(ui, rect, words, readings_width(live), view.figures);
    // No hover texts in the Surgeon view or over the driven instrument.
    let pointed_at = response.hover_pos().filter(|_| view.figures && !response.dragged() && !leading);
    if let Some(words) = pointed_at.and_then(|pointer| pick::pick(pointer, rect, &camera, &live.scene, &arms)) {
        response.on_hover_text_at_pointer(words);
    }
}

/// Rotates and zooms the free camera with mouse and wheel.
fn turn(ui: &Ui, live: &LiveState, view: &mut SceneView, response: &egui::Response, leading: bool) {
    if response.dragged() && !leading {
        view.camera.orbit(response.drag_delta());
    }
    if response.double_clicked() {
        view.camera = SceneCamera::of(&live.scene);
    }
    if response.contains_pointer() && !leading {
        let wheel = ui.input(|input| input.smooth_scroll_delta().y + 100.0 * (input.zoom_delta() - 1.0));
        view.camera.zoom((wheel * 0.003).exp());
    }
}

/// Returns the objects of one side from its newest tick, or the start of the task before the first tick. Forces only if
/// arrows are drawn.
fn arm(live: &LiveState, side: Side, view: &SceneView) -> Option<StageArm> {
    let scene = live.scene.of_side(side)?;
    let finite = |v: Vector3<f64>| v.iter().all(|x| x.is_finite());
    let start_m = view.starts_m[side.index()].unwrap_or_default();
    let rest = StagePose { tip_m: start_m.cast(), measured_n: None, rendered_n: Vector3::zeros() };
    let pose = live.tick_of(side).filter(|tick| finite(tick.positions.tip_m)).map_or(rest, |tick| StagePose {
        tip_m: tick.positions.tip_m.cast(),
        measured_n: tick.known_n().map(nalgebra::Matrix::cast),
        rendered_n: tick.rendering.rendered_n.cast(),
    });
    // Hidden forces must not reveal anything, not even whether they are known.
    let hidden = StagePose { measured_n: Some(Vector3::zeros()), rendered_n: Vector3::zeros(), ..pose };
    let pose = if view.arrows { pose } else { hidden };
    // The endoscope is inside the body, the arm outside.
    let is_drawn = view.extras.robot && view.look == CameraLook::Free;
    Some(StageArm {
        side,
        trocar_m: scene.trocar_m.cast(),
        targets_m: scene.targets_m.iter().map(|position_m| position_m.cast()).collect(),
        pose,
        trail_m: live.trails[side.index()].iter().copied().collect(),
        links_m: if is_drawn { live.links_m(side) } else { Vec::new() },
    })
}

fn triangles(
    rect: Rect,
    live: &LiveState,
    view: &mut SceneView,
    arms: &[StageArm],
    shown: Option<DisplayedObjects>,
) -> Option<egui::PaintCallback> {
    let renderer = view.renderer.clone()?;
    let camera = view.camera(&live.scene);
    let scene = live.scene.name.clone();
    let smooth = view.smooth;
    let extras = view.extras;
    let wanted = SceneInputs { rect, scene, camera, smooth, extras, arms: arms.to_vec(), shown };
    if let Some((_, callback)) = view.drawn.as_ref().filter(|(drawn, _)| *drawn == wanted) {
        return Some(callback.clone());
    }
    let eye_m = camera.eye_m();
    let right = camera.right();
    let style = stage::SceneStyle { eye_m: &eye_m, right: &right, fine: smooth, shadows: extras.shadows };
    let is_round = view.look == CameraLook::Endoscope && extras.round;
    // The masked part of a round image is neither drawn nor redrawn.
    let part = if is_round { vignette::part_of(rect) } else { rect };
    let frame = gl::GlFrame {
        mesh: stage::build(&live.scene, arms, wanted.shown.as_ref(), style),
        dims: if extras.depth { camera.dims() } else { [0.0; 2] },
        clip_from_workspace: vignette::part_from_whole(part, rect) * camera.clip_from_workspace(rect.aspect_ratio()),
        eye_m,
        shafts_m: arms.iter().map(|arm| [arm.pose.tip_m, arm.trocar_m]).collect(),
        backdrop: [theme::FIELD_FAR, theme::FIELD_NEAR],
        smooth,
    };
    let paint = egui_glow::CallbackFn::new(move |info, painter| {
        renderer.paint(painter.gl(), &info.viewport_in_pixels(), &frame);
    });
    let callback = egui::PaintCallback { rect: part, callback: Arc::new(paint) };
    view.drawn = Some((wanted, callback.clone()));
    Some(callback)
}
