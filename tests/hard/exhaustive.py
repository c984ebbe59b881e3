"""Random systems, a hundred impacts each, against arbitrary precision: the part "impacts" of the torture.

    python tests/hard/torture.py impacts --count 10000

Counts what was missed, invented or wrong, and keeps the worst errors. One system in ten has up to 30 modes, the others
one to three, whose truth is some hundred impacts a second. That of stiff systems is slow: after ``PATIENCE`` seconds of
CPU time a system's motion is judged no further.
"""

from __future__ import annotations

from agreement import follow
from random_systems import random_case
from verdict import Verdict
from workers import Stage

IMPACTS, EACH = 2000, 8  # of a system at most, and of a burst

PATIENCE = 2.0

LARGE = 10  # one number in so many has any size


def judge(seed: int, number: int, stage: Stage) -> Verdict:
    """The impacts of one system, burst by burst."""
    stage("bursts")
    size = None if number % LARGE == 0 else 1 + number % 3
    readout = vars(follow(random_case(seed, number, size), IMPACTS, EACH, PATIENCE))
    return Verdict(
        counts={"systems": 1} | {name: value for name, value in readout.items() if isinstance(value, int)},
        worst={name: value for name, value in readout.items() if isinstance(value, float)},
        findings=readout["faults"],
    )
