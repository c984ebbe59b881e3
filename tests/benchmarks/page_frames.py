"""Start, frames and flights of the page that flies, in Debian's Chromium and Firefox; bytes of pages.

    python tests/benchmarks/page_frames.py [--rounds 3] [--out tests/benchmarks/results/page_frames.json]

The page of the DTU case, opened from disk without a window; wall time, for that is what its reader waits for. Flights
run beside the native library's, one thread, the same points each from static equilibrium: the ratio is of the least of
the rounds. Frames: the gap's slider moves a step each frame, best of the rounds; "at work" is the time within the
page's own code, which the 16.7 ms of a frame bound. Needs the extra ``browser``, Debian's chromium and firefox-esr.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import vibeam

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(ROOT / "tests/support"))

CASE = ROOT / "cases/dtu_neutral.toml"
FIDELITIES = {"sdof": 1, "two_modes": 2, "beam": 8}
SIZES = ("dtu_neutral", "sdof_nominal", "rigs/harvester", "rigs/two_stops")
FRAMES, FLIGHTS = 240, 8  # of a drag; of a curve in each round

OPEN = """
    const payload = JSON.parse(document.getElementById("engine").textContent), times = [];
    for (let round = 0; round < given[0]; round += 1) {
        const begun = performance.now();
        await vibeam.open(payload);
        times.push(performance.now() - begun);
    }
    return times;
"""
FIRST = """
    while (!document.querySelector("#live-history canvas")) await new Promise((done) => setTimeout(done, 1));
    return performance.now();
"""
DRAG = """
    const [wanted, frames] = given, wait = (ms) => new Promise((done) => setTimeout(done, ms));
    const boxes = [...document.querySelectorAll("#flown input")];
    for (const box of boxes.filter((each, at) => each.checked !== wanted.includes(at))) box.click();
    document.querySelector("#live-history").scrollIntoView();
    await wait(1500);
    const slider = document.querySelector("#slide-gap"), next = window.requestAnimationFrame.bind(window);
    const stamps = [], work = [], low = +slider.value, high = +slider.max;
    let spent = 0, drawn = 0;
    const measured = (act) => { const begun = performance.now(); act(); spent += performance.now() - begun; };
    window.requestAnimationFrame = (draw) => next((now) => { drawn += 1; measured(() => draw(now)); });
    await new Promise((done) => {
        const tick = (now) => {
            if (stamps.length) work.push(spent);
            stamps.push(now);
            spent = 0;
            if (stamps.length > frames) return done();
            slider.value = String(Math.min(low + stamps.length, high - 1 - stamps.length % 2));
            measured(() => slider.dispatchEvent(new Event("input", {bubbles: true})));
            next(tick);
        };
        next(tick);
    });
    window.requestAnimationFrame = next;
    return {stamps, work, drawn};
"""
FLY = """
    const [rounds, fidelity, frequencies, settle, hold] = given;
    const engine = await vibeam.open(JSON.parse(document.getElementById("engine").textContent));
    const least = (act) => {
        let best = Infinity;
        for (let round = 0; round < rounds; round += 1) {
            const begun = performance.now();
            act();
            best = Math.min(best, performance.now() - begun);
        }
        return best;
    };
    const {states} = engine.response(fidelity, {}, frequencies, {settle, hold});
    return {
        response: least(() => engine.response(fidelity, {}, frequencies, {settle, hold})),
        live: least(() => engine.response(fidelity, {gap: 1e-6}, frequencies, {settle: 20, hold: 10, states})),
        orbits: least(() => engine.orbits(fidelity, {}, frequencies)),
        motion: least(() => engine.motion(fidelity, {}, {settle: 20, periods: 4})),
    };
"""

Run = Callable[..., Any]


@contextmanager
def chromium() -> Iterator[tuple[Callable[[Path], None], Run, str]]:
    """How Chromium opens a file and runs the body of an async function in it; its version."""
    from browsers import CHROMIUM, OPTIONS
    from playwright.sync_api import sync_playwright

    with sync_playwright() as started:
        browser = started.chromium.launch(executable_path=str(CHROMIUM), args=OPTIONS)
        page = browser.new_page(viewport={"width": 1366, "height": 900})

        def run(script: str, *given: Any) -> Any:
            return page.evaluate(f"async (given) => {{ {script} }}", list(given))

        yield lambda file: page.goto(file.as_uri()), run, f"Chromium {browser.version}"
        browser.close()


@contextmanager
def firefox() -> Iterator[tuple[Callable[[Path], None], Run, str]]:
    """The same of Firefox."""
    from firefox import PREFERENCES, Firefox

    with Firefox(PREFERENCES | {"privacy.reduceTimerPrecision": False}) as found:
        version = found.run("return navigator.userAgent;").rpartition("/")[2]
        yield lambda file: found.open(file.as_uri()), found.run, f"Firefox {version}"


def in_browser(opened: Any, files: dict[str, Path], rounds: int) -> dict[str, Any]:
    """What a reader waits for in one browser."""
    with opened() as (go, run, name):
        first = []
        for _ in range(rounds):
            go(files["dtu_neutral"])
            first.append(run(FIRST))
        run("await new Promise((done) => setTimeout(done, 2000));")
        opening = run(OPEN, 2 * rounds)
        frequencies = vibeam.load(CASE).sweep.frequency.tolist()
        flights = {each: run(FLY, FLIGHTS * rounds, each, frequencies, 300, 50) for each in FIDELITIES}
        drags = {}
        for at, wanted in enumerate([[0], [1], [2], [0, 1, 2]]):
            go(files["dtu_neutral"])
            run(FIRST)
            found = [frames(run(DRAG, wanted, FRAMES)) for _ in range(rounds)]
            drags[[*FIDELITIES, "all three"][at]] = max(found, key=lambda each: each["a second"])
    return {"name": name, "first": median(first), "open": median(opening), "flights": flights, "frames": drags}


def frames(found: dict[str, Any]) -> dict[str, float]:
    """Frames a second, the share drawn, and the time at work in a frame: median and that of 19 in 20."""
    steps = np.diff(found["stamps"])
    work = np.array(found["work"])
    return {
        "a second": 1e3 / float(steps.mean()), "drawn": found["drawn"] / len(steps),
        "median": float(np.median(work)), "most": float(np.quantile(work, 0.95)),
    }  # fmt: skip


def native(rounds: int) -> dict[str, dict[str, float]]:
    """Least wall times, ms, of the same flights by the native library on one thread."""
    case, found = vibeam.load(CASE), {}
    omega = 2 * np.pi * case.sweep.frequency
    for name in FIDELITIES:
        given = {"omega": omega, "amplitude": case.amplitude_of(name, omega), "output": case.sweep.output, "threads": 1}
        fly = partial(vibeam.batch, case.system(name), **given)
        after = fly(settle=300, hold=50)
        found[name] = {
            "response": _least(partial(fly, settle=300, hold=50), rounds),
            "live": _least(partial(fly, state=after, settle=20, hold=10), rounds),
        }
    return found


def _least(act: Callable[[], object], rounds: int) -> float:
    times = []
    for _ in range(rounds):
        begun = time.perf_counter()
        act()
        times.append(time.perf_counter() - begun)
    return 1e3 * min(times)


def written(folder: Path) -> tuple[dict[str, Path], dict[str, dict[str, float]]]:
    """Pages of cases, their bytes, those of the kernels within, and the CPU time of writing them."""
    files, sizes = {}, {}
    for stem in SIZES:
        begun = time.process_time()
        text = vibeam.explore(ROOT / f"cases/{stem}.toml").html
        spent = time.process_time() - begun
        files[stem] = folder / f"{Path(stem).name}.html"
        files[stem].write_text(text, encoding="utf-8")
        libraries = json.loads(text.split('<script id="engine" type="application/json">')[1].split("</script>")[0])
        kernels = sum(map(len, libraries["libraries"].values()))
        sizes[stem] = {"page": files[stem].stat().st_size, "kernels": kernels, "seconds": spent}
    return files, sizes


def main() -> None:
    """Measure, print and store."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--out", type=Path, default=HERE / "results" / "page_frames.json")
    given = parser.parse_args()
    before = os.getloadavg()
    with TemporaryDirectory() as folder:
        files, sizes = written(Path(folder))
        browsers = [in_browser(each, files, given.rounds) for each in (chromium, firefox)]
    found = {
        "pages": sizes, "native": native(FLIGHTS * given.rounds), "browsers": browsers, "rounds": given.rounds,
        "flights": FLIGHTS * given.rounds,
        "cores": os.cpu_count(), "python": platform.python_version(),
        "load": {"before": before, "after": os.getloadavg()},
    }  # fmt: skip
    given.out.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    print(json.dumps(found, indent=1))


if __name__ == "__main__":
    main()
