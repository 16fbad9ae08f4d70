//! A time that can be read from the image itself: 64 black and white squares in its upper left corner.
//!
//! Two rows of 32 squares, the highest bit first: 52 bits of microseconds, then 12 check bits. An emulator draws it; a
//! test that reads it from a screen obtains the delay of the image.

const COLUMNS: usize = 32;
const ROWS: usize = 2;
const TIME_BITS: u32 = 52;
const CHECK_BITS: u32 = 12;
/// Minimum difference in brightness between black and white.
const CONTRAST_MIN: u32 = 64;

/// Returns width and height of the code with squares of this side, px.
pub const fn size_px(square_px: usize) -> [usize; 2] {
    [COLUMNS * square_px, ROWS * square_px]
}

/// Draws a time (us, below 2^52) into an image with three bytes per pixel; squares outside the image are left out.
pub fn draw(time_us: u64, square_px: usize, rgb: &mut [u8], width_px: usize) {
    let word = word(time_us);
    let [columns_px, rows_px] = size_px(square_px);
    for (y, row) in rgb.chunks_exact_mut(3 * width_px).take(rows_px).enumerate() {
        for (x, pixel) in row.chunks_exact_mut(3).take(columns_px).enumerate() {
            let place = COLUMNS * (y / square_px) + x / square_px;
            pixel.fill(if word >> (63 - place) & 1 == 1 { 255 } else { 0 });
        }
    }
}

/// Reads the time (us); `brightness` returns the brightness of the pixel at x and y. `None` if there is no valid code.
pub fn read(square_px: usize, mut brightness: impl FnMut(usize, usize) -> u8) -> Option<u64> {
    let mut values = [0_u32; ROWS * COLUMNS];
    // Sample the middle of each square: near its edges the neighbours blend in.
    let from = square_px / 4;
    let to = (square_px - square_px / 4).max(square_px / 4 + 1);
    for (place, value) in values.iter_mut().enumerate() {
        let corner = [square_px * (place % COLUMNS), square_px * (place / COLUMNS)];
        for y in from..to {
            for x in from..to {
                *value += u32::from(brightness(corner[0] + x, corner[1] + y));
            }
        }
        *value /= ((to - from) * (to - from)) as u32;
    }
    let low = values.iter().min()?;
    let high = values.iter().max()?;
    if high - low < CONTRAST_MIN {
        return None;
    }
    let middle = u32::midpoint(*low, *high);
    let read = values.iter().fold(0, |word, value| word << 1 | u64::from(*value > middle));
    let time_us = read >> CHECK_BITS;
    (word(time_us) == read).then_some(time_us)
}

fn word(time_us: u64) -> u64 {
    let time_us = time_us & ((1 << TIME_BITS) - 1);
    time_us << CHECK_BITS | check(time_us)
}

/// Returns a cyclic check with the polynomial x^12 + x^11 + x^3 + x^2 + x + 1 (CRC-12). It is not zero for zero, so
/// that a black image is not a valid time.
fn check(time_us: u64) -> u64 {
    let mut rest = 0xfff_u64;
    for bit in (0..TIME_BITS).rev() {
        let high = rest >> 11 & 1 ^ time_us >> bit & 1;
        rest = rest << 1 & 0xfff;
        if high == 1 {
            rest ^= 0x80f;
        }
    }
    rest
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const WIDTH: usize = 400;

    fn drawn(time_us: u64) -> Vec<u8> {
        let mut rgb = vec![90; 3 * WIDTH * 40];
        draw(time_us, 12, &mut rgb, WIDTH);
        rgb
    }

    fn read_from(rgb: &[u8]) -> Option<u64> {
        read(12, |x, y| rgb[3 * (WIDTH * y + x)])
    }

    proptest! {
        #[test]
        fn every_time_is_read_as_it_was_drawn(time_us in 0_u64..1 << 52) {
            prop_assert_eq!(read_from(&drawn(time_us)), Some(time_us));
        }

        #[test]
        fn a_wrong_square_is_noticed(time_us in 0_u64..1 << 52, square in 0_usize..64) {
            let mut rgb = drawn(time_us);
            for y in 0..12 {
                for x in 0..12 {
                    let at = 3 * (WIDTH * (12 * (square / 32) + y) + 12 * (square % 32) + x);
                    rgb[at] = 255 - rgb[at];
                }
            }
            prop_assert_eq!(read_from(&rgb), None);
        }
    }

    #[test]
    fn a_black_a_white_and_a_grey_picture_have_no_time() {
        for value in [0, 255, 128] {
            assert_eq!(read_from(&vec![value; 3 * WIDTH * 40]), None);
        }
    }
}
