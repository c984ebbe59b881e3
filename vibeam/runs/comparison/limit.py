"""Limit of a fidelity: the model to which it tends with more modes and finer elements.

With the restitution R of the contact held, modes added one by one take their share of each impulse
p = −(1+R) v⁻/S, S = Σ c_i², and the motion tends to its limit as S does, like 1/N: the mass at the contact makes
1/S → 1/S∞ > 0. With the restitution R₁ of mode 1 held, the impulse is the limit's own from the first mode on, and what
remains decays much faster. The limit is therefore computed with few modes and the impulse of infinitely many:

    R' = (1+R) S/S∞ − 1 in the model of mobility S,      1 + R = (1+R₁) S∞/c₁² where R₁ is held.

1/S∞ is extrapolated over two meshes: the inertia of the elements beside the contact falls linearly with their length.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from vibeam.case.fidelity import Fidelity, system
from vibeam.case.held import holding
from vibeam.case.reduced_structure import mobility_at_contact
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.number_text import ratio
from vibeam_models.beam import structure_of
from vibeam_models.scene import RigScene, Scene, line_of

LEAST, MOST = 16, 32  # modes of the limit: twice the fidelity's, within these
RESOLVED = 3  # elements a mode: the frequency of the highest is then within 0.1 %
LEAST_SHARE = 0.8  # of the mobility of all modes that those kept must have

GIVEN = "the case gives only these modes"
FAR = (
    "the contact has little or no mass of its own: {modes} modes have {share:.0%} of its mobility, and with one "
    "coefficient of restitution mode 1 gets less of the impulse with each mode more"
)


@dataclass(frozen=True)
class Limit:
    """Limit in so many ``modes`` on so many ``elements`` (0: of given matrices); ``mobility`` S∞ of all modes, 1/kg."""

    system: ImpactSystem
    elements: int
    mobility: float

    @property
    def modes(self) -> int:
        """Number of modes kept."""
        return self.system.size

    def holding(self, scene: RigScene, restitution_of: str) -> ImpactSystem:
        """System with the impulse of infinitely many modes; ValueError where no restitution in [0, 1] gives that."""
        given, first = scene.stop.usual_restitution, float(self.system.contact[0])
        impulse = (1 + given) / self.mobility if restitution_of == "contact" else (1 + given) / first**2
        restitution = impulse * self.system.mobility - 1
        at_contact = impulse * self.mobility - 1
        if not 0 <= restitution <= 1 or at_contact > 1:
            needed = at_contact if at_contact > 1 else restitution
            raise ValueError(f"its limit would need R = {ratio(needed)} at the contact, outside [0, 1]")
        return replace(self.system, restitution=restitution)


def limit(scene: RigScene, modes: int) -> Limit:
    """Limit of a fidelity of ``modes`` modes, uncoupled; ValueError where the case has none.

    Of given matrices, and of a solid, it is that of all of their modes: their own mesh is not refined.
    """
    count = min(max(LEAST, 2 * modes), MOST)
    line = line_of(scene)
    if line is None:
        return _of_matrices(scene, count)
    plain, elements = holding(line, "contact"), resolving(line, count).beam.elements
    fine, coarse = (
        system(replace(plain, beam=replace(line.beam, elements=each)), Fidelity("limit", "full"))
        for each in (elements, elements // 2)
    )
    own, half = (each.mobility for each in (fine, coarse))
    inertia, kept = 2 / own - 1 / half, lowest_modes(fine, count)
    share = kept.mobility * inertia
    if share < LEAST_SHARE:
        raise ValueError(FAR.format(modes=kept.size, share=max(share, 0.0)))
    return Limit(kept, elements, 1 / inertia)


def resolving(scene: Scene, modes: int) -> Scene:
    """The scene on an even number of elements that resolve so many modes."""
    elements = max(scene.beam.elements, RESOLVED * modes)
    return replace(scene, beam=replace(scene.beam, elements=elements + elements % 2))


def _of_matrices(scene: RigScene, count: int) -> Limit:
    if not scene.all_modes:
        raise ValueError(GIVEN)
    most = count if scene.in_three_dimensions else min(count, structure_of(scene).size)
    kept = system(holding(scene, "contact"), Fidelity("limit", "modal", most))
    mobility = mobility_at_contact(scene)
    share = kept.mobility / mobility
    if share < LEAST_SHARE:
        raise ValueError(FAR.format(modes=kept.size, share=share))
    return Limit(kept, 0, mobility)


def lowest_modes(whole: ImpactSystem, count: int) -> ImpactSystem:
    """System truncated to its lowest modes."""
    kept = np.argsort(whole.omega, kind="stable")[:count]
    rows = {name: getattr(whole, name)[kept] for name in ("omega", "zeta", "contact", "load", "static")}
    outputs = {name: row[kept] for name, row in whole.outputs.items() if name != "contact"}
    derivatives = {name: each.taking(kept) for name, each in whole.derivatives.items()}
    return replace(whole, outputs=outputs, derivatives=derivatives, **rows)
