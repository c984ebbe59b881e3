"""Periodic motions with one impact per n drive periods, exact for any number of modes (periodic Green's function).

Its public names are listed in ``__init__.pyi``.
"""

from __future__ import annotations

from vibeam.system.public_names import namespace

namespace(__name__, __file__)
