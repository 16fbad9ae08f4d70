"""Identification over arrays, frames and files."""

from __future__ import annotations

import json
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike, fspath
from typing import Any, TypedDict, cast

import numpy as np
import numpy.typing as npt

from . import _nima
from ._arrays import Floats, as_floats, columns, is_frame, line

MODES: tuple[str, ...] = tuple(_nima.modes())
"""All rendering modes: the program's own, then the baselines."""

GATES: tuple[str, ...] = (
    "open",
    "not_permitted",
    "validity",
    "age",
    "dead_band",
    "gain",
    "slew",
    "energy",
    "ceiling",
    "governor",
)
"""Names of the numbers in :attr:`Identification.gates`."""

_AXES = ("x", "y", "z")


class ErrorFigures(TypedDict):
    """Mean, standard deviation, 95th percentile and maximum of an error (units of the forces)."""

    mae: float
    sd: float
    p95: float
    max: float


class Figures(TypedDict):
    """The figures that ``nima identify --json`` prints."""

    samples: int
    rate_hz: float
    axes: list[str]
    mode: str
    own_motion: str
    window_ms: float
    delay_ms: float
    compared: int
    error: ErrorFigures
    hold: ErrorFigures
    reconstruction: dict[str, dict[str, float]]
    degree_share: list[float]
    nonlinear_share: float
    condition: dict[str, float]
    rejected: int
    holes: int
    longest_hole_s: float
    force_renewal_hz: float | None
    position_scale: float
    tick_us: dict[str, float]


class Parcels(TypedDict):
    """The follower's messages in each of ``n`` samples, for ``a`` axes.

    ``*_coefficients`` is the paper's ``M``: columns ``u, u', u'', ..., u^5, u'^5, u''^5`` (N per SI unit of the column).
    """

    literal_degree: npt.NDArray[np.uint8]
    literal_constant_n: Floats
    literal_coefficients: Floats
    linear_degree: npt.NDArray[np.uint8]
    linear_constant_n: Floats
    linear_coefficients: Floats
    anchored_motion: Floats
    anchored_constant_n: Floats
    anchored_gain: Floats
    anchored_degree: npt.NDArray[np.uint8]
    matched_degree: npt.NDArray[np.uint8]
    nima_degree: npt.NDArray[np.uint8]
    resting: npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Identification:
    """Result of :func:`identify` for ``n`` samples of ``a`` axes."""

    forces_n: Floats
    """Rendered force before the gates, shape (n, a): for time t, from data up to t - delay and the motion at t. NaN
    before the first data arrived, or if the mode has nothing valid."""
    held_n: Floats
    """Force measured one delay ago (delayed reflection), shape (n, a); NaN before the first."""
    degrees: npt.NDArray[np.uint8]
    """Degree used, shape (n,); 0 for no model."""
    conditions: Floats
    """Condition number of the scaled regression, shape (n,); 0 without a regression."""
    gates: npt.NDArray[np.uint8]
    """The first gate that would change this force, shape (n,): index into :data:`GATES`."""
    figures: Figures
    """The figures of ``nima identify --json``."""
    parcels: Parcels | None
    """The messages over the link in each sample, if requested."""

    @property
    def errors(self) -> dict[str, ErrorFigures]:
        """The error table: ``rendered`` and ``held`` force against the measured one; ``pandas.DataFrame(result.errors)``."""
        return {"rendered": self.figures["error"], "held": self.figures["hold"]}

    @property
    def ratio(self) -> float:
        """Mean error of the rendered force as a multiple of the held force's; NaN if that is exact."""
        held = self.figures["hold"]["mae"]
        return self.figures["error"]["mae"] / held if held > 0.0 else float("nan")

    def __str__(self) -> str:
        rows = (f"{name:<9}" + "".join(f"{row[key]:>12.5f}" for key in ("mae", "sd", "p95", "max"))
                for name, row in cast("dict[str, dict[str, float]]", self.errors).items())
        head = f"{'':<9}" + "".join(f"{key:>12}" for key in ("mean", "sd", "p95", "max"))
        return "\n".join([head, *rows, f"rendered / held {self.ratio:.3f}"])


@dataclass(frozen=True)
class Recording:
    """Motion and force of ``n`` samples and ``a`` axes, from a file."""

    times_s: Floats
    """Times, shape (n,), s."""
    rate_hz: float
    """One over the median time step, Hz."""
    axes: list[str]
    """Names of the axes, from ``x``, ``y``, ``z``."""
    positions_m: Floats
    """Positions of the tip, shape (n, a), m."""
    forces_n: Floats
    """Forces at the tip, shape (n, a), N."""
    leader_positions_m: Floats | None
    """The leader's own motion, shape (n, a), m, if it was mapped."""
    notes: list[str] = field(default_factory=list)
    """Data that a session lacks, one line each; empty for a complete one, and for a table."""


def read_recording(
    path: str | PathLike[str],
    *,
    map: Mapping[str, str] | Sequence[str] = (),
    arm: str | None = None,
) -> Recording:
    """Read a table (CSV) or an arm of a session (.mcap), as ``nima identify`` does. Warn of data that the session lacks.

    Parameters
    ----------
    path
        CSV file with ``t_s``, ``x_m, y_m, z_m`` and ``fx_n, fy_n, fz_n`` (one to three axes), or a session.
    map
        Other column names with an optional factor: ``{"x": "px_mm*0.001"}`` or ``["x=px_mm*0.001"]``; for three axes at
        once ``{"xyz": "px_mm,py_mm,pz_mm*0.001"}``; ``lx``, ``ly``, ``lz`` or ``lxyz`` for the leader's own motion.
    arm
        ``"right"`` or ``"left"``, for a session with both arms.

    Raises
    ------
    OSError
        The file cannot be read.
    ValueError
        A column is missing, a field is not a number, or time does not increase; the error names the line.
    """
    recording = Recording(**_nima.read_recording(path, _map_texts(map), arm))
    for note in recording.notes:
        warnings.warn(f"{fspath(path)}: {note}", stacklevel=2)
    return recording


def identify(
    positions_m: Any,
    forces_n: npt.ArrayLike | None = None,
    rate_hz: float | None = None,
    delay_s: float = 0.0,
    *,
    mode: str = "best",
    times_s: npt.ArrayLike | None = None,
    leader_positions_m: npt.ArrayLike | None = None,
    map: Mapping[str, str] | Sequence[str] = (),
    window_s: float = 0.3,
    max_degree: int = 5,
    cross_talk: bool = False,
    reading: str = "increments",
    choice: str = "window",
    constant: bool = False,
    ridge: float = 0.0,
    parcels: bool = False,
) -> Identification:
    """Identify the impedance sample by sample, from past data only, and render the force that a leader behind a link of
    ``delay_s`` would feel.

    Source: ``nima_study::replay``, the function behind ``nima identify``; the results agree to the last bit.

    Parameters
    ----------
    positions_m
        Positions of the tip in m, shape (n,) or (n, axes) with one to three axes, C or Fortran order or any view; float64
        is not copied. Or a :class:`Recording`, or a frame (pandas, polars) with the columns of a recording.
    forces_n
        Forces at the tip in N, of the same shape. Omit them with a recording or a frame.
    rate_hz
        Samples per second, 20 to 10000; by default computed from ``times_s``. Arrays need one of the two.
    delay_s
        One-way delay of the link, s, 0 to 1.
    mode
        One of :data:`MODES`.
    times_s
        Rising times of the samples, shape (n,), s. A step longer than 0.05 s (and ten periods) is a gap: nothing is
        identified or rendered across it. By default the samples are evenly spaced.
    leader_positions_m
        The leader's own motion in the same samples, mapped to the tip, m. The force is then computed from it, as in the loop
        with ``own_motion = "handle"``.
    map
        Columns of a frame; see :func:`read_recording`.
    window_s
        Length of the identification window, s; 10 to 10000 samples.
    max_degree
        Highest polynomial degree, 1 to 5.
    cross_talk
        The force on each axis may depend on the motion of all axes (matched and best; slower).
    reading, choice, constant, ridge
        How *literal* and *linear* interpret the paper: ``"increments"`` or ``"displacement"``; ``"window"`` or ``"next"``; a free
        constant force; ridge per row of the window, 0 to 1e6.
    parcels
        Return the messages over the link in each sample, too.

    Returns
    -------
    Identification

    Raises
    ------
    ValueError
        Wrong shape, a value that is not finite, a time that does not increase, or a setting out of its range.
    """
    axes: list[str] | None = None
    times: Floats | None
    leader: list[Floats] | None
    if isinstance(positions_m, Recording):
        recording = positions_m
        _only_one_source(forces_n, map)
        if times_s is not None or leader_positions_m is not None:
            raise ValueError("times_s and leader_positions_m are part of the recording: omit them")
        axes, rate_hz = recording.axes, recording.rate_hz if rate_hz is None else rate_hz
        positions, forces = columns("positions_m", recording.positions_m), columns("forces_n", recording.forces_n)
        times = recording.times_s
        leader = None if recording.leader_positions_m is None else columns("leader", recording.leader_positions_m)
    elif is_frame(positions_m):
        if forces_n is not None or times_s is not None or leader_positions_m is not None:
            raise ValueError("positions_m is a frame, which has everything: name its columns with map")
        axes, times, positions, forces, leader = _of_frame(positions_m, map)
    else:
        if forces_n is None:
            raise ValueError("forces_n is missing: give one force for each position")
        if map:
            raise ValueError("map names columns of a frame, and positions_m is an array: omit it")
        positions, forces = columns("positions_m", positions_m), columns("forces_n", forces_n)
        times = None if times_s is None else line("times_s", times_s)
        leader = None if leader_positions_m is None else columns("leader_positions_m", leader_positions_m)
    if rate_hz is None:
        if times is None:
            raise ValueError("rate_hz and times_s are missing: give one of them")
        rate_hz = _nima.rate_of(times)
    places = range(len(positions)) if axes is None else [_AXES.index(axis) for axis in axes]
    result = _nima.identify(
        positions,
        forces,
        times_s=times,
        rate_hz=float(rate_hz),
        leader_positions_m=leader,
        axes=list(places),
        mode=mode,
        delay_s=float(delay_s),
        window_s=float(window_s),
        max_degree=max_degree,
        cross_talk=cross_talk,
        reading=reading,
        choice=choice,
        constant=constant,
        ridge=float(ridge),
        parcels=parcels,
    )
    figures = cast(Figures, json.loads(result.pop("figures")))
    return Identification(figures=figures, **result)


def _only_one_source(forces_n: Any, map: Any) -> None:
    if forces_n is not None:
        raise ValueError("forces_n is part of the recording: omit it")
    if map:
        raise ValueError("map is for read_recording: omit it")


def _map_texts(map: Mapping[str, str] | Sequence[str]) -> list[str]:
    if isinstance(map, str):
        return [map]
    if isinstance(map, Mapping):
        return [f"{name}={source}" for name, source in map.items()]
    return list(map)


def _sources(map: Mapping[str, str] | Sequence[str]) -> dict[str, tuple[str, float]]:
    """Returns column and factor of each mapped quantity, checked by the program's own parser."""
    return {quantity: (column, scale) for quantity, column, scale in _nima.parse_map(_map_texts(map))}


def _of_frame(
    frame: Any, map: Mapping[str, str] | Sequence[str]
) -> tuple[list[str], Floats, list[Floats], list[Floats], list[Floats] | None]:
    """Returns axes, times, positions, forces and the leader's motion of a frame, as if read from its CSV file."""
    mapped = _sources(map)
    names = [str(name) for name in frame.columns]

    def has(quantity: str) -> bool:
        return quantity in mapped or quantity in names

    def column(quantity: str) -> Floats:
        name, scale = mapped.get(quantity, (quantity, 1.0))
        if name not in names:
            known, key = ", ".join(names), quantity.rsplit("_", 1)[0]
            raise ValueError(
                f'the frame has no column "{name}"; its columns are {known}; name another with map={{"{key}": "COLUMN"}}'
            )
        values = as_floats(f'column "{name}"', frame[name])
        return values if scale == 1.0 else values * scale

    found = [axis for axis in _AXES if has(f"{axis}_m") or has(f"f{axis}_n") or f"l{axis}_m" in mapped] or ["x"]
    has_leader = any(f"l{axis}_m" in mapped for axis in _AXES)
    return (
        found,
        column("t_s"),
        [column(f"{axis}_m") for axis in found],
        [column(f"f{axis}_n") for axis in found],
        [column(f"l{axis}_m") for axis in found] if has_leader else None,
    )
