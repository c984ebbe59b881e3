"""Price of a long computation by a stand-in for the clock of the processor: costs along the work are known exactly."""

from __future__ import annotations

from collections.abc import Callable
from math import exp
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from vibeam.store import price as pricing
from vibeam.store.long_work import LongWork, WorkStep
from vibeam.store.price import price

Rate = Callable[[float], float]
RATES: dict[str, Rate] = {  # seconds of an item, by its place from 0 to 1
    "even": lambda at: 0.02,
    "a spike with most of the cost": lambda at: 0.002 + 0.2 * exp(-(((at - 0.07) / 0.04) ** 2)),
    "three panels": lambda at: (0.05, 0.001, 0.01)[int(3 * at * 0.999)],
    "uneven without order": lambda at: 0.01 * (1 + (at * 7919.0) % 1.0),
}


def priced(folder: Path, monkeypatch: pytest.MonkeyPatch, rate: Rate, seconds: float, alone: float = 1.0) -> Any:
    """Price, and what all steps take; ``alone``: cost of an item by itself over that of one in a whole step."""
    clock = [0.0]
    monkeypatch.setattr(pricing, "process_time", lambda: clock[0])

    def cost(step: WorkStep) -> float:
        items = range(step.first, step.last)
        share = alone + (1 - alone) * (len(items) - 1) / 19
        return share * sum(rate(item / 10_000) for item in items)

    def evaluate(step: WorkStep) -> dict[str, Any]:
        clock[0] += cost(step)
        return {"x": np.zeros(3)}

    work = LongWork(folder / "o", {"a": ""}, {"a": range(0, 10_000, 20)}, evaluate)
    return price(work, seconds), sum(map(cost, work.every))


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("alone", [1.0, 5.0])
def test_a_share_of_the_work_tells_its_price_within_its_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, rate: str, alone: float
) -> None:
    """A fifth of it, steps whole or pieces as long as is affordable: within 20 %, and within what is said of it."""
    whole = sum(RATES[rate](item / 10_000) for item in range(10_000))
    found, true = priced(tmp_path, monkeypatch, RATES[rate], whole / 5, alone)
    assert found.sampled < 0.3 * true
    assert found.seconds == pytest.approx(true, rel=min(0.2, found.error))


def test_an_error_grows_where_little_is_known(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rate = RATES["a spike with most of the cost"]
    few, true = priced(tmp_path, monkeypatch, rate, 2.0)
    many, _ = priced(tmp_path, monkeypatch, rate, 60.0)
    assert many.error < 0.15 < few.error
    assert abs(few.seconds / true - 1) < few.error


def test_short_work_is_done_whole_and_its_price_is_what_it_took(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found, true = priced(tmp_path, monkeypatch, RATES["three panels"], 1e4)
    assert found.seconds == pytest.approx(true, rel=1e-12)
    assert found.error == pricing.FLOOR
