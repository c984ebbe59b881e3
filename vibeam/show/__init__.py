"""What a case shows beside its frequency-response curves: each kind of [show.NAME] table is one entry and one module.

A kind's module has ``sheets(case, fidelity, plan)``, the numbers of one fidelity (kept in the results file), and
``draw(figure, result, plan, sheets)``, which makes the figure of them. A case without such tables loads no kind
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Kind:
    """One kind: where it is, what it shows, the keys that it needs and those that it may have."""

    home: str
    meaning: str
    needs: tuple[str, ...] = ()
    takes: tuple[str, ...] = ()


MOTION = ("periods", "settle")
KINDS = {
    "history": Kind("vibeam.show.history", "displacement and velocity over time", ("frequency",), MOTION),
    "portrait": Kind("vibeam.show.portrait", "velocity over displacement", ("frequency",), MOTION),
    "section": Kind("vibeam.show.section", "one point a drive period", ("frequency",), MOTION),
    "curve": Kind("vibeam.show.curve", "another quantity over frequency", ("quantity",)),
    "boundaries": Kind("vibeam.show.boundaries", "averaging's limits beside the exact ones", ("quantity",)),
}
#: of the kind ``boundaries``: Q* of eq. 24, Δ_MAX of eq. 26, and the reach and the gap at the exact folds
LIMITS = ("least_stable_reach", "largest_gap")
