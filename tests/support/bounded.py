"""A bound on loops whose end a processor's last digits may decide: a motion by someone else, from event to event."""

from __future__ import annotations


class Bound:
    """The rounds that a loop may take: ``while within(t < end)`` of ``within = Bound(1000)``."""

    def __init__(self, most: int = 100_000) -> None:
        self.most, self.left = most, most

    def __call__(self, going: bool) -> bool:
        """Whether the loop goes on, as given; AssertionError after its most rounds."""
        self.left -= 1
        assert self.left >= 0, f"not at its end after {self.most} rounds"
        return bool(going)
