//! A moving image on the screen.

use egui::{ColorImage, Context, TextureHandle, TextureId, TextureOptions};
use nima_endoscope::DecodedImage;

/// Two textures: one is shown while the other is written. With a software renderer, its threads may still read the previous
/// frame, and would show parts of both images.
#[derive(Default)]
pub struct DoubleBuffer {
    textures: [Option<TextureHandle>; 2],
    front: usize,
}

impl DoubleBuffer {
    /// Uploads an image, which is shown from now on.
    pub fn upload(&mut self, ctx: &Context, name: &str, decoded: &DecodedImage) {
        let image = ColorImage::from_rgba_premultiplied(decoded.size_px, &decoded.rgba);
        self.front = 1 - self.front;
        let back = &mut self.textures[self.front];
        match back {
            Some(texture) => texture.set(image, TextureOptions::LINEAR),
            None => *back = Some(ctx.load_texture(name, image, TextureOptions::LINEAR)),
        }
    }

    /// Returns the shown texture; `None` before the first image.
    pub fn id(&self) -> Option<TextureId> {
        self.textures[self.front].as_ref().map(TextureHandle::id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_shown_before_is_not_written() {
        let ctx = Context::default();
        let mut buffer = DoubleBuffer::default();
        let decoded = DecodedImage { size_px: [1, 1], rgba: vec![255; 4] };
        assert_eq!(buffer.id(), None);
        let ids = [(); 4].map(|()| {
            buffer.upload(&ctx, "test", &decoded);
            buffer.id().unwrap()
        });
        assert!(ids[0] != ids[1] && ids[..2] == ids[2..], "{ids:?}");
    }
}
