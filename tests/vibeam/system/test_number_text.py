"""Numbers as text: a ratio that is neither 0 nor 1 never shows as one of them."""

from __future__ import annotations

from math import inf, nan

import pytest

import vibeam
from vibeam.case.held import Held
from vibeam.report.tables import coefficient
from vibeam.system.number_text import percent, ratio, signed
from vibeam_models.laws.restitution import contact_restitution


@pytest.mark.parametrize("form", ["g", ".4g", ".4f", ".3g", ".0f"])
@pytest.mark.parametrize("near", [1 - 1e-9, 1 + 1e-9, 1 - 4e-7, 1 + 4e-5, 0.99996, 1e-9, -1e-9, -1 + 1e-9, 1e-300])
def test_a_ratio_that_is_not_1_or_0_does_not_show_as_1_or_0(near: float, form: str) -> None:
    if abs(near) < 1e-12 and form.endswith("f"):
        assert float(ratio(near, form)) == 0  # round-off beside 1
    else:
        assert abs(float(ratio(near, form))) not in (0.0, 1.0)
        assert float(ratio(near, form)) == pytest.approx(near, rel=0.5, abs=0.0)


def test_what_is_1_or_0_or_elsewhere_keeps_its_format() -> None:
    assert [ratio(each, ".4f") for each in (0.0, 1.0, 0.72, 1 - 1e-15, 1.5)] == [
        "0.0000",
        "1.0000",
        "0.7200",
        "1.0000",
        "1.5000",
    ]
    assert [ratio(each) for each in (nan, inf, -inf, 12.3456)] == ["nan", "inf", "-inf", "12.35"]


def test_a_share_that_is_not_all_is_not_100_percent() -> None:
    assert [percent(each) for each in (1.0, 0.9999, 0.99996, 1 - 1e-9, 1 - 1e-15)] == [
        "100 %", "99.99 %", "99.996 %", "99.9999999 %", "100 %"
    ]  # fmt: skip
    assert [percent(each) for each in (12.34, 0.5, 0.012345, inf, nan)] == ["1230 %", "50 %", "1.23 %", "∞", "–"]
    assert [signed(each) for each in (-1.0, -0.99996, 12.34, 0.1)] == ["-100 %", "-99.996 %", "+1230 %", "+10 %"]


def test_restitutions_near_1_are_said_as_they_are() -> None:
    near = 1 - 1e-9
    assert Held("contact", near).label == "R = 0.999999999 at the contact"
    assert coefficient(near) == "0.999999999"
    assert "restitution=0.999999999" in repr(
        vibeam.ImpactSystem.from_modes([10.0], 0.02, [1.0], [1.0], gap=1.0, restitution=near)
    )


def test_one_that_is_beyond_1_is_not_called_1() -> None:
    with pytest.raises(ValueError, match=r"with 1\.00000004 at the contact, outside \[0, 1\]"):
        contact_restitution(1.0, 1.0, 1.00000002)
