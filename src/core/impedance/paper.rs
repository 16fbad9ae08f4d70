//! The paper's model in the identifier: its window, its solutions, and the data that are sent and reported.

use nalgebra::Vector3;

use super::{
    MAX_DEGREE, Mode,
    gram::Gram,
    literal::LiteralSolver,
    messages::{Parcel, Report, active},
    method::{Method, Seen},
    recipe::{Choice, Next},
    settings::{ModeSet, Settings},
    window::{SlidingWindow, Summary as _},
};

#[derive(Clone, Debug)]
pub(super) struct Paper {
    mode: Mode,
    window: SlidingWindow<Gram>,
    solver: LiteralSolver,
    /// Used if the degree is chosen by the data after the window.
    next: Option<Next>,
}

impl Paper {
    /// Creates the model for the mode literal, or for linear alone, by the recipe of the settings.
    pub(super) fn new(mode: Mode, settings: &Settings) -> Self {
        let degree = if mode == Mode::Linear { 1 } else { settings.max_degree };
        let recipe = &settings.literal;
        let one = active(&Vector3::repeat(1.0), settings.axes);
        let empty = if recipe.constant { Gram::with_constant(3 * degree, one) } else { Gram::new(3 * degree) };
        Self {
            mode,
            window: SlidingWindow::new(settings.block(), empty.clone(), empty),
            solver: LiteralSolver::new(degree, settings.axes, recipe, &settings.scales),
            next: (recipe.choice == Choice::Next).then(|| Next::new(settings.rate_hz)),
        }
    }

    pub(super) const fn solver(&self) -> &LiteralSolver {
        &self.solver
    }
}

impl Method for Paper {
    fn serves(&self, modes: ModeSet) -> bool {
        modes.contains(self.mode) && (self.mode == Mode::Literal || !modes.contains(Mode::Literal))
    }

    /// Literal and linear read the same window: it restarts when either begins, and when literal ends.
    fn begins(&self, before: ModeSet, now: ModeSet) -> bool {
        let begins = |mode: Mode| now.contains(mode) && !before.contains(mode);
        let ends = before.contains(Mode::Literal) && !now.contains(Mode::Literal);
        begins(Mode::Literal) || begins(Mode::Linear) || ends
    }

    fn take(&mut self, seen: &Seen<'_>, parcel: &mut Parcel, report: &mut Report) {
        if !seen.learn {
            return;
        }
        let Self { window, solver, next, .. } = self;
        let row = if seen.usable { window.current().row(seen.x, seen.force_n) } else { Gram::BLANK_ROW };
        window.push(&row);
        if !window.is_full() {
            return;
        }
        solver.solve(window.current(), window.len());
        let choice = match next {
            Some(next) => next.step(seen.usable.then_some((seen.x, seen.force_n)), solver),
            None => solver.choice(),
        };
        parcel.linear = *solver.model(1);
        parcel.literal = *solver.model(choice);
        report.paper_degree = choice as u8;
        report.literal_failures = solver.failures();
        for degree in 1..=MAX_DEGREE {
            report.reconstruction_n[degree - 1] = (seen.force_n - solver.model(degree).product(seen.x)).vector();
        }
    }

    fn reset(&mut self) {
        self.window.reset();
        self.solver.reset();
        self.next.iter_mut().for_each(Next::reset);
    }
}
