"""Stop that yields in place of a coefficient of restitution, as the table [stop] of a case: Hunt and Crossley's law.

Its loss per speed does not depend on the mass that strikes it, so that it is the same stop in every model of the rig,
and its stiffness follows from radius and materials. The case's R is taken as that of a free mass at 0.1 m/s. Radius,
speed and what the case does not say of the materials are assumed, and marked so.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from vibeam_models.keys import defaults_of, keys_of
from vibeam_models.scene import RigScene
from vibeam_models.stop import Stop

LEAST = 0.05  # restitution in place of 0, which no damping of this law gives
OTHER = ("position", "restitution", "restitution_of")
ASSUMED = "  # assumed: write your own"
STEEL = ("210 GPa", 0.3)


def yielding_stop(scene: RigScene) -> str:
    """Table [stop] of a case with the scene's stop made to yield: TOML of several lines, complete."""
    return "\n".join(["[stop]", *_place(scene), *_law(scene)])


def _place(scene: RigScene) -> Iterator[str]:
    """Keys of the stop that go with every law, where they are not as usual."""
    rig: Any = scene
    stop: Any = scene.stop
    if not scene.no_beam and (rig.mass is None or rig.mass.position != stop.position):
        yield f'position = "{stop.position:.12g} m"'
    usual = defaults_of(Stop)
    for name, key in keys_of(Stop).items():
        value = getattr(stop, name)
        if name in OTHER or (name in usual and value == usual[name]):
            continue
        written = [f'"{each:.12g} {key.unit}"' if key.unit else f'"{each}"' for each in _listed(value)]
        yield f"{name} = {'[' + ', '.join(written) + ']' if key.several else written[0]}"


def _listed(value: Any) -> tuple[Any, ...]:
    return value if isinstance(value, tuple) else (value,)


def _law(scene: RigScene) -> Iterator[str]:
    """Keys of the law: Hertz's stiffness of a sphere, and the loss."""
    rig: Any = scene
    beam = None if scene.no_beam else rig.beam
    modulus = STEEL[0] if beam is None else f"{beam.youngs_modulus / 1e9:.12g} GPa"
    yield 'law = "hunt-crossley"'
    yield f"restitution = {max(scene.stop.usual_restitution, LEAST):.12g}"
    yield f'velocity = "0.1 m/s"{ASSUMED}, of impacts at which this restitution holds'
    yield f'radius = "5 mm"{ASSUMED}, of the stop where it is met'
    yield f'youngs_modulus = "{modulus}"{ASSUMED}'
    yield f"poissons_ratio = {STEEL[1]}{ASSUMED}"
    if beam is None:
        yield f'counterbody_youngs_modulus = "{STEEL[0]}"{ASSUMED}'
    if beam is None or beam.poissons_ratio is None:
        yield f"counterbody_poissons_ratio = {STEEL[1]}{ASSUMED}"
