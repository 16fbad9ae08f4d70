//! The window's picture as it is kept from frame to frame.
//!
//! Where Mesa draws by the processor, showing a frame copies the picture to the screen and leaves it where it is, so the next
//! frame need only change parts of it. OpenGL does not promise that; so each frame leaves a sign in one point (a part in 255 of blue)
//! and the next one looks for it. Where it is not found again and again, every frame is drawn whole, as without all this.
//! Between frames a framebuffer of one point is bound, because eframe begins each frame by wiping whatever is.

#![expect(unsafe_code, reason = "OpenGL calls through glow")]

use std::sync::{
    Arc, Mutex, PoisonError,
    atomic::{AtomicBool, AtomicU64, Ordering},
};

use eframe::{
    egui_glow::CallbackFn,
    glow::{self, HasContext as _},
};
use egui::{Color32, Context, Rect, Vec2, epaint::ViewportInPixels};

/// Words in the name of a renderer that draws by the processor.
const SOFTWARE: [&str; 6] = ["llvmpipe", "softpipe", "swrast", "swiftshader", "software", "gdi generic"];
/// Pictures that were not found again, one after the other, before keeping is given up.
const LOST_MAX: u32 = 3;

/// What is known of the window's picture, shared between the comparison and the driver's calls.
#[derive(Debug, Default)]
pub struct Surface {
    inner: Mutex<Inner>,
    /// Number of the newest frame that stands in the window.
    drawn: AtomicU64,
    /// Part of the window that was drawn anew in it, in millionths.
    share: AtomicU64,
    refused: AtomicBool,
}

#[derive(Debug, Default)]
struct Inner {
    sink: Option<Sink>,
    size: [i32; 2],
    /// The sign that the last frame left.
    sign: Option<u8>,
    lost: u32,
    /// The frame that is being drawn is not the whole window.
    torn: bool,
}

/// A framebuffer of one point.
#[derive(Debug)]
struct Sink {
    framebuffer: glow::Framebuffer,
    colour: glow::Renderbuffer,
}

/// What draws, in the driver's words.
pub fn renderer_of(gl: &glow::Context) -> String {
    // SAFETY: a question to eframe's current context.
    unsafe { gl.get_parameter_string(glow::RENDERER) }
}

impl Surface {
    /// A surface where the processor draws, which is where it pays.
    pub fn where_it_pays(gl: &glow::Context) -> Option<Arc<Self>> {
        let name = renderer_of(gl).to_lowercase();
        SOFTWARE.iter().any(|word| name.contains(word)).then(Arc::default)
    }

    /// Pictures are not kept here.
    pub fn is_refused(&self) -> bool {
        self.refused.load(Ordering::Relaxed)
    }

    /// This frame stands in the window.
    pub fn shows(&self, frame: u64) -> bool {
        frame > 0 && self.drawn.load(Ordering::Relaxed) == frame
    }

    /// Part of the window that was drawn anew in the last frame, 0 to 1.
    pub fn drawn_share(&self) -> f64 {
        if self.is_refused() { 1.0 } else { self.share.load(Ordering::Relaxed) as f64 * 1e-6 }
    }

    /// What comes before the shapes of a frame: these parts of the window (points) become empty. `expected` is the window's size in
    /// pixels; `whole` tells that all of it is drawn.
    pub(super) fn begin(
        self: &Arc<Self>,
        expected: Vec2,
        whole: bool,
        rects: &[Rect],
        background: Color32,
    ) -> CallbackFn {
        let (surface, rects) = (Arc::clone(self), rects.to_vec());
        CallbackFn::new(move |info, painter| {
            let gl = painter.gl();
            let size = info.screen_size_px.map(|x| i32::try_from(x).unwrap_or(0));
            let mut inner = surface.inner.lock().unwrap_or_else(PoisonError::into_inner);
            // SAFETY: called inside egui's paint callback with its context current; egui restores its own state after it.
            unsafe {
                gl.bind_framebuffer(glow::FRAMEBUFFER, painter.intermediate_fbo());
                let found = inner.finds_its_sign(gl, size);
                let as_expected = [expected.x, expected.y].iter().zip(size).all(|(a, b)| (a - b as f32).abs() < 1.0);
                inner.torn = !as_expected || !(found || whole);
                let [r, g, b, _] = background.to_normalized_gamma_f32();
                gl.clear_color(r, g, b, 1.0);
                for rect in &rects {
                    let place = ViewportInPixels::from_points(rect, info.pixels_per_point, info.screen_size_px);
                    gl.scissor(place.left_px, place.from_bottom_px, place.width_px, place.height_px);
                    gl.clear(glow::COLOR_BUFFER_BIT);
                }
            }
            if inner.lost >= LOST_MAX {
                surface.refused.store(true, Ordering::Relaxed);
            }
        })
    }

    /// What comes after them. The window shows `frame` from now on, `share` of which was drawn anew.
    pub(super) fn end(self: &Arc<Self>, ctx: &Context, frame: u64, share: f64, background: Color32) -> CallbackFn {
        let (surface, ctx) = (Arc::clone(self), ctx.clone());
        CallbackFn::new(move |_, painter| {
            let mut inner = surface.inner.lock().unwrap_or_else(PoisonError::into_inner);
            if inner.torn || surface.is_refused() {
                // The next frame is whole.
                ctx.request_repaint();
            }
            // SAFETY: called inside egui's paint callback with its context current; egui restores its own state after it.
            if surface.is_refused() || !unsafe { inner.leave(painter.gl(), frame, background) } {
                surface.refused.store(true, Ordering::Relaxed);
                return;
            }
            surface.drawn.store(if inner.torn { 0 } else { frame }, Ordering::Relaxed);
            surface.share.store((share * 1e6) as u64, Ordering::Relaxed);
        })
    }

    /// Gives everything back to the driver.
    pub fn destroy(&self, gl: &glow::Context) {
        let mut inner = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(sink) = inner.sink.take() {
            // SAFETY: the objects were made in this context and are not used again.
            unsafe { sink.destroy(gl) }
        }
    }
}

impl Inner {
    /// The picture in the window is the one that the last frame left there.
    ///
    /// # Safety
    /// The context must be current, with the window's framebuffer bound.
    unsafe fn finds_its_sign(&mut self, gl: &glow::Context, size: [i32; 2]) -> bool {
        let same_size = std::mem::replace(&mut self.size, size) == size;
        let Some(sign) = self.sign.filter(|_| same_size) else { return false };
        let mut point = [0_u8; 4];
        let pixels = glow::PixelPackData::Slice(Some(&mut point));
        // SAFETY: as for this function; one pixel of four bytes fits the slice.
        unsafe { gl.read_pixels(0, 0, 1, 1, glow::RGBA, glow::UNSIGNED_BYTE, pixels) };
        let found = point[2] == sign;
        self.lost = if found { 0 } else { self.lost + 1 };
        found
    }

    /// Leaves a sign and turns what wipes the window away from it; false when the driver refuses.
    ///
    /// # Safety
    /// The context must be current, with the window's framebuffer bound.
    unsafe fn leave(&mut self, gl: &glow::Context, frame: u64, background: Color32) -> bool {
        // Three in turn, so that neither of two windows that take turns is taken for the other.
        let blue = background.b().clamp(1, 254) - 1 + (frame % 3) as u8;
        let [r, g, _, _] = background.to_normalized_gamma_f32();
        unsafe {
            gl.scissor(0, 0, 1, 1);
            gl.clear_color(r, g, f32::from(blue) / 255.0, 1.0);
            gl.clear(glow::COLOR_BUFFER_BIT);
            if self.sink.is_none() {
                self.sink = Sink::new(gl);
            }
            let Some(sink) = &self.sink else { return false };
            gl.bind_framebuffer(glow::DRAW_FRAMEBUFFER, Some(sink.framebuffer));
        }
        self.sign = Some(blue);
        true
    }
}

impl Sink {
    /// # Safety
    /// The context must be current.
    unsafe fn new(gl: &glow::Context) -> Option<Self> {
        unsafe {
            let before = gl.get_parameter_framebuffer(glow::DRAW_FRAMEBUFFER_BINDING);
            let framebuffer = gl.create_framebuffer().ok()?;
            let colour = gl.create_renderbuffer().ok()?;
            gl.bind_framebuffer(glow::FRAMEBUFFER, Some(framebuffer));
            gl.bind_renderbuffer(glow::RENDERBUFFER, Some(colour));
            gl.renderbuffer_storage(glow::RENDERBUFFER, glow::RGBA8, 1, 1);
            gl.framebuffer_renderbuffer(glow::FRAMEBUFFER, glow::COLOR_ATTACHMENT0, glow::RENDERBUFFER, Some(colour));
            let complete = gl.check_framebuffer_status(glow::FRAMEBUFFER) == glow::FRAMEBUFFER_COMPLETE;
            gl.bind_framebuffer(glow::FRAMEBUFFER, before);
            let sink = Self { framebuffer, colour };
            if !complete {
                sink.destroy(gl);
            }
            complete.then_some(sink)
        }
    }

    /// # Safety
    /// The context must be current; the sink is not used again.
    unsafe fn destroy(&self, gl: &glow::Context) {
        unsafe {
            gl.bind_framebuffer(glow::FRAMEBUFFER, None);
            gl.delete_framebuffer(self.framebuffer);
            gl.delete_renderbuffer(self.colour);
        }
    }
}
