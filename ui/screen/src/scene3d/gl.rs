//! Draws the scene's triangles: a small OpenGL renderer with a depth test, inside egui's frame.
//!
//! Antialiasing uses a multisampled framebuffer of the view's size, which is copied into egui's frame. Multisampling
//! the whole window would double the cost of every frame on a software renderer (74 instead of 37 ms at 1600x1000).

#![expect(unsafe_code, reason = "OpenGL calls through glow")]

use std::sync::{Mutex, PoisonError};

use eframe::glow::{self, HasContext as _};
use egui::{Color32, epaint::ViewportInPixels};
use nalgebra::{Matrix4, Vector3};

use super::mesh::{Material, Mesh};

/// Data of one frame.
#[derive(Debug)]
pub struct GlFrame {
    pub mesh: Mesh,
    /// Transformation from workspace to clip space.
    pub clip_from_workspace: Matrix4<f32>,
    /// Position of the eye, m.
    pub eye_m: Vector3<f32>,
    /// Tip and top of each instrument's shaft, m, for the shadows. At most two shafts are used.
    pub shafts_m: Vec<[Vector3<f32>; 2]>,
    /// Loss of brightness per metre, and the distance from which it starts, m.
    pub dims: [f32; 2],
    /// Colours at the top and at the bottom of the background.
    pub backdrop: [Color32; 2],
    pub smooth: bool,
}

/// Bands of the background gradient; neighbouring bands differ by at most 1/255.
const BACKDROP_STEPS: i32 = 32;
// Samples of a pixel; every driver of OpenGL 3 and OpenGL ES 3 supports four.
const SAMPLES: i32 = 4;
/// Size of a [`MeshVertex`](super::mesh::MeshVertex), checked by a test of the mesh.
const VERTEX_BYTES: i32 = 28;
const ATTRIBUTES: [&str; 3] = ["a_position", "a_normal", "a_colour"];

/// The shader programs, by [`Material`] and number of shafts with shadows; the last is for two.
const PROGRAMS: [(Material, usize); 5] =
    [(Material::Matte, 1), (Material::Tissue, 1), (Material::Metal, 1), (Material::Plain, 1), (Material::Tissue, 2)];
/// Drawing order: front objects first, so that hidden pixels are not shaded.
const ORDER: [Material; 4] = [Material::Plain, Material::Metal, Material::Matte, Material::Tissue];

/// The shader programs and their buffers on the GPU. Must be released with [`GlRenderer::destroy`].
#[derive(Debug)]
pub struct GlRenderer {
    programs: Vec<glow::Program>,
    array: glow::VertexArray,
    vertices: glow::Buffer,
    indices: glow::Buffer,
    /// Created when first needed and when the size of the view changes.
    target: Mutex<TargetState>,
}

#[derive(Debug)]
enum TargetState {
    None,
    Made(RenderTarget),
    /// The driver does not support it, so there is no antialiasing.
    Refused,
}

/// A multisampled framebuffer for the view.
#[derive(Debug)]
struct RenderTarget {
    framebuffer: glow::Framebuffer,
    colour: glow::Renderbuffer,
    depth: glow::Renderbuffer,
    size: [i32; 2],
}

impl GlRenderer {
    /// Compiles the shader programs; the error is the driver's message.
    pub fn new(gl: &glow::Context) -> Result<Self, String> {
        // SAFETY: called with eframe's current context; every object created here is destroyed in `destroy`.
        unsafe {
            let programs = PROGRAMS
                .iter()
                .map(|(material, shafts)| program(gl, *material, *shafts))
                .collect::<Result<Vec<_>, _>>()?;
            let array = gl.create_vertex_array()?;
            let vertices = gl.create_buffer()?;
            let indices = gl.create_buffer()?;
            gl.bind_vertex_array(Some(array));
            gl.bind_buffer(glow::ARRAY_BUFFER, Some(vertices));
            gl.bind_buffer(glow::ELEMENT_ARRAY_BUFFER, Some(indices));
            let stride = VERTEX_BYTES;
            gl.vertex_attrib_pointer_f32(0, 3, glow::FLOAT, false, stride, 0);
            gl.vertex_attrib_pointer_f32(1, 3, glow::FLOAT, false, stride, 12);
            gl.vertex_attrib_pointer_f32(2, 4, glow::UNSIGNED_BYTE, true, stride, 24);
            for slot in 0..ATTRIBUTES.len() as u32 {
                gl.enable_vertex_attrib_array(slot);
            }
            gl.bind_vertex_array(None);
            Ok(Self { programs, array, vertices, indices, target: Mutex::new(TargetState::None) })
        }
    }

    /// Draws one frame into egui's viewport, in the bound framebuffer.
    pub fn paint(&self, gl: &glow::Context, place: &ViewportInPixels, frame: &GlFrame) {
        let size = [place.width_px, place.height_px];
        if frame.mesh.indices.is_empty() || size.iter().any(|&x| x < 1) {
            return;
        }
        let mut state = self.target.lock().unwrap_or_else(PoisonError::into_inner);
        // SAFETY: called inside egui's paint callback with its context current; egui restores its own state after it.
        unsafe {
            // The framebuffer of egui is not always number 0.
            let into = gl.get_parameter_framebuffer(glow::DRAW_FRAMEBUFFER_BINDING);
            if frame.smooth {
                state.fit(gl, size);
            }
            let target =
                if let (true, TargetState::Made(target)) = (frame.smooth, &*state) { Some(target) } else { None };
            if let Some(target) = target {
                gl.bind_framebuffer(glow::FRAMEBUFFER, Some(target.framebuffer));
                gl.viewport(0, 0, size[0], size[1]);
            }
            let corner = if target.is_some() { [0, 0] } else { [place.left_px, place.from_bottom_px] };
            clear(gl, corner, size, frame.backdrop);
            self.draw(gl, frame);
            if let Some(target) = target {
                gl.scissor(place.left_px, place.from_bottom_px, size[0], size[1]);
                if !target.copy(gl, into, place) {
                    // A driver that cannot copy once is not tried again.
                    target.destroy(gl);
                    *state = TargetState::Refused;
                }
            }
        }
    }

    /// # Safety
    /// The context must be current, with framebuffer, viewport and scissor set.
    unsafe fn draw(&self, gl: &glow::Context, frame: &GlFrame) {
        unsafe {
            gl.disable(glow::BLEND);
            gl.enable(glow::DEPTH_TEST);
            gl.depth_func(glow::LEQUAL);
            gl.bind_vertex_array(Some(self.array));
            gl.bind_buffer(glow::ARRAY_BUFFER, Some(self.vertices));
            gl.buffer_data_u8_slice(glow::ARRAY_BUFFER, bytes(&frame.mesh.vertices), glow::STREAM_DRAW);
            let corners = frame.mesh.corners_by_material();
            let shafts = frame.shafts_m.len().clamp(1, 2);
            gl.bind_buffer(glow::ELEMENT_ARRAY_BUFFER, Some(self.indices));
            for material in ORDER {
                let corners = &corners[material as usize];
                let two = material == Material::Tissue && shafts == 2;
                let Some(program) = self.programs.get(if two { PROGRAMS.len() - 1 } else { material as usize }) else {
                    continue;
                };
                if corners.is_empty() {
                    continue;
                }
                gl.use_program(Some(*program));
                uniforms(gl, *program, frame);
                gl.buffer_data_u8_slice(glow::ELEMENT_ARRAY_BUFFER, bytes(corners), glow::STREAM_DRAW);
                let count = i32::try_from(corners.len()).unwrap_or(0);
                gl.draw_elements(glow::TRIANGLES, count, glow::UNSIGNED_INT, 0);
            }
            gl.bind_vertex_array(None);
            gl.disable(glow::DEPTH_TEST);
            gl.enable(glow::BLEND);
        }
    }

    /// Releases all objects on the GPU.
    pub fn destroy(&self, gl: &glow::Context) {
        let state = self.target.lock().unwrap_or_else(PoisonError::into_inner);
        // SAFETY: the objects were created in this context and are not used again.
        unsafe {
            if let TargetState::Made(target) = &*state {
                target.destroy(gl);
            }
            for program in &self.programs {
                gl.delete_program(*program);
            }
            gl.delete_vertex_array(self.array);
            gl.delete_buffer(self.vertices);
            gl.delete_buffer(self.indices);
        }
    }
}

impl TargetState {
    /// Creates the framebuffer, or replaces it if the size has changed.
    ///
    /// # Safety
    /// The context must be current.
    unsafe fn fit(&mut self, gl: &glow::Context, size: [i32; 2]) {
        match self {
            Self::Refused => return,
            Self::Made(target) if target.size == size => return,
            // SAFETY: the same conditions as for this function.
            Self::Made(target) => unsafe { target.destroy(gl) },
            Self::None => {}
        }
        // SAFETY: the same conditions as for this function.
        *self = unsafe { RenderTarget::new(gl, size) }.map_or(Self::Refused, Self::Made);
    }
}

impl RenderTarget {
    /// # Safety
    /// The context must be current.
    unsafe fn new(gl: &glow::Context, size: [i32; 2]) -> Option<Self> {
        unsafe {
            let framebuffer = gl.create_framebuffer().ok()?;
            let colour = gl.create_renderbuffer().ok()?;
            let depth = gl.create_renderbuffer().ok()?;
            gl.bind_framebuffer(glow::FRAMEBUFFER, Some(framebuffer));
            for (buffer, format, slot) in [
                (colour, glow::RGBA8, glow::COLOR_ATTACHMENT0),
                (depth, glow::DEPTH_COMPONENT24, glow::DEPTH_ATTACHMENT),
            ] {
                gl.bind_renderbuffer(glow::RENDERBUFFER, Some(buffer));
                gl.renderbuffer_storage_multisample(glow::RENDERBUFFER, SAMPLES, format, size[0], size[1]);
                gl.framebuffer_renderbuffer(glow::FRAMEBUFFER, slot, glow::RENDERBUFFER, Some(buffer));
            }
            let complete = gl.check_framebuffer_status(glow::FRAMEBUFFER) == glow::FRAMEBUFFER_COMPLETE;
            let target = Self { framebuffer, colour, depth, size };
            if !complete {
                target.destroy(gl);
            }
            complete.then_some(target)
        }
    }

    /// Copies the image into egui's framebuffer; false if the driver refuses.
    ///
    /// # Safety
    /// The context must be current.
    unsafe fn copy(&self, gl: &glow::Context, into: Option<glow::Framebuffer>, place: &ViewportInPixels) -> bool {
        unsafe {
            // Clear errors left over from egui.
            gl.get_error();
            gl.bind_framebuffer(glow::READ_FRAMEBUFFER, Some(self.framebuffer));
            gl.bind_framebuffer(glow::DRAW_FRAMEBUFFER, into);
            let [width, height] = self.size;
            let left = place.left_px;
            let bottom = place.from_bottom_px;
            gl.blit_framebuffer(
                0,
                0,
                width,
                height,
                left,
                bottom,
                left + width,
                bottom + height,
                glow::COLOR_BUFFER_BIT,
                glow::NEAREST,
            );
            let good = gl.get_error() == glow::NO_ERROR;
            gl.bind_framebuffer(glow::FRAMEBUFFER, into);
            gl.viewport(left, bottom, width, height);
            good
        }
    }

    /// # Safety
    /// The context must be current; the framebuffer is not used again.
    unsafe fn destroy(&self, gl: &glow::Context) {
        unsafe {
            gl.bind_framebuffer(glow::FRAMEBUFFER, None);
            gl.delete_framebuffer(self.framebuffer);
            gl.delete_renderbuffer(self.colour);
            gl.delete_renderbuffer(self.depth);
        }
    }
}

/// Clears a part of the framebuffer to a gradient, band by band: on a software renderer much cheaper than shading every
/// pixel.
///
/// # Safety
/// The context must be current.
unsafe fn clear(gl: &glow::Context, [left, bottom]: [i32; 2], [width, height]: [i32; 2], backdrop: [Color32; 2]) {
    let [top, ground] = [0, 1].map(|i| backdrop[i].to_normalized_gamma_f32());
    unsafe {
        gl.depth_mask(true);
        gl.clear_depth_f32(1.0);
        for step in 0..BACKDROP_STEPS {
            let [from, to] = [step, step + 1].map(|step| height * step / BACKDROP_STEPS);
            let fraction = step as f32 / (BACKDROP_STEPS - 1) as f32;
            let [r, g, b] = [0, 1, 2].map(|i| ground[i] + fraction * (top[i] - ground[i]));
            gl.scissor(left, bottom + from, width, to - from);
            gl.clear_color(r, g, b, 1.0);
            gl.clear(glow::COLOR_BUFFER_BIT | glow::DEPTH_BUFFER_BIT);
        }
        gl.scissor(left, bottom, width, height);
    }
}

/// Returns the bytes of a slice of plain numbers, in the GPU's format.
fn bytes<T: Copy>(slice: &[T]) -> &[u8] {
    // SAFETY: `T` is `MeshVertex` (seven 4-byte fields, no padding) or `u32`; every byte is initialised.
    unsafe { std::slice::from_raw_parts(slice.as_ptr().cast(), size_of_val(slice)) }
}

/// Sets the uniforms of a program; those that it does not use are skipped.
///
/// # Safety
/// The context must be current, with the program in use.
unsafe fn uniforms(gl: &glow::Context, program: glow::Program, frame: &GlFrame) {
    unsafe {
        let place = |name| gl.get_uniform_location(program, name);
        gl.uniform_3_f32(place("u_eye").as_ref(), frame.eye_m.x, frame.eye_m.y, frame.eye_m.z);
        let ends: Vec<f32> = frame.shafts_m.iter().take(2).flatten().flat_map(|end| [end.x, end.y, end.z]).collect();
        if let (Some(place), false) = (place("u_shaft_ends"), ends.is_empty()) {
            gl.uniform_3_f32_slice(Some(&place), &ends);
        }
        gl.uniform_2_f32(place("u_dims").as_ref(), frame.dims[0], frame.dims[1]);
        let clip = frame.clip_from_workspace.as_slice();
        gl.uniform_matrix_4_f32_slice(place("u_clip_from_workspace").as_ref(), false, clip);
    }
}

/// # Safety
/// The context must be current.
unsafe fn program(gl: &glow::Context, material: Material, shafts: usize) -> Result<glow::Program, String> {
    let head = if gl.version().is_embedded { "#version 300 es\nprecision highp float;\n" } else { "#version 140\n" };
    let head = format!("{head}#define MATERIAL {}\n#define SHAFTS {shafts}\n", material as u8);
    unsafe {
        let program = gl.create_program()?;
        for (slot, name) in ATTRIBUTES.iter().enumerate() {
            gl.bind_attrib_location(program, slot as u32, name);
        }
        for (kind, source) in [
            (glow::VERTEX_SHADER, include_str!("scene.vert.glsl")),
            (glow::FRAGMENT_SHADER, include_str!("scene.frag.glsl")),
        ] {
            let shader = gl.create_shader(kind)?;
            gl.shader_source(shader, &format!("{head}{source}"));
            gl.compile_shader(shader);
            if !gl.get_shader_compile_status(shader) {
                return Err(gl.get_shader_info_log(shader));
            }
            gl.attach_shader(program, shader);
            // It is deleted with the program to which it is attached.
            gl.delete_shader(shader);
        }
        gl.link_program(program);
        if gl.get_program_link_status(program) { Ok(program) } else { Err(gl.get_program_info_log(program)) }
    }
}
