//! Converts unevenly spaced samples to a smooth track at 100 Hz, with its derivatives and its spectrum.

mod decimator;
mod derivatives;
mod spectrum;
mod track;

pub(crate) use decimator::{Decimator, LONGEST_GAP_S};
pub(crate) use derivatives::{DerivativeOrder, magnitudes, mean, peak};
pub(crate) use spectrum::magnitude_spectrum;
pub(crate) use track::{RATE_HZ, STEP_S, TipTrack};
