"""Data of a run for its figures: the case and the responses of its fidelities, whoever holds them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, ValuesView
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.figures.sheet import Sheet
    from vibeam.system.response import Branches


class WithinAccuracy(Protocol):
    """Curve within an accuracy of the finest fidelity."""

    @property
    def within(self) -> float:
        """Allowed relative error."""
        ...

    @property
    def finest(self) -> str:
        """Reference fidelity of the error."""
        ...


class Comparison(Protocol):
    """Branches of every fidelity by name, as a mapping, with the figures' further data."""

    @property
    def case(self) -> Case:
        """Case of the run."""
        ...

    @property
    def accuracy(self) -> WithinAccuracy | None:
        """Accuracy of the one curve, where the case asks for one."""
        ...

    @property
    def finest(self) -> Mapping[str, str]:
        """Finest fidelity of the same physics for each fidelity."""
        ...

    @property
    def held(self) -> str:
        """Restitution held equal in the fidelities, and what the other choice gives; empty without a comparison."""
        ...

    @property
    def shown(self) -> Mapping[str, tuple[Sheet, ...]]:
        """Numbers of the figures that the case asks for."""
        ...

    def __getitem__(self, fidelity: str, /) -> Branches: ...
    def __iter__(self) -> Iterator[str]: ...
    def __len__(self) -> int: ...
    def values(self) -> ValuesView[Branches]:
        """Branches in the case's order."""
        ...
