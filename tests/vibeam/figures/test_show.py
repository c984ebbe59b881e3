"""What a case shows beside its curves: the numbers, from each fidelity's own solver, in the file, and drawn."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from stand_in import one_mode

import vibeam
from vibeam.case.case import Case
from vibeam.casefile.read import parse
from vibeam.exchange.faults import CaseError
from vibeam.extensions.paper.boundaries_figure import numbers as limits
from vibeam.figures import FIGURES
from vibeam.report.figures import figure, write_shown
from vibeam.runs.store.file import read

SDOF = one_mode('["1.8 rad/s", "2 rad/s"]', 150, 4, gap="GAP", direction="up")
EVERY = [
    '[show.history]\nkind = "history"\nfrequency = ["1.8 rad/s", "2 rad/s"]\nperiods = 3',
    '[show.portrait]\nkind = "portrait"\nfrequency = "2 rad/s"',
    '[show.section]\nkind = "section"\nfrequency = "2 rad/s"\nperiods = 5',
    '[show.curve]\nkind = "curve"\nquantity = "impact_velocity"',
    '[show.gaps]\nkind = "boundaries"\nquantity = "largest_gap"',
]


def case_of(*parts: str, gap: float = 0.0, solvers: tuple[str, ...] = ("flight",)) -> Case:
    own = [f'[fidelity.{name}]\nsolver = "{name}"' for name in solvers]
    return parse("\n".join([SDOF.replace("GAP", str(gap)), *own, *parts]) + "\n")


@pytest.mark.parametrize(
    ("solver", "near"), [("flight", 1e-9), ("mapping", 1e-7), ("orbit", 1e-7), ("direct", 5e-3), ("zhuravlev", 5e-3),
                         ("ivanov", 5e-3), ("moreau", 2e-2), ("averaging", 4e-2)]
)  # fmt: skip
def test_every_solvers_motion_obeys_the_model(solver: str, near: float) -> None:
    """At Δ = 0, Ω = 2: the reach that PHYSICS §3 has from the Green's function, v⁺ = −R v⁻, no impact but one a period.

    The velocity is the rate of the displacement between impacts, and jumps at impacts alone: in Zhuravlev's
    coordinates too, where the paper's Fig. 5 shows a further jump.
    """
    case = case_of('[show.it]\nkind = "history"\nfrequency = "2 rad/s"\nperiods = 3', solvers=(solver,))
    if solver in ("direct", "zhuravlev", "ivanov"):
        case = parse(case.text, set={"sweep.frequency": ["2 rad/s"], "sweep.settle": 70})  # 0.86⁷⁰ of a start is left
    (sheet,) = vibeam.run(case).shown["it"]
    time, place, speed = sheet["time"], sheet["displacement"], sheet["velocity"]
    assert not sheet.fault
    assert -place.min() == pytest.approx(1.753002e-2, rel=max(near, 1e-6))
    assert len(sheet["impact_time"]) == 3
    assert np.allclose(np.diff(sheet["impact_time"]), np.pi, rtol=1e-2)
    before = np.searchsorted(time, sheet["impact_time"] - 1e-9)
    after = np.searchsorted(time, sheet["impact_time"] + 1e-9) - 1
    if solver == "moreau":  # its impacts fall between two steps
        before, after = before - 1, after + 1
    assert np.allclose(speed[before], sheet["impact_velocity"], rtol=max(near, 1e-6))
    back = -1.0 if solver == "averaging" else -0.9
    assert np.allclose(speed[after], back * speed[before], rtol=max(near, 1e-6))
    smooth = np.ones(len(time) - 1, dtype=bool)
    for first, last in zip(before, after, strict=True):
        smooth[first:last] = False
    rise, rate = np.diff(place)[smooth], (np.diff(time) * (speed[1:] + speed[:-1]) / 2)[smooth]
    assert np.max(np.abs(rise - rate)) < 2e-3 * np.ptp(place)
    assert np.max(np.abs(np.diff(speed)[smooth])) < 0.3 * np.max(speed)


def test_the_averaged_motion_is_the_formula() -> None:
    """q = Δ − Q|sin θ| at two places by hand, Q = 1.8125e-2 (PHYSICS §3), one impact every T = π."""
    case = case_of('[show.it]\nkind = "history"\nfrequency = "2 rad/s"\nperiods = 2', solvers=("averaging",))
    (sheet,) = vibeam.run(case).shown["it"]
    struck = float(sheet["impact_time"][0])
    for after, share in ((np.pi / 2, 1.0), (np.pi / 6, 0.5)):
        place = np.interp(struck + after, sheet["time"], sheet["displacement"])
        assert place == pytest.approx(-share * 1.8125e-2, rel=1e-4)


def test_a_section_repeats_after_as_many_periods_as_the_response_says() -> None:
    text = '[show.it]\nkind = "section"\nfrequency = "2.35 rad/s"\nperiods = 12\nsettle = 1000'
    (sheet,) = vibeam.run(case_of(text, gap=0.5e-3)).shown["it"]
    points = np.stack([sheet["displacement"], sheet["velocity"]], axis=1)
    size = np.ptp(points, axis=0)
    assert np.all(np.abs(points[4:] - points[:-4]) < 1e-6 * size)  # period 4 (Fig. 13)
    assert np.all(np.max(np.abs(points[2:] - points[:-2]) / size, axis=1) > 1e-3)


def test_limits_against_their_closed_forms() -> None:
    """Averaging's by eq. 24 and 26 by hand; the exact fold from the quadratic's discriminant, sums term by term."""
    case = case_of(gap=0.5e-3, solvers=("flight", "averaging"))
    frequency, omega, beta, loss = np.array([1.8 / (2 * np.pi)]), 1.8, 0.015, 0.9
    sigma, decay, force = -0.1, (beta + 0.1 / np.pi) / 2, 1.8**2 * 0.5e-3 / 3
    assert limits(case, "averaging", frequency, "largest_gap")[0] == pytest.approx(
        force * np.sqrt(1 + (sigma / decay) ** 2), rel=1e-12
    )
    assert limits(case, "averaging", frequency, "least_stable_reach")[0] == pytest.approx(
        0.1e-3 / (np.pi * (sigma**2 + decay**2)), rel=1e-12
    )
    g0, g1 = impulse_train(omega, beta)
    kappa = loss / (1 + loss) - g1
    harmonic = omega**2 * 0.5e-3 / abs(complex(1 - omega**2, 2 * beta * omega))
    exact = limits(case, "flight", frequency, "largest_gap")[0]
    assert exact == pytest.approx(harmonic * np.sqrt(g0**2 + (kappa / omega) ** 2) * omega / abs(kappa), rel=1e-9)


def impulse_train(omega: float, beta: float) -> tuple[float, float]:
    """Response to unit impulses at 0, −T, −2T …: displacement at 0 and velocity at 0⁺, summed term by term."""
    rate, time = np.sqrt(1 - beta**2), np.arange(0, 4000) * 2 * np.pi / omega
    fade = np.exp(-beta * time)
    sine, cosine = np.sin(rate * time) / rate, np.cos(rate * time)
    return float(np.sum(fade * sine)), float(np.sum(fade * (cosine - beta * sine)))


@pytest.mark.usefixtures("undrawn")
def test_everything_is_kept_and_not_made_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = tmp_path / "r.h5"
    case = case_of(*EVERY, solvers=("flight", "averaging"))
    first = vibeam.run(case, out)
    files = write_shown(first, out)
    assert {file.name for file in files} == {f"r_{name}.{end}" for name in case.shows for end in ("png", "svg")}
    assert all(file.stat().st_size > 1000 for file in files)

    def never(*_: Any) -> None:
        raise AssertionError("made again")

    kinds = [f"figures.kinds.{each}.columns" for each in ("history", "portrait", "section")]
    for made in (*kinds, "extensions.paper.boundaries_figure.sheets"):
        monkeypatch.setattr(f"vibeam.{made}", never)
    again = vibeam.run(case, out)
    for name in ("history", "portrait", "section", "gaps"):
        for one, other in zip(first.shown[name], again.shown[name], strict=True):
            assert (one.fidelity, one.fault) == (other.fidelity, other.fault)
            assert set(one.columns) == set(other.columns)
            assert all(np.array_equal(one[key], other[key], equal_nan=True) for key in one.columns)
    with pytest.raises(AssertionError, match="made again"):
        vibeam.run(case_of(*EVERY[:1], '[show.portrait]\nkind = "portrait"\nfrequency = "1.9 rad/s"',
                           solvers=("flight", "averaging")), out)  # fmt: skip
    with h5py.File(out) as file:
        rows = file["show/history/flight/1/velocity"]
        assert (rows.attrs["units"], rows.attrs["long_name"]) == ("s-1", "velocity of the output")
        assert file["show/history/flight/1"].attrs["frequency"] == pytest.approx(1 / np.pi)
    assert set(read(out)) == {("flight", "up"), ("averaging", "up")}


def test_what_fails_says_why() -> None:
    text = '[show.it]\nkind = "portrait"\nfrequency = "2.35 rad/s"'
    case = case_of(text, gap=0.5e-3, solvers=("orbit",))
    result = vibeam.run(case)
    (sheet,) = result.shown["it"]
    assert sheet.fault.startswith("no stable motion")
    labels = [text.get_text().replace("\n", " ") for text in figure(result, case.shows["it"]).legends[0].get_texts()]
    assert labels == ["stop", f"orbit: {sheet.fault}"]


def test_a_figure_shows_the_numbers_and_the_stop() -> None:
    case = case_of(EVERY[1], gap=0.5e-3)
    result = vibeam.run(case)
    (axes,) = figure(result, case.shows["portrait"]).axes
    path, marks, stop = axes.lines
    assert np.array_equal(path.get_xdata(), result.shown["portrait"][0]["displacement"])
    assert np.array_equal(path.get_ydata(), result.shown["portrait"][0]["velocity"])
    assert np.allclose(marks.get_xdata(), 0.5e-3, atol=1e-12)
    assert np.allclose(marks.get_ydata(), result.shown["portrait"][0]["impact_velocity"], rtol=1e-6)
    assert list(stop.get_xdata()) == [0.5e-3, 0.5e-3]


@pytest.mark.parametrize(
    ("lines", "fault"),
    [
        ('kind = "movie"', "kind: 'movie' is not one of " + " | ".join(f'"{name}"' for name in FIGURES)),
        ('kind = "portrait"', 'frequency: missing: kind = "portrait" needs it'),
        ('kind = "curve"\nquantity = "reach"\nperiods = 3', 'periods: kind = "curve" has no use for it: leave it away'),
        ('kind = "curve"\nquantity = "largest_gap"', 'quantity: kind = "curve" shows "amplitude" | "reach" | '
         '"maximum" | "minimum" | "impact_velocity" | "impacts_per_period" | "period" | "output_reach"'),
        ('kind = "boundaries"\nquantity = "reach"',
         'quantity: kind = "boundaries" shows "least_stable_reach" | "largest_gap"'),
        ('kind = "portrait"\nfrequency = "2 rad/s"\nfidelities = ["flihgt"]',
         "fidelities.0: no fidelity 'flihgt'; did you mean 'flight'?"),
    ],
)  # fmt: skip
def test_wrong_tables_are_told(lines: str, fault: str) -> None:
    with pytest.raises(CaseError) as caught:
        case_of("[show.it]", lines)
    assert [str(each).split(": ", 1)[1] for each in caught.value.faults] == [f"show.it.{fault}"]


def test_a_figure_refuses_a_system_that_its_closed_forms_do_not_know() -> None:
    linear = 'law = "linear"\nstiffness = 100.0\nrestitution = 0.9'
    made = [parse(case_of(EVERY[4]).text.replace("restitution = 0.9", linear)), case_of(EVERY[4])]
    with pytest.raises(CaseError, match=r"case\.toml:\d+: show\.gaps\.fidelities: flight: no closed form"):
        vibeam.run(made[0])
    assert not vibeam.run(made[1]).shown["gaps"][0].fault


@pytest.mark.parametrize("group", ["show", "comparison", "models"])
def test_no_fidelity_takes_the_place_of_another_group(group: str) -> None:
    with pytest.raises(CaseError, match=f'the name "{group}" is that of a group'):
        case_of(f"[fidelity.{group}]")


def test_a_show_changes_no_sweep() -> None:
    assert case_of().key == case_of(*EVERY).key
    plans = [case_of(EVERY[1]), case_of(EVERY[1].replace("2 rad", "2.1 rad")), case_of(EVERY[1], gap=1e-3)]
    assert len({case.shows["portrait"].key for case in plans}) == 3


@pytest.mark.parametrize("name", ["direct", "zhuravlev", "ivanov"])
def test_options_that_a_solver_hands_on_are_known(name: str) -> None:
    case = case_of(f'[fidelity.other]\nsolver = "{name}"\noptions = {{ method = "RK45", rtol = 1e-6 }}')
    short = parse(case.text, set={"sweep.settle": 3})
    assert vibeam.run(short, show=False)["other"].up is not None
    with pytest.raises(CaseError, match="has no option steps: there are method, rtol, atol, limit, repeats"):
        vibeam.run(case_of(f'[fidelity.other]\nsolver = "{name}"\noptions = {{ steps = 3 }}'))
