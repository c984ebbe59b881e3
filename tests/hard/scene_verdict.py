"""A solver's answer to a scene beside the truth: impacts missed, invented, late, the stop passed, the end, energy."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from agreement import _speed as speed_scale
from scenes import FIRM, Scene, energy_of

import vibeam

BEYOND = 0.01  # share of the motion's reach by which the contact may stand beyond the stop before that is told
ASTRAY = 0.01  # the same of where it is in the end
MADE = 0.01  # the same of the energy that it has there
FAINT = 1e-9  # share of the velocities' scale below which an impact where there is none is round-off's


@dataclass
class Found:
    """What a solver says: impacts (m, 2), places of the contact with that in the end last, and what it complained of.

    ``state``: displacements and velocities (2, n) of the modes in the end, where it tells them.
    """

    impacts: np.ndarray
    places: np.ndarray
    complaint: str = ""
    state: np.ndarray | None = None


@dataclass
class Verdict:
    """Its answer beside the truth."""

    missed: int = 0
    invented: int = 0
    late: float = 0.0  # worst error of a time over the time since the start
    timed: int = 0  # impacts found
    beyond: float = 0.0
    off: float = 0.0
    made: float | None = None  # energy in the end above the true one, over that of the start; of undriven motions
    words: list[str] = field(default_factory=list)

    @property
    def fine(self) -> bool:
        """Nothing missed, invented or complained of, and neither place nor energy of the end beyond a hundredth."""
        wrong = self.beyond > BEYOND or self.off > ASTRAY or abs(self.made or 0.0) > MADE
        return not (self.missed or self.invented or self.words or wrong)

    def __str__(self) -> str:
        parts = list(self.words)
        parts += [f"{self.missed} missed"] if self.missed else []
        parts += [f"{self.invented} invented"] if self.invented else []
        parts += [f"{self.beyond:.0%} through the stop"] if self.beyond > BEYOND else []
        parts += [f"ends {self.off:.0%} off"] if self.off > ASTRAY else []
        timed = [f"{self.late:.0e}"] if self.timed else []
        return "; ".join([*(parts or ["ok"]), *timed])


def judged(scene: Scene, found: Found) -> Verdict:
    """Each firm true impact looks for its nearest within half an interval; a firm one without a partner is invented."""
    verdict = Verdict(words=[found.complaint] if found.complaint else [])
    firm = scene.firm
    free = np.ones(len(found.impacts), dtype=bool)
    for k, (t, _) in enumerate(firm):
        beside = [abs(t - firm[j, 0]) for j in (k - 1, k + 1) if 0 <= j < len(firm)]
        window = min([*beside, scene.end - scene.begin]) / 2
        apart = np.where(free, np.abs(found.impacts[:, 0] - t), np.inf)
        if not len(apart) or not apart.min() <= window:
            verdict.missed += 1
            continue
        free[apart.argmin()] = False
        verdict.timed += 1
        since = t - scene.begin
        verdict.late = max(verdict.late, apart.min() / (since if since > 0 else scene.end - scene.begin))
    least = FIRM * firm[:, 1].max() if len(firm) else FAINT * speed_scale(scene.case)
    verdict.invented = int(np.sum(free & (found.impacts[:, 1] >= least)))
    _judge_places(scene, found, verdict)
    return verdict


def _judge_places(scene: Scene, found: Found, verdict: Verdict) -> None:
    system = scene.case.system
    away = [system.gap - found.places]
    away += [] if system.second_gap is None else [system.second_gap + found.places]
    reach = max(scene.size, float(np.max(away)))
    verdict.beyond = max(0.0, -float(np.min(away))) / reach
    if scene.place is not None:
        verdict.off = abs(float(found.places[-1]) - scene.place) / reach
    if scene.energy is not None and found.state is not None:
        begun = energy_of(scene.case, scene.case.start.displacement, scene.case.start.velocity)
        verdict.made = (energy_of(scene.case, *found.state) - scene.energy) / (begun - least_energy(scene.case.system))


def least_energy(system: vibeam.ImpactSystem) -> float:
    """Energy of the place where modes without a drive come to rest: free, else on the stop by a multiplier."""
    n, stiffness = system.size, system.omega**2
    if np.all(stiffness > 0) and system.contact @ (system.static / stiffness) <= system.gap:
        return -float(np.sum(system.static**2 / stiffness)) / 2
    held = np.block([[np.diag(stiffness), system.contact[:, None]], [system.contact[None, :], np.zeros((1, 1))]])
    place = np.linalg.solve(held, np.append(system.static, system.gap))[:n]
    return float(np.sum(stiffness * place**2) / 2 - system.static @ place)


def flown(scene: Scene, certify: bool = False) -> tuple[Found, list[vibeam.Trajectory]]:
    """The flight solver's answer, and its paths."""
    system, drive, start = scene.case
    paths, begin = [], scene.begin
    for end in scene.pieces:
        paths.append(vibeam.simulate(system, drive, end, start, t_start=begin, certify=certify))
        start, begin = paths[-1].state, end
    impacts = [np.stack([path.impact_times, path.impact_velocities], axis=1) for path in paths]
    places = [path.at(np.linspace(path.t_start, path.t_end, 2001 if len(paths) < 10 else 5)) for path in paths]
    complaint = "" if paths[-1].ended is vibeam.Ended.COMPLETE else paths[-1].ended.value
    state = np.stack([start.displacement, start.velocity])
    last = system.contact @ start.displacement  # ``at`` the end is another double of time
    return Found(np.concatenate(impacts), np.append(np.concatenate(places), last), complaint, state), paths
