"""Structure of a mesh of the user's own, kept by the content of its file, and all that is wrong with it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial
from hashlib import sha256
from pathlib import Path
from typing import Any, NamedTuple

from vibeam.exchange.files import FormatError, digest_of
from vibeam.extensions.solid.elasticity.body import SolidBody
from vibeam.extensions.solid.elasticity.own_mesh import OwnRig
from vibeam.extensions.solid.elasticity.plan import OwnMesh
from vibeam.extensions.solid.elasticity.scene import SPATIAL
from vibeam.extensions.solid.meshes.body import BodyReading, OwnFault
from vibeam.extensions.solid.meshes.read import read_mesh
from vibeam_models.given import GivenStructure

KEPT = 4  # structures
WHOLE = "mesh without faults"


class OwnBody(NamedTuple):
    """Body of a mesh with its drive and readings, None where there are ``faults``; ``assumed``: what no key says."""

    body: SolidBody | None
    rig: OwnRig | None
    faults: tuple[OwnFault, ...]
    assumed: tuple[str, ...]


def own_structure(
    plan: OwnMesh,
    folder: Path,
    noted: Callable[..., Any] = lambda *_: None,
    note: Callable[..., None] = lambda *_: None,
) -> tuple[GivenStructure | None, tuple[OwnFault, ...]]:
    """Structure of a mesh (None: it cannot be made), and every complaint about it; ``plan.file`` is in ``folder``.

    ``note`` gets what is known of a mesh without faults, and its digest, by which ``noted`` finds it again: that mesh
    is read where its structure is first asked for.
    """
    try:
        said = f"{digest_of(folder / plan.file)} {replace(plan, file='')!r}"
        asked = _Asked(sha256(said.encode()).hexdigest(), plan, folder)
        known = noted(_known, WHOLE, asked.digest)
        if known is None:
            made = _body(asked)
            if made.faults or made.body is None:
                return None, made.faults
            known = made.body.mass + sum(each.mass for each in made.body.masses), made.assumed
            note(known, WHOLE, asked.digest)
    except FormatError as error:
        return None, (("mesh", f"{plan.file}: {error}"),)
    made_of = partial(_structure, asked), None, *known, SPATIAL, partial(_solid_body, asked)
    return GivenStructure(asked.digest, "solid", *made_of), ()


def _known(said: tuple[float, list[str]]) -> tuple[float, tuple[str, ...]]:
    """Mass of a mesh without faults, and what no key says of it, from a note; an error where that is another's."""
    mass, assumed = said
    return float(mass), tuple(map(str, assumed))


@dataclass(frozen=True)
class _Asked:
    digest: str
    plan: OwnMesh = field(compare=False)
    folder: Path = field(compare=False)


@lru_cache(maxsize=KEPT)
def _body(asked: _Asked) -> OwnBody:
    mesh = read_mesh(asked.folder / asked.plan.file)
    made = BodyReading(asked.plan, replace(mesh, points=mesh.points * asked.plan.unit))
    body, rig = made.body_and_rig()
    return OwnBody(body, rig, tuple(dict.fromkeys(made.faults)), tuple(dict.fromkeys(made.assumed)))


@lru_cache(maxsize=KEPT)
def _structure(asked: _Asked) -> Any:
    from vibeam.extensions.solid.elasticity.own_structure import body_structure

    made: Any = _body(asked)  # without faults
    return body_structure(made.body, made.rig).with_(damping=asked.plan.damping)


def _solid_body(asked: _Asked) -> Any:
    return _body(asked).body
