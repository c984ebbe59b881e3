"""A motion by a solver of ordinary differential equations with events: started again behind every impact and rest.

What a user of ``solve_ivp`` or of CVODE writes: flights end where a gap closes, a flight that the force ends soon
begins with a shorter step, and a contact that is too slow to come away is held until the force changes sign.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from tests.others.scenes.told import RESTING, Answer, Array, Told

STIFF = 1e5  # turns of the fastest mode in the motion from which on an implicit method is taken
STILL = 100  # impacts in one last digit of time: the solver does not come away
Leg = Callable[[float, Array, int | None, float], tuple[float, Array, int | None, Array, str]]


class Equations:
    """Rates and events of a scene in numpy."""

    def __init__(self, told: Told) -> None:
        self.told, self.n = told, told.size
        self.stiffness, self.damping, self.force = told.omega**2, 2 * told.zeta * told.omega, told.force
        self.rows = np.array([stop.row for stop in told.stops])
        self.gaps = np.array([stop.gap for stop in told.stops])

    def accelerations(self, t: float, y: Array) -> Array:
        """Of the modes, free of stops."""
        n = self.n
        driven = self.force * math.sin(self.told.drive * t) + self.told.static
        return driven - self.damping * y[n:] - self.stiffness * y[:n]

    def rate(self, t: float, y: Array, held: int | None = None) -> Array:
        """Time derivative of y = (η, η'), the contact held at a stop or free."""
        pull = self.accelerations(t, y)
        if held is not None:
            row = self.rows[held]
            pull = pull - row * ((row @ pull) / (row @ row))
        return np.concatenate([y[self.n :], pull])

    def jacobian(self, held: int | None = None) -> Array:
        """∂rate/∂y."""
        below = np.hstack([-np.diag(self.stiffness), -np.diag(self.damping)])
        if held is not None:
            row = self.rows[held]
            below = below - np.outer(row, row @ below) / (row @ row)
        return np.vstack([np.hstack([np.zeros((self.n, self.n)), np.eye(self.n)]), below])

    def beyond(self, y: Array, stop: int) -> float:
        """Depth beyond a stop, negative in front of it."""
        return float(self.rows[stop] @ y[: self.n] - self.gaps[stop])

    def press(self, t: float, y: Array, stop: int) -> float:
        """Acceleration into a stop, free of it."""
        return float(self.rows[stop] @ self.accelerations(t, y))

    def struck(self, t: float, y: Array, met: int) -> tuple[Array, float, bool]:
        """State behind an impact, how long a flight lasts if the force stays, and whether the contact rests instead."""
        n, stop, row = self.n, self.told.stops[met], self.rows[met]
        toward, speed, press = row / (row @ row), float(row @ y[n:]), self.press(t, y, met)
        place, rebound = y[:n] - toward * self.beyond(y, met), stop.restitution * speed
        rests = rebound < RESTING * self.told.speed and press > 0
        velocity = y[n:] - toward * speed if rests else y[n:] + stop.kick * speed
        return np.concatenate([place, velocity]), 2 * rebound / press if press > 0 else np.inf, rests


def is_stiff(told: Told) -> bool:
    """Modes that turn too often to be followed turn by turn."""
    return bool(told.omega.max() * (told.end - told.begin) > 2 * np.pi * STIFF)


def longest_step(told: Told) -> float:
    """1/50 of the drive's period, 1/100 of the motion: between the ends of a step no event is looked for."""
    return min(told.cycle / 50, (told.end - told.begin) / 100)


def march(told: Told, equations: Equations, leg: Leg) -> Answer:
    """The whole motion by ``leg(t, y, held, soon)``: time, y, stop met or let go (None at the end), places, complaint.

    ``soon``: how long the flight lasts if the force behind the impact stays.
    """
    n, t, y, held = told.size, told.begin, told.start, told.held
    impacts: list[tuple[float, float]] = []
    places: list[Array] = []
    complaint, soon = "", np.inf
    while t < told.end and not complaint:
        t, y, met, passed, complaint = leg(t, y, held, soon)
        places.append(passed)
        if met is None:
            continue
        if held is not None:
            held, soon = None, np.inf
            continue
        impacts.append((t, float(told.stops[met].row @ y[n:])))
        y, soon, rests = equations.struck(t, y, met)
        held = met if rests else None
        if len(impacts) > STILL and t - impacts[-STILL][0] <= STILL * np.spacing(t):
            complaint = "hangs"
    return Answer(np.array(impacts).reshape(-1, 2), np.concatenate(places), y.reshape(2, n), complaint)
