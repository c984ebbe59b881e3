"""What the tables of effects say together with the rest of a case."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace

from vibeam.lines import KeyPath
from vibeam.reading import Complaint


def effect_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about the effects that a beam's case names; an effect that is absent is None there."""
    if case.gravity is not None:
        yield from _gravity(case.gravity)
    if case.torsion is not None:
        yield from _torsion(case)
    if case.platform is not None:
        yield from _platform(case.platform)
    if case.shaker is not None:
        yield from _shaker(case)


def platform_output(case: SimpleNamespace, path: KeyPath, output: str | None) -> Iterator[Complaint]:
    """A complaint where the motion of a platform is asked for that is not there, or is prescribed."""
    if output == "platform" and (case.platform is None or case.platform.coupling == "one-way"):
        yield path, 'the platform has no motion of its own: add [platform] with coupling = "two-way"'


def _gravity(gravity: SimpleNamespace) -> Iterator[Complaint]:
    downwards = gravity.direction in ("hanging", "standing")
    if downwards and gravity.acceleration is not None and gravity.acceleration < 0:
        other = "standing" if gravity.direction == "hanging" else "hanging"
        yield ("gravity", "acceleration"), f'is negative: for the other way up write direction = "{other}"'


def _torsion(case: SimpleNamespace) -> Iterator[Complaint]:
    torsion, width = case.torsion, case.beam.width
    path = ("torsion", "poissons_ratio")
    given = [name for name in ("poissons_ratio", "shear_modulus") if getattr(torsion, name) is not None]
    if len(given) == 2:
        yield path, "shear_modulus says it already: keep one of the two"
    elif not given:
        yield path, "missing (or shear_modulus): write poissons_ratio = 0.3"
    elif torsion.poissons_ratio is not None and torsion.poissons_ratio > 0.5:
        yield path, f"{torsion.poissons_ratio:g} is above 0.5, where the volume grows under pressure"
    if torsion.eccentricity is not None and width is not None and abs(torsion.eccentricity) > width / 2:
        yield ("torsion", "eccentricity"), f"{torsion.eccentricity:g} m is beside the beam: beam.width is {width:g} m"


def _platform(platform: SimpleNamespace) -> Iterator[Complaint]:
    path = ("platform", "frequency")
    if platform.frequency is not None and platform.stiffness is not None:
        yield path, "platform.stiffness says it already: keep one of the two"
    elif platform.frequency is None and platform.stiffness is None:
        yield path, 'missing (or stiffness): write frequency = "3.25 Hz"'


def _shaker(case: SimpleNamespace) -> Iterator[Complaint]:
    if case.platform is None:
        yield ("shaker",), "drives a platform: add [platform], or take [shaker] away"
    elif case.platform.coupling == "two-way" and case.shaker.inductance:
        yield (
            ("shaker", "inductance"),
            "with two-way coupling the coil's current would be a state of its own, half a mode, which no solver "
            'carries: leave inductance out, or write coupling = "one-way"',
        )
