//! The scene's triangles on the screen: one small OpenGL program with a depth test, inside egui's own frame.

#![expect(unsafe_code, reason = "OpenGL calls through glow")]

use eframe::glow::{self, HasContext as _};
use nalgebra::{Matrix4, Vector3};

use super::mesh::{Mesh, Vertex};

/// Everything one frame needs.
#[derive(Debug)]
pub struct Frame {
    /// What to draw.
    pub mesh: Mesh,
    /// Workspace to clip space.
    pub clip_from_workspace: Matrix4<f32>,
    /// Position of the eye, m.
    pub eye_m: Vector3<f32>,
    /// Both ends of the instrument's shaft, m: it throws a shadow.
    pub shaft_m: [Vector3<f32>; 2],
}

/// The program and its buffers on the GPU. Must be given back with [`Renderer::destroy`].
#[derive(Debug)]
pub struct Renderer {
    program: glow::Program,
    array: glow::VertexArray,
    vertices: glow::Buffer,
    indices: glow::Buffer,
}

const ATTRIBUTES: [&str; 3] = ["a_position", "a_normal", "a_colour"];

impl Renderer {
    /// Compiles the program. The error says what the driver disliked.
    pub fn new(gl: &glow::Context) -> Result<Self, String> {
        // SAFETY: called with eframe's current context; every object made here is destroyed in `destroy`.
        unsafe {
            let program = program(gl)?;
            let array = gl.create_vertex_array()?;
            let vertices = gl.create_buffer()?;
            let indices = gl.create_buffer()?;
            gl.bind_vertex_array(Some(array));
            gl.bind_buffer(glow::ARRAY_BUFFER, Some(vertices));
            gl.bind_buffer(glow::ELEMENT_ARRAY_BUFFER, Some(indices));
            let stride = size_of::<Vertex>() as i32;
            gl.vertex_attrib_pointer_f32(0, 3, glow::FLOAT, false, stride, 0);
            gl.vertex_attrib_pointer_f32(1, 3, glow::FLOAT, false, stride, 12);
            gl.vertex_attrib_pointer_f32(2, 4, glow::UNSIGNED_BYTE, true, stride, 24);
            for slot in 0..ATTRIBUTES.len() as u32 {
                gl.enable_vertex_attrib_array(slot);
            }
            gl.bind_vertex_array(None);
            Ok(Self { program, array, vertices, indices })
        }
    }

    /// Draws one frame into egui's viewport, over what is there.
    pub fn paint(&self, gl: &glow::Context, frame: &Frame) {
        // SAFETY: called inside egui's paint callback with its context current; egui restores its own state after it.
        unsafe {
            gl.enable(glow::DEPTH_TEST);
            gl.depth_func(glow::LEQUAL);
            gl.depth_mask(true);
            gl.clear_depth_f32(1.0);
            // egui's scissor keeps this inside the view.
            gl.clear(glow::DEPTH_BUFFER_BIT);
            gl.disable(glow::BLEND);
            gl.use_program(Some(self.program));
            let place = |name| gl.get_uniform_location(self.program, name);
            gl.uniform_matrix_4_f32_slice(
                place("u_clip_from_workspace").as_ref(),
                false,
                frame.clip_from_workspace.as_slice(),
            );
            for (name, v) in
                [("u_eye", &frame.eye_m), ("u_shaft_tip", &frame.shaft_m[0]), ("u_shaft_top", &frame.shaft_m[1])]
            {
                gl.uniform_3_f32(place(name).as_ref(), v.x, v.y, v.z);
            }
            gl.bind_vertex_array(Some(self.array));
            gl.bind_buffer(glow::ARRAY_BUFFER, Some(self.vertices));
            gl.buffer_data_u8_slice(glow::ARRAY_BUFFER, bytes(&frame.mesh.vertices), glow::STREAM_DRAW);
            gl.bind_buffer(glow::ELEMENT_ARRAY_BUFFER, Some(self.indices));
            gl.buffer_data_u8_slice(glow::ELEMENT_ARRAY_BUFFER, bytes(&frame.mesh.indices), glow::STREAM_DRAW);
            gl.draw_elements(glow::TRIANGLES, frame.mesh.indices.len() as i32, glow::UNSIGNED_INT, 0);
            gl.bind_vertex_array(None);
            gl.disable(glow::DEPTH_TEST);
            gl.enable(glow::BLEND);
        }
    }

    /// Gives everything back to the driver.
    pub fn destroy(&self, gl: &glow::Context) {
        // SAFETY: the objects were made in this context and are not used again.
        unsafe {
            gl.delete_program(self.program);
            gl.delete_vertex_array(self.array);
            gl.delete_buffer(self.vertices);
            gl.delete_buffer(self.indices);
        }
    }
}

/// The memory of a slice of plain numbers, as the GPU takes it.
fn bytes<T: Copy>(slice: &[T]) -> &[u8] {
    // SAFETY: `T` is `Vertex` (seven 4-byte fields, no padding) or `u32`; every byte is initialised.
    unsafe { std::slice::from_raw_parts(slice.as_ptr().cast(), size_of_val(slice)) }
}

/// # Safety
/// The context must be current.
unsafe fn program(gl: &glow::Context) -> Result<glow::Program, String> {
    let head = if gl.version().is_embedded { "#version 300 es\nprecision highp float;\n" } else { "#version 140\n" };
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
            // Lives as long as the program it is attached to.
            gl.delete_shader(shader);
        }
        gl.link_program(program);
        if gl.get_program_link_status(program) { Ok(program) } else { Err(gl.get_program_info_log(program)) }
    }
}
