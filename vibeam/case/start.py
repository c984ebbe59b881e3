"""Start of a record case: the state of a system that is plucked, moving or dropped, or has settled."""

from __future__ import annotations

from dataclasses import replace
from math import sqrt

import numpy as np

from vibeam.case.plans import StartPlan, moving
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.record_samples import GRAVITY
from vibeam.system.state import State
from vibeam_models.arrays import Array

BEYOND = 1e-12  # share of the deflection at a stop by which it may be beyond it, rounded


def start_of(system: ImpactSystem, plan: StartPlan) -> State:
    """State of ``system`` at the start; ValueError where it is beyond a stop, or nothing there gives way.

    A dropped rig is weightless until its base stops: it is then in equilibrium without its static load.
    """
    dropped = base_velocity(plan)
    system = replace(system, static=np.zeros(system.size)) if dropped else system
    if plan.displacement is None and plan.force is None:
        state = _settled(system, plan)
        if not moving(plan):
            return state
        displacement = state.displacement
    else:
        displacement = _plucked(system, plan)
    velocity = system.load * dropped if plan.velocity is None else _moving(system, plan)
    return State(displacement, velocity)


def base_velocity(plan: StartPlan) -> float:
    """Velocity of a dropped rig when its base stops, m/s; 0 of one that is not dropped."""
    return sqrt(2 * GRAVITY * plan.height) if plan.height is not None else plan.base_velocity or 0.0


def _settled(system: ImpactSystem, plan: StartPlan) -> State:
    if plan.settled is None:
        raise ValueError("start: the static equilibrium is not known here")
    return plan.settled(system)


def _shape(system: ImpactSystem, output: str) -> tuple[Array, Array]:
    """Row of an output, and the modes' deflection under a unit force there."""
    if not np.all(system.omega > 0):
        raise ValueError("start: a mode without stiffness has no static shape: write base_velocity in its place")
    row = system.output(output)
    return row, row / system.omega**2


def _plucked(system: ImpactSystem, plan: StartPlan) -> Array:
    row, shape = _shape(system, plan.output)
    weight = system.static / system.omega**2
    if plan.force is None:
        assert plan.displacement is not None
        force = (plan.displacement - float(row @ weight)) / _yield(row, shape, plan.output)
    else:
        force = plan.force
    deflected = np.asarray(weight + shape * force)
    _require_clear(system, deflected)
    return deflected


def _moving(system: ImpactSystem, plan: StartPlan) -> Array:
    row, shape = _shape(system, plan.output)
    return np.asarray(shape * (plan.velocity or 0.0) / _yield(row, shape, plan.output))


def _yield(row: Array, shape: Array, output: str) -> float:
    found = float(row @ shape)
    if not found > 0:
        raise ValueError(f"start: the output {output!r} does not move in this model")
    return found


def _require_clear(system: ImpactSystem, deflected: Array) -> None:
    """ValueError for a deflection beyond a stop that is rigid; into one that yields it may go."""
    stops = [(system.contact, system.gap, system.contact_law, "the stop")]
    if system.second_gap is not None:
        stops.append((-system.contact, system.second_gap, system.contact_law, "the second stop"))
    stops += [(each.row, each.gap, each.contact_law, "a further stop") for each in system.further or ()]
    for row, gap, law, name in stops:
        depth = float(row @ deflected) - gap
        if not law.yields and depth > BEYOND * (abs(gap) + float(np.abs(row * deflected).sum())):
            raise ValueError(f"start: the contact is {depth:.4g} beyond {name}, which does not yield: deflect it less")
