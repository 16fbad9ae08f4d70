//! The paper's model in the identifier: its window, its solutions, and what is sent and reported of them.

use nalgebra::Vector3;

use super::{
    MAX_DEGREE,
    features::Features,
    gram::Gram,
    literal::LiteralSolver,
    messages::{Parcel, Report, active},
    recipe::{Choice, Next},
    settings::Settings,
    window::{SlidingWindow, Summary as _},
};
use crate::signal::Lanes;

#[derive(Clone, Debug)]
pub(super) struct Paper {
    window: SlidingWindow<Gram>,
    solver: LiteralSolver,
    /// Where the degree is chosen by what comes after the window.
    next: Option<Next>,
}

impl Paper {
    /// Up to this degree, by the recipe of the settings.
    pub(super) fn new(degree: usize, settings: &Settings) -> Self {
        let recipe = &settings.literal;
        let one = active(&Vector3::repeat(1.0), settings.axes);
        let empty = if recipe.constant { Gram::with_constant(3 * degree, one) } else { Gram::new(3 * degree) };
        Self {
            window: SlidingWindow::new(settings.block(), empty.clone(), empty),
            solver: LiteralSolver::new(degree, settings.axes, recipe, &settings.scales),
            next: (recipe.choice == Choice::Next).then(|| Next::new(settings.rate_hz)),
        }
    }

    /// Takes the paper's `X` and the force (N); `usable`: both were measured.
    pub(super) fn step(
        &mut self,
        x: &Features,
        force_n: Lanes,
        usable: bool,
        parcel: &mut Parcel,
        report: &mut Report,
    ) {
        let Self { window, solver, next } = self;
        let row = if usable { window.current().row(x, force_n) } else { Gram::BLANK_ROW };
        window.push(&row);
        if !window.is_full() {
            return;
        }
        solver.solve(window.current(), window.len());
        let choice = match next {
            Some(next) => next.step(usable.then_some((x, force_n)), solver),
            None => solver.choice(),
        };
        parcel.linear = *solver.model(1);
        parcel.literal = *solver.model(choice);
        report.paper_degree = choice as u8;
        report.literal_failures = solver.failures();
        for degree in 1..=MAX_DEGREE {
            report.reconstruction_n[degree - 1] = (force_n - solver.model(degree).product(x)).vector();
        }
    }

    pub(super) const fn solver(&self) -> &LiteralSolver {
        &self.solver
    }

    pub(super) fn reset(&mut self) {
        self.window.reset();
        self.solver.reset();
        self.next.iter_mut().for_each(Next::reset);
    }
}
