"""Where things stand in the arrays of a certificate."""

from __future__ import annotations

FLIGHT, FROM, LENGTH, CLAIM, SIGNAL = range(5)  # columns of a piece; the first is its segment

COLUMNS = 5

OPEN, CLOSES, UNPROVED = 0.0, 1.0, 2.0  # claims

NEGATIVE = 4  # added to the number of a signal (``layout``: GAP_SIGNAL, FORCE_SIGNAL, each plus the side): its negative

SEGMENT, WATCHED, ORDER, RISE, CLOSING = range(5)  # columns of a task: a signal over a segment, its root at the start

TASK_COLUMNS = 5
