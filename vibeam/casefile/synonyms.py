"""Synonyms: keys and tables of a case by what others call them, and what is suggested for an unknown key."""

from __future__ import annotations

from collections.abc import Collection

from vibeam.exchange.faults import suggest, suggestion
from vibeam_models.extensions import absent

#: what others call it, in small letters: the keys and tables of a case that it may be
SYNONYMS = {
    "section": ("beam.shape",), "profile": ("beam.shape",), "cross_section": ("beam.shape",),
    "material": ("beam.youngs_modulus", "beam.density"), "modulus": ("beam.youngs_modulus",),
    "e": ("beam.youngs_modulus", "stop.restitution"), "elastic_modulus": ("beam.youngs_modulus",),
    "rho": ("beam.density",), "nu": ("beam.poissons_ratio",), "zeta": ("beam.damping_ratio",),
    "l": ("beam.length",), "span": ("beam.length",), "b": ("beam.width",), "breadth": ("beam.width",),
    "h": ("beam.thickness",), "t": ("beam.thickness",), "height": ("beam.thickness",), "depth": ("beam.thickness",),
    "a": ("beam.area",), "i": ("beam.second_moment",), "radius": ("beam.diameter",),
    "d": ("beam.diameter", "beam.outer_diameter"), "wall_thickness": ("beam.wall",),
    "boundary": ("beam.ends",), "boundary_conditions": ("beam.ends",), "bc": ("beam.ends",), "supports": ("beam.ends",),
    "mesh": ("beam.elements", "solid.mesh"), "fluid": ("beam.added_mass_per_length",), "second_beam": ("opposite",),
    "m": ("mass.mass",), "inertia": ("mass.rotary_inertia", "beam.second_moment"), "tip_mass": ("mass",),
    "payload": ("mass",), "x": ("mass.position", "stop.position"), "location": ("mass.position", "stop.position"),
    "clearance": ("stop.gap",), "distance": ("stop.gap",), "cor": ("stop.restitution",), "r": ("stop.restitution",),
    "contact": ("stop",), "impact": ("stop",), "obstacle": ("stop",), "stopper": ("stop",), "wall": ("stop",),
    "contact_law": ("stop.law",), "impact_law": ("stop.law",), "k": ("stop.stiffness",), "c": ("stop.damping",),
    "probe": ("sensor",), "excitation": ("drive",), "forcing": ("drive",), "load": ("drive",), "base": ("drive",),
    "accelerogram": ("drive.file",), "earthquake": ("drive.file",), "signal": ("drive.file",), "csv": ("drive.file",),
    "wav": ("drive.file",), "shock": ("drive.shape",), "pulse": ("drive.shape",), "waveform": ("drive.shape",),
    "peak": ("drive.acceleration", "drive.force"), "psd": ("drive.density",), "asd": ("drive.density",),
    "spectrum": ("drive.density",), "white_noise": ("drive.density",), "noise": ("drive.density", "measurement.noise"),
    "random": ("drive.density",), "level": ("drive.density", "drive.acceleration"), "fs": ("drive.rate",),
    "sampling_rate": ("drive.rate",), "sample_rate": ("drive.rate",), "drift": ("drive.remove", "stop.drift"),
    "head": ("drive.column",), "time_history": ("record", "drive.file"), "t_end": ("record.duration",),
    "length_of_time": ("record.duration",), "seeds": ("record.realisations",), "realizations": ("record.realisations",),
    "ensemble": ("record.realisations",), "vary": ("record.over",), "certificate": ("record.certify",),
    "initial": ("start",), "initial_conditions": ("start",), "plucked": ("start.displacement",),
    "x0": ("start.displacement",), "v0": ("start.velocity",), "drop": ("start.height",), "dropped": ("start.height",),
    "f": ("drive.force",), "frequencies": ("sweep.frequency",), "freq": ("sweep.frequency",),
    "omega": ("sweep.frequency",), "transient": ("sweep.settle", "record"), "periods": ("sweep.hold",),
    "method": ("fidelity.reduction", "fidelity.solver"), "model": ("fidelity.reduction",), "models": ("fidelity",),
    "gmsh": ("solid.mesh",), "hexahedra": ("solid",), "three_dimensional": ("solid",), "patch": ("solid.contact",),
    "block": ("solid.mass_size",), "n": ("fidelity.modes",), "order": ("fidelity.modes",), "plot": ("show",),
    "plots": ("show",), "sigma": ("measured.uncertainty",),
}  # fmt: skip


def meant(name: str, known: Collection[str]) -> list[str]:
    """Keys among those ``known`` in one place that others call so."""
    keys = (place.rpartition(".")[2] for place in SYNONYMS.get(name.lower(), ()))
    return list(dict.fromkeys(key for key in keys if key in known))


def suggest_key(name: str, known: Collection[str]) -> str:
    """As ``suggest``, of an unknown key: what others call so here, what is spelt so, what others call so elsewhere.

    Of one that an absent extension brings: that.
    """
    if why := absent(name):
        return why
    keys = meant(name, known)
    if not keys and not suggestion(name, known):
        keys = list(SYNONYMS.get(name.lower(), ()))
    return f"did you mean {' and '.join(map(repr, keys))}?" if keys else suggest(name, known)
