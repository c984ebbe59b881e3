"""Exact flights of the model from rest at many keys, side by side: starts of a fit, and what steers it.

Points outside the closed-form family have no exact derivatives here; where their motion repeats alike at neighbouring
keys it has a difference quotient. It steers the keys while points are explained, and takes no part in the estimate.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vibeam.batches.batch import batch
from vibeam.periodic.tangents import ModalData
from vibeam.studies.fit.explanation import robust
from vibeam.studies.fit.other_motions import HOLD, SETTLE, OtherMotion
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.batches.response import BatchResponse
    from vibeam.studies.fit.points import Points
    from vibeam.studies.fit.problem import Problem
    from vibeam_models.arrays import Index


SHORT = 150  # drive periods settled where starts are looked for
STEP = 1e-3  # of a difference quotient, share of the bounds
NEAR = 3.0  # residual of a flown motion up to which it is taken to be that of the point


@dataclass(frozen=True)
class Rows:
    """Linear residuals about shares ``x``: ``residual`` (rows,) and ``jacobian`` (rows, P)."""

    x: Array
    residual: Array
    jacobian: Array

    def after(self, own: tuple[Array, Array], x: Array) -> tuple[Array, Array]:
        """Residuals and Jacobian with these rows below them."""
        moved = self.residual + self.jacobian @ (x - self.x)
        return np.concatenate([own[0], moved]), np.concatenate([own[1], self.jacobian])


def flown_losses(problem: Problem, every: Array) -> Array:
    """Losses (m,) of shares (m, P): every point against the model's motion from rest."""
    cost = np.empty((len(every), problem.count))
    for group, at, own in problem.parts():
        value = _flown(problem, group, own, every, SHORT)[0]
        off = (value - group.value) / group.uncertainty
        cost[:, at] = np.where(np.isfinite(off), off**2, 1e300)
    return np.array([robust(each) for each in cost])


def flown_rows(problem: Problem, x: Array, others: dict[int, OtherMotion]) -> Rows | None:
    """Residuals of points outside the family and their difference quotients; None where there is none."""
    away = np.where(x < 0.5, STEP, -STEP)
    every, residual, jacobian = np.vstack([x, x + np.diag(away)]), [], []
    for group, at, own in problem.parts():
        some = np.flatnonzero(np.isin(at, [j for j, each in others.items() if np.isfinite(each.value)]))
        if not len(some):
            continue
        value, found = _flown(problem, group.some(some), own[some], every, SETTLE)
        alike = np.all(found.period == found.period[0], axis=0) & (found.period[0] > 0)
        for k, j in enumerate(some.tolist()):
            if alike[k] and abs(value[0, k] - others[int(at[j])].value) < NEAR * group.uncertainty[j]:
                residual.append((value[0, k] - group.value[j]) / group.uncertainty[j])
                jacobian.append((value[1:, k] - value[0, k]) / away / group.uncertainty[j])
    return Rows(x, np.array(residual), np.array(jacobian)) if residual else None


def _flown(problem: Problem, group: Points, own: Index, every: Array, settle: int) -> tuple[Array, BatchResponse]:
    """Values (m, points) of a group's quantity from rest at shares (m, P), NaN where there is no system; all that is
    read off."""
    surface, omega = problem.surfaces[group.fidelity], group.omega
    known = [(k, surface.at(x)) for k, x in enumerate(every) if _possible(problem, group, x)]
    systems = np.array([_system(data) for _, data in known], dtype=object)[:, None]
    drive = np.array([data.drive[own] for _, data in known])
    flown = batch(systems, omega[None, :], drive, settle=settle, hold=HOLD, output="seen")
    value = np.full((len(every), len(omega)), np.nan)
    value[[k for k, _ in known]] = getattr(flown, group.quantity)
    return value, flown


def _possible(problem: Problem, group: Points, x: Array) -> bool:
    try:
        problem.surfaces[group.fidelity].at(x)
    except ValueError:
        return False
    return True


def _system(data: ModalData) -> ImpactSystem:
    return ImpactSystem(
        data.omega, data.zeta, data.contact, data.load, data.static, data.gap, data.restitution, {"seen": data.row}
    )
