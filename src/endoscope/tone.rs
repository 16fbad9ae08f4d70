//! Brightness, contrast and gamma of the displayed image.

use crate::DecodedImage;

/// Display settings of an image. The default changes nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tone {
    /// Added to every value, as a fraction of white: -0.5 to 0.5.
    pub brightness: f64,
    /// Factor on every value's distance from middle grey: 0.25 to 4.
    pub contrast: f64,
    /// Above 1 brightens dark values but keeps black and white: 0.25 to 4.
    pub gamma: f64,
}

impl Default for Tone {
    fn default() -> Self {
        Self { brightness: 0.0, contrast: 1.0, gamma: 1.0 }
    }
}

impl Tone {
    /// Returns whether it changes nothing.
    pub fn is_plain(&self) -> bool {
        *self == Self::default()
    }

    /// Returns the settings clamped to their limits; a value that is not a number becomes the default.
    #[must_use]
    pub fn limited(&self) -> Self {
        let plain = Self::default();
        let within = |value: f64, [low, high]: [f64; 2], usual: f64| {
            if value.is_finite() { value.clamp(low, high) } else { usual }
        };
        Self {
            brightness: within(self.brightness, [-0.5, 0.5], plain.brightness),
            contrast: within(self.contrast, [0.25, 4.0], plain.contrast),
            gamma: within(self.gamma, [0.25, 4.0], plain.gamma),
        }
    }

    /// Returns the output for each value.
    fn table(&self) -> [u8; 256] {
        let Self { brightness, contrast, gamma } = self.limited();
        std::array::from_fn(|value| {
            let fraction = (value as f64 / 255.0 - 0.5) * contrast + 0.5 + brightness;
            (255.0 * fraction.clamp(0.0, 1.0).powf(1.0 / gamma)).round() as u8
        })
    }

    /// Applies the settings to an image.
    pub fn apply(&self, image: &mut DecodedImage) {
        if self.is_plain() {
            return;
        }
        let table = self.table();
        for pixel in image.rgba.chunks_exact_mut(4) {
            for value in &mut pixel[..3] {
                *value = table[usize::from(*value)];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(tone: Tone, value: u8) -> u8 {
        let mut image = DecodedImage { size_px: [1, 1], rgba: vec![value, value, value, 255] };
        tone.apply(&mut image);
        assert_eq!(image.rgba[3], 255);
        assert!(image.rgba[..3].iter().all(|one| *one == image.rgba[0]));
        image.rgba[0]
    }

    #[test]
    fn each_does_what_it_says() {
        for value in [0, 1, 77, 128, 254, 255] {
            assert_eq!(of(Tone::default(), value), value);
        }
        let brighter = Tone { brightness: 0.2, ..Tone::default() };
        assert_eq!([0, 100, 255].map(|value| of(brighter, value)), [51, 151, 255]);
        let steeper = Tone { contrast: 2.0, ..Tone::default() };
        assert_eq!([0, 100, 255].map(|value| of(steeper, value)), [0, 73, 255]);
        let lifted = Tone { gamma: 2.0, ..Tone::default() };
        assert_eq!([0, 64, 255].map(|value| of(lifted, value)), [0, 128, 255]);
    }

    #[test]
    fn what_is_out_of_its_limits_is_within_them() {
        let wild = Tone { brightness: f64::NAN, contrast: 1e9, gamma: -3.0 };
        assert_eq!(wild.limited(), Tone { brightness: 0.0, contrast: 4.0, gamma: 0.25 });
        assert_eq!([of(wild, 0), of(wild, 255)], [0, 255]);
    }
}
