"""Plan of the study: keys of the table [mode_share]."""

from __future__ import annotations

from dataclasses import dataclass

from vibeam_models import keys as declare


@dataclass(frozen=True)
class ModeSharePlan:
    """Plan of ``vibeam mode_share``: ``contact_time`` s of an impact on the stop, ``speed`` m/s; None: no choice."""

    contact_time: float | None = declare.quantity(
        "s", "how long an impact on the rigid stop lasts: what its restitution is in terms of other programs then",
        "0.5 ms", None, above=0,
    )  # fmt: skip
    speed: float | None = declare.quantity(
        "m/s", "of the impact; absent = the law's, else 0.1 m/s", "0.1 m/s", None, above=0
    )
