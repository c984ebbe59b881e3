"""Plain samples of uncertain inputs by numpy, and the modes of all of them at once.

Nothing of the study that is judged is used, only assembled systems: read at Chebyshev nodes of the inputs that change
the structure, so that modes between them follow by polynomials.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import astuple, dataclass
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

Array = Any
NODES = 6  # of Chebyshev for each input


@dataclass(frozen=True)
class Input:
    """Uncertain input: its ``key`` and ``text`` in a case, and the same to draw from, SI.

    ``kind`` ``"normal"``: about ``first`` with the standard deviation ``second``; ``"uniform"``: from one to the other.
    """

    key: str
    text: str
    kind: str
    first: float
    second: float

    def drawn(self, rng: np.random.Generator, count: int) -> Array:
        """Plain samples (count,)."""
        return (rng.normal if self.kind == "normal" else rng.uniform)(self.first, self.second, count)

    @property
    def ends(self) -> tuple[float, float]:
        """Range of nearly all samples: five standard deviations, or the whole of a uniform one."""
        if self.kind == "uniform":
            return self.first, self.second
        return self.first - 5 * self.second, self.first + 5 * self.second


def drawn(inputs: Sequence[Input], count: int, seed: int) -> dict[str, Array]:
    """Plain samples (count,) of each input, by its key."""
    rng = np.random.default_rng(seed)
    return {each.key: each.drawn(rng, count) for each in inputs}


@dataclass(frozen=True)
class Modes:
    """Modes of m samples, (m, n) each: frequency ω, rad/s, damping ratio, rows of contact, load and output."""

    omega: Array
    zeta: Array
    contact: Array
    load: Array
    output: Array

    @classmethod
    def of(cls, system: Any, output: str) -> Modes:
        """Modes (1, n) of an assembled system; ValueError for one whose modes are not all there is."""
        if np.any(system.static) or system.coupling is not None or system.second_gap is not None:
            raise ValueError("static forces, coupled damping, a second stop")
        rows = (system.omega, system.zeta, system.contact, system.load, system.output(output))
        return cls(*(row[None] for row in rows))

    def at(self, which: Any) -> Modes:
        """Modes of some samples."""
        return Modes(*(row[which] for row in astuple(self)))


def interpolated(rows: Callable[[Mapping[str, float]], Array], inputs: Sequence[Input]) -> Callable[..., Array]:
    """Function of samples by key (m,) for ``rows`` of one sample: (m, …), by polynomials in each of the inputs."""
    ends, keys = np.array([each.ends for each in inputs]), [each.key for each in inputs]
    nodes = chebyshev.chebpts1(NODES)
    places = np.stack([each.ravel() for each in np.meshgrid(*[nodes] * len(inputs), indexing="ij")], axis=1)
    values = ends[:, 0] + (places + 1) / 2 * np.ptp(ends, axis=1)
    known = np.stack([rows(dict(zip(keys, row.tolist(), strict=True))) for row in values])
    coefficients = np.linalg.solve(_terms(places), known.reshape(len(known), -1))

    def at(samples: Mapping[str, Array]) -> Array:
        shares = (np.stack([samples[key] for key in keys], axis=1) - ends[:, 0]) / np.ptp(ends, axis=1)
        return (_terms(2 * shares - 1) @ coefficients).reshape(-1, *known.shape[1:])

    return at


def _terms(places: Array) -> Array:
    """Products (m, NODES^d) of Chebyshev's polynomials at places (m, d)."""
    product = np.ones((len(places), 1))
    for column in places.T:
        each = chebyshev.chebvander(column, NODES - 1)
        product = (product[:, :, None] * each[:, None, :]).reshape(len(places), -1)
    return product
