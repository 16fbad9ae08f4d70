"""Recorded sessions (MCAP)."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from os import PathLike, fspath
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from . import _nima
from ._arrays import Floats
from ._identification import Recording, read_recording


@dataclass(frozen=True)
class Ticks:
    """Plots of an arm in ``n`` ticks; frame ``world``."""

    t_s: Floats
    """Time since the session began, shape (n,), s."""
    time_ns: npt.NDArray[np.uint64]
    """Time of its messages, shape (n,), ns since 1970 (UTC)."""
    tip_m: Floats
    """Position of the instrument's tip, shape (n, 3), m."""
    leader_m: Floats
    """Commanded position of the tip, shape (n, 3), m."""
    measured_n: Floats
    """Force at the tip, shape (n, 3), N; NaN where it was unknown."""
    delayed_n: Floats
    """Force at the tip as delivered by the link, shape (n, 3), N; NaN before the first, and when it is too old."""
    asked_n: Floats
    """Force of the mode before the gates, shape (n, 3), N."""
    rendered_n: Floats
    """Force on the hand, after the gates, shape (n, 3), N."""
    state: list[str]
    """State of the arm."""


class Event(NamedTuple):
    """A line of the session's log."""

    t_s: float
    level: str
    part: str
    words: str


class Channel(NamedTuple):
    """A channel of a session."""

    topic: str
    schema: str
    messages: int | None


class Attachment(NamedTuple):
    """An attached file."""

    name: str
    media_type: str
    size: int


class Session:
    """A recorded session. Chunks are read on demand. The first read of its data warns of data that the session lacks.

    Parameters
    ----------
    path
        Session file (.mcap), finished or truncated.

    Raises
    ------
    OSError
        The file cannot be read.
    ValueError
        It is not a session, or it is damaged.
    """

    def __init__(self, path: str | PathLike[str]) -> None:
        self._path = fspath(path)
        self._native = _nima.Session(path)
        self._has_warned = False

    def _warn(self) -> None:
        """Warns once of the data that the file lacks, at the line that called the public method."""
        if self._has_warned:
            return
        self._has_warned = True
        for note in self.notes:
            warnings.warn(f"{self._path}: {note}", stacklevel=3)

    @property
    def arms(self) -> list[str]:
        """The plotted arms: ``right``, ``left`` or both."""
        return self._native.arms

    @property
    def channels(self) -> list[Channel]:
        """Topic, schema and number of messages of every channel (``None`` if unknown)."""
        return [Channel(*channel) for channel in self._native.channels]

    @property
    def attachments(self) -> list[Attachment]:
        """Name, media type and size in bytes of every attached file: rig, scene, layouts."""
        return [Attachment(*one) for one in self._native.attachments]

    def attachment(self, name: str) -> bytes:
        """Returns the data of an attached file; raises :class:`ValueError` if no file has this name."""
        return self._native.attachment(name)

    @property
    def metadata(self) -> dict[str, dict[str, str]]:
        """Metadata tables of the file, by name."""
        return self._native.metadata

    @property
    def notes(self) -> list[str]:
        """Data that the file lacks, one line each, as every command reports them; empty for a complete file. Reads all of it."""
        return self._native.notes

    @property
    def library(self) -> str:
        """The program that wrote it."""
        return self._native.library

    @property
    def begin_ns(self) -> int:
        """When the session began, ns since 1970 (UTC)."""
        return self._native.begin_ns

    @property
    def end_s(self) -> float:
        """End of the session, s since it began."""
        return self._native.end_s

    def ticks(self, arm: str | None = None, *, from_s: float | None = None, to_s: float | None = None) -> Ticks:
        """Returns the plots of an arm in every tick of a time range (``from_s`` to before ``to_s``, s since it began).

        Raises
        ------
        ValueError
            The session lacks this arm, or has two and ``arm`` is missing; an empty time range; a damaged chunk.
        """
        self._warn()
        return Ticks(**self._native.ticks(arm, from_s, to_s))

    def plot(self, topic: str, *, from_s: float | None = None, to_s: float | None = None) -> dict[str, Floats]:
        """Returns the named numbers of a channel such as ``right/identification`` or ``timing``, each of shape (n,), and ``t_s``.

        Raises
        ------
        ValueError
            The channel is missing or has other messages, the time range is empty, or a chunk is damaged.
        """
        self._warn()
        return self._native.plot(topic, from_s, to_s)

    def events(self, *, from_s: float | None = None, to_s: float | None = None) -> list[Event]:
        """Returns the events: states, faults, commands, marks, alarms; the oldest first.

        Raises
        ------
        ValueError
            An empty time range, or a damaged chunk.
        """
        self._warn()
        return [Event(*line) for line in self._native.events(from_s, to_s)]

    def recording(self, arm: str | None = None) -> Recording:
        """Returns motion and force of an arm, for :func:`nima.identify`; the same as ``nima identify SESSION.mcap``.

        Raises
        ------
        ValueError
            See :meth:`ticks`; also a value that is not finite, or fewer than three ticks.
        """
        return read_recording(self._path, arm=arm)
