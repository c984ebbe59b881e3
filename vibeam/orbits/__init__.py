"""Periodic motions with one impact per n drive periods, exact for any number of modes (periodic Green's function).

``sums`` reduces the modes to a few numbers a frequency, ``balance`` solves the quadratic for the impulse,
``multipliers`` judges stability through the saltation matrix; ``curve`` does so for whole frequency axes, ``orbit`` for
one drive, certified by the flight solver in ``certify``; ``boundaries`` finds where a branch ends or changes, and
``follow`` takes such a point along a second parameter; ``map`` and ``contours`` do so for a whole plane. ``touching``
proves how close a motion comes to the stop between impacts, from the bounds in ``shape`` and ``parts``. ``several``
refines motions with up to four impacts a span, ``train_boundaries`` follows them.
"""
