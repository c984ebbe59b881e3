"""Coordinates in which solvers with events integrate a flight, and their common parts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arguments import count, number, refuse
from vibeam_models.arrays import Array

EXPLICIT = ("RK23", "RK45", "DOP853")


@dataclass(frozen=True)
class IntegrationSettings:
    """scipy's ``method`` and ``rtol``; ``atol``: contact displacement, m; ``limit``: events a drive period."""

    method: str
    rtol: float
    atol: float
    limit: int

    def __post_init__(self) -> None:
        faults: list[str] = []
        for name in ("rtol", "atol"):
            object.__setattr__(self, name, number(name, getattr(self, name), faults, above=0.0))
        object.__setattr__(self, "limit", count("limit", self.limit, faults, least=1))
        refuse("solver", faults)


class Frame(Protocol):
    """Coordinates of one flight. States are (2n,), or (2n, m) for m of them, as in scipy."""

    @property
    def scale(self) -> Array:
        """Size of each coordinate, (2n,), for a contact motion of 1 m."""

    def outward(self, states: Array) -> Array:
        """Modal displacements and velocities (m, 2, n) of states (2n, m)."""

    def rate(self, t: float, y: Array) -> Any:
        """Rate dy/dt in flight."""

    def rate_at_rest(self, t: float, y: Array) -> Any:
        """Rate dy/dt with the contact held on the stop."""

    def excess(self, y: Array) -> Any:
        """Contact displacement − gap, m."""

    def approach(self, y: Array) -> Any:
        """Contact velocity, positive toward the stop, m/s."""

    def press(self, t: float, y: Array) -> float:
        """Acceleration of the free contact toward the stop, m/s²; the contact force has its sign."""

    def touch(self, y: Array) -> Array:
        """State projected exactly onto the stop."""

    def hold(self, y: Array) -> Array:
        """State on the stop, its contact velocity removed by the least impulse."""

    def strike(self, y: Array) -> tuple[Frame, Array]:
        """Frame and state after an impact."""


def chosen(method: str, known: Sequence[str]) -> str:
    """Validate the method against the known ones; ValueError for another."""
    if method not in known:
        raise ValueError(f"method: {method!r} is none of {', '.join(known)}")
    return method


def only_one_mode(name: str, system: ImpactSystem) -> None:
    """Raise ValueError for a system of several modes."""
    if system.size != 1:
        raise ValueError(
            f"{name}: its coordinates are made for one mode, this system has {system.size}: reduce it to 1"
        )
