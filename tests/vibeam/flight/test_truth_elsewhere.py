"""Truth tests of the flight on the kernels for Windows, run by wine.

Needs libraries for that system and a host (apt install wine64 gcc-mingw-w64-x86-64)::

    python -m vibeam.flight.ahead_of_time FOLDER --levels all
    VIBEAM_LIBRARIES=FOLDER pytest -m slow tests/vibeam/flight/test_truth_elsewhere.py
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator

import numpy as np
import pytest
from hosted_kernels import LIBRARIES, SOURCE, Host
from regular_motions import TWO, points
from test_truth_in_webassembly import IN_WEBASSEMBLY as TRUTH

from vibeam.flight.engine.entries import ENTRIES

globals().update({name: vars(module)[name] for module, names in TRUTH.items() for name in names})

LEVELS = ("windows-x86-64-v2", "windows-x86-64-v3")
COMPILER = "x86_64-w64-mingw32-gcc"

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not (shutil.which(COMPILER) and shutil.which("wine")), reason="no wine or no mingw-w64"),
    pytest.mark.skipif(not (LIBRARIES / LEVELS[0]).exists(), reason="VIBEAM_LIBRARIES names no libraries for Windows"),
]


@pytest.fixture(scope="module", params=LEVELS)
def host(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Host]:
    folder = tmp_path_factory.mktemp("host")
    subprocess.run([COMPILER, "-O1", str(SOURCE), "-o", str(folder / "host.exe")], check=True)
    found = Host(
        request.param, ["wine", str(folder / "host.exe")], {"WINEPREFIX": str(folder / "wine"), "WINEDEBUG": "-all"}
    )
    yield found
    found.end()


@pytest.fixture(autouse=True)
def elsewhere(host: Host) -> Iterator[None]:
    before = sum(host.calls.values())
    with host.hosting():
        yield
    assert sum(host.calls.values()) > before  # the test did fly there


def test_points_side_by_side_are_those_of_the_kernels_here(host: Host) -> None:
    assert all(map(host.taken, ENTRIES))
    omega = np.linspace(70.0, 110.0, 17)
    found = points(TWO, omega)
    for each in ENTRIES:
        vars(each).pop("function", None)
    expected = points(TWO, omega)
    regular = expected.period > 0
    assert np.sum(regular) >= 12
    np.testing.assert_array_equal(found.period, expected.period)
    for a, b in ((found.maximum, expected.maximum), (found.minimum, expected.minimum)):
        np.testing.assert_allclose(a[regular], b[regular], rtol=0, atol=1e-12 * np.max(expected.amplitude))
