//! Saves the content of the window as a PNG file.

use std::{io, path::Path};

use anyhow::Context as _;
use egui::ColorImage;
use image::{ExtendedColorType, ImageEncoder as _, codecs::png::PngEncoder};
use nima_files::write_atomically;

/// Writes the image, opaque, as 8-bit RGBA.
pub fn save(path: &Path, image: &ColorImage) -> anyhow::Result<()> {
    let [width, height] = image.size;
    let pixels: Vec<u8> = image.pixels.iter().flat_map(|pixel| [pixel.r(), pixel.g(), pixel.b(), 255]).collect();
    write_atomically(path, |file| {
        PngEncoder::new(file)
            .write_image(&pixels, width as u32, height as u32, ExtendedColorType::Rgba8)
            .map_err(io::Error::other)
    })
    .with_context(|| format!("the screenshot could not be saved to {}", path.display()))
}
