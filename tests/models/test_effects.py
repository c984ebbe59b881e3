import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from refusals import answers
from scipy.linalg import eigh

from tests.models.bench import POINT_MASS, STEEL
from vibeam_models.beam import assemble, assemble_with_space
from vibeam_models.effects.further_stop import FurtherStop
from vibeam_models.effects.gravity import Gravity
from vibeam_models.effects.masses import AddedMass, MasslessBeam, RigidZone, RotaryInertia
from vibeam_models.effects.opposite import Opposite
from vibeam_models.effects.sections import BondedPlate, Section
from vibeam_models.effects.supports import BeamEnds, Clamp, FurtherSupport
from vibeam_models.effects.torsion import Torsion
from vibeam_models.scene import Mass
from vibeam_models.space import bare_beam

ROOT = Path(__file__).parents[2]
LIGHT = replace(STEEL, density=7850e-9)
EI = STEEL.bending_stiffness
PLAIN = POINT_MASS
EACH = {
    type(effect).__name__: effect
    for effect in (
        AddedMass(0.0024, 0.09), RotaryInertia(2.8e-5), RigidZone(0.0117), MasslessBeam(), Clamp(100.0),
        FurtherSupport(0.05), BeamEnds("clamped-pinned"), Section(0.0, 0.05, thickness=2e-3),
        BondedPlate(0.0, 0.05, 0.02, 1e-3, 0.01), FurtherStop(0.17, 1e-3, 0.7), Opposite(0.1), Gravity("hanging"),
        Torsion(1e-3, 2.8e-5, shear_modulus=80e9),
    )
}  # fmt: skip
NAMED = {name: replace(PLAIN, effects=(effect,)) for name, effect in EACH.items()}


def end_flexibility(length):
    """Deflection and slope at the end of a cantilever under a force and a couple there."""
    return np.array([[length**3 / 3, length**2 / 2], [length**2 / 2, length]]) / EI


def test_point_mass_at_a_place_that_is_no_node():
    fine = replace(LIGHT, elements=100)
    structure, _ = AddedMass(0.1, 0.0907).apply(*bare_beam(fine), PLAIN)
    assert structure.modes(1).omega[0] == pytest.approx(np.sqrt(3 * EI / (0.1 * 0.0907**3)), rel=1e-5)


def test_point_mass_shares_in_the_base_load():
    bare, space = bare_beam(STEEL, [0.09])
    structure, _ = AddedMass(0.1, 0.09).apply(bare, space, PLAIN)
    extra = structure.contact @ np.linalg.solve(structure.K, structure.load - bare.load)
    assert extra == pytest.approx(-0.1 * 0.09**2 * (3 * 0.18 - 0.09) / (6 * EI), rel=1e-9)


def test_mass_with_rotary_inertia_at_the_end_of_a_nearly_massless_beam():
    structure, space = AddedMass(0.2, 0.18).apply(*bare_beam(LIGHT), PLAIN)
    structure, _ = RotaryInertia(2.8e-5).apply(structure, space, replace(PLAIN, mass=Mass(0.2, 0.18)))
    squared = eigh(np.linalg.inv(end_flexibility(0.18)), np.diag([0.2, 2.8e-5]), eigvals_only=True)
    np.testing.assert_allclose(structure.modes(2).omega, np.sqrt(squared), rtol=1e-6)


def test_rotary_inertia_brings_no_base_load():
    bare, space = bare_beam(STEEL)
    structure, _ = RotaryInertia(2.8e-5).apply(bare, space, PLAIN)
    assert np.array_equal(structure.load, bare.load)


def test_rigid_zone_on_a_nearly_massless_beam():
    """A flexible part of 120.3 mm carries a rigid one whose middle, 11.7 mm on, holds the mass."""
    arm = np.array([1.0, 0.0117])
    flexibility = arm @ end_flexibility(0.132 - 0.0117) @ arm
    light = replace(NAMED["RigidZone"], beam=LIGHT)
    assert assemble(light).modes(1).omega[0] == pytest.approx((0.2 * flexibility) ** -0.5, rel=1e-7)


def test_rigid_zone_is_the_limit_of_a_stiff_one_and_keeps_the_strips_mass():
    rigid = assemble(NAMED["RigidZone"])
    soft = bare_beam(STEEL, [0.132, 0.132 - 0.0117, 0.132 + 0.0117])

    middles = (soft[1].nodes[1:] + soft[1].nodes[:-1]) / 2
    factor = np.where(np.abs(middles - 0.132) < 0.0117, 1e4, 1.0)[:, None]
    stiff = soft[1].elements.stiffness(EI * factor)[2:, 2:]
    mass = AddedMass(0.2, 0.132).apply(*soft, PLAIN)[0].M
    flexibility = eigh(mass, stiff, eigvals_only=True)[::-1]
    np.testing.assert_allclose(rigid.modes(4).omega, flexibility[:4] ** -0.5, rtol=2e-4)
    assert assemble(PLAIN).modes(3).omega[2] < 0.8 * rigid.modes(3).omega[2]


def test_inside_the_rigid_zone_the_deflection_is_linear():
    structure, space = assemble_with_space(NAMED["RigidZone"])
    shape = structure.modes(5).shapes
    slope = space.rows([0.1204, 0.127, 0.1333, 0.1436], 1) @ shape
    np.testing.assert_allclose(slope, np.broadcast_to(slope[0], slope.shape), rtol=1e-6)
    middle, end = space.row(0.132) @ shape, space.row(0.1390) @ shape
    np.testing.assert_allclose(end - middle, 0.007 * slope[0], rtol=1e-6, atol=1e-9)


def test_a_rigid_zone_that_reaches_an_end_or_is_round_off_or_has_no_nodes_is_refused():
    def built(half_width):
        return assemble(replace(PLAIN, effects=(RigidZone(half_width),)))

    assert answers(built, [0.132, 0.048, 0.2], "must lie inside the beam") == []
    assert answers(built, [1e-5], "leave it out") == []
    assert answers(lambda zone: zone.apply(*bare_beam(STEEL), PLAIN), [RigidZone(0.0117)], "no node at") == []


def test_effects_change_the_numbers():
    plain = assemble(PLAIN).modes(2).omega
    for name, scene in NAMED.items():
        omega = assemble(scene).modes(2).omega
        if name == "FurtherStop":  # a row more, no matrix is another one
            assert set(assemble(scene).outputs) > set(assemble(PLAIN).outputs)
            continue
        assert np.max(np.abs(omega / plain[: len(omega)] - 1)) > 1e-3


SCRIPT = """
import hashlib, sys
for name in {blocked}:
    sys.modules["vibeam_models.effects." + name] = None   # an import of it now fails
from vibeam_models.beam import assemble
from vibeam_models.beams.beam import Beam, Damping
from vibeam_models.beams.shapes import Rectangle
from vibeam_models.scene import *
{named}
beam = Beam(0.18, Rectangle(0.02, 1.034e-3), 210e9, 7850.0, Damping("constant", (0.017,)))
scene = Scene(beam, Mass(0.2, 0.132), Stop(0.132, 0.0, 0.72), Sensor(0.1), Base(amplitude=1e-4), {effects_of_scene})
s = assemble(scene)
arrays = [s.M, s.C, s.K, s.load, s.static, s.contact, *s.outputs.values()]
loaded = [n for n in {effects} if sys.modules.get("vibeam_models.effects." + n) is not None]
print(hashlib.sha256(b"".join(a.tobytes() for a in arrays)).hexdigest(), *loaded)
"""
EFFECTS = sorted(file.stem for file in (ROOT / "models/vibeam_models/effects").glob("[a-z]*.py"))


def chapter(effect):
    """File of an effect."""
    return type(effect).__module__.rpartition(".")[2]


def program(blocked=(), effect=None):
    """What prints hash of every array, chapters loaded …, where the ``blocked`` chapters do not exist."""
    named = f"from {type(effect).__module__} import {type(effect).__name__}" if effect else ""
    given = {"named": named, "effects_of_scene": f"({effect!r},)" if effect else "()"}
    script = SCRIPT.format(effects=EFFECTS, blocked=sorted(blocked), **given)
    path = f"import sys; sys.path[:0] = [{str(ROOT / 'models')!r}]\n"
    return path + script


EACH_APART = """
import os, sys
import numpy, scipy.linalg, skfem  # of which nothing here depends on what was loaded before
for program in {programs!r}:
    sys.stdout.flush()
    child = os.fork()
    if not child:
        exec(program, {{}})
        sys.stdout.flush()
        os._exit(0)
    assert os.waitpid(child, 0)[1] == 0
"""


def built(programs):
    """[hash of every array, chapters loaded …] of each program, in a process where nothing of ours is loaded yet."""
    script = EACH_APART.format(programs=programs)
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    return [line.split() for line in done.stdout.splitlines()]


@pytest.fixture(scope="module")
def plain():
    return built([program()])[0]


def test_effects_that_are_absent_are_not_imported(plain):
    assert len(plain) == 1
    assert len(plain[0]) == 64


def test_absent_effects_cost_nothing(plain):
    """Bit by bit the same numbers as where the effects' code does not exist."""
    assert built([program(blocked=EFFECTS)]) == [plain]


def test_an_effect_is_loaded_alone_where_it_is_named(plain):
    found = built([program(effect=effect) for effect in EACH.values()])
    assert [loaded for _, *loaded in found] == [[chapter(effect)] for effect in EACH.values()]
    assert plain[0] not in [digest for digest, *_ in found]


@pytest.mark.parametrize("effect", EACH)
def test_an_effect_used_before_leaves_no_trace(effect):
    before = assemble(PLAIN)
    assemble(NAMED[effect])
    after = assemble(PLAIN)
    assert all(np.array_equal(getattr(before, name), getattr(after, name)) for name in ("M", "C", "K", "load"))
