"""The simulated loop, step by step."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Dict, cast

import numpy as np
import numpy.typing as npt

from . import _nima
from ._arrays import Floats, as_floats

if TYPE_CHECKING:
    _Observation = Dict[str, Floats]

    class _Base:
        """Members of :class:`gymnasium.Env`, if it is installed."""

        np_random: np.random.Generator

        def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any: ...
else:
    _Observation = Dict[str, np.ndarray]
    try:
        from gymnasium import Env as _Base
    except ImportError:

        class _Base:
            """Replaces gymnasium.Env if it is not installed: only the seed."""

            def reset(self, *, seed=None, options=None):
                if seed is not None or not hasattr(self, "np_random"):
                    self.np_random = np.random.default_rng(seed)


CONTROLS: tuple[str, ...] = ("nothing", "handle_position", "handle_force", "rendered_force")
"""Kinds of actions; see :class:`Environment`."""

_HANDLE_MAX_M = 0.2
_FORCE_MAX_N = 20.0
_VECTORS = ("handle_m", "handle_m_s", "command_m", "delayed_tip_m", "delayed_n", "rendered_n")


class Environment(_Base):
    """The whole loop (handle, link, arm, tissue, identification, gates) on a simulated scene, on its own clock.

    ``reset`` and ``step`` follow gymnasium, which need not be installed; if it is, this is a ``gymnasium.Env``.

    Parameters
    ----------
    scene
        Name of a built-in scene that measures the force at the tip (``peg_transfer``, ``free_motion``, ``lumps``, ``rings``,
        ``find_lumps``, ``wire``, ``bimanual``, ...), or a TOML file.
    mode
        Rendering mode, one of :data:`nima.MODES`; by default the rig's. Not with ``control="rendered_force"``.
    delay_s
        One-way delay from follower to leader, s; by default the rig's.
    control
        Meaning of an action:

        ``"handle_position"``
            Position of the handle at the end of the step, (3,), m, in the workspace frame; reached in even steps, at
            1 m/s at most.
        ``"handle_force"``
            Force of your controller on the handle, (3,), N. The handle moves as the scene's mass of hand and handle under
            this force and the rendered force.
        ``"rendered_force"``
            Force in the hand, (3,), N, instead of a mode: your own rendering, through the same gates. It acts on the
            scene's simulated hand, which holds the handle.
        ``"nothing"``
            No action: the scene's hand moves the handle and a mode renders; call ``step()`` without an argument.

        In a scene with rings an action on the handle has a fourth number, the opening of the gripper (rad).
    substeps
        Ticks of the loop in one step: 1 for 1 kHz, 10 for 100 Hz with the simulated rig.
    rig
        Name or TOML file of a simulated rig: rate, gates, identification.
    max_seconds
        Time after which an episode is truncated, s; ``None`` for never.

    Notes
    -----
    The observation has the values available to a controller at the leader, each (3,), float64: ``handle_m``,
    ``handle_m_s``, ``command_m`` (commanded tip), ``delayed_tip_m`` and ``delayed_n`` (tip and force one delay ago), ``rendered_n``. A space of
    gymnasium has no NaN: until the first force has arrived over the link, ``delayed_n`` is 0 and ``info["has_force"]`` false.

    The reward is the fraction of the scene's task that was done in this step (0 in a scene without a task). ``terminated``: the
    task is done, or a fault of the loop ended the engagement (``info["fault"]``). ``info`` has values that only a simulation
    can provide: ``t_s``, ``state``, ``fault``, ``mode``, the current ``tip_m`` and ``measured_n``, ``asked_n`` (before the
    gates), ``gate`` (the first that acted), ``has_force`` (a force has arrived over the link), ``task``. An
    unknown ``measured_n`` is NaN.

    Deterministic: the same seed and actions give the same numbers to the last bit.

    Raises
    ------
    ValueError
        An unknown scene, rig, mode or control, a value out of its range, or a scene that measures at the wrist.
    """

    metadata: dict[str, Any] = {"render_modes": []}
    render_mode: str | None = None

    def __init__(
        self,
        scene: str = "peg_transfer",
        mode: str | None = None,
        delay_s: float | None = None,
        *,
        control: str = "handle_position",
        substeps: int = 1,
        rig: str = "simulated",
        max_seconds: float | None = 60.0,
    ) -> None:
        if max_seconds is not None and not max_seconds > 0.0:
            raise ValueError(f"max_seconds is {max_seconds}; give a time above 0, or None")
        if not 1 <= substeps <= 100_000:
            raise ValueError(f"substeps is {substeps}; it must be 1 to 100000")
        self._native = _nima.Simulation(scene, rig, mode, delay_s, control, substeps)
        self._control = control
        self._max_seconds = max_seconds
        self._begun_s = 0.0
        self._share = 0.0
        self._running = False
        self._set_spaces()

    @property
    def rate_hz(self) -> float:
        """Ticks of the loop per second, Hz."""
        return self._native.rate_hz

    @property
    def delay_s(self) -> float:
        """Delay of the link, s."""
        return self._native.delay_s

    @property
    def mode(self) -> str:
        """Current rendering mode."""
        return self._native.mode

    @property
    def ceiling_n(self) -> float:
        """Maximum force that passes the gates, N."""
        return self._native.ceiling_n

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[_Observation, dict[str, Any]]:
        """Restart and run until the arm is engaged.

        Parameters
        ----------
        seed
            Seed of the scene: tremor, sensor noise, hidden lumps. By default the next one is drawn.
        options
            Not used.

        Raises
        ------
        ValueError
            The scene cannot be engaged.
        """
        super().reset(seed=seed)
        if seed is None:
            seed = int(self.np_random.integers(0, 2**32))
        observation, info = self._native.reset(seed)
        self._begun_s = info["t_s"]
        self._share = 0.0 if info["task"] is None else info["task"]["share"]
        self._running = True
        return observation, info

    def step(
        self, action: npt.ArrayLike | None = None
    ) -> tuple[_Observation, float, bool, bool, dict[str, Any]]:
        """Do one step of ``substeps`` ticks: observation, reward, terminated, truncated, info.

        Raises
        ------
        ValueError
            An action of the wrong shape or with a number that is not finite; an episode that is over or has not begun.
        """
        if not self._running:
            raise ValueError("the episode is over or has not begun: call reset")
        numbers = np.empty(0) if action is None else as_floats("action", action).ravel()
        observation, info, engaged = self._native.step(numbers.tolist())
        task = info["task"]
        share = self._share if task is None else task["share"]
        reward, self._share = float(share - self._share), share
        terminated = not engaged or (task is not None and task["ended"])
        elapsed_s = info["t_s"] - self._begun_s
        truncated = self._max_seconds is not None and elapsed_s >= self._max_seconds - 1e-9
        self._running = not (terminated or truncated)
        return observation, reward, terminated, truncated, info

    def score(self) -> dict[str, Any] | None:
        """Returns the score of the episode so far, in the format of ``nima run --json``; ``None`` in a scene without a task,
        and on a second call: the first call ends the scoring."""
        score = self._native.score()
        return None if score is None else cast("dict[str, Any]", json.loads(score))

    def render(self) -> None:
        """Draws nothing: record the session and open it in the console."""

    def close(self) -> None:
        """Does nothing."""

    def _set_spaces(self) -> None:
        """Sets the spaces of gymnasium, if it is installed."""
        try:
            from gymnasium.spaces import Box, Dict
        except ImportError:
            return
        reach, jaws = self._reach()
        low, high = np.full(3, -reach), np.full(3, reach)
        if jaws:
            low, high = np.append(low, 0.0), np.append(high, _nima.Simulation.GRIP_MAX_RAD)
        if self._control == "nothing":
            low, high = np.empty(0), np.empty(0)
        self.action_space = Box(low, high, dtype=np.float64)
        self.observation_space = Dict({name: Box(-np.inf, np.inf, (3,), np.float64) for name in _VECTORS})

    def _reach(self) -> tuple[float, bool]:
        if self._control == "rendered_force":
            return _FORCE_MAX_N, False
        reach = _HANDLE_MAX_M if self._control == "handle_position" else _FORCE_MAX_N
        return reach, self._native.has_jaws
