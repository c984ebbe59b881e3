"""Periodic motions with one impact per n drive periods, exact for any number of modes (periodic Green's function).

``modal_sums`` reduces the modes to a few numbers a frequency, and solves the quadratic for the impulse. ``multipliers``
judges stability through the saltation matrix. ``orbit_curve`` does so for whole frequency axes, ``orbit`` for one
drive, certified by the flight solver. ``boundaries`` locates the ends and bifurcations of a branch and follows them
along a second parameter, ``orbit_map`` and ``contours`` cover a whole plane. ``clearance`` bounds the distance from the
stop between impacts, with the bounds of ``gap``. ``train_orbits`` refines motions with up to four impacts a span,
``train_boundaries`` follows them.

Its public names are listed in ``__init__.pyi``.
"""

from __future__ import annotations

from vibeam.system.public_names import namespace

namespace(__name__, __file__)
