"""The twelve scenes, of ``tests/hard/scenes.py``, and their judge beside them."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parents[2] / "hard")]

from scene_verdict import ASTRAY, BEYOND, MADE, Found, Verdict, flown, judged  # noqa: E402

import scenes  # noqa: E402
from scenes import Scene  # noqa: E402

__all__ = ["ASTRAY", "BEYOND", "CHOSEN", "MADE", "Found", "Scene", "Verdict", "flown", "judged"]

CHOSEN = {
    "chatter to rest: a ball, R = 0.9": scenes.ball,
    "driven chatter: rest, release, strikes again, three modes": scenes.driven_chatter,
    "rest and release: the force changes sign": scenes.released,
    "grazing touch: 1e-8 beyond a crest of the drive": scenes.at_a_crest,
    "grazing miss: a hundred crests, 1e-6 short": scenes.hundred_crests,
    "close impacts: a ringing mode strikes again": scenes.ringing,
    "stiff: 402 modes of a beam, first strike": scenes.full_model,
    "R = 1: a thousand impacts without loss": scenes.elastic,
    "resonance: driven at an undamped mode": scenes.resonance,
    "long times: begun after 10⁶ periods": scenes.late,
    "weak contact: all modes nearly at their nodes, 1e-9": scenes.weak_contact,
    "clearance on both sides: three modes from rest": scenes.both_sides,
}
