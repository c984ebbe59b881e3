"""Motions that call every entry point once, so that numba compiles each for the arguments that it gets."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vibeam.flight.disturbance.tangent import TangentMaps
from vibeam.flight.engine.entries import march
from vibeam.flight.event_driven import Segments
from vibeam.flight.extremes import extremes
from vibeam.flight.kernels import layout
from vibeam.flight.points.disturbances import carry
from vibeam.flight.points.points import PlainPoints, PointSettings, compute
from vibeam.flight.trajectory import simulate
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.record import Record
from vibeam.system.rows import Contact
from vibeam.system.state import State
from vibeam_models.laws.compliant import HuntCrossley

DRIVE = Drive(omega=95.0, amplitude=1e-4)
PLAIN = ImpactSystem.from_modes(
    [47.7, 635.0], 0.017, contact=[2.12, 0.31], load=[0.46, 0.09], gap=0.0, restitution=0.72
)

ONE = np.ones(1)
POINT = PlainPoints([PLAIN], np.zeros(1, dtype=np.int64), DRIVE.omega * ONE, DRIVE.amplitude * ONE, ONE, 0.7 * ONE)


def fly() -> None:
    """Tables, motions, poses and certificates of the plain engine."""
    simulate(PLAIN, DRIVE, 0.1, certify=True).at(0.05)


def fly_in_regimes() -> None:
    """Motions, poses and certificates of the engine of any law and regime."""
    simulate(replace(PLAIN, law=HuntCrossley(1e6)), DRIVE, 0.1, certify=True).at(0.05)


def fly_between_contacts() -> None:
    """Motions and poses with several contacts."""
    simulate(replace(PLAIN, further=(Contact(np.array([1.0, -0.5]), 1e-4, 0.5),)), DRIVE, 0.1, certify=True).at(0.05)
    extremes(simulate(PLAIN, Record.half_sine(1.0, 0.01), 0.1), ("contact",))


def fly_side_by_side() -> None:
    """Points of a batch."""
    compute(POINT, PointSettings(settle=1, hold=1, output="contact", strobes=0, elastic=False, most_modes=2))


def disturb() -> None:
    """Disturbances of a batch's points."""
    carry(POINT, False, np.ones(1, dtype=np.int64), np.ones((1, 1, 2, 2)), single=True)


def carry_along() -> None:
    """Tangent maps of a motion without duration."""
    at_once = Segments(np.zeros((1, layout.TRACE_COLUMNS)), np.zeros((1, 2, 2)), 1.0)
    TangentMaps(PLAIN, DRIVE, at_once, State(np.zeros(2), np.zeros(2))).product()


def step() -> None:
    """No step of Moreau–Jean time stepping."""
    march(
        np.ones((layout.MOREAU_ROWS, 1)), np.ones(4), np.zeros(1), np.zeros((2, 1)), np.zeros((0, 2, 1)), np.zeros(0),
        np.zeros((0, 2)), np.zeros(2, dtype=np.int64),
    )  # fmt: skip


SCENES = {  # by group: the libraries and what calls all of their entry points
    "flight": (("tables", "flight", "certificate"), (fly,)),
    "regimes": (("regimes",), (fly_in_regimes,)),
    "contacts": (("contacts",), (fly_between_contacts,)),
    "points": (("points",), (fly_side_by_side,)),
    "tangents": (("tangents",), (disturb,)),
    "tangent_maps": (("tangent_maps",), (carry_along,)),
    "moreau": (("moreau",), (step,)),
}
