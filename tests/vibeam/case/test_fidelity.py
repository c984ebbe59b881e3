import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.models.bench import POINT_MASS, RIG, STEEL
from vibeam.case.fidelity import Fidelity, system
from vibeam_models.base import Base
from vibeam_models.base_motion import base_amplitude
from vibeam_models.beam import assemble
from vibeam_models.beams.beam import Damping
from vibeam_models.laws.restitution import first_mode_restitution
from vibeam_models.sdof import SdofScene
from vibeam_models.stop import Stop
from vibeam_reductions.declaration import REDUCTIONS

SDOF = Fidelity("sdof", "static_mode")
BEAM = Fidelity("beam", "modal", modes=8)
WHOLE = Fidelity("whole", "full")
SIZES = [(SDOF, 1), (BEAM, 8), (WHOLE, 64)]


@pytest.mark.parametrize(("fidelity", "size"), SIZES, ids=lambda x: getattr(x, "name", None))
def test_every_fidelity_of_the_rig(fidelity, size):
    made = system(RIG, fidelity)
    assert made.size == size == REDUCTIONS[fidelity.reduction].make(assemble(RIG), fidelity.modes).structure.size
    assert set(made.outputs) == {"sensor", "tip"}
    assert made.omega[0] / (2 * np.pi) == pytest.approx(7.597, abs=1e-3)
    np.testing.assert_allclose(made.zeta, 0.017, rtol=1e-3)
    assert (made.gap, made.restitution) == (0.0, 0.72)


@pytest.mark.parametrize("fidelity", [SDOF, BEAM, WHOLE], ids=lambda f: f.name)
def test_well_below_resonance_the_beam_moves_with_the_sign_of_the_base(fidelity):
    """Slow base: u'' + ω²u = Ω²B sin Ωt pushes toward +u while b is positive, on every rung alike."""
    made = system(RIG, fidelity)
    quasi_static = made.outputs["sensor"] @ (made.load / made.omega**2)
    assert quasi_static == pytest.approx(
        system(RIG, WHOLE).outputs["sensor"] @ (system(RIG, WHOLE).load / system(RIG, WHOLE).omega ** 2), rel=5e-3
    )
    assert quasi_static > 0


def test_base_load_of_a_point_mass_on_a_nearly_massless_beam():
    """The paper's B = γṼ: the sensor of the one-mode beam is driven by 1/φ(L_m)."""
    light = replace(POINT_MASS, beam=replace(STEEL, density=7850e-9))
    made = system(light, SDOF)
    assert made.outputs["sensor"][0] * made.load[0] == pytest.approx(1 / 1.5540324324324324, rel=1e-6)


def test_fine_meshes_keep_proportional_damping_proportional():
    """Round-off couples the modes by 10⁻⁸ on fine meshes: that is no reason to refuse them."""
    stiff = replace(STEEL, damping=Damping("stiffness", (0.017,)), elements=144)
    assert system(replace(RIG, beam=stiff), BEAM).zeta[0] == pytest.approx(0.017, rel=1e-5)


def test_a_gap_measured_at_the_sensor_is_carried_to_the_contact():
    made = system(replace(RIG, stop=Stop(0.132, 1e-4, 0.72, gap_at="sensor")), BEAM)
    shape = np.linalg.solve(assemble(RIG).K, assemble(RIG).contact)
    ratio = assemble(RIG).contact @ shape / (assemble(RIG).outputs["sensor"] @ shape)
    assert made.gap == pytest.approx(1e-4 * ratio, rel=1e-9)
    assert 1.5 < ratio < 1.6


@pytest.mark.parametrize("fidelity", [SDOF, Fidelity("two", "modal", modes=2), BEAM], ids=lambda f: f.name)
def test_restitution_of_the_first_mode(fidelity):
    made = system(replace(RIG, stop=Stop(0.132, 0.0, 0.72, restitution_of="first mode")), fidelity)
    seen = first_mode_restitution(made.restitution, made.contact[0], np.sum(made.contact**2))
    assert seen == pytest.approx(0.72, abs=1e-12)
    assert made.restitution >= 0.72


def test_a_first_mode_restitution_that_no_contact_gives():
    with pytest.raises(ValueError, match=r"mode 1 would see 0\.95"):
        system(replace(RIG, stop=Stop(0.132, 0.0, 0.95, restitution_of="first mode")), WHOLE)


def test_the_sdof_scene_is_itself_at_every_fidelity():
    scene = SdofScene(1.0, 0.015, 0.5e-3, 0.9, 0.4e-3)
    for fidelity in (SDOF, BEAM):
        made = system(scene, fidelity)
        assert (made.omega[0], made.zeta[0], made.load[0], made.contact[0]) == (1.0, 0.015, 1.0, 1.0)
        assert (made.gap, made.restitution, made.outputs["sensor"][0]) == (0.5e-3, 0.9, 1.0)
    assert base_amplitude(scene) == 0.4e-3


def test_base_amplitude():
    assert base_amplitude(replace(RIG, base=Base(amplitude=1e-4))) == 1e-4
    assert base_amplitude(RIG) == pytest.approx(5.16e-4 * 0.6 * 1.5540324324324324 * 0.18, rel=1e-14)


@pytest.mark.parametrize("base", [Base(), Base(voltage=0.6), Base(gain=1e-3), Base(amplitude=1e-4, voltage=0.6)])
def test_a_base_that_says_too_little_or_too_much(base):
    with pytest.raises(ValueError, match="either an amplitude"):
        base_amplitude(replace(RIG, base=base))


@pytest.mark.parametrize(("reduction", "modes"), [("modal", None), ("modal", 0), ("full", 3), ("pod", None)])
def test_a_fidelity_that_makes_no_sense(reduction, modes):
    with pytest.raises(ValueError, match="fidelity 'x'"):
        Fidelity("x", reduction, modes)


def test_more_modes_than_the_beam_has():
    with pytest.raises(ValueError, match="has 1 to 64"):
        system(RIG, Fidelity("x", "modal", modes=65))


def test_naming_fidelities_loads_neither_scipy_nor_scikit_fem():
    root = Path(__file__).parents[3]
    script = (
        f"import sys; sys.path[:0] = [{str(root)!r}, {str(root / 'models')!r}, {str(root / 'reductions')!r}]\n"
        "import vibeam.case.fidelity, vibeam.studies.derive; assert not {'scipy', 'skfem'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", script], check=True)
