"""A stop behind a spring without mass, as a contact that a reduction leaves without inertia has one."""

from __future__ import annotations

from vibeam_models.laws.compliant import CompliantStop, HuntCrossley, LinearStop
from vibeam_models.laws.restitution import Restitution, VelocityRestitution


def in_series(law: Restitution | VelocityRestitution | CompliantStop | None, flexibility: float) -> LinearStop:
    """The linear stop with a spring of ``flexibility`` g (m/N) before it: 1/k + g.

    ValueError for a law that has no such form. A rigid stop has none because the mobility of a contact without mass is
    infinite; a damped one none without a state of its own.
    """
    if isinstance(law, LinearStop) and not law.damping:
        return LinearStop(law.stiffness / (1 + law.stiffness * flexibility))
    if isinstance(law, LinearStop):
        said = "a damper behind a contact without mass makes a state of the first order"
    elif isinstance(law, HuntCrossley):
        said = f'the law "{law.name}" in series with a spring has no closed form'
    else:
        said = "its mobility is infinite, so that an impulse and a coefficient of restitution have no meaning"
    raise ValueError(
        f'contact without mass: {said}: write reduction = "residual_flexibility", or a stop with law = "linear" and '
        'damping = "0 N s/m"'
    )
