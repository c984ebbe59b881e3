"""Many impacts at once give what the laws give one by one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import vibeam
from vibeam.flight.rebound import rebound
from vibeam_models.laws.restitution import PlasticRestitution, TableRestitution, ViscousRestitution

LAWS = [
    TableRestitution((0.05, 0.3, 2.0), (0.9, 0.6, 0.5)), TableRestitution((0.0, 1.0), (0.3, 0.8)),
    PlasticRestitution(0.7, 0.2), ViscousRestitution(0.6), ViscousRestitution(2.0, 0.5),
]  # fmt: skip


@pytest.mark.parametrize("law", LAWS)
def test_as_the_law_says(law: TableRestitution | PlasticRestitution | ViscousRestitution) -> None:
    system = replace(vibeam.ImpactSystem.from_modes(1.0, 0.1, 1.0, 1.0), law=law)
    speeds = np.concatenate([[0.0, 0.05, 0.3, 1.0, 2.0], np.geomspace(1e-9, 1e3, 200)])
    np.testing.assert_allclose(rebound(system, speeds), [law.at(v) * v for v in speeds], rtol=1e-14)
