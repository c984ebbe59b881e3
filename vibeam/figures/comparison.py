"""What figures draw of a run: the case and the responses of its fidelities, whoever holds them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, ValuesView
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.figures.sheet import Sheet
    from vibeam.system.response import Branches


class WithinAccuracy(Protocol):
    """A curve that keeps within an accuracy of the finest fidelity."""

    @property
    def within(self) -> float:
        """The relative error allowed."""
        ...

    @property
    def finest(self) -> str:
        """The fidelity whose error it is."""
        ...


class Comparison(Protocol):
    """The branches of every fidelity by name, as a mapping has them, with what the figures say beside them."""

    @property
    def case(self) -> Case:
        """The case that was run."""
        ...

    @property
    def accuracy(self) -> WithinAccuracy | None:
        """Where the case asks for an accuracy: what the one curve keeps to."""
        ...

    @property
    def finest(self) -> Mapping[str, str]:
        """For each fidelity the finest one of the same physics."""
        ...

    @property
    def shown(self) -> Mapping[str, tuple[Sheet, ...]]:
        """The numbers of the figures that the case asks for."""
        ...

    def __getitem__(self, fidelity: str, /) -> Branches: ...
    def __iter__(self) -> Iterator[str]: ...
    def __len__(self) -> int: ...
    def values(self) -> ValuesView[Branches]:
        """The branches in the case's order."""
        ...
