"""MuJoCo: modes as slide joints with springs and dampers, a stop as the limit of a fixed tendon, rolled out in C.

A limit is soft: ``solref`` in its direct form, −stiffness and −damping, makes it a spring and a damper that only push,
of which the damping follows from the restitution. How long it is in contact, and how short a step that takes, is the
user's to choose.
"""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np
from mujoco import rollout

from tests.others.scenes.told import Answer, Array, Peer, Told
from vibeam_models.laws.compliant import contact_damping_ratio

CONTACT, STEPS, HARD, CHUNK = 1 / 500, 20, 0.9999, 20_000  # a contact in cycles, its steps, solimp, steps at once
SETTING = (
    "RK4, modes as slide joints, stops as limits of a fixed tendon: `solref` −stiffness, −damping of a contact that "
    "lasts 1/500 of the drive's or the slowest mode's period, or 1/5 000 of the motion, and gives back R, `solimp` "
    "0.9999; a step of 1/20 of that; `rollout`"
)


def model_text(told: Told, step: float, lasts: float) -> str:
    """MJCF of a scene; rows of stops scaled to 1, so that the limit sees a unit mass."""
    n, row, norm = told.size, told.stops[0].row, float(np.linalg.norm(told.stops[0].row))
    stiffness = (np.pi / lasts) ** 2
    damping = 2 * contact_damping_ratio(told.stops[0].restitution) * np.sqrt(stiffness)
    joints = "".join(
        f'<body><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><joint name="q{i}" type="slide" axis="1 0 0" '
        f'stiffness="{told.omega[i] ** 2!r}" damping="{2 * told.zeta[i] * told.omega[i]!r}"/></body>'
        for i in range(n)
    )

    def tendon(name: str, coefficients: Array, more: str = "") -> str:
        parts = "".join(f'<joint joint="q{i}" coef="{float(c)!r}"/>' for i, c in enumerate(coefficients))
        return f'<fixed name="{name}" {more}>{parts}</fixed>'

    low = -told.stops[1].gap / norm if len(told.stops) > 1 else -1e6
    limit = (
        f'limited="true" range="{low!r} {told.stops[0].gap / norm!r}" solreflimit="{-stiffness!r} {-damping!r}" '
        f'solimplimit="{HARD} {HARD} 0.001 0.5 2"'
    )
    tendons = tendon("contact", row / norm, limit) + tendon("drive", told.force) + tendon("static", told.static)
    return (
        (
            f'<mujoco><option timestep="{step!r}" gravity="0 0 0" integrator="RK4"><flag autoreset="disable"/></option>'
            f"<worldbody>{joints}</worldbody><tendon>{tendons}</tendon>"
            f'<actuator><motor tendon="drive"/><motor tendon="static"/></actuator></mujoco>'
        )
        .replace("np.float64(", "")
        .replace(")", "")
    )


def prepare(told: Told) -> Callable[[], Answer]:
    """The model, compiled."""
    span = told.end - told.begin
    lasts = min(CONTACT * told.cycle, span / 5000)
    count = int(np.ceil(span * STEPS / lasts))
    step = span / count
    mujoco.set_mju_user_warning(lambda _: None)  # told by a complaint, and in no file
    model = mujoco.MjModel.from_xml_string(model_text(told, step, lasts))
    data, n = mujoco.MjData(model), told.size

    def run() -> Answer:
        state, found = np.concatenate([[0.0], told.start]), Crossings(told)
        for first in range(0, count, CHUNK):
            middle = told.begin + step * (np.arange(first, min(first + CHUNK, count)) + 0.5)
            control = np.stack([np.sin(told.drive * middle), np.ones_like(middle)], axis=1)
            path = rollout.rollout(model, data, state[None], control[None])[0][0]
            found.add(middle - step / 2, np.vstack([state, path])[:, 1:], step)
            state = path[-1]
            if not np.all(np.isfinite(state)) or np.abs(state).max() > 1e10:
                return found.answer(state[1:].reshape(2, n), "diverges")
        return found.answer(state[1:].reshape(2, n), "")

    return run


class Crossings:
    """Entries into the stops, by straight lines between steps."""

    def __init__(self, told: Told) -> None:
        self.told = told
        self.impacts: list[Array] = []
        self.places = [float(told.stops[0].row @ told.displacement)]

    def add(self, times: Array, states: Array, step: float) -> None:
        """Those of a chunk: times (m,) and states (m + 1, 2n) with the one before."""
        n = self.told.size
        for stop in self.told.stops:
            place, speed = states[:, :n] @ stop.row, states[:, n:] @ stop.row
            into = np.flatnonzero((place[:-1] <= stop.gap) & (place[1:] > stop.gap) & (speed[:-1] > 0))
            share = (stop.gap - place[into]) / (place[into + 1] - place[into])
            self.impacts.append(np.stack([times[into] + step * share, speed[into]], axis=1))
        place = states[:, :n] @ self.told.stops[0].row
        self.places += [float(place.min()), float(place.max()), float(place[-1])]

    def answer(self, state: Array, complaint: str) -> Answer:
        """In the order of time."""
        impacts = np.concatenate(self.impacts)
        return Answer(impacts[np.argsort(impacts[:, 0])], np.array(self.places), state, complaint)


PEERS = [Peer("MuJoCo", "mujoco", SETTING, prepare)]
