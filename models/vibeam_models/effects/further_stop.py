"""A further stop beside the beam: elsewhere along it, or on its other side, by a law of its own."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import MISSING, dataclass, fields
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from vibeam_models.keys import quantity, word
from vibeam_models.laws import CONSTANT, LAWS, ContactLaw
from vibeam_models.scene import Effect, Scene

if TYPE_CHECKING:
    from vibeam_models.laws.mechanics import StopLaw
    from vibeam_models.space import BeamSpace
    from vibeam_models.structure import Structure

NAMES = (CONSTANT, "velocity restitution", "viscous restitution", "linear", "hertz", "hunt-crossley")
NUMBERS = ("restitution", "velocity", "exponent", "stiffness", "damping", "hertz_stiffness")


@dataclass(frozen=True)
class FurtherStop(Effect):
    """A stop beside that of [stop], one table for each; rigid ones struck at once follow Newton's law in turn."""

    position: float = quantity("m", "of the contact, from x = 0", "170 mm", above=0)
    gap: float = quantity("m", "gap at rest, at this contact; negative = the beam is pressed against it", "0.1 mm")
    restitution: float | None = quantity(
        "", "coefficient of restitution of this contact, for laws with a velocity the one there", 0.7, None, least=0,
        most=1,
    )  # fmt: skip
    side: Literal["above", "below"] = word(
        ("above", "below"), "above: the side that [stop] is on; below: the other one", "below", "above"
    )
    law: str = word(NAMES, "contact law of this stop, with the keys that [stop] has for it", "linear", CONSTANT)
    velocity: float | None = quantity("m/s", "of impact at which the restitution holds", "0.1 m/s", None, above=0)
    exponent: float | None = quantity("", "of penetration or velocity, as in [stop]", 1.5, None, above=0)
    stiffness: float | None = quantity("N/m", "of law linear: force over penetration", "1e6 N/m", None, above=0)
    damping: float | None = quantity("N s/m", "of law linear: force over velocity", "10 N s/m", None, least=0)
    hertz_stiffness: float | None = quantity(
        "", "of laws hertz and hunt-crossley: force over penetration^exponent, in N/m^exponent", 1e9, None, above=0
    )

    name: ClassVar[str] = "further_stop"

    @classmethod
    def faults(cls, table: Any, case: Any) -> Iterator[tuple[str, str]]:
        """As ``Effect.faults``: a place beyond the tip, numbers that the law lacks or does not know."""
        length, named = case.beam.length, table.law or CONSTANT
        if None not in (table.position, length) and table.position > length:
            yield "position", f"{table.position:g} m is beyond the tip: beam.length is {length:g} m"
        if named not in NAMES:
            return
        law = _declaration(named)
        known = {each.name: each.default is MISSING for each in fields(law)}
        given = {name for name in NUMBERS if getattr(table, name) is not None}
        lacking = [name for name, needed in known.items() if needed and name not in given]
        yield from ((name, f'missing: law = "{named}" needs it') for name in lacking)
        yield from ((name, f'does not go with law = "{named}": take it out') for name in sorted(given - set(known)))
        yield from () if lacking else law.faults(table)

    @property
    def output(self) -> str:
        """Name of the output that is the displacement toward it."""
        return f"toward the stop {self.side} at {1000 * self.position:g} mm"

    def contact(self, mobility: float) -> StopLaw | None:
        """Law of the contact in a model where its mobility is S = w M⁻¹ wᵀ (1/kg); None: the restitution alone."""
        if self.law == CONSTANT:
            return None
        declared = _declaration(self.law)
        return declared(**{each.name: getattr(self, each.name) for each in fields(declared)}).contact(mobility)

    def apply(self, structure: Structure, space: BeamSpace, scene: Scene) -> tuple[Structure, BeamSpace]:
        """An output more: the displacement toward this stop."""
        row = space.row(self.position) * (1.0 if self.side == "above" else -1.0)
        outputs, units = {**structure.outputs, self.output: row}, {**structure.units, self.output: "m"}
        return structure.with_(outputs=outputs, units=units), space


def _declaration(name: str) -> type[ContactLaw]:
    """Declaration of a law, in the form that its numbers give."""
    found: type[ContactLaw] = LAWS[name].load().forms()[0]
    return found
