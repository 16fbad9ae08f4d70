//! The OpenGL renderer of the window.

#![expect(unsafe_code, reason = "OpenGL calls through glow")]

use eframe::glow::{self, HasContext as _};

/// Parts of the names of software renderers.
const SOFTWARE: [&str; 6] = ["llvmpipe", "softpipe", "swrast", "swiftshader", "software", "gdi generic"];

/// Returns the name of the OpenGL renderer.
pub fn renderer_of(gl: &glow::Context) -> String {
    // SAFETY: a query of eframe's current context.
    unsafe { gl.get_parameter_string(glow::RENDERER) }
}

/// Returns whether a processor draws instead of a graphics card.
pub fn is_software(renderer: &str) -> bool {
    let name = renderer.to_lowercase();
    SOFTWARE.iter().any(|word| name.contains(word))
}
