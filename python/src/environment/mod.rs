//! The simulated loop, step by step; see `nima.Environment`.

mod handle;
mod link;
mod running;

use std::sync::{Mutex, PoisonError};

use nalgebra::Vector3;
use nima_core::impedance::Mode;
use nima_machine::{
    config::RigConfig,
    messages::LoopState,
    rig::{GRIP_MAX_RAD, SIDES},
    teleop::Calibrations,
};
use nima_simulation::{SimulationPlan, scene::Scene};
use numpy::PyArray1;
use pyo3::{prelude::*, types::PyDict};

use self::running::{ControllerAction, SimulationRun, StepObservation};
use crate::errors::{guarded, value};

/// The quantity that an external controller sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum EnvironmentControl {
    Nothing,
    HandlePosition,
    HandleForce,
    RenderedForce,
}

impl EnvironmentControl {
    const ALL: [(&'static str, Self); 4] = [
        ("nothing", Self::Nothing),
        ("handle_position", Self::HandlePosition),
        ("handle_force", Self::HandleForce),
        ("rendered_force", Self::RenderedForce),
    ];

    fn of(name: &str) -> PyResult<Self> {
        let known = Self::ALL.into_iter().find(|(known, _)| *known == name).map(|(_, control)| control);
        known.ok_or_else(|| {
            value(format_args!("control is {name:?}; give one of {}", Self::ALL.map(|(known, _)| known).join(", ")))
        })
    }
}

/// A loop with its simulated world.
#[pyclass(module = "nima._nima")]
pub(crate) struct Simulation {
    plan: SimulationPlan,
    control: EnvironmentControl,
    substeps: u32,
    has_jaws: bool,
    /// The lock is only for `PyO3`, which shares objects between threads: the queues of a run cannot be shared.
    running: Mutex<Option<SimulationRun>>,
}

/// Maximum number of ticks of a step.
const SUBSTEPS_MAX: u32 = 100_000;

#[pymethods]
impl Simulation {
    /// Reads the rig and the scene, and checks them.
    #[new]
    #[pyo3(signature = (scene, rig, mode, delay_s, control, substeps))]
    fn new(
        scene: &str,
        rig: &str,
        mode: Option<&str>,
        delay_s: Option<f64>,
        control: &str,
        substeps: u32,
    ) -> PyResult<Self> {
        let control = EnvironmentControl::of(control)?;
        if !(1..=SUBSTEPS_MAX).contains(&substeps) {
            return Err(value(format_args!("substeps is {substeps}; it must be 1 to {SUBSTEPS_MAX}")));
        }
        nima_score::provide_tasks();
        let scene = Scene::load(scene).map_err(value)?;
        let mut rig = RigConfig::load(rig).map_err(value)?;
        if rig.devices.is_some() || rig.desk.is_some() {
            return Err(value(format_args!("rig \"{}\" has devices; give a simulated one", rig.name)));
        }
        let mode: Option<Mode> = mode.map(str::parse).transpose().map_err(value)?;
        rig.mode = match (control, mode) {
            (EnvironmentControl::RenderedForce, None) => Mode::Dfr,
            (EnvironmentControl::RenderedForce, Some(mode)) => {
                return Err(value(format_args!(
                    "mode is {mode}, and control \"rendered_force\" renders the force itself; omit mode"
                )));
            }
            (_, mode) => mode.unwrap_or(rig.mode),
        };
        rig.identification.compare &= control != EnvironmentControl::RenderedForce;
        rig.delay_s = delay_s.unwrap_or(rig.delay_s);
        rig.validate().map_err(value)?;
        let calibrations: [Calibrations; SIDES] = Default::default();
        let has_jaws = scene.objects.is_some();
        let plan = SimulationPlan { rig, scene, calibrations, engage: true };
        if !plan.may_engage() {
            return Err(value(format_args!(
                "scene \"{}\" cannot be engaged: its force is measured at the wrist, which needs calibrations; give a scene that measures at the tip",
                plan.scene.name
            )));
        }
        Ok(Self { plan, control, substeps, has_jaws, running: Mutex::default() })
    }

    /// Returns the number of ticks per second.
    #[getter]
    fn rate_hz(&self) -> f64 {
        self.plan.rig.rate_hz
    }

    /// Returns the force limit of the gates, N.
    #[getter]
    fn ceiling_n(&self) -> f64 {
        self.plan.rig.gates.ceiling_n
    }

    /// Returns the delay of the link, s.
    #[getter]
    fn delay_s(&self) -> f64 {
        self.plan.rig.delay_s
    }

    /// Returns the active mode.
    #[getter]
    fn mode(&self) -> &'static str {
        self.plan.rig.mode.name()
    }

    /// Returns whether the instrument has jaws, whose opening is the last number of an action.
    #[getter]
    fn has_jaws(&self) -> bool {
        self.has_jaws
    }

    /// Maximum opening of the gripper, rad.
    #[classattr]
    const GRIP_MAX_RAD: f64 = GRIP_MAX_RAD;

    /// Restarts, and runs until the arm is engaged.
    fn reset<'py>(&mut self, py: Python<'py>, seed: Option<u64>) -> PyResult<(Bound<'py, PyDict>, Bound<'py, PyDict>)> {
        let mut plan = self.plan.clone();
        if let Some(seed) = seed {
            plan.scene.seed = seed;
            plan.scene = plan.scene.drawn_anew(seed);
        }
        let begin = || -> PyResult<(SimulationRun, StepObservation)> {
            let mut running = SimulationRun::new(&plan).map_err(value)?;
            let known = running.engage().map_err(value)?;
            Ok((running, known))
        };
        let (running, known) = guarded(|| py.detach(begin))?;
        *self.running() = Some(running);
        Ok((observation(py, &known)?, info(py, &known)?))
    }

    /// Runs one step; returns the observation, additional information, and whether the loop is still running.
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        action: Vec<f64>,
    ) -> PyResult<(Bound<'py, PyDict>, Bound<'py, PyDict>, bool)> {
        let (action, grip_rad) = self.action(&action)?;
        let substeps = self.substeps;
        let running = self.running().as_mut().ok_or_else(|| value("call reset before step"))?;
        let known = guarded(|| Ok(py.detach(|| running.step(action, grip_rad, substeps))))?;
        let known = known.ok_or_else(|| value("the scene has no right arm"))?;
        Ok((observation(py, &known)?, info(py, &known)?, known.tick.state == LoopState::Engaged))
    }

    /// Returns the score as JSON; `None` in a scene without a task, or after the first call.
    fn score(&mut self) -> PyResult<Option<String>> {
        let score = self.running().as_mut().and_then(SimulationRun::end);
        score.map(|score| serde_json::to_string(&score).map_err(value)).transpose()
    }
}

impl Simulation {
    fn running(&mut self) -> &mut Option<SimulationRun> {
        self.running.get_mut().unwrap_or_else(PoisonError::into_inner)
    }

    fn action(&self, numbers: &[f64]) -> PyResult<(ControllerAction, Option<f64>)> {
        let grips = self.has_jaws
            && matches!(self.control, EnvironmentControl::HandlePosition | EnvironmentControl::HandleForce);
        let needed = if self.control == EnvironmentControl::Nothing { 0 } else { 3 + usize::from(grips) };
        if numbers.len() != needed {
            return Err(value(format_args!("the action has {} numbers, {needed} are needed", numbers.len())));
        }
        if let Some(number) = numbers.iter().find(|number| !number.is_finite()) {
            return Err(value(format_args!("the action contains {number}; give finite numbers")));
        }
        let &[x, y, z, ..] = numbers else { return Ok((ControllerAction::Watch, None)) };
        let vector = Vector3::new(x, y, z);
        let action = match self.control {
            EnvironmentControl::Nothing => ControllerAction::Watch,
            EnvironmentControl::HandlePosition => ControllerAction::Place(vector),
            EnvironmentControl::HandleForce => ControllerAction::Push(vector),
            EnvironmentControl::RenderedForce => ControllerAction::Render(vector),
        };
        Ok((action, numbers.get(3).copied()))
    }
}

fn array<'py>(py: Python<'py>, vector: &Vector3<f64>) -> Bound<'py, PyArray1<f64>> {
    PyArray1::from_slice(py, vector.as_slice())
}

/// Returns the information available to a controller at the leader.
fn observation<'py>(py: Python<'py>, known: &StepObservation) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    let vectors = [
        ("handle_m", &known.handle_m),
        ("handle_m_s", &known.handle_m_s),
        ("command_m", &known.tick.positions.leader_m),
        ("delayed_tip_m", &known.delayed_tip_m),
        ("delayed_n", &known.delayed_n),
        ("rendered_n", &known.tick.rendering.rendered_n),
    ];
    for (name, vector) in vectors {
        all.set_item(name, array(py, vector))?;
    }
    Ok(all)
}

/// Returns additional information.
fn info<'py>(py: Python<'py>, known: &StepObservation) -> PyResult<Bound<'py, PyDict>> {
    let tick = &known.tick;
    let all = PyDict::new(py);
    all.set_item("t_s", tick.t_s)?;
    all.set_item("state", tick.state.word())?;
    let fault = if let LoopState::Faulted(fault) = tick.state { Some(format!("{fault:?}")) } else { None };
    all.set_item("fault", fault)?;
    all.set_item("mode", tick.mode.name())?;
    all.set_item("tip_m", array(py, &tick.positions.tip_m))?;
    all.set_item("measured_n", array(py, &tick.measured_n))?;
    all.set_item("asked_n", array(py, &tick.rendering.asked_n[tick.mode.index()]))?;
    all.set_item("gate", tick.gates.first_closed())?;
    all.set_item("has_force", known.has_force)?;
    let Some(training) = &known.training else {
        all.set_item("task", py.None())?;
        return Ok(all);
    };
    let task = PyDict::new(py);
    task.set_item("ended", training.ended)?;
    task.set_item("share", training.fraction)?;
    task.set_item("placed", training.placed)?;
    task.set_item("dropped", training.dropped)?;
    task.set_item("touches", training.touches)?;
    all.set_item("task", task)?;
    Ok(all)
}
