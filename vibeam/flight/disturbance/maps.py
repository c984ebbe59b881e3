"""Tangent maps of a motion by the kind of its system: contact at one place, or at several."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vibeam.flight.disturbance.tangent import TangentMaps

if TYPE_CHECKING:
    from vibeam.flight.event_driven import Segments
    from vibeam.system.impact_system import Drive, ImpactSystem
    from vibeam.system.state import State


def maps_of(system: ImpactSystem, drive: Drive, segments: Segments, state: State) -> TangentMaps:
    """The tangent maps of a motion that ends in ``state``; ValueError where ``tangent_fault`` has a reason."""
    if reason := tangent_fault(system):
        raise ValueError(f"tangent maps are not known for {reason}")
    if system.further is None:
        return TangentMaps(system, drive, segments, state)
    from vibeam.flight.disturbance.contacts import ContactMaps

    return ContactMaps(system, drive, segments, state)


def tangent_fault(system: ImpactSystem) -> str:
    """Reason why the tangent maps of a system's motions are not known; empty where they are."""
    for law in [system.contact_law, *(each.contact_law for each in system.further or ())]:
        if system.further is not None and law.integrated:
            return f'several contacts with the law "{law.name}", which is integrated'
        if not (law.yields or law.has_slope):
            return f'the contact law "{law.name}": let the law have rebound_slope, or its contact give a table'
    return ""
