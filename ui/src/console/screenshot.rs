//! Saves what the window shows as a PNG file.

use std::path::Path;

use anyhow::Context as _;
use egui::ColorImage;

/// Writes the picture, opaque, as 8-bit RGBA.
pub fn save(path: &Path, picture: &ColorImage) -> anyhow::Result<()> {
    let [width, height] = picture.size;
    let pixels: Vec<u8> = picture.pixels.iter().flat_map(|pixel| [pixel.r(), pixel.g(), pixel.b(), 255]).collect();
    image::save_buffer(path, &pixels, width as u32, height as u32, image::ColorType::Rgba8)
        .with_context(|| format!("the screenshot could not be saved to {}", path.display()))
}
