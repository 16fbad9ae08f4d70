"""Fits of gravity and of the correspondence between two sensors."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, TypedDict, cast

import numpy.typing as npt

from . import _nima
from ._arrays import Floats, optional_table, table


class GravityReport(TypedDict):
    """The report of ``nima calibrate gravity --json``. Only a model with the verdict ``accepted`` may be used."""

    verdict: str
    reason: str
    chosen: str | None
    poses: int
    source: str
    outliers: list[int]
    coverage: float
    condition: float | None
    mass_kg: float | None
    com_m: list[float] | None
    folds: int
    drift_n: float | None
    fits: list[dict[str, Any]]


class CorrespondenceReport(TypedDict):
    """The report of ``nima calibrate correspondence --json``. Only a rotation with the verdict ``accepted`` may be used."""

    verdict: str
    reason: str
    pairs: int
    weak: list[int]
    outliers: list[int]
    excitation: dict[str, Any]
    solution: dict[str, Any] | None


def fit_gravity(
    forces_n: npt.ArrayLike,
    torques_nm: npt.ArrayLike | None = None,
    *,
    accelerations_m_s2: npt.ArrayLike | None = None,
    world_from_sensor_wxyz: npt.ArrayLike | None = None,
    model: str | None = None,
    flip_imu: bool = False,
) -> GravityReport:
    """Fit weight, centre of mass and bias to still poses of the tool, and judge the fit on held-out poses.

    Source: ``nima_core::calibration::gravity::fit``.

    Parameters
    ----------
    forces_n, torques_nm
        Mean readings of the wrist sensor in each pose, shape (n, 3), N and Nm, in the sensor's frame.
    accelerations_m_s2
        Mean readings of the accelerometer at rest, shape (n, 3), m/s^2. Either these
    world_from_sensor_wxyz
        or the orientation of the sensor by the arm, shape (n, 4), unit quaternions w, x, y, z.
    model
        ``"physical"``, ``"gain"`` or ``"paper"``; by default physical, or gain if the poses clearly support it.
    flip_imu
        The accelerometer's vector points down at rest, not up.

    Raises
    ------
    ValueError
        Wrong shape, a number that is not finite, an invalid quaternion, or an accelerometer without signal. Poses that
        determine nothing or fit badly do not raise: the verdict says so, with its reason.
    """
    report = _nima.fit_gravity(
        table("forces_n", forces_n),
        optional_table("torques_nm", torques_nm),
        optional_table("accelerations_m_s2", accelerations_m_s2),
        optional_table("world_from_sensor_wxyz", world_from_sensor_wxyz),
        model,
        flip_imu,
    )
    return cast(GravityReport, json.loads(report))


def remove_gravity(
    model: GravityReport | Mapping[str, Any],
    forces_n: npt.ArrayLike,
    torques_nm: npt.ArrayLike | None = None,
    *,
    accelerations_m_s2: npt.ArrayLike | None = None,
    world_from_sensor_wxyz: npt.ArrayLike | None = None,
) -> tuple[Floats, Floats | None]:
    """Remove weight and bias from readings; returns forces and torques (``None`` if none were given), shape (n, 3).

    The loop's low-pass is not applied, so that each row depends on itself only.

    Parameters
    ----------
    model
        A report of :func:`fit_gravity` with a chosen model, or the model itself (``report["fits"][i]["model"]``).
    forces_n, torques_nm, accelerations_m_s2, world_from_sensor_wxyz
        See :func:`fit_gravity`; the source of orientation must be the model's.

    Raises
    ------
    ValueError
        No model was chosen, wrong shape, a number that is not finite, or the model's source of orientation is missing.
    """
    if "fits" in model:
        chosen = [fit["model"] for fit in model["fits"] if fit["kind"] == model["chosen"]]
        if not chosen:
            raise ValueError(f"the report has no chosen model: {model['reason']}")
        model = chosen[0]
    return _nima.remove_gravity(
        json.dumps(model),
        table("forces_n", forces_n),
        optional_table("torques_nm", torques_nm),
        optional_table("accelerations_m_s2", accelerations_m_s2),
        optional_table("world_from_sensor_wxyz", world_from_sensor_wxyz),
    )


def fit_correspondence(
    wrist_forces_n: npt.ArrayLike,
    tissue_forces_n: npt.ArrayLike,
    *,
    sensor_from_camera_wxyz: npt.ArrayLike | None = None,
    flip_tissue: bool = False,
) -> CorrespondenceReport:
    """Fit the rotation between the sensor under the tissue and the sensor at the wrist to pushes that both measured.

    Source: ``nima_core::calibration::correspondence::fit``.

    Parameters
    ----------
    wrist_forces_n, tissue_forces_n
        Forces of both sensors in each push, shape (n, 3), N, in their own frames; wrist forces without gravity.
    sensor_from_camera_wxyz
        The known part of the chain in each push, shape (n, 4), unit quaternions w, x, y, z; needed if the wrist turned
        between the pushes.
    flip_tissue
        The sensor under the tissue measures the force on the tissue, not on the instrument.

    Raises
    ------
    ValueError
        Wrong shape, or an invalid force or rotation. Pushes that determine nothing do not raise: the verdict says so.
    """
    report = _nima.fit_correspondence(
        table("wrist_forces_n", wrist_forces_n),
        table("tissue_forces_n", tissue_forces_n),
        optional_table("sensor_from_camera_wxyz", sensor_from_camera_wxyz),
        flip_tissue,
    )
    return cast(CorrespondenceReport, json.loads(report))
