"""Conversion of array arguments."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


def as_floats(name: str, values: npt.ArrayLike) -> Floats:
    """Returns the values as float64, without a copy if possible (other types and unaligned numbers are copied)."""
    try:
        return np.require(np.asarray(values, dtype=np.float64), requirements="A")
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name}: the values are not numbers ({error})") from None


def columns(name: str, values: npt.ArrayLike) -> list[Floats]:
    """Returns one view per axis of an array of shape (n,) or (n, axes)."""
    array = as_floats(name, values)
    if array.ndim == 1:
        return [array]
    if array.ndim != 2:
        raise ValueError(f"{name} has {array.ndim} dimensions; give the shape (n,) or (n, axes)")
    return [array[:, axis] for axis in range(array.shape[1])]


def table(name: str, values: npt.ArrayLike) -> Floats:
    """An array of shape (n, k)."""
    array = as_floats(name, values)
    if array.ndim != 2:
        raise ValueError(f"{name} has {array.ndim} dimensions; give one row for each sample")
    return array


def optional_table(name: str, values: npt.ArrayLike | None) -> Floats | None:
    """Returns an array of shape (n, k), or ``None`` if it is not given."""
    return None if values is None else table(name, values)


def line(name: str, values: npt.ArrayLike) -> Floats:
    """An array of shape (n,)."""
    array = as_floats(name, values)
    if array.ndim != 1:
        raise ValueError(f"{name} has {array.ndim} dimensions; give the shape (n,)")
    return array


def is_frame(source: Any) -> bool:
    """Whether the source is a table with named columns (pandas, polars)."""
    return hasattr(source, "columns") and hasattr(source, "__getitem__") and not isinstance(source, np.ndarray)
