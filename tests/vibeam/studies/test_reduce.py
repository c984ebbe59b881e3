"""Reductions of a case: losses against independent solutions, and what is recommended."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from observed import NEUTRAL
from scipy.integrate import quad
from vibeam.studies.modes_needed.bases import ReductionBasis
from vibeam.studies.modes_needed.losses import Question, ResponseError, assurance
from vibeam.studies.modes_needed.reduction import Losses, ReducedStructures, ReductionStudy, _reference
from vibeam.studies.modes_needed.response import Claim
from vibeam.studies.modes_needed.transfer import INSTANTS, ContactPulse, ModalForm, TransferStudy, contact_time

import vibeam
from tests.benchmarks.recommended import flown
from tests.models.bench import RIG, STEEL
from tests.models.test_sparse import net, squared_frequencies
from vibeam.observe.restitution import first_mode_restitution
from vibeam_models.beam import assemble
from vibeam_models.beams.beam import Damping
from vibeam_models.laws.compliant import LinearStop
from vibeam_models.structure import Structure
from vibeam_reductions.declaration import REDUCTIONS
from vibeam_reductions.modes import modal
from vibeam_reductions.projection import projection

CASES = Path(__file__).parents[3] / "cases"
SMALL = {"beam.elements": 8}


@pytest.fixture(scope="module")
def study() -> ReductionStudy:
    return vibeam.reduce(vibeam.load(NEUTRAL, set=SMALL))


def coarse(damping: Damping = STEEL.damping) -> Structure:
    return assemble(replace(RIG, beam=replace(STEEL, elements=6, damping=damping)))


def direct(structure: Structure, place: str, omega: float) -> complex:
    """Transfer function from the drive by one solution of (K − ω²M + iωC) x = load."""
    row = structure.contact if place == "contact" else structure.outputs[place]
    dynamic = structure.K - omega**2 * structure.M + 1j * omega * structure.C
    return complex(row @ np.linalg.solve(dynamic, structure.load))


def with_a_damper(structure: Structure) -> Structure:
    """A dashpot at the tip couples the modes."""
    tip = structure.outputs["tip"]
    return structure.with_(C=structure.C + 0.4 * np.outer(tip, tip))


@pytest.mark.parametrize("coupled", [False, True])
@pytest.mark.parametrize("name", ["modal", "craig_bampton", "krylov", "residual_flexibility"])
def test_errors_are_those_of_direct_solutions(name: str, coupled: bool) -> None:
    structure = with_a_damper(coarse()) if coupled else coarse()
    mus = np.array([3.0, 7.55, 31.0, 80.0, 98.0, 140.0])
    asked = TransferStudy(ModalForm.of(structure), mus)
    assert asked.full.coupled == coupled
    for n in (4, 6):
        made = REDUCTIONS[name].make(structure, n)
        for place in ("contact", "sensor"):
            found = asked.errors_of(ModalForm.of(made.structure))[place]
            omegas = 2 * np.pi * mus
            exact = np.array([direct(structure, place, omega) for omega in omegas])
            small = np.array([direct(made.structure, place, omega) for omega in omegas])
            size = np.maximum(np.abs(exact), 0.01 * np.abs(exact).max())
            np.testing.assert_allclose(found, np.abs(small - exact) / size, rtol=1e-4, atol=1e-9)


@pytest.mark.parametrize("omega", [0.0, 3.0, np.pi, 40.0])
def test_the_half_sine_pulse_is_duhamels_integral(omega: float) -> None:
    """∫ sin(πτ/T) sin ω(t − τ)/ω dτ, with ω at the pulse's own frequency and at 0 too."""
    pulse = ContactPulse(1.0)
    found = pulse.deflection(np.array([omega]), np.array([2.0]), 0.1)
    for i in (10, 33, 64):
        t = i / (INSTANTS - 1)
        answer = lambda tau, t=t: np.sin(np.pi * tau) * (np.sin(omega * (t - tau)) / omega if omega else t - tau)  # noqa: E731
        assert found[i] == pytest.approx(4 * quad(answer, 0, t)[0] + 0.1 * np.sin(np.pi * t), rel=1e-6, abs=1e-12)


def test_contact_time_of_one_mass_on_springs() -> None:
    """π √(m/(K + k)), and of a far lighter, unhindered mass hit beside it π √(m/k)."""
    one = Structure([[0.2]], [[0.0]], [[50.0]], [-0.2], [0.0], [1.0])
    assert contact_time(ModalForm.of(one), LinearStop(1e4)) == pytest.approx(np.pi * np.sqrt(0.2 / 10050), rel=1e-12)
    two = Structure(np.diag([100.0, 0.2]), np.zeros((2, 2)), np.diag([1.0, 1e-6]), [-1.0, -1], [0.0, 0], [0.0, 1])
    assert contact_time(ModalForm.of(two), LinearStop(1e4)) == pytest.approx(np.pi * np.sqrt(0.2 / 1e4), rel=1e-6)


def test_restitutions_are_those_of_the_table_of_modes() -> None:
    for held in ("first mode", "contact"):
        own = {"stop.restitution_of": held, "fidelity.all": {"reduction": "full"}}
        case = vibeam.load(NEUTRAL, set=SMALL | own)
        rows = vibeam.reduce(case, bases=["modal"], most=6).of("modal")
        for row, mode in zip(rows, vibeam.modes(case, 6).rows, strict=True):
            assert row.first_mode_restitution == pytest.approx(mode.first_mode_restitution, rel=1e-9)
            assert row.contact_restitution == pytest.approx(mode.contact_restitution, rel=1e-9)
            assert row.mobility == pytest.approx(1 - mode.share, rel=1e-6)
            whole = case.system("all")
            seen = first_mode_restitution(whole)
            assert row.restitution == pytest.approx(abs(row.first_mode_restitution - seen) / (1 - seen), abs=1e-9)
            assert (row.restitution > 0.01) == (held == "contact")
            assert row.impact == row.mobility  # a rigid stop: contact time 0


def test_shapes_are_compared_with_the_mass_matrix() -> None:
    structure = coarse()
    modes = structure.modes().shapes
    turned = np.column_stack([modes[:, 0], 0.8 * modes[:, 1] + 0.6 * modes[:, 4]])
    made = projection(structure, turned)
    found = assurance(ModalForm.of(structure), made, ModalForm.of(made.structure))
    np.testing.assert_allclose(found, [1, 0.64], rtol=1e-9)


def test_a_mode_missing_in_the_band_is_a_loss_of_all_of_it(study: ReductionStudy) -> None:
    assert study.in_band == 2  # of 7.6, 101 and 407 Hz below 170 Hz
    first, second = study.of("modal")[:2]
    assert (first.frequency, first.loss) == (1, 1)
    assert second.frequency == 0


def test_what_is_recommended_stays_enough() -> None:
    """By the response; by the losses beside it. A flight that was not made counts for nothing."""
    offs = [0.4, 0.04, 0.06, 0.03, float("nan"), 0.02]
    rows = [
        Losses("basis", n + 1, loss=2 * off, response=ResponseError(off, off, -off, 7, 7, complete=n != 4))
        for n, off in enumerate(offs)
    ]
    basis = ReductionBasis("basis", REDUCTIONS["modal"])
    made = ReducedStructures(basis, rows)
    found = made.recommended(Claim(), 0.05)
    assert (found.modes, found.by_losses) == (4, 6)
    assert made.recommended(Claim(), 0.01).modes is None
    assert made.recommended(Claim(refused="no"), 0.05).modes is None
    assert ReducedStructures(basis, [Losses("basis", 1, why="none")]).recommended(Claim(), 0.01).why == "none"


def test_losses_ask_for_more_coordinates_for_a_shorter_contact_and_a_wider_band() -> None:
    case = vibeam.load(NEUTRAL, set=SMALL)

    def enough(**asked: Any) -> int:
        (found,) = vibeam.reduce(case, bases=["modal"], most=16, accuracy="2 %", **asked).recommended
        return found.by_losses or 17

    assert enough(contact_time=2e-2) < enough(contact_time=2e-4) <= enough()
    assert enough(contact_time=2e-2, band=(0.0, 20.0)) < enough(contact_time=2e-2, band=(0.0, 3000.0))


def test_each_spring_stop_predicts_the_winner_of_its_case() -> None:
    bases = ("modal", "residual_flexibility", "massless_boundary")
    cases = (vibeam.load(CASES / "reductions" / f"{name}.toml") for name in ("near_clamp", "at_mass"))
    near, at = (vibeam.reduce(case, bases=bases, most=4) for case in cases)
    assert near.of("modal")[3].static_stiffness > 0.05 > 1e-6 > near.of("residual_flexibility")[1].static_stiffness
    assert at.of("modal")[3].loss < 1e-3 < 0.1 < at.of("residual_flexibility")[1].loss
    assert near.of("massless_boundary")[3].impact < near.of("modal")[3].impact
    assert [each.why for each in at.recommended if each.basis == "massless_boundary"] == [
        "contact without mass: a damper behind a contact without mass makes a state of the first order"
    ]


def test_bases_of_fidelities_come_with_their_keys() -> None:
    own = {"reduction": "krylov", "modes": 2, "frequency": "300 Hz"}
    flown = {"reduction": "pod", "modes": 2, "frequency": "15 Hz", "periods": 20}
    case = vibeam.load(NEUTRAL, set=SMALL | {"fidelity.far": own, "fidelity.flown": flown})
    found = vibeam.reduce(case, most=4)
    assert {"far", "flown"} <= {row.basis for row in found.rows}
    assert found.of("far")[3].frequency > 10 * found.of("krylov")[3].frequency
    assert found.of("flown")[3].loss < found.of("flown")[0].loss
    with pytest.raises(KeyError, match="no basis 'pod': there are modal, static_shapes"):
        found.of("pod")


def test_a_basis_that_a_case_cannot_have_says_why_beside_the_others() -> None:
    platform = {"mass": "5 kg", "frequency": "3.25 Hz", "damping_ratio": 0.05, "coupling": "one-way"}
    platform |= {"calibrated_at": "15.5 Hz"}
    flown = {"reduction": "pod", "modes": 2, "frequency": "15 Hz"}
    found = vibeam.reduce(vibeam.load(NEUTRAL, set=SMALL | {"platform": platform, "fidelity.flown": flown}), most=3)
    said = {each.basis: each.why for each in found.recommended}
    assert said["flown"].startswith("pod: its flight is over a base that moves as prescribed")
    assert said["modal"] == ""


def test_a_free_body_has_no_static_stiffness_to_lose() -> None:
    K = np.array([[1.0, -1, 0], [-1, 2, -1], [0, -1, 1]]) * 1e3
    free = Structure(np.eye(3), 1e-3 * K, K, -np.ones(3), np.zeros(3), [0, 0, 1.0], {"sensor": [1.0, 0, 0]})
    asked = Question(TransferStudy(ModalForm.of(free), np.linspace(1, 9, 40)), 3, None, 0.5, False)
    found = asked.losses("modal", 2, modal(free, 2))
    assert np.isnan(found.static_stiffness)
    c = free.contact @ free.modes().shapes
    assert found.mobility == pytest.approx(c[2] ** 2 / (c @ c), rel=1e-9)
    assert (found.loss, found.decided_by) == (1.0, "frequency")


def test_a_sparse_structure_is_answered_by_its_lowest_modes() -> None:
    structure, notes = _reference(net(11, 13, Damping("constant", (0.02,))))
    assert structure.size == 47
    assert notes == ("143 coordinates, sparse: 47 modes with static correction stand for the full model",)
    np.testing.assert_allclose(structure.modes(30).omega ** 2, squared_frequencies(11, 13)[:30], rtol=1e-8)


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"accuracy": 0.0}, r"accuracy: 0.0 is outside \[0, 1\]"),
        ({"band": (5.0, 5.0), "most": 0}, "band: the list must ascend.*; most: 0 is outside"),
        ({"band": (1.0, 2.0, 3.0)}, "band: its two ends, not 3 frequencies"),
        ({"contact_time": "1 Hz"}, "contact_time: '1 Hz' is a frequency"),
        ({"bases": ["modl"]}, "basis: no modl: there are modal, static_shapes"),
        ({"within": 0.05}, "within: no such setting; "),
    ],
)
def test_arguments_outside_their_range_are_refused(asked: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        vibeam.reduce(vibeam.load(NEUTRAL, set=SMALL), **asked)


@pytest.mark.slow
@pytest.mark.parametrize("held", ["contact", "first mode"])
@pytest.mark.parametrize("name", ["dtu_neutral", "dtu_loose", "dtu_tight"])
def test_what_is_recommended_is_near_all_modes_when_flown(name: str, held: str) -> None:
    """Where motions repeat alike, the amplitude is within the 5 % at each point; with one mode it is not, held at R."""
    rows = flown(CASES / f"{name}.toml", held, points=31 if name == "dtu_tight" else 13)
    for row in rows if rows[0]["basis"] else []:
        assert row["alike"] >= 3, row
        assert row["worst"] <= 0.05, row
    assert len(rows) >= 5 or (name, held) == ("dtu_tight", "contact")
    if name == "dtu_neutral" and held == "contact":
        case = vibeam.load(
            CASES / "dtu_neutral.toml", set={"stop.restitution_of": "contact", "sweep.frequency": ["15.5 Hz"]}
        )
        alone = vibeam.run(replace(case, references={}))
        one, eight = (alone[each].up for each in ("sdof", "beam"))
        assert one is not None
        assert eight is not None
        assert one.amplitude[0] > 1.1 * eight.amplitude[0]
