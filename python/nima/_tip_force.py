"""The network that removes the trocar's friction from the wrist force."""

from __future__ import annotations

import json
from dataclasses import dataclass
from os import PathLike
from typing import Any, cast

import numpy as np
import numpy.typing as npt

from . import _nima
from ._arrays import Floats, line, table


@dataclass(frozen=True)
class Estimates:
    """Predictions of a network for ``n`` rows and ``k`` outputs."""

    output: Floats
    """Shape (n, k), in the outputs' own units; zero for unusable inputs."""
    spread: Floats
    """Largest deviation of a member of the ensemble from the mean, shape (n, k)."""
    doubt: Floats
    """Distance from the training data, shape (n,); 1 is the limit, infinite for unusable inputs."""
    in_doubt: npt.NDArray[np.bool_]
    """Whether a prediction is unreliable, shape (n,)."""


@dataclass(frozen=True)
class TipForce:
    """Force at the tip for ``n`` samples, computed as in the loop."""

    forces_n: Floats
    """Force of the tissue on the tip, shape (n, 3), N, in the wrist sensor's frame."""
    network_share: Floats
    """Weight of the network in it, shape (n,), 0 to 1; the rest is the fallback."""
    doubt: Floats
    """Distance from the training data, shape (n,); 1 is the limit, infinite before the instrument has moved."""


class TipForceModel:
    """A network written by ``nima train tip-force``.

    Parameters
    ----------
    path
        File (.safetensors).

    Raises
    ------
    OSError
        The file cannot be read.
    ValueError
        It is not a network of this program.
    """

    def __init__(self, path: str | PathLike[str]) -> None:
        self._native = _nima.TipForceModel(path)

    @property
    def inputs(self) -> list[str]:
        """Names of the inputs, with their units."""
        return self._native.inputs

    @property
    def outputs(self) -> list[str]:
        """Names of the outputs, with their units."""
        return self._native.outputs

    @property
    def origin(self) -> dict[str, Any]:
        """Origin of the network: files, settings, errors, sensor and tool."""
        return cast("dict[str, Any]", json.loads(self._native.origin))

    def estimate(self, inputs: npt.ArrayLike) -> Estimates:
        """Predict row by row; ``inputs`` has the shape (n, len(self.inputs)). Computed in float32, as in the loop.

        Raises
        ------
        ValueError
            Wrong number of columns, or a number that is not finite.
        """
        return Estimates(**self._native.estimate(table("inputs", inputs)))

    def infer(
        self,
        times_s: npt.ArrayLike,
        forces_n: npt.ArrayLike,
        torques_nm: npt.ArrayLike,
        world_from_sensor_wxyz: npt.ArrayLike,
        insertion_m: npt.ArrayLike,
        *,
        fallback: str = "wrist_force",
    ) -> TipForce:
        """Infer the force at the tip sample by sample, as the loop does.

        Parameters
        ----------
        times_s
            Rising times, shape (n,), s; after a gap of more than 20 ms the direction of friction is unknown.
        forces_n, torques_nm
            Gravity-free wrench at the wrist, shape (n, 3), N and Nm, in the sensor's frame.
        world_from_sensor_wxyz
            Orientation of the sensor, shape (n, 4), unit quaternions w, x, y, z.
        insertion_m
            Depth of the instrument through the trocar, shape (n,), m.
        fallback
            Force while the network is in doubt: ``"wrist_force"`` or ``"hold_and_fade"``.

        Raises
        ------
        ValueError
            Wrong shape, a number that is not finite, or a network with inputs that the loop does not have.
        """
        result = self._native.infer(
            line("times_s", times_s),
            table("forces_n", forces_n),
            table("torques_nm", torques_nm),
            table("world_from_sensor_wxyz", world_from_sensor_wxyz),
            line("insertion_m", insertion_m),
            fallback,
        )
        return TipForce(**result)
