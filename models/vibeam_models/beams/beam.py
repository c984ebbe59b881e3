"""Beam: what carries mass, stop and sensor, and the supports that hold it, as frozen data in SI units."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf
from typing import Any, Literal

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.beams.shapes import Shape
from vibeam_models.beams.stretch import Material, Plate, Stretch

#: end → (stiffness against deflection, against rotation)
ENDS = {"clamped": (inf, inf), "pinned": (inf, 0.0), "guided": (0.0, inf), "free": (0.0, 0.0)}

#: what a case may write: the end at x = 0, then that at the full length
PAIRS = tuple(f"{one}-{other}" for one in ENDS for other in ENDS)
CANTILEVER = "clamped-free"


@dataclass(frozen=True)
class Support:
    """Support at ``position`` m by ``stiffness`` N/m and ``rotational_stiffness`` N m/rad; inf: rigid, 0: none."""

    position: float
    stiffness: float = inf
    rotational_stiffness: float = 0.0

    @property
    def each(self) -> tuple[float, float]:
        """Stiffness against deflection, and against rotation."""
        return self.stiffness, self.rotational_stiffness


def end_supports(pair: str, length: float) -> tuple[Support, ...]:
    """The supports at the ends of a beam of ``length`` m, ``pair`` one of ``PAIRS``; free ends have none."""
    both = zip((0.0, length), pair.split("-"), strict=True)
    return tuple(Support(x, *ENDS[end]) for x, end in both if end != "free")


def holds(supports: Collection[Support]) -> bool:
    """Test whether no rigid motion u = a + bx is left: Σ k (1, x)(1, x)ᵀ + k_θ (0, 1)(0, 1)ᵀ has full rank."""
    places = {each.position for each in supports if each.stiffness > 0}
    return len(places) > 1 or (len(places) == 1 and any(each.rotational_stiffness > 0 for each in supports))


def stiffnesses(table: Any) -> tuple[float, float]:
    """N/m and N m/rad of a support by its keys: None is rigid against deflection, free to turn."""
    return inf if table.stiffness is None else table.stiffness, table.rotational_stiffness or 0.0


POINTS, WEIGHTS = np.polynomial.legendre.leggauss(8)  # exact for every linear taper


@dataclass(frozen=True)
class Damping:
    """Damping of the beam by modal ratios.

    ``kind``: ``"constant"`` (every mode has ratios[0]), ``"stiffness"`` (C = D K, mode 1 has ratios[0]: the paper's),
    ``"rayleigh"`` (C = αM + DK, modes 1 and 2 have ratios[0] and ratios[1]) or ``"list"`` (mode i has ratios[i], every
    further mode the last one).
    """

    kind: Literal["constant", "stiffness", "rayleigh", "list"]
    ratios: tuple[float, ...]


@dataclass(frozen=True)
class Beam:
    """A beam along x: lengths in m, modulus in Pa, density in kg/m³; its own section where no other is named.

    ``added_mass_per_length``: what it carries all along without being stiffened, kg/m. ``ends``: at x = 0 and at its
    length, one of ``PAIRS``. ``supports``: further ones. ``sections``: stretches with another section, which do not
    overlap. ``plates``: bonded to it. ``poissons_ratio``: needed where ``shear`` is to be seen: Timoshenko's beam.
    """

    length: float
    shape: Shape
    youngs_modulus: float
    density: float
    damping: Damping
    elements: int = 36
    added_mass_per_length: float = 0.0
    ends: str = CANTILEVER
    poissons_ratio: float | None = None
    shear: bool = False
    sections: tuple[Stretch, ...] = ()
    plates: tuple[Plate, ...] = ()
    supports: tuple[Support, ...] = ()

    @property
    def material(self) -> Material:
        """Its own material."""
        return Material(self.youngs_modulus, self.density, self.poissons_ratio)

    @property
    def is_uniform(self) -> bool:
        """True where its own section is all there is of it."""
        return not (self.sections or self.plates)

    @property
    def is_uniform_cantilever(self) -> bool:
        """True where the closed forms of a uniform cantilever hold."""
        return self.is_uniform and self.ends == CANTILEVER and not self.supports and not self.shear

    @property
    def bending_stiffness(self) -> float:
        """EI of its own section, N m²."""
        return float(self.shape.second_moment_times(self.youngs_modulus))

    @property
    def mass_per_length(self) -> float:
        """ρA of its own section with what is added all along, kg/m."""
        return float(self.shape.area_times(self.density) + self.added_mass_per_length)

    @property
    def held(self) -> tuple[Support, ...]:
        """Supports at the ends, and all others."""
        return (*end_supports(self.ends, self.length), *self.supports)

    @property
    def mass(self) -> float:
        """kg: of the beam with what belongs to it."""
        return self.mass_per_length * self.length if self.is_uniform else float(self.mass_beyond(np.array(0.0)))

    def mass_beyond(self, x: Array) -> Array:
        """Mass (shape of ``x``) of the beam beyond ``x`` m, kg."""
        if self.is_uniform:
            return np.asarray(self.mass_per_length * (self.length - x))
        total = np.zeros(np.shape(x))
        for piece in self.stretches:
            start = np.clip(x, piece.start, piece.end)
            half = (piece.end - start) / 2
            places = start[..., None] + half[..., None] * (1 + POINTS)
            total = total + half * (piece.mass_per_length(places) @ WEIGHTS)
        return total

    @property
    def breaks(self) -> tuple[float, ...]:
        """Places (m) where the section or the support changes, ascending, its ends among them."""
        parts: tuple[Stretch | Plate, ...] = (*self.sections, *self.plates)
        places = {0.0, self.length, *(x for part in parts for x in (part.start, part.end))}
        return tuple(sorted(places | {each.position for each in self.supports}))

    @property
    def stretches(self) -> tuple[Stretch, ...]:
        """The whole beam as stretches between its breaks."""
        return tuple(self._stretch(start, end) for start, end in pairwise(self.breaks))

    def stretch_at(self, x: float) -> Stretch:
        """The stretch at ``x`` m; where two meet the later one."""
        return next(each for each in reversed(self.stretches) if each.start <= x <= each.end)

    def height_at(self, x: float) -> float:
        """Height in m of the beam's own section at ``x`` m; NaN where its shape does not say it."""
        return float(self.stretch_at(x).section(np.array(x)).height or np.nan)

    def _stretch(self, start: float, end: float) -> Stretch:
        middle = (start + end) / 2
        own = Stretch(start, end, self.shape, self.material, added=self.added_mass_per_length)
        there = next((each for each in self.sections if each.start <= middle <= each.end), own)
        plates = tuple(each for each in self.plates if each.start <= middle <= each.end)
        return replace(there.between(start, end), plates=plates)

    def along(self, quantity: Callable[[Stretch, Array], Array], x: Array) -> Array:
        """A quantity of a stretch (``Stretch.bending_stiffness``, say) at ``x`` (any shape) m, inside stretches."""
        found = np.zeros(np.shape(x))
        for piece in self.stretches:
            here = (x >= piece.start) & (x <= piece.end)
            found[here] = quantity(piece, x[here])
        return found

    def massless(self) -> Beam:
        """The same without mass of its own."""
        return replace(
            self,
            density=0.0,
            added_mass_per_length=0.0,
            sections=tuple(each.massless() for each in self.sections),
            plates=tuple(replace(each, density=0.0) for each in self.plates),
        )
