"""Keys of what a results file keeps: digests of all that decides the numbers of a branch, a model, a comparison."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from hashlib import sha256
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.run.code import digest_of_code

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.system.response import Branches


def branch_key(own: str, direction: str, up: NDArray[np.float64], after_up: bool) -> str:
    """Key of all numbers of a branch beside the frequencies, the sweep's lowest frequency included.

    ``own``: key of its fidelity, ``up``: all frequencies, ascending; ``after_up``: it goes on from the upward sweep.
    """
    start = up.tobytes() if direction == "down" and after_up else b"equilibrium"
    return sha256(b"\n".join((own.encode(), direction.encode(), up[:1].tobytes(), start))).hexdigest()


def model_key(case: Case, name: str) -> str:
    """Key of one fidelity's model and of its fitness for the frequencies: the case's part in it, and the code.

    Empty where the code is not known.
    """
    code = digest_of_code()
    return code and sha256(f"{code} {case.own[name]}".encode() + case.sweep.frequency.tobytes()).hexdigest()


def comparison_key(case: Case, finest: Mapping[str, str], branches: Mapping[str, Branches]) -> str:
    """Key of a comparison of fidelities with their ``finest``: models, and every number of their ``branches``.

    Empty where the code is not known.
    """
    if not digest_of_code():
        return ""
    found = sha256(repr([(name, top, model_key(case, name)) for name, top in finest.items()]).encode())
    for name, several in branches.items():
        for direction, response in several.items():
            found.update(f"{name} {direction}".encode())
            for field in fields(response):
                found.update(np.ascontiguousarray(getattr(response, field.name)).tobytes())
    return found.hexdigest()
