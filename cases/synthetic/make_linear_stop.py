"""Write ``linear_stop.csv``: up-sweep of the rig of ``linear_stop.toml`` with other keys and noise. No measurement.

Twelve modes in place of eight; stiffness, gap and gain in ``TRUTH``. Amplitudes have normal noise of 1 % (seed 5).

    python cases/synthetic/make_linear_stop.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import vibeam

HERE = Path(__file__).parent
TRUTH = {"stop.stiffness": "20 N/mm", "stop.gap": "0.05 mm", "drive.gain": "6e-4 1/V"}
FREQUENCIES = np.arange(12.0, 17.01, 0.25)
SPREAD, SEED = 0.01, 5


def text() -> str:
    """The file: frequency and amplitude with their units in the heads."""
    changes = TRUTH | {"sweep.frequency": [f"{each} Hz" for each in FREQUENCIES], "fidelity.beam.modes": 12}
    case = vibeam.load(HERE / "linear_stop.toml", set=changes | {"fit": None, "reference": None})
    curve = vibeam.run(case, show=False)["beam"].up
    measured = curve.amplitude * (1 + SPREAD * np.random.default_rng(SEED).standard_normal(len(curve)))
    rows = [f"{f:.4f},{1e3 * value:.6f}" for f, value in zip(curve.frequency, measured, strict=True)]
    return "\n".join(["Frequency [Hz],Amplitude [mm]", *rows]) + "\n"


if __name__ == "__main__":
    (HERE / "linear_stop.csv").write_text(text(), encoding="utf-8")
