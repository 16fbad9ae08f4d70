//! Keeps the image of a window from frame to frame.
//!
//! Mesa's software renderer copies the image to the screen and keeps it, so the next frame needs to change only parts
//! of it. OpenGL does not guarantee that, so each frame marks one pixel (blue changed by 1/255) and the next one checks
//! the mark. If it is repeatedly missing, every frame is drawn completely. Between frames a framebuffer of one pixel is
//! bound, because eframe clears the bound framebuffer at the start of each frame.

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

/// Parts of the names of software renderers.
const SOFTWARE: [&str; 6] = ["llvmpipe", "softpipe", "swrast", "swiftshader", "software", "gdi generic"];
/// Number of consecutive missing marks after which partial drawing is given up.
const LOST_MAX: u32 = 3;

/// State of the window's image, shared between the comparison of frames and the drawing code.
#[derive(Debug, Default)]
pub struct Surface {
    inner: Mutex<SurfaceInner>,
    /// Number of the frame that is in the window.
    drawn: AtomicU64,
    /// Fraction of the window that was redrawn in the last frame, in millionths.
    fraction: AtomicU64,
    refused: AtomicBool,
    /// The other windows of this context.
    others: Mutex<Vec<Arc<Self>>>,
}

#[derive(Debug, Default)]
struct SurfaceInner {
    sink: Option<PixelSink>,
    size: [i32; 2],
    /// The mark set by the last frame.
    sign: Option<u8>,
    lost: u32,
    /// The current frame is not the whole window.
    torn: bool,
}

/// A framebuffer of one pixel.
#[derive(Debug)]
struct PixelSink {
    framebuffer: glow::Framebuffer,
    colour: glow::Renderbuffer,
}

/// Returns the name of the OpenGL renderer.
pub fn renderer_of(gl: &glow::Context) -> String {
    // SAFETY: a query of eframe's current context.
    unsafe { gl.get_parameter_string(glow::RENDERER) }
}

impl Surface {
    /// Returns a surface if a software renderer is used; with a GPU it would have no benefit.
    pub fn where_it_pays(gl: &glow::Context) -> Option<Arc<Self>> {
        let name = renderer_of(gl).to_lowercase();
        SOFTWARE.iter().any(|word| name.contains(word)).then(Arc::default)
    }

    /// Returns the surface of another window of the same context, released with this one.
    pub(super) fn of_another_window(&self) -> Arc<Self> {
        let other = Arc::<Self>::default();
        self.others.lock().unwrap_or_else(PoisonError::into_inner).push(Arc::clone(&other));
        other
    }

    /// Returns whether partial drawing was given up.
    pub fn is_refused(&self) -> bool {
        self.refused.load(Ordering::Relaxed)
    }

    /// Returns whether the window shows this frame.
    pub fn shows(&self, frame: u64) -> bool {
        frame > 0 && self.drawn.load(Ordering::Relaxed) == frame
    }

    /// Returns the fraction of the window that was redrawn in the last frame, 0 to 1.
    pub fn drawn_fraction(&self) -> f64 {
        if self.is_refused() { 1.0 } else { self.fraction.load(Ordering::Relaxed) as f64 * 1e-6 }
    }

    /// Called before the shapes of a frame: clears these parts of the window (points). `expected` is the window's size
    /// in pixels; `whole` means that the whole window is drawn.
    pub(super) fn begin(
        self: &Arc<Self>,
        expected: Vec2,
        whole: bool,
        rects: &[Rect],
        background: Color32,
    ) -> CallbackFn {
        let surface = Arc::clone(self);
        let rects = rects.to_vec();
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

    /// Called after the shapes. From now on the window shows `frame`; `fraction` of it was redrawn.
    pub(super) fn end(self: &Arc<Self>, ctx: &Context, frame: u64, fraction: f64, background: Color32) -> CallbackFn {
        let surface = Arc::clone(self);
        let ctx = ctx.clone();
        CallbackFn::new(move |_, painter| {
            let mut inner = surface.inner.lock().unwrap_or_else(PoisonError::into_inner);
            if inner.torn || surface.is_refused() {
                // The next frame is drawn completely.
                ctx.request_repaint();
            }
            // SAFETY: called inside egui's paint callback with its context current; egui restores its own state after it.
            if surface.is_refused() || !unsafe { inner.leave(painter.gl(), frame, background) } {
                surface.refused.store(true, Ordering::Relaxed);
                return;
            }
            surface.drawn.store(if inner.torn { 0 } else { frame }, Ordering::Relaxed);
            surface.fraction.store((fraction * 1e6) as u64, Ordering::Relaxed);
        })
    }

    /// Releases all objects on the GPU.
    pub fn destroy(&self, gl: &glow::Context) {
        for other in self.others.lock().unwrap_or_else(PoisonError::into_inner).drain(..) {
            other.destroy(gl);
        }
        let mut inner = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(sink) = inner.sink.take() {
            // SAFETY: the objects were created in this context and are not used again.
            unsafe { sink.destroy(gl) }
        }
    }
}

impl SurfaceInner {
    /// Returns whether the image in the window is the one that the last frame left.
    ///
    /// # Safety The context must be current, with the window's framebuffer bound.
    unsafe fn finds_its_sign(&mut self, gl: &glow::Context, size: [i32; 2]) -> bool {
        let same_size = std::mem::replace(&mut self.size, size) == size;
        let Some(sign) = self.sign.filter(|_| same_size) else { return false };
        let mut point = [0_u8; 4];
        let pixels = glow::PixelPackData::Slice(Some(&mut point));
        // SAFETY: the same conditions as for this function; one pixel of four bytes fits into the slice.
        unsafe { gl.read_pixels(0, 0, 1, 1, glow::RGBA, glow::UNSIGNED_BYTE, pixels) };
        let found = point[2] == sign;
        self.lost = if found { 0 } else { self.lost + 1 };
        found
    }

    /// Sets the mark and binds the small framebuffer, so that the window is not cleared; false if the driver refuses.
    ///
    /// # Safety
    /// The context must be current, with the window's framebuffer bound.
    unsafe fn leave(&mut self, gl: &glow::Context, frame: u64, background: Color32) -> bool {
        // Cycle through three values, so that the images of two alternating buffers cannot be confused.
        let blue = background.b().clamp(1, 254) - 1 + (frame % 3) as u8;
        let [r, g, _, _] = background.to_normalized_gamma_f32();
        unsafe {
            gl.scissor(0, 0, 1, 1);
            gl.clear_color(r, g, f32::from(blue) / 255.0, 1.0);
            gl.clear(glow::COLOR_BUFFER_BIT);
            if self.sink.is_none() {
                self.sink = PixelSink::new(gl);
            }
            let Some(sink) = &self.sink else { return false };
            gl.bind_framebuffer(glow::DRAW_FRAMEBUFFER, Some(sink.framebuffer));
        }
        self.sign = Some(blue);
        true
    }
}

impl PixelSink {
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
