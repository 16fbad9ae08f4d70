//! The paper's model in the identifier: its window, its solutions, and the data that are sent and reported.

use nalgebra::Vector3;

use super::{
    MAX_DEGREE, Mode, Models,
    features::{ImpedanceFeatures, MOTION_COLUMNS},
    gram::Gram,
    literal::LiteralSolver,
    messages::{IdentificationReport, LinkPacket, active},
    method::{FollowerEnd, LeaderEnd, LeaderInput, MethodInput, Place, RenderingMethod},
    packed::{PackedNumbers, PackedReader, PackedWriter},
    recipe::{DegreeChoice, NextDegree},
    settings::{ImpedanceSettings, ModeSet},
    window::{SlidingWindow, WindowSummary as _},
};
use crate::signal::Lanes;

/// The paper to the letter.
#[derive(Clone, Debug)]
pub(super) struct Literal;

impl RenderingMethod for Literal {
    const NAME: &'static str = "literal";
    const ABOUT: &'static str = ABOUT;
    const HAS_WINDOW: bool = true;
    const HAS_DEGREES: bool = true;
    const PARAMETERS: Option<Place> = Some(|models| &mut models.literal);

    fn follower(settings: &ImpedanceSettings, _delay_ticks: usize) -> Option<Box<dyn FollowerEnd>> {
        Some(Box::new(PaperMethod::new(Mode::Literal, settings)))
    }

    fn leader(_settings: &ImpedanceSettings) -> Box<dyn LeaderEnd> {
        Box::new(Self)
    }

    fn degree(report: &IdentificationReport) -> u8 {
        report.degrees.paper
    }

    fn note(models: &Models, report: &mut IdentificationReport) {
        report.degrees.paper = models.literal.degree;
    }
}

impl LeaderEnd for Literal {
    fn render(&mut self, moment: &LeaderInput<'_>) -> Option<Lanes> {
        moment.parcel.models.literal.force(moment.x)
    }
}

/// The paper's linear model.
#[derive(Clone, Debug)]
pub(super) struct Linear;

impl RenderingMethod for Linear {
    const NAME: &'static str = "linear";
    const ABOUT: &'static str = ABOUT;
    const HAS_WINDOW: bool = true;
    const PARAMETERS: Option<Place> = Some(|models| &mut models.linear);

    fn follower(settings: &ImpedanceSettings, _delay_ticks: usize) -> Option<Box<dyn FollowerEnd>> {
        Some(Box::new(PaperMethod::new(Mode::Linear, settings)))
    }

    fn leader(_settings: &ImpedanceSettings) -> Box<dyn LeaderEnd> {
        Box::new(Self)
    }

    fn degree(report: &IdentificationReport) -> u8 {
        // The degree of linear is always 1.
        u8::from(report.degrees.paper > 0)
    }
}

impl LeaderEnd for Linear {
    fn render(&mut self, moment: &LeaderInput<'_>) -> Option<Lanes> {
        moment.parcel.models.linear.force(moment.x)
    }
}

const ABOUT: &str = "at the horizon; the paper tests within the window only";

/// Parameters of the paper's model `f = M X`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiteralModel {
    /// Degree `N`; 0: none could be solved.
    pub degree: u8,
    /// Constant force (N); zero unless the recipe has one.
    pub constant_n: Lanes,
    /// `M`: the first `3 N` are in use, N per SI unit of the feature.
    pub coefficients: [Lanes; MOTION_COLUMNS],
}

impl LiteralModel {
    /// No model.
    pub const NONE: Self = Self { degree: 0, constant_n: Lanes::ZERO, coefficients: [Lanes::ZERO; MOTION_COLUMNS] };

    /// Returns `M X` (N), with `X` in SI units as defined by the recipe.
    #[inline]
    pub(super) fn product(&self, x: &ImpedanceFeatures) -> Lanes {
        let terms = self.coefficients.iter().zip(x).take(3 * usize::from(self.degree));
        terms.fold(self.constant_n, |sum, (m, x)| sum + *m * *x)
    }

    /// Returns the same; `None` without a model or where the product is not finite.
    pub(super) fn force(&self, x: &ImpedanceFeatures) -> Option<Lanes> {
        let force = self.product(x);
        (self.degree > 0 && force.is_finite()).then_some(force)
    }
}

impl PackedNumbers for LiteralModel {
    const NONE: Self = Self::NONE;

    fn write(&self, row: &mut PackedWriter<'_>) {
        row.put(f64::from(self.degree));
        row.lanes(self.constant_n);
        row.row(&self.coefficients);
    }

    fn read(row: &mut PackedReader<'_>) -> Option<Self> {
        Some(Self { degree: row.count(MAX_DEGREE)? as u8, constant_n: row.lanes()?, coefficients: row.row()? })
    }
}

#[derive(Clone, Debug)]
pub(super) struct PaperMethod {
    mode: Mode,
    window: SlidingWindow<Gram>,
    solver: LiteralSolver,
    /// Used if the degree is chosen by the data after the window.
    next: Option<NextDegree>,
}

impl PaperMethod {
    /// Creates the model for the mode literal, or for linear alone, with the recipe in the settings.
    pub(super) fn new(mode: Mode, settings: &ImpedanceSettings) -> Self {
        // Linear is the paper's predecessor with degree 1 (IMA).
        let degree = if mode == Mode::Linear { 1 } else { settings.max_degree };
        let recipe = &settings.literal;
        let one = active(&Vector3::repeat(1.0), settings.axes);
        let empty = if recipe.constant { Gram::with_constant(3 * degree, one) } else { Gram::new(3 * degree) };
        Self {
            mode,
            window: SlidingWindow::new(settings.block(), empty.clone(), empty),
            solver: LiteralSolver::new(degree, settings.axes, recipe, &settings.scales),
            next: (recipe.choice == DegreeChoice::Next).then(|| NextDegree::new(settings.rate_hz)),
        }
    }
}

impl FollowerEnd for PaperMethod {
    fn serves(&self, modes: ModeSet) -> bool {
        // Literal contains the linear model, so a separate window is needed only without literal.
        modes.contains(self.mode) && (self.mode == Mode::Literal || !modes.contains(Mode::Literal))
    }

    /// Literal and linear use the same window: it restarts when either begins, and when literal ends.
    fn begins(&self, before: ModeSet, now: ModeSet) -> bool {
        let begins = |mode: Mode| now.contains(mode) && !before.contains(mode);
        let ends = before.contains(Mode::Literal) && !now.contains(Mode::Literal);
        begins(Mode::Literal) || begins(Mode::Linear) || ends
    }

    fn take(&mut self, seen: &MethodInput<'_>, parcel: &mut LinkPacket, report: &mut IdentificationReport) {
        // The window stops with the identification: rest would fill it with rows that say nothing.
        if !seen.learn {
            return;
        }
        let Self { window, solver, next, .. } = self;
        let row = if seen.usable { window.current().row(seen.x, seen.force_n) } else { Gram::BLANK_ROW };
        window.push(&row);
        // The paper fits whole windows; the first 300 ms have no fit.
        if !window.is_full() {
            return;
        }
        solver.solve(window.current(), window.len());
        let choice = match next {
            Some(next) => next.step(seen.usable.then_some((seen.x, seen.force_n)), solver),
            None => solver.choice(),
        };
        parcel.models.linear = *solver.model(1);
        parcel.models.literal = *solver.model(choice);
        report.degrees.paper = choice as u8;
        report.failures.literal_solves = solver.failures();
        for degree in 1..=MAX_DEGREE {
            // In the report only: the reconstruction at the newest sample, as the paper evaluates it.
            report.reconstruction_n[degree - 1] = (seen.force_n - solver.model(degree).product(seen.x)).vector();
        }
    }

    fn reset(&mut self) {
        self.window.reset();
        self.solver.reset();
        self.next.iter_mut().for_each(NextDegree::reset);
    }

    fn paper(&self) -> Option<&LiteralSolver> {
        Some(&self.solver)
    }
}
