"""Observers of a response, whatever fidelity made it: pure functions of a motion or of samples.

Functions of a motion take a ``Trajectory`` (or anything like it: ``Path``), functions of samples arrays in s, m and
m/s; both give frozen records of named arrays. Each name is listed in ``__init__.pyi`` and loaded when
first used.
"""

from __future__ import annotations

from vibeam.system.public_names import namespace

namespace(__name__, __file__)
