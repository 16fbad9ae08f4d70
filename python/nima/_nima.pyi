"""The compiled part of the package; call it through the functions of ``nima``."""

from os import PathLike
from typing import Any, ClassVar, TypedDict, final

import numpy as np
import numpy.typing as npt

_Floats = npt.NDArray[np.float64]

class _Estimates(TypedDict):
    output: _Floats
    spread: _Floats
    doubt: _Floats
    in_doubt: npt.NDArray[np.bool_]

class _TipForce(TypedDict):
    forces_n: _Floats
    network_share: _Floats
    doubt: _Floats

class _Ticks(TypedDict):
    t_s: _Floats
    time_ns: npt.NDArray[np.uint64]
    tip_m: _Floats
    leader_m: _Floats
    measured_n: _Floats
    delayed_n: _Floats
    asked_n: _Floats
    rendered_n: _Floats
    state: list[str]

class _Recording(TypedDict):
    times_s: _Floats
    rate_hz: float
    axes: list[str]
    positions_m: _Floats
    forces_n: _Floats
    leader_positions_m: _Floats | None
    notes: list[str]

def modes() -> list[str]: ...
def rate_of(times_s: _Floats) -> float: ...
def parse_map(map: list[str]) -> list[tuple[str, str, float]]: ...
def identify(
    positions_m: list[_Floats],
    forces_n: list[_Floats],
    *,
    times_s: _Floats | None,
    rate_hz: float,
    leader_positions_m: list[_Floats] | None,
    axes: list[int],
    mode: str,
    delay_s: float,
    window_s: float,
    max_degree: int,
    cross_talk: bool,
    reading: str,
    choice: str,
    constant: bool,
    ridge: float,
    parcels: bool,
) -> dict[str, Any]: ...
def read_recording(path: str | PathLike[str], map: list[str], arm: str | None) -> _Recording: ...
def fit_gravity(
    forces_n: _Floats,
    torques_nm: _Floats | None,
    accelerations_m_s2: _Floats | None,
    world_from_sensor_wxyz: _Floats | None,
    model: str | None,
    flip_imu: bool,
) -> str: ...
def remove_gravity(
    model: str,
    forces_n: _Floats,
    torques_nm: _Floats | None,
    accelerations_m_s2: _Floats | None,
    world_from_sensor_wxyz: _Floats | None,
) -> tuple[_Floats, _Floats | None]: ...
def fit_correspondence(
    wrist_forces_n: _Floats,
    tissue_forces_n: _Floats,
    sensor_from_camera_wxyz: _Floats | None,
    flip_tissue: bool,
) -> str: ...
@final
class Simulation:
    GRIP_MAX_RAD: ClassVar[float]
    def __new__(
        cls, scene: str, rig: str, mode: str | None, delay_s: float | None, control: str, substeps: int
    ) -> Simulation: ...
    @property
    def rate_hz(self) -> float: ...
    @property
    def ceiling_n(self) -> float: ...
    @property
    def delay_s(self) -> float: ...
    @property
    def mode(self) -> str: ...
    @property
    def has_jaws(self) -> bool: ...
    def reset(self, seed: int | None) -> tuple[dict[str, _Floats], dict[str, Any]]: ...
    def step(self, action: list[float]) -> tuple[dict[str, _Floats], dict[str, Any], bool]: ...
    def score(self) -> str | None: ...

@final
class Session:
    def __new__(cls, path: str | PathLike[str]) -> Session: ...
    @property
    def library(self) -> str: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def arms(self) -> list[str]: ...
    @property
    def begin_ns(self) -> int: ...
    @property
    def end_s(self) -> float: ...
    @property
    def channels(self) -> list[tuple[str, str, int | None]]: ...
    @property
    def attachments(self) -> list[tuple[str, str, int]]: ...
    def attachment(self, name: str) -> bytes: ...
    @property
    def metadata(self) -> dict[str, dict[str, str]]: ...
    def ticks(self, arm: str | None, from_s: float | None, to_s: float | None) -> _Ticks: ...
    def plot(self, topic: str, from_s: float | None, to_s: float | None) -> dict[str, _Floats]: ...
    def events(self, from_s: float | None, to_s: float | None) -> list[tuple[float, str, str, str]]: ...

@final
class TipForceModel:
    def __new__(cls, path: str | PathLike[str]) -> TipForceModel: ...
    @property
    def inputs(self) -> list[str]: ...
    @property
    def outputs(self) -> list[str]: ...
    @property
    def origin(self) -> str: ...
    def estimate(self, inputs: _Floats) -> _Estimates: ...
    def infer(
        self,
        times_s: _Floats,
        forces_n: _Floats,
        torques_nm: _Floats,
        world_from_sensor_wxyz: _Floats,
        insertion_m: _Floats,
        fallback: str,
    ) -> _TipForce: ...
