//! The model of a packet as a row of plain numbers for a network: one rendering's parameters at a time.
//!
//! The numbers are 32 bits wide: a parameter that is accurate to 1 in 10 million changes no force that a hand can feel,
//! and half the bytes leave room for the repair of losses. Columns that a model does not use are omitted.

use super::{LinkPacket, MODES, Mode, ModeSet, matched::COLUMNS as MATCHED_COLUMNS};
use crate::signal::Lanes;

/// Maximum number of numbers in one packed model: matched rendering with every column in use.
/// Apart from its columns, a matched model has 21 numbers (form, degrees, five vectors, two lengths, a count).
pub const PACKED_MAX: usize = 3 * MATCHED_COLUMNS + 24;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterPack {
    /// Mode of the parameters: index into [`Mode::ALL`]; [`MODES`] for a baseline.
    pub slot: u8,
    /// Number of entries in use.
    pub len: u8,
    /// The parameters, SI units, in the order in which [`ParameterPack::of`] writes them.
    pub numbers: [f32; PACKED_MAX],
}

/// Conversion of the parameters of one rendering to and from numbers.
pub trait PackedNumbers: Sized {
    /// No parameters.
    const NONE: Self;

    /// Appends the parameters to a row.
    fn write(&self, row: &mut PackedWriter<'_>);

    /// Returns the parameters, or `None` if the numbers are invalid or not finite.
    fn read(row: &mut PackedReader<'_>) -> Option<Self>;
}

/// The parameters of one rendering in their place in a packet.
pub trait PackedParameters {
    /// Appends the parameters to a row.
    fn write(&self, row: &mut PackedWriter<'_>);

    /// Replaces the parameters; returns false, and changes nothing, if the new ones are invalid or not finite.
    fn renew(&mut self, row: &mut PackedReader<'_>) -> bool;

    /// Nothing is known any more.
    fn forget(&mut self);
}

impl<T: PackedNumbers> PackedParameters for T {
    fn write(&self, row: &mut PackedWriter<'_>) {
        PackedNumbers::write(self, row);
    }

    fn renew(&mut self, row: &mut PackedReader<'_>) -> bool {
        T::read(row).map(|model| *self = model).is_some()
    }

    fn forget(&mut self) {
        *self = T::NONE;
    }
}

impl LinkPacket {
    /// Returns the parameters of the rendering in this slot; `None` if that rendering has none. Every slot after the
    /// program's own modes is the baseline's.
    fn parameters(&mut self, slot: usize) -> Option<&mut dyn PackedParameters> {
        match Mode::ALL.get(slot) {
            Some(mode) => mode.parameters().map(|place| place(&mut self.models)),
            None => Some(&mut self.models.baseline),
        }
    }
}

impl ParameterPack {
    pub const NONE: Self = Self { slot: MODES as u8, len: 0, numbers: [0.0; PACKED_MAX] };

    pub fn used(&self) -> &[f32] {
        self.numbers.get(..usize::from(self.len)).unwrap_or(&[])
    }

    /// Returns the number of renderings in this set that have parameters to send.
    pub fn turns(modes: ModeSet) -> usize {
        Self::renderings(modes).count()
    }

    /// Returns the renderings that have parameters, in the order in which they take turns.
    fn renderings(modes: ModeSet) -> impl Iterator<Item = Mode> {
        modes.modes().filter(|mode| matches!(mode, Mode::Baseline(_)) || mode.parameters().is_some())
    }

    /// Packs the parameters of the rendering whose turn it is; returns `None` if no rendering in the packet has any.
    pub fn of(parcel: &LinkPacket, turn: usize) -> Option<Self> {
        let turn = turn.checked_rem(Self::turns(parcel.modes))?;
        let slot = Self::renderings(parcel.modes).nth(turn)?.index();
        let mut packed = Self { slot: slot as u8, ..Self::NONE };
        // A copy, because `parameters` returns mutable references.
        let mut parcel = *parcel;
        parcel.parameters(slot)?.write(&mut PackedWriter { packed: &mut packed });
        Some(packed)
    }

    /// Removes the parameters of this slot from the packet, because they are too old to compute a force.
    pub fn forget(slot: u8, parcel: &mut LinkPacket) {
        if let Some(parameters) = parcel.parameters(usize::from(slot)) {
            parameters.forget();
        }
    }

    /// Writes the parameters into the packet. Returns false, and changes nothing, if they are invalid or not finite.
    pub fn put_into(&self, parcel: &mut LinkPacket) -> bool {
        let parameters = parcel.parameters(usize::from(self.slot));
        parameters.is_some_and(|parameters| parameters.renew(&mut PackedReader { rest: self.used() }))
    }
}

/// A row of numbers that is being written.
#[derive(Debug)]
pub struct PackedWriter<'a> {
    packed: &'a mut ParameterPack,
}

impl PackedWriter<'_> {
    pub(super) fn put(&mut self, number: f64) {
        // Never past the end: a row that is too long loses its tail instead of failing in a tick.
        if let Some(place) = self.packed.numbers.get_mut(usize::from(self.packed.len)) {
            // f32 halves the packet; 24 bits are finer than any sensor.
            *place = number as f32;
            self.packed.len += 1;
        }
    }

    pub(super) fn lanes(&mut self, lanes: Lanes) {
        // The fourth lane is padding.
        let Lanes([x, y, z, _]) = lanes;
        for number in [x, y, z] {
            self.put(number);
        }
    }

    pub(super) fn row(&mut self, row: &[Lanes]) {
        // Trailing zeros are not sent: most models use a part of their columns.
        let used = row.iter().rposition(|lanes| *lanes != Lanes::ZERO).map_or(0, |last| last + 1);
        self.put(used as f64);
        row.iter().take(used).for_each(|lanes| self.lanes(*lanes));
    }
}

/// The rest of a row of numbers.
#[derive(Debug)]
pub struct PackedReader<'a> {
    rest: &'a [f32],
}

impl PackedReader<'_> {
    pub(super) fn take(&mut self) -> Option<f64> {
        let (first, rest) = self.rest.split_first()?;
        self.rest = rest;
        first.is_finite().then(|| f64::from(*first))
    }

    /// Returns a whole number up to `max`.
    pub(super) fn count(&mut self, max: usize) -> Option<usize> {
        let number = self.take()?;
        // A negative or huge number saturates here and then fails the comparison.
        let count = number as usize;
        ((count as f64 - number).abs() < f64::EPSILON && count <= max).then_some(count)
    }

    pub(super) fn lanes(&mut self) -> Option<Lanes> {
        Some(Lanes([self.take()?, self.take()?, self.take()?, 0.0]))
    }

    pub(super) fn row<const N: usize>(&mut self) -> Option<[Lanes; N]> {
        let used = self.count(N)?;
        let mut row = [Lanes::ZERO; N];
        for place in row.iter_mut().take(used) {
            *place = self.lanes()?;
        }
        Some(row)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::impedance::{
        Baseline, BaselineModel, HuntCrossleyContact, Identifier, ImpedanceSettings, Models, SLOTS, Sample, Wave,
    };

    /// Returns the last packet of two seconds of pressing, with all modes and the model of one baseline.
    fn parcel(baseline: &BaselineModel) -> LinkPacket {
        let mut identifier =
            Identifier::new(&ImpedanceSettings { delay_s: 0.05, ..ImpedanceSettings::default() }).unwrap();
        for i in 0..2000_u32 {
            let t_s = f64::from(i) * 1e-3;
            let depth_m = 0.004 * (6.0 * t_s).sin();
            let position_m = Vector3::new(0.002 * (9.0 * t_s).cos(), 0.001 * (4.0 * t_s).sin(), -depth_m);
            let force_n = Vector3::new(0.3 * (9.0 * t_s).cos(), 0.0, 600.0 * depth_m.max(0.0));
            identifier.step(&Sample { t_s, position_m, force_n });
        }
        let mut parcel = *identifier.parcel();
        parcel.modes = parcel.modes.with(Mode::Baseline(Baseline::Kalman));
        parcel.models.baseline = *baseline;
        parcel
    }

    const LANES: Lanes = Lanes([0.5, -2.0, 0.25, 0.0]);

    const CONTACT: HuntCrossleyContact = HuntCrossleyContact {
        surface_m: LANES,
        reach_m: LANES,
        exponent: LANES,
        parameters: [LANES, Lanes::ZERO, LANES, LANES, LANES, Lanes::ZERO, Lanes::ZERO],
        bounds_n: [LANES, Lanes::ZERO],
    };

    const BASELINES: [BaselineModel; 5] = [
        BaselineModel::Contact(CONTACT),
        BaselineModel::Wave(Wave { returning: LANES, impedance_n_s_m: LANES }),
        BaselineModel::Returned { energy_j: LANES },
        BaselineModel::Trend { force_n: LANES, rate_n_s: Lanes::ZERO },
        BaselineModel::Forecast { force_n: LANES },
    ];

    fn close(one: &Models, other: &Models) -> bool {
        // Compares every parameter to 32 bits: comparing the debug texts number by number would be equivalent but slow.
        let near = |a: Lanes, b: Lanes| (a - b).norm() <= 1e-6 * (a.norm() + 1e-9);
        let rows = |a: &[Lanes], b: &[Lanes]| a.iter().zip(b).all(|(a, b)| near(*a, *b));
        rows(&one.matched.parameters, &other.matched.parameters)
            && rows(&one.nima.parameters, &other.nima.parameters)
            && rows(&one.anchored.motion, &other.anchored.motion)
            && rows(&one.literal.coefficients, &other.literal.coefficients)
            && rows(&one.linear.coefficients, &other.linear.coefficients)
            && near(one.anchored.centre_m, other.anchored.centre_m)
            && near(one.matched.origin, other.matched.origin)
            && [one.literal.degree, one.anchored.degree, one.matched.degree, one.nima.degree]
                == [other.literal.degree, other.anchored.degree, other.matched.degree, other.nima.degree]
            && (one.matched.form, one.nima.form) == (other.matched.form, other.nima.form)
            && one.baseline == other.baseline
    }

    #[test]
    fn every_model_arrives_as_it_was_packed() {
        for baseline in &BASELINES {
            let parcel = parcel(baseline);
            let mut arrived = LinkPacket { modes: parcel.modes, ..LinkPacket::BLANK };
            assert!(!close(&parcel.models, &arrived.models));
            let turns = ParameterPack::turns(parcel.modes);
            for turn in 0..turns {
                assert!(ParameterPack::of(&parcel, turn).unwrap().put_into(&mut arrived), "turn {turn}");
            }
            assert!(close(&parcel.models, &arrived.models), "{baseline:?}");
            (0..SLOTS as u8).for_each(|slot| ParameterPack::forget(slot, &mut arrived));
            assert_eq!(arrived, LinkPacket { modes: parcel.modes, ..LinkPacket::BLANK });
        }
    }

    #[test]
    fn a_set_without_parameters_has_none_to_send() {
        let parcel = LinkPacket { modes: ModeSet::only(Mode::Dfr), ..LinkPacket::BLANK };
        assert_eq!((ParameterPack::turns(parcel.modes), ParameterPack::of(&parcel, 0)), (0, None));
        assert_eq!(ParameterPack::turns(ModeSet::only(Mode::Best)), 2);
    }

    #[test]
    fn what_makes_no_sense_changes_nothing() {
        let parcel = parcel(&BASELINES[0]);
        for turn in 0..ParameterPack::turns(parcel.modes) {
            let good = ParameterPack::of(&parcel, turn).unwrap();
            for at in 0..usize::from(good.len) {
                for bad in [f32::NAN, f32::INFINITY] {
                    let mut packed = good;
                    packed.numbers[at] = bad;
                    let mut arrived = parcel;
                    assert!(!packed.put_into(&mut arrived), "turn {turn}, number {at}");
                    assert_eq!(arrived, parcel);
                }
                let cut = ParameterPack { len: at as u8, ..good };
                assert!(!cut.put_into(&mut parcel.clone()), "turn {turn}, cut at {at}");
            }
            assert!(!ParameterPack { slot: Mode::Best.index() as u8, ..good }.put_into(&mut parcel.clone()));
        }
        let mut packed = ParameterPack::of(&parcel, 3).unwrap();
        packed.numbers[0] = 17.0;
        assert!(!packed.put_into(&mut parcel.clone()), "no such form");
    }
}
