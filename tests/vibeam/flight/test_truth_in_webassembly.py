"""Truth tests of the flight on the kernels of web pages; beside the native ones, and in node beside wasmtime."""

from __future__ import annotations

import ctypes
import json
import subprocess
from collections.abc import Iterator
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import test_flight_truth
import test_lanes
import test_one_motion_two_engines
import test_regimes
import test_rest
import test_yielding_stops
import wasm_kernels
from javascript import NODE
from regular_motions import REGULAR, TWO, fly_all, motion, points
from test_browser_libraries import data_end

import vibeam
from vibeam.flight.engine.browser import FIRST, LIBRARIES, SLOT, place_of
from vibeam.flight.engine.loading import WASM, file_of
from vibeam_models.laws.compliant import HuntCrossley

IN_WEBASSEMBLY = {  # truth tests that run here once more
    test_flight_truth: (
        "test_fifty_impacts_of_random_systems", "test_a_touch_is_there", "test_a_miss_is_not_there",
        "test_chatter_rest_release_and_the_next_impact", "test_the_state_where_the_rest_begins",
        "test_the_comparison_sees_a_millionth_of_the_restitution",
    ),
    test_lanes: ("test_extremes_are_those_of_the_closed_form",),
    test_rest: ("test_release_and_the_next_impacts_are_exact", "test_rest_after_chatter_is_the_same_rest"),
    test_one_motion_two_engines: ("test_the_impacts_are_the_same",),
    test_regimes: (
        "test_free_motion_with_coupled_damping_is_the_exponential_of_its_matrix",
        "test_contacts_are_those_that_an_ode_solver_finds", "test_a_free_mass_on_a_linear_stop",
        "test_a_free_mass_on_a_hertzian_stop", "test_a_free_mass_on_hunt_and_crossleys_stop",
        "test_each_impact_has_the_restitution_of_its_velocity",
        "test_a_mass_between_two_stops_rattles_with_the_period_of_its_speed",
    ),
    test_yielding_stops: ("test_the_largest_force_is_the_law_at_its_top", "test_equilibrium_stays"),
}  # fmt: skip

globals().update({name: vars(module)[name] for module, names in IN_WEBASSEMBLY.items() for name in names})


@pytest.fixture(autouse=True)
def webassembly() -> Iterator[None]:
    wasm_kernels.take()
    yield
    wasm_kernels.give_back()


def natively(work: Any, *given: Any) -> Any:
    """What ``work`` gives by the native kernels."""
    wasm_kernels.give_back()
    found = work(*given)
    wasm_kernels.take()
    return found


def assert_the_same_counters(found: vibeam.Trajectory, expected: vibeam.Trajectory) -> None:
    """Root searches may take a step more for the last digit: of integrated contacts they do."""
    assert set(found.stats) == {"cpu_seconds", "impacts", "evaluations"}
    assert found.stats["impacts"] == expected.stats["impacts"] >= 5
    integrated = isinstance(found.system.law, HuntCrossley)
    assert found.stats["evaluations"] == pytest.approx(expected.stats["evaluations"], rel=0.01 if integrated else 0)


@pytest.mark.parametrize("name", REGULAR)
def test_impacts_counters_and_values_are_those_of_the_native_kernels(name: str) -> None:
    found, expected = motion(REGULAR[name]), natively(motion, REGULAR[name])
    assert_the_same_counters(found, expected)
    assert found.segments.trace.shape == expected.segments.trace.shape
    times = np.linspace(0.0, 0.6, 200)
    for a, b in (
        (found.impact_times, expected.impact_times), (found.impact_velocities, expected.impact_velocities),
        (found.modes_at(times), expected.modes_at(times)),
    ):  # fmt: skip
        np.testing.assert_allclose(a, b, rtol=1e-12, atol=1e-12 * np.max(np.abs(b)))


def test_points_side_by_side_are_those_of_the_native_kernels_and_of_motions() -> None:
    omega = np.linspace(70.0, 110.0, 17)
    found, expected = points(TWO, omega), natively(points, TWO, omega)
    regular = expected.period > 0
    assert np.sum(regular) >= 12
    np.testing.assert_array_equal(found.period, expected.period)
    np.testing.assert_array_equal(found.impacts[regular], expected.impacts[regular])
    for a, b in ((found.maximum, expected.maximum), (found.minimum, expected.minimum)):
        np.testing.assert_allclose(a[regular], b[regular], rtol=0, atol=1e-12 * np.max(expected.amplitude))
    for i in np.flatnonzero(regular)[::4]:
        turn = 2 * np.pi / omega[i]
        path = vibeam.simulate(replace(TWO, restitution=0.4), vibeam.Drive(omega[i], 2e-4), 80 * turn)
        late = path.at(np.linspace(60 * turn, 80 * turn, 40_001))
        assert found.minimum[i] == pytest.approx(late.min(), rel=1e-5)  # of 2000 samples a period


IN_NODE = """
import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";
import { gunzipSync } from "node:zlib";
const { first, libraries, calls } = JSON.parse(readFileSync(0, "utf8"));
const memory = new WebAssembly.Memory({ initial: first / 65536 });
const functions = {};
for (const file of libraries) {
  const module = new WebAssembly.Module(gunzipSync(readFileSync(file)));
  Object.assign(functions, new WebAssembly.Instance(module, { env: { memory } }).exports);
}
const digests = calls.map(([name, file]) => {
  const bytes = readFileSync(file), more = first + bytes.length - memory.buffer.byteLength;
  if (more > 0) memory.grow(Math.ceil(more / 65536));
  new Uint8Array(memory.buffer).set(bytes, first);
  const status = functions[name](first);
  const after = Buffer.from(memory.buffer, first, bytes.length);
  return [status, createHash("sha256").update(after).digest("hex")];
});
console.log(JSON.stringify(digests));
"""


def test_node_gives_the_same_bits(tmp_path: Path) -> None:
    """Every call of these motions, once more in another engine: all arrays and results, to the last bit."""
    with wasm_kernels.noted() as calls:
        fly_all()
    assert {name for name, _, _ in calls} == {
        f"{library}_{name}" for library in LIBRARIES for name in LIBRARIES[library]
    }
    files = []
    for i, (name, before, _) in enumerate(calls):
        (tmp_path / f"{i}").write_bytes(before)
        files.append([name, str(tmp_path / f"{i}")])
    given = {"first": FIRST, "libraries": [str(file_of(name, WASM)) for name in LIBRARIES], "calls": files}
    (tmp_path / "calls.mjs").write_text(IN_NODE)
    done = subprocess.run(
        [NODE, tmp_path / "calls.mjs"], input=json.dumps(given), capture_output=True, text=True, check=True
    )
    assert json.loads(done.stdout) == [[0, sha256(after).hexdigest()] for _, _, after in calls]


@pytest.mark.parametrize("library", LIBRARIES)
def test_a_stack_takes_a_small_part_of_its_room(library: str) -> None:
    """Filled with a pattern before the motions, all but its top keeps it: it lies above the constants."""
    shared = wasm_kernels.shared_memory()
    begin, room = -(-data_end(shared.module_bytes(library)) // 16) * 16, SLOT // 2
    assert place_of(library) < begin
    pattern = b"\xa5" * room
    ctypes.memmove(shared.address(FIRST) + begin, pattern, room)
    fly_all()
    after = np.frombuffer(ctypes.string_at(shared.address(FIRST) + begin, room), np.uint8)
    touched = np.flatnonzero(after != 0xA5)
    assert len(touched)
    assert room - touched[0] < room // 4
