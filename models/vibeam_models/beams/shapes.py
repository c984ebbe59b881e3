"""Shapes of a cross-section: area, second moment of area, shear coefficient. Dimensions in m."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass, fields
from math import pi
from typing import Any, ClassVar, Self

from vibeam_models.arrays import Array
from vibeam_models.keys import keys_of, quantity

Value = Any  # a number, or an array of one at each place


@dataclass(frozen=True)
class Shape(ABC):
    """A shape by its keys in ``[beam]`` and ``[[section]]``; motion is along the thickness.

    Along a taper its dimensions are arrays, one number at each place.
    """

    name: ClassVar[str]
    along: ClassVar[str] = ""  # its dimension in the direction of motion

    @abstractmethod
    def area_times(self, factor: Value) -> Value:
        """A times ``factor`` (a density, say), m²."""

    @abstractmethod
    def second_moment_times(self, factor: Value) -> Value:
        """I times ``factor`` (a modulus, say), m⁴: about the axis across the motion."""

    @property
    def height(self) -> Value:
        """Extent in the direction of motion, m; None where it is not known."""
        return getattr(self, self.along) if self.along else None

    def sheared_area(self, poissons_ratio: float) -> Value:
        """κA in m², by Cowper, J. Appl. Mech. 33 (1966) 335–340; None where it is not known."""
        return None

    @classmethod
    def faults(cls, table: Any) -> Iterator[tuple[str, str]]:
        """(key, message) of what does not go together; ``table`` has values as attributes, None what is absent."""
        yield from ()

    def between(self, far: Self, share: Array) -> Self:
        """The shape on the way to ``far``, every dimension linear in ``share`` (0 here, 1 there)."""
        ends = {each.name: (getattr(self, each.name), getattr(far, each.name)) for each in fields(self)}
        return type(self)(**{name: None if a is None else a + (b - a) * share for name, (a, b) in ends.items()})


@dataclass(frozen=True)
class Rectangle(Shape):
    """b × t."""

    width: float = quantity("m", "width of the section", "20 mm", above=0)
    thickness: float = quantity("m", "thickness of the section, in the direction of motion", "1.034 mm", above=0)

    name: ClassVar[str] = "rectangle"
    along: ClassVar[str] = "thickness"

    def area_times(self, factor: Value) -> Value:
        """b t."""
        return factor * self.width * self.thickness

    def second_moment_times(self, factor: Value) -> Value:
        """b t³/12."""
        return factor * self.width * self.thickness**3 / 12

    def sheared_area(self, poissons_ratio: float) -> Value:
        """κ = 10(1 + ν)/(12 + 11ν)."""
        return self.area_times(10 * (1 + poissons_ratio) / (12 + 11 * poissons_ratio))


@dataclass(frozen=True)
class Round(Shape):
    """A full circle."""

    diameter: float = quantity("m", "of a round section", "10 mm", above=0)

    name: ClassVar[str] = "round"
    along: ClassVar[str] = "diameter"

    def area_times(self, factor: Value) -> Value:
        """π d²/4."""
        return factor * pi / 4 * self.diameter**2

    def second_moment_times(self, factor: Value) -> Value:
        """π d⁴/64."""
        return factor * pi / 64 * self.diameter**4

    def sheared_area(self, poissons_ratio: float) -> Value:
        """κ = 6(1 + ν)/(7 + 6ν)."""
        return self.area_times(6 * (1 + poissons_ratio) / (7 + 6 * poissons_ratio))


@dataclass(frozen=True)
class Tube(Shape):
    """A ring."""

    outer_diameter: float = quantity("m", "of a tube", "15.875 mm", above=0)
    wall: float = quantity("m", "of the wall of a tube or a hollow rectangle", "1.2 mm", above=0)

    name: ClassVar[str] = "tube"
    along: ClassVar[str] = "outer_diameter"

    @classmethod
    def faults(cls, table: Any) -> Iterator[tuple[str, str]]:
        """A wall that leaves no bore."""
        yield from _wall(table, table.outer_diameter, "outer_diameter", "round")

    @property
    def bore(self) -> Value:
        """Inner diameter, m."""
        return self.outer_diameter - 2 * self.wall

    def area_times(self, factor: Value) -> Value:
        """π (D² − d²)/4 = π s (D − s)."""
        return factor * pi * self.wall * (self.outer_diameter - self.wall)

    def second_moment_times(self, factor: Value) -> Value:
        """π (D⁴ − d⁴)/64 = A (D² + d²)/16."""
        return self.area_times(factor) * (self.outer_diameter**2 + self.bore**2) / 16

    def sheared_area(self, poissons_ratio: float) -> Value:
        """κ = 6(1 + ν)(1 + m²)²/((7 + 6ν)(1 + m²)² + (20 + 12ν)m²), m = d/D."""
        m = self.bore / self.outer_diameter
        square = (1 + m**2) ** 2
        below = (7 + 6 * poissons_ratio) * square + (20 + 12 * poissons_ratio) * m**2
        return self.area_times(6 * (1 + poissons_ratio) * square / below)


@dataclass(frozen=True)
class HollowRectangle(Shape):
    """A box of one wall thickness."""

    width: float = quantity("m", "width of the section", "20 mm", above=0)
    thickness: float = quantity("m", "thickness of the section, in the direction of motion", "1.034 mm", above=0)
    wall: float = quantity("m", "of the wall of a tube or a hollow rectangle", "1.2 mm", above=0)

    name: ClassVar[str] = "hollow rectangle"
    along: ClassVar[str] = "thickness"

    @classmethod
    def faults(cls, table: Any) -> Iterator[tuple[str, str]]:
        """A wall that leaves no bore."""
        for name in ("width", "thickness"):
            yield from _wall(table, getattr(table, name), name, "rectangle")

    def area_times(self, factor: Value) -> Value:
        """2 s (b + t − 2s)."""
        return factor * 2 * self.wall * (self.width + self.thickness - 2 * self.wall)

    def second_moment_times(self, factor: Value) -> Value:
        """(b t³ − (b − 2s)(t − 2s)³)/12."""
        inner = (self.width - 2 * self.wall) * (self.thickness - 2 * self.wall) ** 3
        return factor * (self.width * self.thickness**3 - inner) / 12

    def sheared_area(self, poissons_ratio: float) -> Value:
        """Cowper's thin-walled box, m = b₁t₁/(h t) with equal walls, n = b₁/h between the middles of the walls."""
        b, h = self.width - self.wall, self.thickness - self.wall
        m = n = b / h
        return self.area_times(_thin_walled(poissons_ratio, m, 10 * n**2 * ((3 + poissons_ratio) * m + 3 * m**2)))


@dataclass(frozen=True)
class ISection(Shape):
    """Two flanges on a web that stands in the direction of motion."""

    width: float = quantity("m", "width of the section", "20 mm", above=0)
    thickness: float = quantity("m", "thickness of the section, in the direction of motion", "1.034 mm", above=0)
    web: float = quantity("m", "thickness of the web of an I", "5 mm", above=0)
    flange: float = quantity("m", "thickness of each flange of an I", "8 mm", above=0)

    name: ClassVar[str] = "I"
    along: ClassVar[str] = "thickness"

    @classmethod
    def faults(cls, table: Any) -> Iterator[tuple[str, str]]:
        """A web wider than the flanges, flanges that meet."""
        if None not in (table.web, table.width) and table.web > table.width:
            yield "web", f"{table.web:g} m is wider than the flanges: width is {table.width:g} m"
        if None not in (table.flange, table.thickness) and 2 * table.flange >= table.thickness:
            yield "flange", f"two flanges of {table.flange:g} m leave no web: thickness is {table.thickness:g} m"

    def area_times(self, factor: Value) -> Value:
        """2 b t_f + (t − 2t_f) t_w."""
        return factor * (2 * self.width * self.flange + (self.thickness - 2 * self.flange) * self.web)

    def second_moment_times(self, factor: Value) -> Value:
        """(b t³ − (b − t_w)(t − 2t_f)³)/12."""
        inner = (self.width - self.web) * (self.thickness - 2 * self.flange) ** 3
        return factor * (self.width * self.thickness**3 - inner) / 12

    def sheared_area(self, poissons_ratio: float) -> Value:
        """Cowper's thin-walled I, m = 2bt_f/(h t_w), n = b/h, h between the middles of the flanges."""
        h = self.thickness - self.flange
        m, n = 2 * self.width * self.flange / (h * self.web), self.width / h
        wide = 30 * n**2 * (m + m**2) + 5 * poissons_ratio * n**2 * (8 * m + 9 * m**2)
        return self.area_times(_thin_walled(poissons_ratio, m, wide))


@dataclass(frozen=True)
class General(Shape):
    """Any section by its area and second moment."""

    area: float = quantity("m^2", "of a general section", "20 mm^2", above=0)
    second_moment: float = quantity(
        "m^4", "of area of a general section, about the axis across the motion", "1.8 mm^4", above=0
    )
    shear_area: float | None = quantity("m^2", "κA of a general section", "16 mm^2", None, above=0)

    name: ClassVar[str] = "general"

    def area_times(self, factor: Value) -> Value:
        """A."""
        return factor * self.area

    def second_moment_times(self, factor: Value) -> Value:
        """I."""
        return factor * self.second_moment

    def sheared_area(self, poissons_ratio: float) -> Value:
        """As given."""
        return self.shear_area


SHAPES: dict[str, type[Shape]] = {
    each.name: each for each in (Rectangle, Round, Tube, HollowRectangle, ISection, General)
}
DIMENSIONS = frozenset(key for each in SHAPES.values() for key in keys_of(each))


def foreign_dimensions(table: Any, shape: str) -> Iterator[tuple[str, str]]:
    """Faults of the dimensions, those at a stretch's end too, that a table has and its ``shape`` does not."""
    for name in sorted(DIMENSIONS - keys_of(SHAPES[shape]).keys()):
        for key in (name, f"end_{name}"):
            if getattr(table, key, None) is not None:
                others = " or ".join(f'shape = "{other}"' for other, each in SHAPES.items() if name in keys_of(each))
                yield key, f'does not go with shape = "{shape}": write {others}, or take it out'


def _thin_walled(poissons_ratio: float, m: Value, wide: Value) -> Value:
    """Cowper's κ of a thin-walled section: 10(1 + ν)(1 + 3m)²/(… + wide)."""
    below = 12 + 72 * m + 150 * m**2 + 90 * m**3 + poissons_ratio * (11 + 66 * m + 135 * m**2 + 90 * m**3)
    return 10 * (1 + poissons_ratio) * (1 + 3 * m) ** 2 / (below + wide)


def _wall(table: Any, outside: Value, key: str, full: str) -> Iterator[tuple[str, str]]:
    if None not in (table.wall, outside) and 2 * table.wall >= outside:
        yield "wall", f'{table.wall:g} m leaves no hollow: {key} is {outside:g} m; write shape = "{full}"'
