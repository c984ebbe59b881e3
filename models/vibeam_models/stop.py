"""Stop: what the contact meets, its gap and its law, as frozen data in SI units."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from vibeam_models.keys import declared, quantity, word
from vibeam_models.laws import RESTITUTION, ContactLaw


@dataclass(frozen=True)
class Stop:
    """A one-sided stop ``gap`` m from the contact point at ``position`` m along the beam.

    ``gap_at``: where the gap was measured, at the contact or, as grazing amplitude, at the sensor (it is then carried
    to the contact by the static mode). ``restitution_of``: whose coefficient ``restitution`` is, the contact's or the
    first mode's (each fidelity's contact value is then derived so that mode 1 sees it); None where the law says the
    loss otherwise. ``law``: None is constant restitution. ``second_gap`` (m): to a second stop on the other side.
    ``drift`` (m): added to the gap at ``drift_frequency`` (Hz), linear between. ``wear`` (m): added to the gap at the
    contact by each impact.
    """

    position: float = quantity(
        "m", "of the contact, from x = 0; absent = at the mass, if there is one", "132 mm", above=0
    )
    gap: float = quantity(
        "m", "gap at rest; negative = the beam is pressed against the stop", "0 mm",
        plain=("gap at rest Δ, in the unit of the motion", 0.0, ""),
    )  # fmt: skip
    restitution: float | None = declared(RESTITUTION, None)
    gap_at: Literal["contact", "sensor"] = word(
        ("contact", "sensor"), "where the gap was measured: at the contact, or as grazing amplitude at the sensor",
        "sensor", "contact",
    )  # fmt: skip
    restitution_of: Literal["contact", "first mode"] = word(
        ("contact", "first mode"),
        "whose it is: the contact's, or mode 1's (each fidelity's own is then derived)", "first mode", "contact",
    )  # fmt: skip
    law: ContactLaw | None = None
    second_gap: float | None = quantity(
        "m", "gap to a second stop on the other side; absent = none", "1 mm", None, effect=True, plain=("", 0.01, "")
    )
    drift_frequency: tuple[float, ...] | None = quantity(
        "Hz", "drive frequencies between which the gap drifts; absent = it stays", ["14 Hz", "17 Hz"], None, above=0,
        several=True, ascending=True, effect=True, plain=("", ["1.5 rad/s", "2.5 rad/s"], ""),
    )  # fmt: skip
    drift: tuple[float, ...] | None = quantity(
        "m", "what is added to the gap at these frequencies, linear between them", ["0 mm", "0.02 mm"], None,
        several=True, of="drift_frequency", plain=("", [0.0, 1e-4], ""),
    )  # fmt: skip
    wear: float | None = quantity(
        "m", "what each impact adds to the gap at the contact, from point to point; absent = none", "0.1 nm", None,
        least=0, effect=True, plain=("what each impact adds to the gap, from point to point; absent = none", 1e-8, ""),
    )  # fmt: skip

    @property
    def usual_restitution(self) -> float:
        """The restitution, or 1 where the law says the loss otherwise: for tables that compare coefficients."""
        return 1.0 if self.restitution is None else self.restitution
