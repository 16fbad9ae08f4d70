//! A fast Fourier transform (radix 2) of one real signal.

use std::f64::consts::PI;

use nalgebra::Complex;

/// Returns the magnitudes of the first `bins` frequencies of a signal padded with zeros to `length`, a power of two.
pub(crate) fn magnitude_spectrum(signal: &[f64], length: usize, bins: usize) -> Vec<f64> {
    let length = length.max(signal.len()).next_power_of_two();
    let mut values = vec![Complex::new(0.0, 0.0); length];
    let bits = length.trailing_zeros();
    for (k, value) in signal.iter().enumerate() {
        values[reversed(k, bits)].re = *value;
    }
    transform(&mut values);
    values.iter().take(bins).map(|value| (value.re * value.re + value.im * value.im).sqrt()).collect()
}

/// Reverses the lowest `bits` of the number.
fn reversed(number: usize, bits: u32) -> usize {
    if bits == 0 { 0 } else { number.reverse_bits() >> (usize::BITS - bits) }
}

/// Transforms in place, from bit-reversed order (Cooley and Tukey 1965).
fn transform(values: &mut [Complex<f64>]) {
    let length = values.len();
    let turn = |k: usize| {
        let (sin, cos) = libm::sincos(-2.0 * PI * k as f64 / length as f64);
        Complex::new(cos, sin)
    };
    // Each is computed separately: a recurrence would lose digits.
    let turns: Vec<Complex<f64>> = (0..length / 2).map(turn).collect();
    let mut half = 1;
    while half < length {
        let stride = length / (2 * half);
        for block in values.chunks_exact_mut(2 * half) {
            let (low, high) = block.split_at_mut(half);
            for ((a, b), turn) in low.iter_mut().zip(high).zip(turns.iter().step_by(stride)) {
                let turned = *b * *turn;
                *b = *a - turned;
                *a += turned;
            }
        }
        half *= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fast_transform_equals_the_sum() {
        let signal: Vec<f64> = (0..50).map(|k| f64::from(k * k % 17) - 3.0).collect();
        let fast = magnitude_spectrum(&signal, 128, 128);
        for (bin, fast) in fast.iter().enumerate() {
            let part = |(k, value): (usize, &f64)| Complex::from_polar(*value, -2.0 * PI * (k * bin) as f64 / 128.0);
            let slow: Complex<f64> = signal.iter().enumerate().map(part).sum();
            assert!((slow.norm() - fast).abs() < 1e-10, "bin {bin}: {} {fast}", slow.norm());
        }
    }
}
