"""Long computation cut into numbered steps: what decides its numbers, its steps and files, and a part of them.

Consecutive steps lie in one file; file j belongs to the part whose number is j modulo the number of parts, so that no
part waits for another, and their number may change from run to run.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from vibeam.store.blocks import Values
from vibeam.store.place import place_of

LONGEST = 300.0  # s of a file, about
USUAL, MOST = 2_000, 10_000  # files: of a computation that is not very long, and of any


@dataclass(frozen=True)
class WorkStep:
    """Items ``first`` to ``last`` (not itself) of what has that ``name``; ``number``: among all steps."""

    number: int
    name: str
    first: int
    last: int


@dataclass(frozen=True)
class WorkPart:
    """Part ``number`` (from 1) ``of`` so many."""

    number: int = 1
    of: int = 1

    @classmethod
    def read(cls, text: str) -> WorkPart:
        """The part that is written ``3/64``; ValueError with the cure."""
        found = re.fullmatch(r"([0-9]{1,9})/([0-9]{1,9})", text.strip())
        if not found or not 1 <= int(found[1]) <= int(found[2]):
            raise ValueError(f"{text!r} is no part: write its number and how many there are, 1/64 to 64/64")
        return cls(int(found[1]), int(found[2]))

    def has(self, file: int) -> bool:
        """Test whether a file, numbered from 1, belongs to this part."""
        return (file - 1) % self.of == self.number - 1


@dataclass(frozen=True)
class LongWork:
    """Long computation for the file ``path``, whose steps lie in ``OUT.parts`` meanwhile.

    ``keys``: digests of all that decides its numbers, the code aside, by name; ``steps``: by the same names,
    ``range(0, items, items of a step)``; ``evaluate``: values of a step, a function of the step alone, called from
    several threads. ``code``: digest of the code; ``points``: of an item, where not one; ``seconds``: that a step
    takes, about, where not one; ``command``: what ``--part`` stands behind.
    """

    path: Path
    keys: Mapping[str, str]
    steps: Mapping[str, range]
    evaluate: Callable[[WorkStep], Values]
    code: str = ""
    points: Mapping[str, int] = field(default_factory=dict)
    seconds: Mapping[str, float] = field(default_factory=dict)
    command: str = "vibeam map CASE NAME"
    together: int = 0  # steps of a file; 0: by their seconds

    @cached_property
    def folder(self) -> Path:
        """Folder of the files."""
        return place_of(self.path).folder

    @cached_property
    def every(self) -> Sequence[WorkStep]:
        """All steps, in order."""
        cuts = ((name, first, cut) for name, cut in self.steps.items() for first in cut)
        return [
            WorkStep(number, name, first, min(first + cut.step, cut.stop))
            for number, (name, first, cut) in enumerate(cuts)
        ]

    @cached_property
    def steps_a_file(self) -> int:
        """Steps of a file: of five minutes at most, fewer where there would be few files, more where too many."""
        total, count = sum(self.seconds.get(each.name, 1.0) for each in self.every), len(self.every)
        by_time = min(LONGEST, total / USUAL) / (total / count) if total else count / USUAL
        return self.together or max(1, round(by_time), -(-count // MOST))

    @property
    def files(self) -> int:
        """Number of files."""
        return -(-len(self.every) // self.steps_a_file)

    def size(self, step: WorkStep) -> int:
        """Points of a step."""
        return (step.last - step.first) * self.points.get(step.name, 1)
