"""Truth tests of the flight on the kernels for other systems: of Windows by wine, of macOS mapped in that system's way,
of aarch64 by an emulator, of Linux with musl as its C library.

Needs the libraries of all systems, and hosts (apt install wine64 gcc-mingw-w64-x86-64 qemu-user gcc-aarch64-linux-gnu
musl-tools)::

    python -m vibeam.flight.ahead_of_time FOLDER --levels all
    VIBEAM_LIBRARIES=FOLDER pytest -m slow tests/vibeam/flight/test_truth_elsewhere.py
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from host_programs import PROGRAMS, missing
from hosted_kernels import Host
from regular_motions import TWO, points
from test_truth_in_webassembly import IN_WEBASSEMBLY as TRUTH

from vibeam.flight.engine.entries import ENTRIES

globals().update({name: vars(module)[name] for module, names in TRUTH.items() for name in names})

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module", params=PROGRAMS)
def host(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Host]:
    reason = missing(request.param)
    if reason:
        pytest.skip(reason)
    found = PROGRAMS[request.param].begun(tmp_path_factory.mktemp("host"))
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
