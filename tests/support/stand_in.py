"""A case without a beam and a solver that takes no time: every point hangs on the state to its last bit."""

from __future__ import annotations

import os
import signal
import time
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path
from threading import Lock
from types import SimpleNamespace
from typing import Any

import numpy as np

from vibeam.case.plans import FigurePlan
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import FrequencyResponse
from vibeam.system.state import State
from vibeam_models.sdof import SdofScene

RIG = Path(__file__).parents[2] / "cases" / "dtu_neutral.toml"
HELD_AT_CONTACT = RIG.read_text(encoding="utf-8").replace('restitution_of = "first mode"', 'restitution_of = "contact"')


#: makes the plain numbers of a case SI, as an override: the lines of its text stay where they are
SI = {"units": "SI"}


def one_mode(
    frequency: str, settle: int, hold: int, *further: str, gap: object = 0, loss: str = "restitution = 0.9",
    direction: str | None = None,
) -> str:  # fmt: skip
    """Text of a case of one degree of freedom, the paper's nominal one; ``further``: its last lines."""
    swept = [f"frequency = {frequency}", *([f'direction = "{direction}"'] if direction else [])]
    stop = ["[stop]", f"gap = {gap}", loss, "[drive]", "amplitude = 0.5e-3"]
    lines = [
        'units = "SI"',
        "[sdof]",
        "damping_ratio = 0.015",
        *stop,
        "[sweep]",
        *swept,
        f"settle = {settle}",
        f"hold = {hold}",
    ]
    return "\n".join([*lines, *further]) + "\n"


GRID = '{ from = "1.5 rad/s", to = "2.5 rad/s", points = 5 }'
SDOF = 'title = "one degree of freedom"\n' + one_mode(GRID, 20, 5, "[fidelity.sdof]", gap=0.0, direction="both")


class Solver:
    """Stands in for ``march_blocks``; ``calls`` collects the points computed, ``fail_at`` stops before one."""

    def __init__(self, fail_at: int | None = None, failure: BaseException | str = "kill", pause: float = 0.0) -> None:
        self.calls: list[tuple[int, float]] = []
        self.fail_at, self.failure, self.pause = fail_at, failure, pause
        self._lock = Lock()

    def __call__(
        self, system: ImpactSystem, points: Any, settings: Any, state: State | None = None, **options: Any
    ) -> Iterator[tuple[FrequencyResponse, list[State]]]:
        state = state or State(np.full(system.size, 0.3), np.full(system.size, 0.1))
        for each in points.omega:
            time.sleep(self.pause)
            self._call(system.size, float(each))
            state = self._next(state, float(each))
            yield point(float(each) / (2 * np.pi), system.size, amplitude=abs(float(state.displacement[0]))), [state]

    @staticmethod
    def _next(state: State, omega: float) -> State:
        """A chaotic map: a state that is off by one bit is soon off altogether."""
        x = 3.9 * state.displacement * (1 - state.displacement)
        return State(x, np.sin(state.velocity * omega * 7.3), resting=bool(x[0] > 0.5))

    def _call(self, size: int, omega: float) -> None:
        with self._lock:
            if self.fail_at is not None and len(self.calls) >= self.fail_at:
                if isinstance(self.failure, BaseException):
                    raise self.failure
                os.kill(os.getpid(), signal.SIGKILL)
            self.calls.append((size, omega))


def point(frequency: float, modes: int = 1, **values: float) -> FrequencyResponse:
    """One complete point of period 1."""
    response = FrequencyResponse.empty(np.array([frequency]), modes)
    usual = {"period": 1, "ended": 0, "impacts": 100, "impacts_per_period": 1.0, "cpu_seconds": 1e-3 * modes}
    for name, value in (usual | values).items():
        getattr(response, name)[:] = value
    return response


def curve(frequency: Any, amplitude: Any, period: Any = 1, modes: int = 1, **values: Any) -> FrequencyResponse:
    """Many complete points: amplitude in m, period as in a response."""
    response = FrequencyResponse.empty(np.asarray(frequency, dtype=float), modes)
    hits = np.where(np.asarray(period) == -1, 0.0, 1.0)
    usual = {"ended": 0, "impacts": 100 * hits, "impacts_per_period": hits, "cpu_seconds": 1e-3}
    for name, value in (usual | {"amplitude": amplitude, "period": period} | values).items():
        getattr(response, name)[:] = value
    return response


def case(points: int = 8, direction: str = "both", key: str = "k" * 64, **changes: Any) -> Any:
    """What ``vibeam.run`` needs of a case: two fidelities, of one mode and of three."""
    systems = {name: system(modes) for name, modes in (("one", 1), ("three", 3))}
    sweep = SimpleNamespace(
        frequency=np.linspace(14.0, 17.0, points), direction=direction, settle=1, hold=1, output="sensor"
    )
    values = {
        "path": Path("case.toml"),
        "text": f'title = "a case"\nkey = "{key}"\n',
        "numbers": f'key = "{key}"\n',
        "key": key,
        "shared": f'key = "{key}"\n',
        "own": {name: f'key = "{key}"\nmodes = {each.size}\n' for name, each in systems.items()},
        "title": "a case",
        "scene": SimpleNamespace(natural_unit=None, outputs=()),
        "fidelities": defaultdict(plain, {name: plain(name) for name in systems}),
        "sweep": sweep,
        "record": None,
        "references": {},
        "expectations": {},
        "measured": {},
        "shows": {},
        "figure": FigurePlan(),
        "system": systems.__getitem__,
        "scene_of": lambda name: SdofScene(48.0, 0.02, 1e-4, 1.0, 1e-3),
        "amplitude_of": lambda name, omega: 1e-3,
    }
    return SimpleNamespace(**(values | changes))


def plain(name: str = "") -> Any:
    """A fidelity with nothing of its own."""
    return SimpleNamespace(name=name, solver="flight", options={}, changes={}, rig={}, without=(), label=None)


def system(modes: int, gap: float = 1e-4) -> ImpactSystem:
    """So many modes; the sensor moves half as far as the contact."""
    row = np.ones(modes)
    return ImpactSystem.from_modes(48.0 * (1 + np.arange(modes)), 0.02, row, row, gap=gap, outputs={"sensor": row / 2})


def same(one: FrequencyResponse, other: FrequencyResponse, but: tuple[str, ...] = ()) -> bool:
    """Equal to the last bit, NaN included."""
    names = [field.name for field in fields(FrequencyResponse) if field.name not in but]
    return all(np.array_equal(getattr(one, name), getattr(other, name), equal_nan=True) for name in names)


def two_modes(gap: float = 0.0, restitution: float = 0.72, **more: Any) -> ImpactSystem:
    """Two modes of the neutral rig, about."""
    return ImpactSystem.from_modes(
        [47.9, 636.0], [0.017, 0.017], [2.14, 1.3], [0.47, 0.38], gap=gap, restitution=restitution,
        outputs={"sensor": [1.36, 2.2]}, **more,
    )  # fmt: skip
