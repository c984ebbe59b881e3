"""Draw ``suffices.png``: one and eight modes of the harvester, an amplitude error and a frequency error in it.

Its numbers go to ``suffices.json``.

    python cases/suffices/make_figure.py
"""

from __future__ import annotations

import json
from pathlib import Path

import matplotlib.pyplot as plt

import vibeam

HERE = Path(__file__).parent
RED, BLUE = "#D55E00", "#0072B2"
MODELS = {"beam": ("eight modes", "0.25", 2.6), "sdof": ("one degree of freedom", BLUE, 1.2)}


def main() -> None:
    """Run the case, write the numbers, draw the picture."""
    case = vibeam.load(HERE.parent / "rigs" / "harvester.toml", {"fidelity.free": None, "sweep.direction": "up"})
    result = vibeam.run(case)
    [sdof] = [each.comparison for each in result.compare() if each.fidelity == "sdof"]
    assert sdof is not None
    assert sdof.amplitude is not None
    late = next(each for each in sdof.ends if each.ours.event == "contact is lost")
    numbers = {
        "amplitude_error": abs(sdof.amplitude.error), "at": sdof.amplitude.frequency, "late": late.error,
        "ours": late.ours.frequency, "reference": late.reference.frequency, "kind": sdof.kinds[0].width,
        "kind_from": sdof.kinds[0].low, "kind_to": sdof.kinds[0].high,
    }  # fmt: skip
    (HERE / "suffices.json").write_text(json.dumps(numbers, indent=2) + "\n", encoding="utf-8")
    figure, axes = plt.subplots(figsize=(7.2, 3.8), layout="constrained")
    for name, (label, colour, width) in MODELS.items():
        up = result[name].up
        axes.plot(up.frequency, 1e3 * up.amplitude, color=colour, linewidth=width, label=label)
    at, sizes = sdof.amplitude.frequency, (1e3 * sdof.amplitude.ours, 1e3 * sdof.amplitude.reference)
    axes.annotate("amplitude error", (at, max(sizes)), (50, 0.45), arrowprops={"arrowstyle": "->"}, color=RED)
    axes.plot([at, at], sizes, "|-", color=RED, markersize=8, zorder=5)
    ends = (late.reference.frequency, late.ours.frequency)
    axes.plot(ends, (0.3, 0.3), "|-", color=RED, markersize=12, zorder=5)
    axes.annotate("frequency error", (sum(ends) / 2, 0.3), (69, 0.36), arrowprops={"arrowstyle": "->"}, color=RED)
    axes.set(xlabel="frequency, swept up (Hz)", ylabel="amplitude at the tip (mm)")
    axes.legend(loc="lower left")
    figure.savefig(HERE / "suffices.png", dpi=150)


if __name__ == "__main__":
    main()
