"""Observers of a response, whatever fidelity made it: pure functions of a motion or of samples.

Functions of a motion take a ``Trajectory`` (or anything like it: ``Path``), functions of samples arrays in s, m and
m/s; both give frozen records of named arrays. Each name is listed in ``__init__.pyi`` and loaded when
first used.
"""

from __future__ import annotations

from vibeam.system.public_names import from_home, homes_of

_HOMES = homes_of(__file__)


def __getattr__(name: str) -> object:
    globals()[name] = value = from_home(_HOMES, __name__, name)
    return value


def __dir__() -> list[str]:
    return sorted(_HOMES)
