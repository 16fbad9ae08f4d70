"""Impedance identification, calibration, sessions and the simulated loop of the nima console.

Everything here calls the same code as the program ``nima``: results agree to the last bit. Research software, not for
clinical use.

Units are SI (m, s, N, rad) and part of the names. Arrays are float64; float64 input is read without a copy.
Unusable values raise :class:`ValueError`, unreadable files :class:`OSError`, each with one line: what failed, where,
and what to do.
"""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version as _version

from ._calibration import (
    CorrespondenceReport,
    GravityReport,
    fit_correspondence,
    fit_gravity,
    remove_gravity,
)
from ._environment import Environment
from ._identification import (
    GATES,
    MODES,
    ErrorFigures,
    Figures,
    Identification,
    Parcels,
    Recording,
    identify,
    read_recording,
)
from ._session import Event, Session, Ticks
from ._tip_force import Estimates, TipForce, TipForceModel
from ._watching import ArmNow, Now, Watching, watch

try:
    __version__ = _version("nima-haptics")
except PackageNotFoundError:  # not installed: run from the source
    __version__ = "unknown"

__all__ = [
    "GATES",
    "MODES",
    "ArmNow",
    "CorrespondenceReport",
    "Environment",
    "ErrorFigures",
    "Estimates",
    "Event",
    "Figures",
    "GravityReport",
    "Identification",
    "Now",
    "Parcels",
    "Recording",
    "Session",
    "Ticks",
    "TipForce",
    "TipForceModel",
    "Watching",
    "fit_correspondence",
    "fit_gravity",
    "identify",
    "read_recording",
    "remove_gravity",
    "watch",
]
