//! The model of a parcel as plain numbers in a row, as it goes over a network: one rendering's parameters at a time.
//!
//! Numbers are 32 bits wide: a parameter that is right to 1 in 10 million changes no force that a hand can feel, and half the
//! bytes leave room for what repairs losses. Columns that a model does not use are left out.

use super::{
    AnchoredModel, BaselineModel, Contact, Form, LiteralModel, MODES, MatchedModel, Mode, ModeSet, Parcel, Wave,
    matched::COLUMNS as MATCHED_COLUMNS,
};
use crate::signal::Lanes;

/// Most numbers of one packed model: matched rendering with every column in use.
pub const PACKED_MAX: usize = 3 * MATCHED_COLUMNS + 24;

/// The parameters of one rendering.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Packed {
    /// Whose parameters: index into [`Mode::ALL`]; [`MODES`] for a baseline.
    pub slot: u8,
    /// How many of the numbers are in use.
    pub len: u8,
    /// The parameters, SI units, in the order in which [`Packed::of`] writes them.
    pub numbers: [f32; PACKED_MAX],
}

/// The renderings that have parameters of their own, in the order in which they take turns.
const WITH_PARAMETERS: [Mode; 5] = [Mode::Literal, Mode::Linear, Mode::Anchored, Mode::Matched, Mode::Nima];

impl Packed {
    /// Nothing.
    pub const NONE: Self = Self { slot: MODES as u8, len: 0, numbers: [0.0; PACKED_MAX] };

    /// The numbers in use.
    pub fn used(&self) -> &[f32] {
        self.numbers.get(..usize::from(self.len)).unwrap_or(&[])
    }

    /// How many renderings of this set have parameters to send.
    pub fn turns(modes: ModeSet) -> usize {
        Self::renderings(modes).count() + usize::from(modes.baseline().is_some())
    }

    fn renderings(modes: ModeSet) -> impl Iterator<Item = Mode> {
        WITH_PARAMETERS.into_iter().filter(move |mode| modes.contains(*mode))
    }

    /// The parameters of the rendering whose turn it is among those that the parcel has; `None` if it has none.
    pub fn of(parcel: &Parcel, turn: usize) -> Option<Self> {
        let turns = Self::turns(parcel.modes);
        let turn = turn.checked_rem(turns)?;
        let mut packed = Self::NONE;
        let mut row = Writer { packed: &mut packed };
        match Self::renderings(parcel.modes).nth(turn) {
            Some(mode) => {
                match mode {
                    Mode::Literal => row.literal(&parcel.literal),
                    Mode::Linear => row.literal(&parcel.linear),
                    Mode::Anchored => row.anchored(&parcel.anchored),
                    Mode::Nima => row.matched(&parcel.nima),
                    _ => row.matched(&parcel.matched),
                }
                packed.slot = mode.index() as u8;
            }
            None => row.baseline(&parcel.baseline),
        }
        Some(packed)
    }

    /// Takes the parameters of this slot out of the parcel: they are too old to make a force of.
    pub fn forget(slot: u8, parcel: &mut Parcel) {
        match Mode::ALL.get(usize::from(slot)) {
            Some(Mode::Literal) => parcel.literal = LiteralModel::NONE,
            Some(Mode::Linear) => parcel.linear = LiteralModel::NONE,
            Some(Mode::Anchored) => parcel.anchored = AnchoredModel::NONE,
            Some(Mode::Matched) => parcel.matched = MatchedModel::NONE,
            Some(Mode::Nima) => parcel.nima = MatchedModel::NONE,
            Some(_) => {}
            None => parcel.baseline = BaselineModel::Nothing,
        }
    }

    /// Puts the parameters into the parcel. Returns false, and changes nothing, if they make no sense or are not finite.
    pub fn put_into(&self, parcel: &mut Parcel) -> bool {
        let mut row = Reader { rest: self.used() };
        let done = match Mode::ALL.get(usize::from(self.slot)) {
            Some(Mode::Literal) => row.literal().map(|model| parcel.literal = model),
            Some(Mode::Linear) => row.literal().map(|model| parcel.linear = model),
            Some(Mode::Anchored) => row.anchored().map(|model| parcel.anchored = model),
            Some(Mode::Matched) => row.matched().map(|model| parcel.matched = model),
            Some(Mode::Nima) => row.matched().map(|model| parcel.nima = model),
            Some(_) => None,
            None => row.baseline().map(|model| parcel.baseline = model),
        };
        done.is_some()
    }
}

struct Writer<'a> {
    packed: &'a mut Packed,
}

impl Writer<'_> {
    fn put(&mut self, number: f64) {
        if let Some(place) = self.packed.numbers.get_mut(usize::from(self.packed.len)) {
            *place = number as f32;
            self.packed.len += 1;
        }
    }

    fn lanes(&mut self, lanes: Lanes) {
        let Lanes([x, y, z, _]) = lanes;
        for number in [x, y, z] {
            self.put(number);
        }
    }

    fn row(&mut self, row: &[Lanes]) {
        let used = row.iter().rposition(|lanes| *lanes != Lanes::ZERO).map_or(0, |last| last + 1);
        self.put(used as f64);
        row.iter().take(used).for_each(|lanes| self.lanes(*lanes));
    }

    fn literal(&mut self, model: &LiteralModel) {
        self.put(f64::from(model.degree));
        self.lanes(model.constant_n);
        self.row(&model.coefficients);
    }

    fn anchored(&mut self, model: &AnchoredModel) {
        self.put(f64::from(model.degree));
        self.put(model.gain);
        self.put(model.bound_n);
        for lanes in [model.constant_n, model.centre_m, model.knee, model.low_n, model.high_n] {
            self.lanes(lanes);
        }
        self.row(&model.motion);
    }

    fn matched(&mut self, model: &MatchedModel) {
        let (form, degree) = match model.form {
            Form::Tissue => (0, 0),
            Form::Sliding => (1, 0),
            Form::Coupled => (2, 0),
            Form::Paper(degree) => (3, degree),
        };
        self.put(f64::from(form));
        self.put(f64::from(degree));
        self.put(f64::from(model.degree));
        for lanes in [model.one, model.origin, model.bounds_n[0], model.bounds_n[1], model.offset_n] {
            self.lanes(lanes);
        }
        model.gives.iter().for_each(|give| self.put(*give));
        self.row(&model.parameters);
    }

    fn baseline(&mut self, model: &BaselineModel) {
        match model {
            BaselineModel::Nothing => self.put(0.0),
            BaselineModel::Contact(contact) => {
                self.put(1.0);
                for lanes in
                    [contact.surface_m, contact.reach_m, contact.exponent, contact.bounds_n[0], contact.bounds_n[1]]
                {
                    self.lanes(lanes);
                }
                self.row(&contact.parameters);
            }
            BaselineModel::Wave(wave) => {
                self.put(2.0);
                self.lanes(wave.returning);
                self.lanes(wave.impedance_n_s_m);
            }
            BaselineModel::Returned { energy_j } => {
                self.put(3.0);
                self.lanes(*energy_j);
            }
            BaselineModel::Trend { force_n, rate_n_s } => {
                self.put(4.0);
                self.lanes(*force_n);
                self.lanes(*rate_n_s);
            }
            BaselineModel::Forecast { force_n } => {
                self.put(5.0);
                self.lanes(*force_n);
            }
        }
    }
}

struct Reader<'a> {
    rest: &'a [f32],
}

impl Reader<'_> {
    fn take(&mut self) -> Option<f64> {
        let (first, rest) = self.rest.split_first()?;
        self.rest = rest;
        first.is_finite().then(|| f64::from(*first))
    }

    /// A whole number up to `most`.
    fn count(&mut self, most: usize) -> Option<usize> {
        let number = self.take()?;
        let count = number as usize;
        ((count as f64 - number).abs() < f64::EPSILON && count <= most).then_some(count)
    }

    fn lanes(&mut self) -> Option<Lanes> {
        Some(Lanes([self.take()?, self.take()?, self.take()?, 0.0]))
    }

    fn row<const N: usize>(&mut self) -> Option<[Lanes; N]> {
        let used = self.count(N)?;
        let mut row = [Lanes::ZERO; N];
        for place in row.iter_mut().take(used) {
            *place = self.lanes()?;
        }
        Some(row)
    }

    fn literal(&mut self) -> Option<LiteralModel> {
        Some(LiteralModel {
            degree: self.count(super::MAX_DEGREE)? as u8,
            constant_n: self.lanes()?,
            coefficients: self.row()?,
        })
    }

    fn anchored(&mut self) -> Option<AnchoredModel> {
        let (degree, gain, bound_n) = (self.count(3)? as u8, self.take()?, self.take()?);
        let (constant_n, centre_m, knee) = (self.lanes()?, self.lanes()?, self.lanes()?);
        let (low_n, high_n) = (self.lanes()?, self.lanes()?);
        Some(AnchoredModel { motion: self.row()?, constant_n, centre_m, knee, low_n, high_n, bound_n, degree, gain })
    }

    fn matched(&mut self) -> Option<MatchedModel> {
        let (form, paper) = (self.count(3)?, self.count(super::MAX_DEGREE)? as u8);
        let form = [Form::Tissue, Form::Sliding, Form::Coupled, Form::Paper(paper)][form];
        let degree = self.count(super::MAX_DEGREE)? as u8;
        let (one, origin) = (self.lanes()?, self.lanes()?);
        let (bounds_n, offset_n) = ([self.lanes()?, self.lanes()?], self.lanes()?);
        let gives = [self.take()?, self.take()?];
        Some(MatchedModel { form, degree, one, parameters: self.row()?, origin, gives, bounds_n, offset_n })
    }

    fn baseline(&mut self) -> Option<BaselineModel> {
        Some(match self.count(5)? {
            0 => BaselineModel::Nothing,
            1 => {
                let (surface_m, reach_m, exponent) = (self.lanes()?, self.lanes()?, self.lanes()?);
                let bounds_n = [self.lanes()?, self.lanes()?];
                BaselineModel::Contact(Contact { surface_m, reach_m, exponent, parameters: self.row()?, bounds_n })
            }
            2 => BaselineModel::Wave(Wave { returning: self.lanes()?, impedance_n_s_m: self.lanes()? }),
            3 => BaselineModel::Returned { energy_j: self.lanes()? },
            4 => BaselineModel::Trend { force_n: self.lanes()?, rate_n_s: self.lanes()? },
            _ => BaselineModel::Forecast { force_n: self.lanes()? },
        })
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::impedance::{Baseline, Identifier, SLOTS, Sample, Settings};

    /// Parcels of two seconds of pressing, every rendering computed.
    fn parcels(baseline: Baseline) -> Vec<Parcel> {
        let modes = ModeSet::ALL.with(Mode::Baseline(baseline));
        let mut identifier = Identifier::new(&Settings { modes, delay_s: 0.05, ..Settings::default() }).unwrap();
        (0..2000_u32)
            .map(|i| {
                let t_s = f64::from(i) * 1e-3;
                let depth_m = 0.004 * (6.0 * t_s).sin();
                let position_m = Vector3::new(0.002 * (9.0 * t_s).cos(), 0.001 * (4.0 * t_s).sin(), -depth_m);
                let force_n = Vector3::new(0.3 * (9.0 * t_s).cos(), 0.0, 600.0 * depth_m.max(0.0));
                identifier.step(&Sample { t_s, position_m, force_n });
                *identifier.parcel()
            })
            .collect()
    }

    fn close(one: &Parcel, other: &Parcel) -> bool {
        // Every parameter to 32 bits: the debug text of both, number by number, would hide nothing, but it is slow.
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
            && std::mem::discriminant(&one.baseline) == std::mem::discriminant(&other.baseline)
    }

    #[test]
    fn every_model_arrives_as_it_was_packed() {
        for baseline in Baseline::ALL {
            let parcel = *parcels(baseline).last().unwrap();
            let mut arrived = Parcel { modes: parcel.modes, ..Parcel::BLANK };
            assert!(!close(&parcel, &arrived));
            let turns = Packed::turns(parcel.modes);
            assert_eq!(turns, 6);
            for turn in 0..turns {
                assert!(Packed::of(&parcel, turn).unwrap().put_into(&mut arrived), "turn {turn}");
            }
            assert!(close(&parcel, &arrived), "{baseline:?}");
            (0..SLOTS as u8).for_each(|slot| Packed::forget(slot, &mut arrived));
            assert_eq!(arrived, Parcel { modes: parcel.modes, ..Parcel::BLANK });
        }
    }

    #[test]
    fn a_set_without_parameters_has_none_to_send() {
        let parcel = Parcel { modes: ModeSet::only(Mode::Dfr), ..Parcel::BLANK };
        assert_eq!((Packed::turns(parcel.modes), Packed::of(&parcel, 0)), (0, None));
        assert_eq!(Packed::turns(ModeSet::only(Mode::Best)), 2);
    }

    #[test]
    fn what_makes_no_sense_changes_nothing() {
        let parcel = *parcels(Baseline::ModelMediated).last().unwrap();
        for turn in 0..6 {
            let good = Packed::of(&parcel, turn).unwrap();
            for at in 0..usize::from(good.len) {
                for bad in [f32::NAN, f32::INFINITY] {
                    let mut packed = good;
                    packed.numbers[at] = bad;
                    let mut arrived = parcel;
                    assert!(!packed.put_into(&mut arrived), "turn {turn}, number {at}");
                    assert_eq!(arrived, parcel);
                }
                let cut = Packed { len: at as u8, ..good };
                assert!(!cut.put_into(&mut parcel.clone()), "turn {turn}, cut at {at}");
            }
            assert!(!Packed { slot: Mode::Best.index() as u8, ..good }.put_into(&mut parcel.clone()));
        }
        let mut packed = Packed::of(&parcel, 3).unwrap();
        packed.numbers[0] = 17.0;
        assert!(!packed.put_into(&mut parcel.clone()), "no such form");
    }
}
